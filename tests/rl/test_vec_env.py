import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor, VecNormalize, VecVideoRecorder

from elastica_gym.rl.vec_env import BatchVecEnv, make_batch_vec_env
from tests.agents.commands import FORWARD, REACH

DURATION = 0.5
STEPS_PER_EPISODE = 10


def actions(steps: int, n: int) -> np.ndarray:
    return np.random.default_rng(3).uniform(-1.2, 1.2, (steps, n, 42)).astype(np.float32)


@pytest.fixture
def env():
    made = make_batch_vec_env(FORWARD, n_envs=3, duration=DURATION)
    yield made
    made.close()


@pytest.mark.parametrize("env_id", [FORWARD, REACH])
def test_rollouts_equal_those_of_dummy_vec_env(env_id):
    n = 3
    native = make_batch_vec_env(env_id, n_envs=n, duration=DURATION)
    dummy = DummyVecEnv([lambda: Monitor(gymnasium.make(env_id, duration=DURATION))] * n)
    for env in (native, dummy):
        env.seed(5)
    np.testing.assert_array_equal(native.reset(), dummy.reset())
    ends = 0
    for action in actions(25, n):
        ours, theirs = native.step(action), dummy.step(action)
        for mine, other in zip(ours[:3], theirs[:3], strict=True):
            np.testing.assert_array_equal(mine, other)
            assert mine.dtype == other.dtype
        for done, mine, other in zip(ours[2], ours[3], theirs[3], strict=True):
            assert mine["TimeLimit.truncated"] == other["TimeLimit.truncated"]
            assert ("terminal_observation" in mine) == ("terminal_observation" in other) == done
            if done:
                ends += 1
                np.testing.assert_array_equal(mine["terminal_observation"], other["terminal_observation"])
                assert mine["terminal_observation"].dtype == other["terminal_observation"].dtype
                assert mine["is_success"] == other["is_success"]
                assert mine["episode"]["l"] == other["episode"]["l"]
                assert mine["episode"]["r"] == pytest.approx(other["episode"]["r"], abs=1e-6)
    assert ends == 2 * n


def test_normalised_rollouts_equal_those_of_dummy_vec_env():
    native = VecNormalize(make_batch_vec_env(FORWARD, n_envs=2, duration=DURATION))
    dummy = VecNormalize(DummyVecEnv([lambda: gymnasium.make(FORWARD, duration=DURATION)] * 2))
    for env in (native, dummy):
        env.seed(1)
        env.reset()
    for action in actions(12, 2):
        ours, theirs = native.step(action), dummy.step(action)
        for mine, other in zip(ours[:3], theirs[:3], strict=True):
            np.testing.assert_array_equal(mine, other)


def test_reward_terms_of_an_episode_sum_to_its_return(env):
    env.seed(0)
    env.reset()
    for action in actions(2 * STEPS_PER_EPISODE, 3):
        *_, dones, infos = env.step(action)
        for info in (info for info, done in zip(infos, dones, strict=True) if done):
            episode = info["episode"]
            assert sum(episode[key] for key in env.term_keys) == pytest.approx(episode["r"])
            assert info["termination_reason"] == "time_limit"
            assert np.isfinite(episode["distance"])


def test_returned_arrays_do_not_change_later(env):
    first = env.reset()
    kept = first.copy()
    second, rewards, *_ = env.step(actions(1, 3)[0])
    kept_second, kept_rewards = second.copy(), rewards.copy()
    env.step(-actions(1, 3)[0])
    np.testing.assert_array_equal(first, kept)
    np.testing.assert_array_equal(second, kept_second)
    np.testing.assert_array_equal(rewards, kept_rewards)


def test_state_continues_bit_for_bit(env):
    env.seed(2)
    env.reset()
    plan = actions(STEPS_PER_EPISODE + 5, 3)
    for action in plan[:4]:
        env.step(action)
    state = env.get_state()
    expected = [env.step(action) for action in plan[4:]]
    other = make_batch_vec_env(FORWARD, n_envs=3, duration=DURATION)
    other.reset()
    other.set_state(state)
    for action, wanted in zip(plan[4:], expected, strict=True):
        got = other.step(action)
        for mine, theirs in zip(got[:3], wanted[:3], strict=True):
            np.testing.assert_array_equal(mine, theirs)
        for mine, theirs in zip(got[3], wanted[3], strict=True):
            assert mine.get("episode", {}).get("r") == theirs.get("episode", {}).get("r")


def test_same_step_autoreset_is_required():
    batch = gymnasium.make_vec(FORWARD, num_envs=2, autoreset_mode=AutoresetMode.NEXT_STEP)
    with pytest.raises(ValueError, match="SAME_STEP"):
        BatchVecEnv(batch)


def test_attributes_are_those_of_the_batch(env):
    assert env.get_attr("num_envs") == [3, 3, 3]
    assert env.get_attr("control_dt", indices=0) == [env.batch.control_dt]
    assert env.env_is_wrapped(Monitor, indices=[0, 1]) == [True, True]
    assert env.env_is_wrapped(VecMonitor) == [False] * 3
    with pytest.raises(ValueError, match="share 'control_dt'"):
        env.set_attr("control_dt", 0.1, indices=[0])


def test_video_recorder_works(offscreen, tmp_path):
    pytest.importorskip("moviepy")
    native = make_batch_vec_env(FORWARD, n_envs=2, duration=DURATION, render_mode="rgb_array", render_size=(96, 64))
    env = VecVideoRecorder(native, str(tmp_path), record_video_trigger=lambda step: step == 0, video_length=2)
    env.reset()
    # tiled horizontally or vertically
    assert env.render().shape[0] * env.render().shape[1] == 2 * 64 * 96
    for action in actions(3, 2):
        env.step(action)
    env.close()
    (video,) = tmp_path.glob("*.mp4")
    assert video.stat().st_size > 500
