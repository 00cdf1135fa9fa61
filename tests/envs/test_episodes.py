"""End and start of episodes in every autoreset mode."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import RecordEpisodeStatistics
from packaging.version import Version

from elastica_gym.envs import TerminationReason
from elastica_gym.scripted import scripted_policy

from .conftest import SHORT, flat, still

STEPS = 10


def lengths(env, num_envs, total):
    """Lengths of the episodes that end within ``total`` calls of step, without reset steps."""
    count, found = np.zeros(num_envs, dtype=int), []
    next_step = env.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    begun = np.zeros(num_envs, dtype=bool)
    for _ in range(total):
        _, _, terminated, truncated, _ = env.step(still(env))
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
    ends = [single.step(still(single))[2:4] for _ in range(STEPS)]
    assert ends == [(False, False)] * (STEPS - 1) + [(False, True)]
    single.close()


def test_same_step_returns_the_final_observation_separately(env_id, make_vec):
    modes = AutoresetMode.SAME_STEP, AutoresetMode.DISABLED
    same, disabled = (make_vec(env_id, 3, autoreset_mode=mode) for mode in modes)
    first, _ = same.reset(seed=0)
    disabled.reset(seed=0)
    for _ in range(STEPS):
        now, reward, _, truncated, info = same.step(still(same))
        expected = disabled.step(still(disabled))
    assert truncated.all() and info["_final_obs"].all()
    np.testing.assert_array_equal(np.stack(list(info["final_obs"])), expected[0])
    np.testing.assert_array_equal(reward, expected[1])
    assert (info["final_info"]["termination_reason"] == TerminationReason.TIME_LIMIT).all()
    assert not np.array_equal(now, expected[0]) and not np.array_equal(now, first)
    assert (same.elapsed == 0).all()


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_an_automatic_episode_equals_one_by_reset(any_id, make_vec, mode):
    automatic, asked = (make_vec(any_id, 2, autoreset_mode=m) for m in (mode, AutoresetMode.DISABLED))
    # an octopus that clenches topples
    gently = still(automatic) + 0.05
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


def test_next_step_resets_in_the_step_after_the_end(any_id, make_vec):
    env, asked = (make_vec(any_id, 2, autoreset_mode=m) for m in (AutoresetMode.NEXT_STEP, AutoresetMode.DISABLED))
    env.reset(seed=0)
    asked.reset(seed=0)
    for _ in range(STEPS):
        _, _, _, truncated, _ = env.step(still(env))
    assert truncated.all()
    _, reward, terminated, truncated, _ = env.step(still(env) + 1.0)
    asked.reset()
    assert (reward == 0.0).all() and not (terminated | truncated).any()
    assert (env.elapsed == 0).all() and np.array_equal(env.levels, asked.levels)


def test_disabled_resets_only_selected_environments(any_id, make_vec):
    env = make_vec(any_id, 3, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    before = flat(env.step(still(env) + 1.0)[0])
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
def test_invalid_options_raise(env_id, make_vec, options, message):
    with pytest.raises(ValueError, match=message):
        make_vec(env_id, 3, autoreset_mode=AutoresetMode.DISABLED).reset(options=options)


def reset_and_steps(env, steps, zeros):
    """The infos of a reset and of some steps."""
    _, info = env.reset(seed=0)
    return [info, *(env.step(zeros)[4] for _ in range(steps))]


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_reset_and_every_step_have_an_info_of_the_same_form(any_id, make_vec, mode):
    env = make_vec(any_id, 2, autoreset_mode=mode)
    single = gymnasium.make(any_id, duration=SHORT)
    together = reset_and_steps(env, STEPS + 1, still(env))
    alone = reset_and_steps(single, STEPS, still(single))
    for info in together:
        forms = {name: (value.shape, value.dtype) for name, value in info.items() if "final" not in name}
        assert forms == {name: (value.shape, value.dtype) for name, value in together[0].items()}
        assert all(info[f"_{name}"].all() for name in alone[0])
        # strings could not be converted to tensors
        assert all(
            value.dtype.kind in "bif"
            for value in (*info.values(), *info.get("final_info", info).values())
            if isinstance(value, np.ndarray) and value is not info.get("final_obs")
        )
    kinds = [{name: type(value) for name, value in info.items()} for info in alone]
    assert kinds == kinds[:1] * len(kinds) and set(kinds[0]) == {n for n in together[0] if not n.startswith("_")}
    single.close()


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_an_automatic_reset_has_the_info_of_a_reset(any_id, make_vec, mode):
    env = make_vec(any_id, 2, autoreset_mode=mode)
    first, *_ = infos = reset_and_steps(env, STEPS + (mode == AutoresetMode.NEXT_STEP), still(env))
    assert not first["is_success"].any() and (first["termination_reason"] == TerminationReason.RUNNING).all()
    for name in (f"reward_{term}" for term in env.task.reward_weights):
        assert (first[name] == 0.0).all() and (infos[-1][name] == 0.0).all()
    np.testing.assert_allclose(first["distance"], 0.0, atol=1e-6)
    assert (infos[-1]["termination_reason"] == TerminationReason.RUNNING).all()
    ended = infos[STEPS].get("final_info", infos[STEPS])
    assert (ended["termination_reason"] == TerminationReason.TIME_LIMIT).all()


def test_a_partial_reset_has_the_info_of_the_reset_environments(any_id, make_vec):
    env = make_vec(any_id, 3, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    env.step(still(env) + 1.0)
    mask = np.array([False, True, False])
    info = env.reset(options={"reset_mask": mask})[1]
    assert all((info[name] == mask).all() for name in info if name.startswith("_"))


def truncated_after(env, shape, most=15):
    """Number of steps until all environments are truncated, and the observations until then."""
    seen = [flat(env.reset(seed=0)[0])]
    for step in range(1, most + 1):
        observations, _, _, truncated, _ = env.step(np.zeros(shape))
        seen.append(flat(observations))
        if np.all(truncated):
            return step, np.array(seen)
    return None, np.array(seen)


@pytest.mark.parametrize(
    ("arguments", "steps"),
    [
        ({"max_episode_steps": 10}, 10),
        ({"max_episode_steps": 10, "duration": 0.25}, 5),
        ({"max_episode_steps": -1, "duration": 0.25}, 5),
        ({"max_episode_steps": None, "duration": 0.25}, 5),
    ],
)
def test_max_episode_steps_and_duration_limit_episodes_of_make_and_make_vec(any_id, arguments, steps):
    batch = gymnasium.make_vec(any_id, num_envs=2, autoreset_mode=AutoresetMode.DISABLED, **arguments)
    single = gymnasium.make(any_id, **arguments)
    many, seen = truncated_after(batch, batch.action_space.shape)
    one, alone = truncated_after(single, single.action_space.shape)
    assert many == one == steps
    np.testing.assert_array_equal(seen[:, 0], alone)
    batch.close()
    single.close()


@pytest.mark.parametrize("steps", [0, -2, 2.5, "10"])
def test_invalid_max_episode_steps_raise(any_id, make_vec, steps):
    with pytest.raises(ValueError, match="max_episode_steps must be a whole number from 1"):
        make_vec(any_id, max_episode_steps=steps)


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_gymnasiums_statistics_are_those_of_whole_episodes(any_id, make_vec, mode):
    if mode == AutoresetMode.SAME_STEP and Version(gymnasium.__version__) < Version("1.4"):
        pytest.skip("before 1.4, this wrapper takes the first step of each later episode for a reset")
    env = RecordEpisodeStatistics(make_vec(any_id, 2, autoreset_mode=mode))
    env.reset(seed=0)
    total, found = np.zeros(2), 0
    for _ in range(2 * STEPS + 3):
        _, reward, terminated, truncated, info = env.step(still(env) + 0.05)
        total += reward
        if (ended := terminated | truncated).all():
            found += 1
            assert info["episode"]["l"].tolist() == [STEPS, STEPS]
            np.testing.assert_allclose(info["episode"]["r"], total, rtol=1e-6, atol=1e-9)
            total[:] = 0.0
            if mode == AutoresetMode.DISABLED:
                env.reset(options={"reset_mask": ended})
    assert found == 2


def test_gymnasium_converts_all_results_of_flat_environments_to_tensors(env_id, make_vec):
    pytest.importorskip("torch")
    pytest.importorskip("array_api_compat")
    from gymnasium.wrappers.vector import NumpyToTorch

    env = NumpyToTorch(make_vec(env_id, 2, autoreset_mode=AutoresetMode.SAME_STEP))
    env.reset(seed=0)
    for _ in range(STEPS):
        info = env.step(env.action_space.sample())[4]
    assert info["final_info"]["termination_reason"].tolist() == [TerminationReason.TIME_LIMIT] * 2


def test_scripted_policy_survives_divergence_of_another_environment(any_id, make_vec):
    env = make_vec(any_id, 3, autoreset_mode=AutoresetMode.NEXT_STEP)
    env.reset(seed=0)
    env.state.v[1, :, 10] = np.nan
    for _ in range(3):
        env.step(scripted_policy(env.task)(env))
    assert np.isfinite(env.pose.head).all()


def test_action_of_an_environment_in_reset_is_ignored(any_id, make_vec):
    env = make_vec(any_id, 2, autoreset_mode=AutoresetMode.NEXT_STEP)
    env.reset(seed=0)
    for _ in range(STEPS):
        env.step(still(env))
    observations = env.step(still(env) + np.nan)[0]
    assert np.isfinite(flat(observations)).all()


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_divergence_ends_only_its_own_environment(env_id, make_vec, mode):
    sick, sound = (make_vec(env_id, 3, autoreset_mode=mode) for _ in range(2))
    for env in (sick, sound):
        env.reset(seed=0)
        last = env.step(still(env) + 0.3)[0]
    sick.state.v[1, :, 10] = np.nan
    observations, rewards, terminated, truncated, info = sick.step(still(sick) + 0.3)
    expected = sound.step(still(sound) + 0.3)
    np.testing.assert_array_equal(observations[[0, 2]], expected[0][[0, 2]])
    np.testing.assert_array_equal(rewards[[0, 2]], expected[1][[0, 2]])
    assert terminated.tolist() == [False, True, False] and not truncated.any()
    assert rewards[1] == sick.task.reward_weights["diverged"] < 0.0
    if mode == AutoresetMode.SAME_STEP:
        np.testing.assert_array_equal(info["final_obs"][1], last[1])
        assert info["final_info"]["termination_reason"][1] == TerminationReason.DIVERGED
    else:
        np.testing.assert_array_equal(observations[1], last[1])
        running, diverged = TerminationReason.RUNNING, TerminationReason.DIVERGED
        assert info["termination_reason"].tolist() == [running, diverged, running]
    # the next episode is valid again
    if mode == AutoresetMode.DISABLED:
        sick.reset(options={"reset_mask": terminated})
    for _ in range(2):
        observations, _, terminated, _, _ = sick.step(still(sick))
    assert np.isfinite(observations).all() and not terminated.any()
