"""Goal-conditioned environments: the reward is a function of achieved and desired goal; nothing else uses the goal."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from elastica_gym.envs import GOAL_IDS, task_of

from .conftest import SHORT, random_actions, still
from .toy import TOY_GOAL


@pytest.fixture(params=(*GOAL_IDS, TOY_GOAL))
def goal_id(request):
    return request.param


def test_gymnasium_checker_accepts_it(goal_id, cannot_draw):
    env = gymnasium.make(goal_id, duration=SHORT, render_size=(64, 48))
    check_env(env.unwrapped, skip_render_check=bool(cannot_draw))
    env.close()


def test_environment_of_a_batch_equals_the_single_one(goal_id, make_vec):
    actions = random_actions(GOAL_IDS[0], 4, 10, 3)
    batch = make_vec(goal_id, 3, autoreset_mode=AutoresetMode.DISABLED)
    single = gymnasium.make(goal_id, duration=SHORT)
    together, _ = batch.reset(seed=100)
    alone, _ = single.reset(seed=102)
    assert batch.observation_space.contains(together) and single.observation_space.contains(alone)
    for action in actions:
        for name, values in together.items():
            np.testing.assert_array_equal(values[2], alone[name])
        together, rewards, *_ = batch.step(action)
        alone, reward, *_ = single.step(action[2])
        assert (
            reward == rewards[2] == single.unwrapped.compute_reward(alone["achieved_goal"], alone["desired_goal"], {})
        )
    single.close()


def test_only_the_desired_goal_depends_on_the_goal(goal_id, make_vec):
    """If two batches differ only in their goals, only desired goals and rewards differ."""
    env, moved = make_vec(goal_id, 2), make_vec(goal_id, 2)
    for each in (env, moved):
        each.reset(seed=0)
    moved.goal[:, :2] = moved.pose.head[:, [0, 2]]
    action = random_actions(GOAL_IDS[0], 0, 1, 2)[0]
    (first, _, _, _, _), (second, reward, terminated, _, _) = env.step(action), moved.step(action)
    np.testing.assert_array_equal(first["observation"], second["observation"])
    np.testing.assert_array_equal(first["achieved_goal"], second["achieved_goal"])
    assert (first["desired_goal"] != second["desired_goal"]).any(axis=1).all()
    # the head hardly moves in one step
    assert reward.tolist() == [1.0, 1.0] and terminated.all()


def test_rewards_of_many_goals_at_once(goal_id, make_vec):
    env = make_vec(goal_id, 1)
    rng = np.random.default_rng(0)
    achieved, desired = rng.uniform(-0.3, 0.3, (2, 50, 2)).astype(np.float32)
    tolerance = task_of(goal_id).tolerance
    rewards = env.compute_reward(achieved, desired, [{}] * 50)
    np.testing.assert_array_equal(rewards, np.hypot(*(achieved - desired).T) <= tolerance)
    assert 0.0 < rewards.mean() < 1.0
    assert [float(env.compute_reward(a, d, {})) for a, d in zip(achieved, desired, strict=True)] == rewards.tolist()


def test_the_final_observation_of_an_episode_is_returned_separately(goal_id, make_vec):
    env = make_vec(goal_id, 2, autoreset_mode=AutoresetMode.SAME_STEP)
    env.reset(seed=0)
    for _ in range(10):
        now, _, _, truncated, info = env.step(still(env))
    assert truncated.all()
    for i, last in enumerate(info["final_obs"]):
        assert env.single_observation_space.contains(last)
        assert (last["desired_goal"] != now["desired_goal"][i]).any()


def test_weights_raise(goal_id, make_vec):
    """Otherwise rewards of `step` would differ from those of `compute_reward`."""
    for make in (gymnasium.make, make_vec):
        with pytest.raises(ValueError, match=r"weights cannot be given .*, not {.reached.: 2"):
            make(goal_id, weights={"reached": 2.0})
