"""Agreement with PyElastica 1.0.0 in the same scenes; docs/differences.md lists exceptions and their reasons."""

import numpy as np
import pytest

from elastica_gym.engine import Rod, Wave, advance
from elastica_gym.engine.surroundings import Contact, Cylinder, Plane

from .scenes import FRICTION, GRAVITY, TIME_STEP, WAVE, ground, kinked, loop, motion, snake

oracle = pytest.importorskip("tests.engine.oracle", reason="pip install 'elastica-gym[bench]'")

KINETIC = Plane(kinetic_friction=(FRICTION, 1.5 * FRICTION, 2.0 * FRICTION))
RESPONSE = Plane(stiffness=10.0, damping=0.01)
TILTED = Plane(
    origin=(0.0, 1e-4, 0.0),
    normal=(0.1, 0.97, -0.2),
    stiffness=3.0,
    damping=1e-3,
    slip_tolerance=0.05,
    kinetic_friction=(0.3, 0.4, 0.5),
    static_friction=(0.6, 0.5, 0.9),
)
LOADS = {
    "none": {},
    "gravity": dict(gravity=GRAVITY),
    "wave": dict(waves=[WAVE]),
    "wave without ramp": dict(
        waves=[
            Wave(coefficients=(1e-3, 2e-3, 1e-3, 3e-3), period=0.7, wave_number=4.0, phase=0.3, axis=(0.3, 0.4, -0.2))
        ]
    ),
    "response": dict(gravity=GRAVITY, planes=[RESPONSE]),
    "kinetic": dict(gravity=GRAVITY, planes=[KINETIC]),
    "slow, static": dict(gravity=GRAVITY, planes=[ground(slip_tolerance=0.05)]),
    "tilted plane": dict(gravity=GRAVITY, planes=[TILTED]),
    "all": dict(gravity=GRAVITY, planes=[ground()], waves=[WAVE]),
}


@pytest.mark.parametrize(
    "rod",
    [snake(), snake(damping_rate=10.0), kinked(), kinked(rest_kappa=np.zeros((3, 39)))],
    ids=["snake", "damped", "kinked", "straightening"],
)
def test_trajectory_without_friction(rod):
    model, state, control, twin = oracle.both([rod], TIME_STEP, gravity=GRAVITY, waves=[WAVE])
    advance(model, state, control, 0, 1, TIME_STEP, 2000)
    twin.advance(2000)
    assert oracle.distance(model, state, twin) < 1e-9
    assert np.abs(motion(model, state)[0] - rod.position).max() > 1e-4


def test_trajectory_with_friction():
    model, state, control, twin = oracle.both([snake()], TIME_STEP, **LOADS["all"])
    advance(model, state, control, 0, 1, TIME_STEP, 100)
    twin.advance(100)
    assert oracle.distance(model, state, twin) < 1e-9


@pytest.mark.parametrize("loads", LOADS.values(), ids=LOADS.keys())
def test_each_load(loads):
    assert oracle.worst_step([snake(damping_rate=10.0)], TIME_STEP, 60, **loads)[0] < 1e-11


def test_whole_step_from_a_thousand_states():
    assert oracle.worst_step([snake()], TIME_STEP, 1000, **LOADS["all"])[0] < 1e-11


def test_tapered_kinked_rod_on_the_ground():
    rod = kinked(damping_rate=3.0)
    assert oracle.worst_step([rod], TIME_STEP, 100, gravity=GRAVITY, planes=[TILTED])[0] < 1e-11


# contact, corrected in the oracle

ARM = dict(density=1000.0, youngs_modulus=2e4, shear_modulus=8e3, radius=0.025, damping_rate=2.0)
LAW = Contact(stiffness=2e3, damping=2.0, friction=0.4, slip_damping=3.0)
SMOOTH = Contact(stiffness=2e3, damping=2.0)
STEP = 4e-5
OBJECT = Cylinder(
    start=(-0.02, 0.08, 0.02),
    direction=(0.1, 1.0, 0.2),
    normal=(1.0, -0.1, 0.0),
    length=0.3,
    radius=0.05,
    mass=2.0,
    rods=LAW,
    ground_stiffness=1e4,
)


def arm(n: int, start: tuple, direction: tuple) -> Rod:
    normal = np.cross(direction, (0.3, 0.5, -0.8))
    return Rod.straight(n, start=start, direction=direction, normal=normal, length=0.5, **ARM)


SCENES = {
    "rod and cylinder": ([arm(16, (-0.25, 0.15, 0.037), (1.0, 0.1, 0.3))], dict(cylinders=[OBJECT])),
    "on the ground": (
        [arm(16, (-0.25, 0.0245, 0.034), (1.0, 0.0, 0.1))],
        dict(cylinders=[OBJECT], planes=[TILTED], gravity=GRAVITY),
    ),
    "two rods": (
        [arm(12, (-0.25, 0.0, 0.0), (1.0, 0.0, 0.0)), arm(10, (-0.1, 0.047, -0.2), (0.5, 0.0, 0.9))],
        dict(rod_contact=SMOOTH),
    ),
    "self contact": ([loop(40, size=0.3, gap=0.047, **ARM)], dict(rod_contact=SMOOTH)),
}


@pytest.mark.parametrize(("rods", "loads"), SCENES.values(), ids=SCENES.keys())
def test_whole_step_in_contact_from_a_thousand_states(rods, loads):
    worst, n_touching = oracle.worst_step(rods, STEP, 1000, **loads)
    assert worst < 1e-11
    assert n_touching > 900
