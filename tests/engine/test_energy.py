"""The work ledger: it adds up, and it finds spurious sources of energy."""

import numpy as np
import pytest

from elastica_gym.engine import Rod, advance, at_rest, build_model, stable_time_step
from elastica_gym.engine.energy import Ledger, energy
from elastica_gym.engine.surroundings import Contact, Cylinder, Plane

N = 20
GRAVITY = (0.0, -9.81, 0.0)


def arm(height: float = 0.0, **material: float) -> Rod:
    return Rod.straight(
        N,
        start=(0.0, height, 0.0),
        direction=(1.0, 0.0, 0.0),
        normal=(0.0, 1.0, 0.0),
        length=0.4,
        radius=0.03,
        density=1000.0,
        youngs_modulus=1e6,
        shear_modulus=1e6 / 1.5,
        **material,
    )


def coiling(model, rod: Rod, cylinders=()) -> tuple:
    """Return State and Control with the muscles commanded to curl the rod out of plane."""
    state, control = at_rest(model, [rod], cylinders=cylinders)
    joints = slice(int(model.first_slot[0]), int(model.first_slot[0]) + N - 1)
    control.couple[:, :, joints] = np.array([8.0, 6.0, 4.0])[:, None] * model.bend[:, joints]
    return state, control


def test_changes_of_energy_are_the_sum_of_works():
    rod = arm(height=0.028, damping_rate=2.0, torque_viscosity=0.05)
    ground = Plane(
        stiffness=1e4,
        damping=10.0,
        kinetic_friction=(0.4, 0.6, 0.8),
        static_friction=(0.8, 1.2, 1.6),
        slip_tolerance=1e-3,
    )
    post = Cylinder(
        start=(0.2, 0.0, 0.075),
        direction=(0.0, 1.0, 0.0),
        normal=(1.0, 0.0, 0.0),
        length=0.3,
        radius=0.05,
        mass=1.0,
        rods=Contact(stiffness=1e4, damping=5.0, friction=0.4, slip_damping=5.0),
        ground_stiffness=1e4,
        ground_damping=20.0,
        ground_friction=0.4,
    )
    model = build_model(
        [rod],
        planes=[ground],
        cylinders=[post],
        gravity=GRAVITY,
        activation_time=0.05,
        is_balanced=True,
        is_reciprocal=True,
    )
    state, control = coiling(model, rod, [post])
    ledger = Ledger(model, state, control)
    ledger.advance(1, 0.2 * stable_time_step(rod), 2000)
    work = ledger.work
    for kind in ("muscles", "damping", "ground friction", "ground damping", "contact friction", "contact damping"):
        assert work[kind][0] * (1 if kind == "muscles" else -1) > 1e-6, kind
    now, start = energy(model, state, control), ledger.start
    kinetic = now.translational + now.rotational - start.translational - start.rotational
    # a drift changes kinetic energy only through spin with a changing section
    assert kinetic == pytest.approx(sum(work.values()), abs=2e-3 * work["muscles"][0])
    assert now.gravitational - start.gravitational == pytest.approx(-work["gravity"], rel=1e-3)


def test_the_ledger_is_bitwise_the_same_as_single_steps():
    rod = arm(height=0.03)
    model = build_model([rod], planes=[Plane(stiffness=1e3)], gravity=GRAVITY, is_balanced=True)
    (one, control), (two, _) = coiling(model, rod), coiling(model, rod)
    dt = 0.5 * stable_time_step(rod)
    Ledger(model, one, control).advance(1, dt, 50)
    for _ in range(50):
        advance(model, two, control, 0, 1, dt, 1)
    np.testing.assert_array_equal(one.x, two.x)
    np.testing.assert_array_equal(one.w, two.w)


def gain_of_a_cycle(is_reciprocal: bool, part: float) -> float:
    """Return the spurious energy of strains, over the work of muscles that bend and release an arm."""
    rod = arm(damping_rate=5.0)
    model = build_model([rod], activation_time=0.05, is_balanced=True, is_reciprocal=is_reciprocal)
    state, control = coiling(model, rod)
    ledger = Ledger(model, state, control)
    dt = part * stable_time_step(rod)
    for _ in range(2):
        ledger.advance(1, dt, round(0.1 / dt))
        control.couple[:] *= -1.0
    return float(ledger.imbalance[0] / ledger.work["muscles"][0])


@pytest.mark.parametrize("part", [0.8, 0.4])
def test_reciprocal_tension_removes_the_energy_gain_of_strong_bends(part):
    assert abs(gain_of_a_cycle(is_reciprocal=False, part=part)) > 5e-3
    assert abs(gain_of_a_cycle(is_reciprocal=True, part=part)) < 1e-3


def test_an_arm_held_bent_by_muscles_does_not_flutter():
    rod = arm(damping_rate=2.0)
    model = build_model([rod], activation_time=0.05, is_balanced=True, is_reciprocal=True)
    state, control = coiling(model, rod)
    dt = 0.5 * stable_time_step(rod)
    advance(model, state, control, 0, 1, dt, round(4.0 / dt))
    assert np.abs(state.v).max() < 0.05
    n = slice(int(model.first_slot[0]), int(model.first_slot[0]) + N)
    np.testing.assert_allclose(state.length[0, n], 0.4 / N, rtol=0.02)
