"""Hindsight experience replay trains on the goal-conditioned environments through `BatchVecEnv`."""

import numpy as np
import pytest
from stable_baselines3 import SAC, HerReplayBuffer

from elastica_gym.envs import GOAL_IDS
from elastica_gym.rl.vec_env import make_batch_vec_env


@pytest.mark.parametrize("env_id", GOAL_IDS)
def test_sac_with_hindsight_trains(env_id):
    env = make_batch_vec_env(env_id, n_envs=4, duration=1.0)
    model = SAC(
        "MultiInputPolicy",
        env,
        replay_buffer_class=HerReplayBuffer,
        learning_starts=160,
        batch_size=64,
        seed=0,
        replay_buffer_kwargs=dict(n_sampled_goal=4, goal_selection_strategy="future"),
        policy_kwargs=dict(net_arch=[32, 32]),
        train_freq=4,
        gradient_steps=2,
    )
    before = [p.detach().numpy().copy() for p in model.actor.parameters()]
    model.learn(400)
    assert any(not np.array_equal(a, p.detach().numpy()) for a, p in zip(before, model.actor.parameters(), strict=True))
    assert all(np.isfinite(p.detach().numpy()).all() for p in model.policy.parameters())
    sample = model.replay_buffer.sample(256)
    rewards = sample.rewards.numpy().ravel()
    after = {name: values.numpy() for name, values in sample.next_observations.items()}
    near = env.batch.compute_reward(after["achieved_goal"], after["desired_goal"], {})
    # relabelled transitions are rewarded for their new goal; without relabelling all rewards would be zero
    np.testing.assert_array_equal(rewards, near)
    assert rewards.mean() > 0.1
    env.close()
