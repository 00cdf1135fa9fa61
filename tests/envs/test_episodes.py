"""How episodes end and begin, in every mode of autoreset."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from .conftest import SHORT, flat

STEPS = 10


def lengths(env, num_envs, total):
    """Lengths of the episodes that end within ``total`` calls of step, counting steps that move."""
    count, found = np.zeros(num_envs, dtype=int), []
    next_step = env.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    begun = np.zeros(num_envs, dtype=bool)
    for _ in range(total):
        _, _, terminated, truncated, _ = env.step(np.zeros((num_envs, 42)))
        count += ~begun
        ended = terminated | truncated
        found += count[ended].tolist()
        count[ended] = 0
        begun = ended & next_step
    return found


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_episodes_are_equally_long_through_make_and_make_vec(any_id, make_vec, mode):
    env = make_vec(any_id, 2, autoreset_mode=mode)
    env.reset(seed=0)
    assert lengths(env, 2, 23) == [STEPS] * 4
    single = gymnasium.make(any_id, duration=SHORT)
    single.reset(seed=0)
    ends = [single.step(np.zeros(42))[2:4] for _ in range(STEPS)]
    assert ends == [(False, False)] * (STEPS - 1) + [(False, True)]
    single.close()


def test_same_step_returns_the_last_observation_aside(env_id, make_vec):
    modes = AutoresetMode.SAME_STEP, AutoresetMode.DISABLED
    same, disabled = (make_vec(env_id, 3, autoreset_mode=mode) for mode in modes)
    first, _ = same.reset(seed=0)
    disabled.reset(seed=0)
    for _ in range(STEPS):
        now, reward, _, truncated, info = same.step(np.zeros((3, 42)))
        expected = disabled.step(np.zeros((3, 42)))
    assert truncated.all() and info["_final_obs"].all()
    np.testing.assert_array_equal(np.stack(list(info["final_obs"])), expected[0])
    np.testing.assert_array_equal(reward, expected[1])
    assert (info["final_info"]["termination_reason"] == "time_limit").all()
    assert not np.array_equal(now, expected[0]) and not np.array_equal(now, first)
    assert (same.elapsed == 0).all()


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_an_automatic_episode_equals_one_asked_for(any_id, make_vec, mode):
    automatic, asked = (make_vec(any_id, 2, autoreset_mode=m) for m in (mode, AutoresetMode.DISABLED))
    # an octopus topples if it clenches
    gently = np.full((2, 42), 0.05)
    for env in (automatic, asked):
        env.reset(seed=0)
        for _ in range(STEPS):
            env.step(gently)
    if mode == AutoresetMode.NEXT_STEP:
        automatic.step(gently)
    asked.reset()
    np.testing.assert_array_equal(automatic.goal, asked.goal)
    for _ in range(3):
        for a, b in zip(automatic.step(gently)[:4], asked.step(gently)[:4], strict=True):
            np.testing.assert_array_equal(flat(a), flat(b))


def test_next_step_begins_with_the_step_after_the_end(any_id, make_vec):
    env, asked = (make_vec(any_id, 2, autoreset_mode=m) for m in (AutoresetMode.NEXT_STEP, AutoresetMode.DISABLED))
    env.reset(seed=0)
    asked.reset(seed=0)
    for _ in range(STEPS):
        _, _, _, truncated, _ = env.step(np.zeros((2, 42)))
    assert truncated.all()
    _, reward, terminated, truncated, _ = env.step(np.ones((2, 42)))
    asked.reset()
    assert (reward == 0.0).all() and not (terminated | truncated).any()
    assert (env.elapsed == 0).all() and np.array_equal(env.levels, asked.levels)


def test_disabled_resets_only_where_asked(any_id, make_vec):
    env = make_vec(any_id, 3, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    before = flat(env.step(np.ones((3, 42)))[0])
    after = flat(env.reset(options={"reset_mask": np.array([False, True, False])})[0])
    np.testing.assert_array_equal(after[[0, 2]], before[[0, 2]])
    assert env.elapsed.tolist() == [1, 0, 1]
    assert not np.array_equal(after[1], before[1])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"reset_mask": [1, 0]}, "reset_mask must be 3 booleans"),
        ({"reset_mask": np.zeros(3, bool)}, "reset_mask must be 3 booleans, at least one"),
        ({"reset_mask": np.array([True, False, False])}, r"first reset must start every .* leaves out \[1, 2\]"),
        ({"reset_maks": np.ones(3, bool)}, "options has no 'reset_maks'; there is 'reset_mask'"),
    ],
)
def test_options_that_cannot_be_are_refused(env_id, make_vec, options, message):
    with pytest.raises(ValueError, match=message):
        make_vec(env_id, 3, autoreset_mode=AutoresetMode.DISABLED).reset(options=options)


def test_infos_say_for_whom_they_are(any_id, make_vec):
    """As in Gymnasium's own batches: the first observation of an episode comes with an empty info."""
    for mode in (AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP):
        env = make_vec(any_id, 2, autoreset_mode=mode)
        env.reset(seed=0)
        for _ in range(STEPS - 1):
            assert env.step(np.zeros((2, 42)))[4]["_distance"].all()
        info = env.step(np.zeros((2, 42)))[4]
        if mode == AutoresetMode.NEXT_STEP:
            assert info["_distance"].all()
            info = env.step(np.zeros((2, 42)))[4]
        assert not info["_distance"].any()


def test_scripted_policy_survives_anothers_divergence(any_id, make_vec):
    env = make_vec(any_id, 3, autoreset_mode=AutoresetMode.NEXT_STEP)
    env.reset(seed=0)
    env.state.v[1, :, 10] = np.nan
    for _ in range(3):
        env.step(env.task.scripted_policy(env))
    assert np.isfinite(env.pose.head).all()


def test_action_of_an_environment_that_begins_is_not_looked_at(any_id, make_vec):
    env = make_vec(any_id, 2, autoreset_mode=AutoresetMode.NEXT_STEP)
    env.reset(seed=0)
    for _ in range(STEPS):
        env.step(np.zeros((2, 42)))
    observations = env.step(np.full((2, 42), np.nan))[0]
    assert np.isfinite(flat(observations)).all()


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_divergence_ends_only_its_own_environment(env_id, make_vec, mode):
    sick, sound = (make_vec(env_id, 3, autoreset_mode=mode) for _ in range(2))
    for env in (sick, sound):
        env.reset(seed=0)
        last = env.step(np.full((3, 42), 0.3))[0]
    sick.state.v[1, :, 10] = np.nan
    observations, rewards, terminated, truncated, info = sick.step(np.full((3, 42), 0.3))
    expected = sound.step(np.full((3, 42), 0.3))
    np.testing.assert_array_equal(observations[[0, 2]], expected[0][[0, 2]])
    np.testing.assert_array_equal(rewards[[0, 2]], expected[1][[0, 2]])
    assert terminated.tolist() == [False, True, False] and not truncated.any()
    assert rewards[1] == sick.task.reward_weights["diverged"] < 0.0
    if mode == AutoresetMode.SAME_STEP:
        np.testing.assert_array_equal(info["final_obs"][1], last[1])
        assert info["final_info"]["termination_reason"][1] == "diverged"
    else:
        np.testing.assert_array_equal(observations[1], last[1])
        assert info["termination_reason"].tolist() == ["", "diverged", ""]
    # and a new episode is sound again
    if mode == AutoresetMode.DISABLED:
        sick.reset(options={"reset_mask": terminated})
    for _ in range(2):
        observations, _, terminated, _, _ = sick.step(np.zeros((3, 42)))
    assert np.isfinite(observations).all() and not terminated.any()
