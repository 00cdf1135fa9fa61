"""Progress of tasks with an object, and that rewards cannot be collected by moving back and forth."""

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from elastica_gym.envs.handling import FEWEST, KEPT, WRAPPED, Handling

from .conftest import random_actions, still

RETURN, GRAB, MOVE, FETCH = (f"elastica_gym/Octopus{name}-v1" for name in ("Return", "Grab", "Move", "Fetch"))


def test_an_object_held_at_the_start_is_and_stays_wrapped(make_vec):
    """By either arm, in any orientation."""
    env = make_vec(RETURN, 12, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    levels = env.levels.copy()
    assert set(levels[:, [0, 7]].argmax(axis=1)) == {0, 1}
    assert (env.situation().progress.span > WRAPPED).all()
    for _ in range(10):
        _, _, terminated, _, _ = env.step(levels)
    held = env.situation().progress
    assert not terminated.any() and (held.span > WRAPPED).all() and (held.grabbed == 1.0).all()
    assert np.degrees(held.tilt).max() < 10.0


def test_releasing_the_object_costs_once(make_vec):
    env = make_vec(RETURN, 2, duration=2.0, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    rewards = np.array([env.step(still(env))[1] for _ in range(20)])
    assert ((rewards < -10.0).sum(axis=0) == 1).all()
    # not immediately: a weaker hold is allowed for 0.2 s
    assert (rewards[:4] > -1.0).all()


def test_the_object_is_grabbed_after_half_a_second_of_wrapping(make_vec):
    env, held = (make_vec(task, 6, duration=2.0, autoreset_mode=AutoresetMode.DISABLED) for task in (GRAB, RETURN))
    held.reset(seed=0)
    env.reset(seed=0)
    for mine, other in zip(env.state, held.state, strict=True):
        mine[...] = other
    for step in range(1, 12):
        _, _, terminated, _, info = env.step(held.levels)
        # wrapped at the ends of steps 1 to 11, which span half a second
        assert info["is_success"].tolist() == terminated.tolist() == [step == 11] * 6
    assert (info["reward_success"] == 10.0).all() and (info["reward_early"] > 7.0).all()


def test_moving_counts_only_during_contact(make_vec):
    """Two octopuses are displaced by 2 cm together with their objects; one holds its object."""
    env = make_vec(RETURN, 2, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    env.state.body_x[1, 0, 0] += 3.0
    env.state.x[:, 2] += 0.02
    env.state.body_x[:, 0, 2] += 0.02
    # a step so short that nothing moves
    env.n_substeps, env.sim_dt = 1, 1e-9
    env.step(env.levels.copy())
    after = env.situation().progress
    np.testing.assert_allclose(after.moved_z, [0.02, 0.0], atol=1e-6)
    np.testing.assert_allclose(after.moved_x, 0.0, atol=1e-6)


@pytest.mark.parametrize("task", [MOVE, GRAB, RETURN, FETCH])
def test_progress_is_numeric_and_part_of_the_state(make_vec, task):
    env = make_vec(task, 3)
    env.reset(seed=0)
    for action in random_actions("elastica_gym/OctopusGrab-v1", 0, 5, 3):
        env.step(action)
    assert env.progress.shape == (3, len(Handling._fields)) and np.isfinite(env.progress).all()
    saved, kept = env.get_state(), env.progress.copy()
    env.reset(seed=1)
    env.set_state(saved)
    np.testing.assert_array_equal(env.progress, kept)


def test_the_bounds_are_those_of_the_hackathon():
    np.testing.assert_allclose(np.degrees([WRAPPED, KEPT]), [200.0, 150.0])
    assert FEWEST == 5
