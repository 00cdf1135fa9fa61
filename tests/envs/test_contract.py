"""Invariants of every registered environment: a new one is tested for free."""

import copy
import itertools
import multiprocessing
import pickle
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from elastica_gym.envs import BatchEnv, task_of

from .conftest import SHORT, flat, random_actions, still


def roll(env, actions, seed):
    """Observations, rewards and terminations of a batch, from a reset with a seed."""
    observations, _ = env.reset(seed=seed)
    seen, rewards, ends = [flat(observations)], [], []
    for action in actions:
        observations, reward, terminated, truncated, _ = env.step(action)
        seen.append(flat(observations))
        rewards.append(reward)
        ends.append((terminated, truncated))
    return np.array(seen), np.array(rewards), np.array(ends)


def assert_same(first, second):
    for a, b in zip(first, second, strict=True):
        np.testing.assert_array_equal(flat(a), flat(b))


def test_gymnasium_checker_accepts_it(env_id, cannot_draw):
    env = gymnasium.make(env_id, duration=SHORT, render_size=(64, 48))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped, skip_render_check=bool(cannot_draw))
    env.close()


def test_same_seed_gives_the_same_bits(any_id, make_vec):
    actions = random_actions(any_id, 0, 12, 2)
    assert_same(roll(make_vec(any_id), actions, 5), roll(make_vec(any_id), actions, 5))


def test_second_episode_equals_that_of_a_fresh_environment(any_id, make_vec):
    actions = random_actions(any_id, 1, 12, 2)
    used = make_vec(any_id)
    roll(used, random_actions(any_id, 2, 7, 2), 3)
    assert_same(roll(used, actions, 11), roll(make_vec(any_id), actions, 11))


