"""A batch equals single environments, whatever threads compute it."""

import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from elastica_gym.engine import advance, at_rest, build_model, make_state
from elastica_gym.engine.threads import Team

from .scenes import GRAVITY, TIME_STEP, disturb, ground, motion, snake


def batch(n_envs):
    rod = snake(20)
    model = build_model([rod], gravity=GRAVITY, planes=[ground()], activation_time=0.05)
    state, control = at_rest(model, [rod], n_envs)
    rng = np.random.default_rng(0)
    single = at_rest(model, [rod])[0]
    for i in range(n_envs):
        disturb(rod, model, single, rng)
        for name in ("x", "v", "Q", "w"):
            getattr(state, name)[i] = getattr(single, name)[0]
        control.couple[i] = 1e-3 * rng.standard_normal(control.couple[i].shape) * (model.bend > 0.0)
        state.time[i] = 0.1 * i
    return model, state, control


def test_an_environment_of_a_batch_equals_a_single_one():
    model, state, control = batch(5)
    start = [a.copy() for a in state]
    advance(model, state, control, 0, 5, TIME_STEP, 200)
    for i in range(5):
        alone = make_state(model)
        for mine, all_of_them in zip(alone, start, strict=True):
            mine[0] = all_of_them[i]
        own = type(control)(*(a[i : i + 1].copy() for a in control))
        advance(model, alone, own, 0, 1, TIME_STEP, 200)
        for mine, theirs in zip(alone, state, strict=True):
            assert np.array_equal(mine[0], theirs[i])


@pytest.mark.parametrize("n_threads", [2, 5])
def test_threads_do_not_change_results(n_threads):
    one, many = batch(10), batch(10)
    advance(*one, 0, 10, TIME_STEP, 200)
    borders = np.linspace(0, 10, n_threads + 1).astype(int)
    with ThreadPoolExecutor(n_threads) as pool:
        jobs = [pool.submit(advance, *many, int(a), int(b), TIME_STEP, 200) for a, b in zip(borders, borders[1:])]  # noqa: B905, RUF007
        for job in jobs:
            job.result()
    for a, b in zip(one[1], many[1], strict=True):
        assert np.array_equal(a, b)


@pytest.mark.parametrize("n_threads", [1, 2, 5])
def test_a_team_advances_each_environment_once(n_threads):
    one, many = batch(10), batch(10)
    advance(*one, 0, 7, TIME_STEP, 200)
    team, told = pickle.loads(pickle.dumps(Team(*many, n_threads))), []
    assert team.advance(7, TIME_STEP, 200) is None
    assert not np.array_equal(one[1].x, many[1].x)
    Team(*many, n_threads).advance(7, TIME_STEP, 200, told.append)
    assert len(told) == n_threads
    assert sorted(np.concatenate(told)) == list(range(7))
    for a, b in zip(one[1], many[1], strict=True):
        assert np.array_equal(a, b)


def test_only_selected_environments_move():
    model, state, control = batch(4)
    before = state.x.copy()
    advance(model, state, control, 1, 3, TIME_STEP, 10)
    assert np.array_equal(state.x[[0, 3]], before[[0, 3]])
    assert (state.x[1:3] != before[1:3]).any()
    assert state.step.tolist() == [0, 10, 10, 0]
    assert state.time[1] == 0.1 + 10 * TIME_STEP


def test_divergence_of_an_environment_does_not_affect_others():
    whole, broken = batch(3), batch(3)
    motion(broken[0], broken[1], env=1)[1][0, 0] = np.nan
    for scene in (whole, broken):
        advance(*scene, 0, 3, TIME_STEP, 50)
    assert not np.isfinite(broken[1].x[1]).all()
    for a, b in zip(whole[1], broken[1], strict=True):
        assert np.array_equal(a[[0, 2]], b[[0, 2]])
