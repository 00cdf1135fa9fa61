"""PPO of AgileRL on the native batch: ``python scripts/examples/engines/agilerl_ppo.py``.

With the default autoreset (NEXT_STEP), which Gymnasium's normalisation needs. The step that only resets stays in
AgileRL's buffer, as one with reward zero.
"""

import argparse

import gymnasium
import numpy as np
import torch
from agilerl.algorithms import PPO
from agilerl.rollouts import collect_rollouts
from gymnasium.wrappers.vector import NormalizeObservation, NormalizeReward, RecordEpisodeStatistics

import elastica_gym  # noqa: F401  registers the environments

ROLLOUT = 40
STATE = ("last_obs", "last_done", "last_scores", "last_info")


def main() -> None:
    """Train a snake with AgileRL's rollouts and updates, one agent instead of a population."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--env", default="elastica_gym/SnakeForward-v1")
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--num-envs", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    a = parser.parse_args()
    np.random.seed(a.seed)
    torch.manual_seed(a.seed)
    batch = RecordEpisodeStatistics(gymnasium.make_vec(a.env, num_envs=a.num_envs))
    envs = NormalizeReward(NormalizeObservation(batch), gamma=0.98)
    envs.reset(seed=a.seed)
    size = ROLLOUT * a.num_envs
    agent = PPO(
        envs.single_observation_space,
        envs.single_action_space,
        num_envs=a.num_envs,
        learn_step=size,
        batch_size=size // 8,
        update_epochs=8,
        lr=1e-3,
        gamma=0.98,
        gae_lambda=0.92,
        ent_coef=0.0,
        net_config={"encoder_config": {"hidden_size": [128]}, "head_config": {"hidden_size": [128]}},
    )
    # its argument action_std_init is a logarithm, but must not be negative
    agent.actor.head_net.log_std.data.fill_(-1.0)
    state = {}
    for steps in range(size, a.steps + 1, size):
        _, *last = collect_rollouts(agent, envs, ROLLOUT, **state)
        state = dict(zip(STATE, last, strict=True))
        agent.learn()
        if batch.return_queue:
            print(f"steps {steps:>8,}  return {np.mean(batch.return_queue):8.3f}", flush=True)
    envs.close()


if __name__ == "__main__":
    main()