@pytest.mark.parametrize(("num_envs", "n_threads"), [(1, 1), (3, 1), (3, 2), (17, 2), (17, 5)])
def test_environment_of_a_batch_equals_the_single_one(env_id, make_vec, num_envs, n_threads):
    actions = random_actions(env_id, 4, 13, 17)[:, :num_envs]
    batch = make_vec(env_id, num_envs, n_threads=n_threads, autoreset_mode=AutoresetMode.DISABLED)
    seen, rewards, ends = roll(batch, actions[:10], 100)
    single = gymnasium.make(env_id, duration=SHORT)
    for i in {0, num_envs // 2, num_envs - 1}:
        observation, _ = single.reset(seed=100 + i)
        np.testing.assert_array_equal(observation, seen[0, i])
        for t in range(10):
            observation, reward, terminated, truncated, _ = single.step(actions[t, i])
            np.testing.assert_array_equal(observation, seen[t + 1, i])
            assert reward == rewards[t, i]
            assert (terminated, truncated) == tuple(ends[t, :, i])
    single.close()


def test_integer_seed_counts_up_over_the_batch(any_id, make_vec):
    together, listed = (flat(make_vec(any_id, 3).reset(seed=seed)[0]) for seed in (7, [7, 8, 9]))
    np.testing.assert_array_equal(together, listed)
    assert not np.array_equal(together[0], together[1])


@pytest.mark.parametrize(
    "seed", [[1, 2], 1.5, "3", "345", [1.7, 2.2, 3.9], np.array([1.0, 2.0, 3.0]), ["1", "2", "3"], np.array(3)], ids=str
)
def test_invalid_seeds_raise(env_id, make_vec, seed):
    with pytest.raises(ValueError, match="seed must be a whole number or 3 of them"):
        make_vec(env_id, 3).reset(seed=seed)


def test_generators_are_the_environments_own(env_id, make_vec):
    env = make_vec(env_id, 3)
    env.reset(seed=np.array([4, 5, 6]))
    assert env.np_random_seed == (4, 5, 6)
    single = gymnasium.make(env_id, duration=SHORT).unwrapped
    first, _ = single.reset(seed=5)
    assert single.np_random_seed == 5 and single.np_random is single.batch.np_random[0]
    single.np_random = np.random.Generator(np.random.PCG64(1))
    one, _ = single.reset()
    single.np_random = np.random.Generator(np.random.PCG64(1))
    two, _ = single.reset()
    np.testing.assert_array_equal(one, two)
    assert not np.array_equal(first, one)


def test_different_seeds_give_different_returns(env_id, make_vec):
    env = make_vec(env_id, 8)
    _, rewards, _ = roll(env, [still(env)] * 10, 0)
    assert len(set(rewards.sum(axis=0))) == 8


def test_every_declared_observation_is_written(env_id, make_vec):
    env = make_vec(env_id, 2)
    env._observations[:] = np.nan
    observations, _ = env.reset(seed=0)
    assert np.isfinite(observations).all()


def test_no_observation_is_constant(env_id, make_vec):
    env = make_vec(env_id, 16, duration=2.0)
    seen, _, _ = roll(env, random_actions(env_id, 5, 40, 16), 0)
    env.reset(seed=1)
    skin = env.body.sensors.skin
    for i, patch in enumerate(itertools.pairwise(skin) if env.body.cylinders else []):
        # every part of the body comes close to the object
        k = sum(patch) // 2
        env.state.body_x[i, 0, [0, 2]] = env.state.x[i, [0, 2], k]
        env.state.body_x[i, 0, 0] += env.state.radius[i, k] + env.body.cylinders[0].radius - 0.003
    # before the object is pushed away
    env.n_substeps = 2
    touching = env.step(still(env))[0]
    seen = np.concatenate([seen, touching[None]])
    constant = np.flatnonzero(np.ptp(seen.reshape(-1, seen.shape[-1]), axis=0) == 0.0)
    assert [env.observation_names[k] for k in constant] == []


def test_observations_are_named_and_within_their_space(env_id, make_vec):
    env = make_vec(env_id, 8, duration=2.0)
    assert len(env.observation_names) == env.single_observation_space.shape[0] == len(set(env.observation_names))
    seen, _, _ = roll(env, random_actions(env_id, 6, 40, 8), 0)
    assert seen.dtype == np.float32
    assert np.isfinite(env.single_observation_space.high).all()
    assert all(env.single_observation_space.contains(o) for o in seen.reshape(-1, seen.shape[-1]))


def test_returned_arrays_are_the_callers_own(env_id, make_vec):
    env = make_vec(env_id)
    first, _ = env.reset(seed=0)
    kept = first.copy()
    second = env.step(still(env) + 1.0)[0]
    np.testing.assert_array_equal(first, kept)
    assert not np.shares_memory(first, second)
    assert not np.shares_memory(second, env._observations)


def test_reward_is_the_sum_of_its_terms(any_id, make_vec):
    env = make_vec(any_id, 4)
    env.reset(seed=0)
    for action in random_actions(any_id, 7, 10, 4):
        _, reward, _, _, info = env.step(action)
        terms = [info[f"reward_{name}"] for name in env.task.reward_weights]
        np.testing.assert_allclose(np.sum(terms, axis=0), reward, rtol=1e-12, atol=1e-15)


def test_state_continues_bit_for_bit(any_id, make_vec):
    actions = random_actions(any_id, 8, 16, 3)
    env = make_vec(any_id, 3, autoreset_mode=AutoresetMode.SAME_STEP)
    roll(env, actions[:4], 0)
    saved = pickle.loads(pickle.dumps(env.get_state()))
    other = make_vec(any_id, 3, autoreset_mode=AutoresetMode.SAME_STEP)
    other.set_state(saved)
    # past the end of an episode, so that the generators are compared too
    for action in actions[4:]:
        assert_same(env.step(action)[:4], other.step(action)[:4])


def test_state_of_another_batch_raises(any_id, make_vec):
    env = make_vec(any_id, 3)
    env.reset(seed=0)
    with pytest.raises(ValueError, match="num_envs is 3; here it is 2"):
        make_vec(any_id, 2).set_state(env.get_state())


@pytest.mark.parametrize("changed", [{"control_dt": 0.1}, {"sim_dt": 1e-4}, {"duration": 1.0}])
def test_state_of_an_environment_with_other_arguments_raises(any_id, make_vec, changed):
    env = make_vec(any_id)
    env.reset(seed=0)
    before = env.get_state()
    with pytest.raises(ValueError, match="the state is of an environment whose"):
        env.set_state(make_vec(any_id, **{"duration": SHORT, **changed}).get_state())
    assert_same(before["physics"].values(), env.get_state()["physics"].values())


def test_pickled_environment_continues_identically(any_id, make_vec):
    env = make_vec(any_id)
    roll(env, random_actions(any_id, 9, 3, 2), 0)
    pickled = pickle.loads(pickle.dumps(env))
    for action in random_actions(any_id, 10, 9, 2):
        assert_same(env.step(action)[:4], pickled.step(action)[:4])


def _worker(env_id, queue):
    import elastica_gym  # noqa: F401  # a spawned process must register the ids

    env = gymnasium.make_vec(env_id, num_envs=3, duration=SHORT, n_threads=2)
    queue.put(roll(env.unwrapped, random_actions(env_id, 11, 3, 3), 2))


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_worker_processes_give_the_same(env_id, make_vec, method):
    here = roll(make_vec(env_id, 3, n_threads=2), random_actions(env_id, 11, 3, 3), 2)
    context = multiprocessing.get_context(method)
    queue = context.Queue()
    process = context.Process(target=_worker, args=(env_id, queue))
    process.start()
    assert_same(queue.get(timeout=120), here)
    process.join(timeout=30)
    assert process.exitcode == 0


def test_gymnasiums_class_is_a_direct_base(any_id, make_vec):
    """skrl checks only direct bases."""
    for env in (make_vec(any_id), gymnasium.make(any_id).unwrapped):
        assert any(base.__module__.startswith("gymnasium.") for base in type(env).__bases__)


def test_a_deep_copy_continues_identically(any_id, make_vec):
    env = make_vec(any_id)
    roll(env, random_actions(any_id, 9, 3, 2), 0)
    copied = copy.deepcopy(env)
    for action in random_actions(any_id, 10, 9, 2):
        assert_same(env.step(action)[:4], copied.step(action)[:4])


def test_closing_twice_is_fine(any_id):
    for env in (gymnasium.make(any_id), gymnasium.make_vec(any_id, num_envs=2)):
        env.close()
        env.close()


def test_actions_of_another_shape_raise(env_id, make_vec):
    env = make_vec(env_id)
    env.reset(seed=0)
    n = env.body.n_activations
    for shape in ((n,), (2, n - 1), (3, n), (2, 1, n)):
        with pytest.raises(ValueError, match=rf"actions must have shape \(2, {n}\), not"):
            env.step(np.zeros(shape))


def test_nan_actions_raise_and_nothing_moves(any_id, make_vec):
    env = make_vec(any_id)
    env.reset(seed=0)
    actions = still(env)
    actions[1, 3] = np.nan
    with pytest.raises(ValueError, match="environment 1 hold NaN"):
        env.step(actions)
    assert env.elapsed.tolist() == [0, 0]


def test_actions_out_of_range_are_clipped(any_id, make_vec):
    wild = 5.0 * random_actions(any_id, 12, 10, 2)
    assert_same(roll(make_vec(any_id), wild, 0), roll(make_vec(any_id), np.clip(wild, -1.0, 1.0), 0))


def test_step_before_reset_raises(any_id, make_vec):
    with pytest.raises(RuntimeError, match="reset"):
        env = make_vec(any_id)
        env.step(still(env))


@pytest.mark.parametrize(
    ("kwargs", "message"),
    [
        ({"num_envs": 0}, "num_envs must be a whole number from 1 to 4096, not 0"),
        ({"num_envs": 2.5}, "num_envs must be a whole number from 1 to 4096, not 2.5"),
        ({"sim_dt": 3e-4}, "sim_dt: the time step must be below"),
        ({"sim_dt": 0.0}, "sim_dt must be a positive number, not 0.0"),
        ({"control_dt": -0.1}, "control_dt must be a positive number, not -0.1"),
        ({"duration": float("nan")}, "duration must be a positive number, not nan"),
        ({"duration": 0}, "duration must be a positive number, not 0"),
        ({"n_threads": 0}, "n_threads must be a whole number from 1"),
        ({"n_threads": -1}, "n_threads must be a whole number from 1"),
        ({"autoreset_mode": "same_step"}, "autoreset_mode must be .* 'SameStep'"),
        ({"weights": {"speed": 1.0}}, "no term 'speed'"),
        ({"weights": {"diverged": float("nan")}}, "must be a finite number, not nan"),
        ({"body_kwargs": {"legs": 4}}, "body_kwargs: .* unexpected keyword argument 'legs'"),
        ({"spread": "nowhere"}, "spread must be one of .*, not 'nowhere'"),
        ({"render_mode": "human"}, "render_mode must be 'rgb_array' or None, not 'human'"),
        ({"render_size": (640, 0)}, r"render_size must be a width and a height from 1 to 2048, .*, not \(640, 0\)"),
        ({"render_size": 640}, "render_size must be a width and a height from 1 to 2048, .*, not 640"),
    ],
)
def test_invalid_arguments_raise_at_construction(env_id, kwargs, message):
    with pytest.raises(ValueError, match=message):
        BatchEnv(task_of(env_id), **kwargs)


@pytest.mark.parametrize("env_id", ["elastica_gym/SnakeReach-v1", "elastica_gym/OctopusFetch-v1"])
def test_four_thousand_animals_at_once(env_id, make_vec):
    env = make_vec(env_id, 4096, control_dt=1e-3, duration=0.002, autoreset_mode=AutoresetMode.SAME_STEP)
    env.reset(seed=0)
    for _ in range(2):
        _, _, terminated, truncated, _ = env.step(still(env))
    # a few of them start at their target
    assert (terminated | truncated).mean() > 0.99
