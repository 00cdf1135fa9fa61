"""Agreement with PyElastica 1.0.0, set up the same way; docs/differences.md lists what is left out, and why."""

import numpy as np
import pytest

from elastica_gym.cosserat import Plane, Wave, advance, at_rest, build_model

from .scenes import FRICTION, GRAVITY, TIME_STEP, WAVE, disturb, ground, kinked, motion, snake

oracle = pytest.importorskip("tests.cosserat.oracle", reason="pip install 'elastica-gym[bench]'")

KINETIC = Plane(kinetic_friction=(FRICTION, 1.5 * FRICTION, 2.0 * FRICTION))
RESPONSE = Plane(stiffness=10.0, damping=0.01)
TILTED = Plane(origin=(0.0, 1e-4, 0.0), normal=(0.1, 0.97, -0.2), stiffness=3.0, damping=1e-3, slip_tolerance=0.05,
               kinetic_friction=(0.3, 0.4, 0.5), static_friction=(0.6, 0.5, 0.9))  # fmt: skip
LOADS = {
    "none": {},
    "gravity": dict(gravity=GRAVITY),
    "wave": dict(waves=[WAVE]),
    "wave without ramp": dict(waves=[Wave(coefficients=(1e-3, 2e-3, 1e-3, 3e-3), period=0.7, wave_number=4.0, phase=0.3,
                                          axis=(0.3, 0.4, -0.2))]),
    "response": dict(gravity=GRAVITY, planes=[RESPONSE]),
    "kinetic": dict(gravity=GRAVITY, planes=[KINETIC]),
    "slow, static": dict(gravity=GRAVITY, planes=[ground(slip_tolerance=0.05)]),
    "tilted plane": dict(gravity=GRAVITY, planes=[TILTED]),
    "all": dict(gravity=GRAVITY, planes=[ground()], waves=[WAVE]),
}  # fmt: skip


def scene(rod, dt=TIME_STEP, **loads):
    model = build_model([rod], **loads)
    return model, *at_rest(model, [rod]), oracle.Twin(rod, dt=dt, **loads)


def largest_difference(model, state, twin):
    """Return the largest difference of positions [m]."""
    return np.abs(motion(model, state)[0] - twin.motion[0]).max()


@pytest.mark.parametrize("rod", [snake(), snake(damping_rate=10.0), kinked(), kinked(rest_kappa=np.zeros((3, 39)))],
                         ids=["snake", "damped", "kinked", "straightening"])  # fmt: skip
def test_trajectory_without_friction(rod):
    model, state, control, twin = scene(rod, gravity=GRAVITY, waves=[WAVE])
    advance(model, state, control, 0, 1, TIME_STEP, 2000)
    twin.advance(2000)
    assert largest_difference(model, state, twin) < 1e-9
    assert np.abs(motion(model, state)[0] - rod.position).max() > 1e-4


def test_trajectory_with_friction():
    model, state, control, twin = scene(snake(), **LOADS["all"])
    advance(model, state, control, 0, 1, TIME_STEP, 100)
    twin.advance(100)
    assert largest_difference(model, state, twin) < 1e-9


def worst_step(rod, loads, n_states, dt=TIME_STEP):
    """Return the largest relative difference of the change of v and w in one step, over random states."""
    model, state, control, twin = scene(rod, dt, **loads)
    rng = np.random.default_rng(0)
    worst = 0.0
    for number in range(n_states):
        # sliding (in part, where the slip tolerance is large) or sticking
        disturb(rod, model, state, rng, speed=(1.0, 1e-9)[number % 2])
        state.time[0] = time = rng.uniform(0.0, 3.0)
        before = tuple(a.copy() for a in motion(model, state))
        twin.set_state(*before, time)
        advance(model, state, control, 0, 1, dt, 1)
        twin.advance(1)
        for index in (1, 3):
            ours, theirs, start = motion(model, state)[index], twin.motion[index], before[index]
            worst = max(worst, np.abs(ours - theirs).max() / np.abs(theirs - start).max())
        for index in (0, 2):
            worst = max(worst, np.abs(motion(model, state)[index] - twin.motion[index]).max())
    return worst


@pytest.mark.parametrize("loads", LOADS.values(), ids=LOADS.keys())
def test_each_load(loads):
    assert worst_step(snake(damping_rate=10.0), loads, 60) < 1e-11


def test_whole_step_from_a_thousand_states():
    assert worst_step(snake(), LOADS["all"], 1000) < 1e-11


def test_tapered_kinked_rod_on_the_ground():
    rod = kinked(damping_rate=3.0)
    assert worst_step(rod, dict(gravity=GRAVITY, planes=[TILTED]), 100) < 1e-11
