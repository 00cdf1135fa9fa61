"""Clamped and jointed rods in the engine, against theory and against the library."""

import numpy as np
import pytest

import elastica_gym.cosserat as ea
from elastica_gym.engine import Joint, Rod, advance, at_rest, build_model, stable_time_step
from elastica_gym.engine.stability import require_stable_model

from .scenes import motion

X, Y, Z = np.eye(3)
LENGTH, RADIUS, N = 0.5, 0.01, 20
MATERIAL = dict(radius=RADIUS, density=1000.0, youngs_modulus=1e6, shear_modulus=4e5)


def straight(start=(0.0, 0.0, 0.0), n=N, **more):
    return Rod.straight(n, start=start, direction=X, normal=Y, length=LENGTH, **MATERIAL, **more)


def test_a_clamped_rod_sags_as_a_cantilever():
    """Tip deflection w L^4 / (8 E I), with w the weight per length; the clamp holds half an element."""
    rod, g, n = straight(n=40, damping_rate=4.0), 0.05, 40
    model = build_model([rod], gravity=-g * Y, clamped=[0])
    state, control = at_rest(model, [rod])
    dt = 0.5 * stable_time_step(rod)
    x, v, Q, w = motion(model, state)
    base = x[:, :1].copy(), Q[..., 0].copy()
    advance(model, state, control, 0, 1, dt, round(6.0 / dt))
    area = np.pi * RADIUS**2
    expected = 1000.0 * area * g * LENGTH**4 / (8.0 * 1e6 * np.pi / 4.0 * RADIUS**4)
    assert -x[1, -1] == pytest.approx(expected * (1.0 - 0.5 / n) ** 4, rel=0.01)
    # held exactly
    np.testing.assert_array_equal(x[:, :1], base[0])
    np.testing.assert_array_equal(Q[..., 0], base[1])
    assert not v[:, 0].any() and not w[:, 0].any()


class Simulator(ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Connections, ea.Damping):
    pass


def test_two_jointed_rods_swing_as_in_the_library():
    """The first one is clamped, both under gravity."""
    law = dict(stiffness=200.0, damping=0.05, turn_stiffness=0.5, turn_damping=1e-4)
    rods = [straight(), straight(start=(LENGTH, 0.0, 0.0))]
    model = build_model(rods, gravity=-9.81 * Y, joints=[Joint(rods=(0, 1), ends=(-1, 0), **law)], clamped=[0])
    state, control = at_rest(model, rods)
    dt, sim, systems = 2e-5, Simulator(), []
    for rod in rods:
        system = ea.CosseratRod.straight_rod(N, rod.position[:, 0], X, Y, LENGTH, RADIUS, 1000.0, youngs_modulus=1e6,
                                             shear_modulus=4e5)  # fmt: skip
        sim.append(system)
        sim.add_forcing_to(system).using(ea.GravityForces, -9.81 * Y)
        systems.append(system)
    sim.constrain(systems[0]).using(ea.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    sim.connect(*systems, -1, 0).using(ea.FixedJoint, k=200.0, nu=0.05, kt=0.5, nut=1e-4)
    sim.finalize()
    advance(model, state, control, 0, 1, dt, 5000)
    ea.integrate(ea.PositionVerlet(), sim, 5000 * dt, 5000, progress_bar=False)
    for number, system in enumerate(systems):
        x, _, Q, _ = motion(model, state, rod=number)
        assert np.abs(x[1]).max() > 0.01
        np.testing.assert_allclose(x, system.position_collection, atol=1e-9)
        np.testing.assert_allclose(Q, system.director_collection, atol=1e-8)


def test_a_stiff_joint_limits_the_time_step():
    rods = [straight(), straight(start=(LENGTH, 0.0, 0.0))]
    model = build_model(rods, joints=[Joint(rods=(0, 1), ends=(-1, 0), stiffness=1e9)])
    with pytest.raises(ValueError, match=r"the time step must be below .* for a joint of rod 0 and rod 1"):
        require_stable_model(model, 1e-5)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (dict(clamped=[2]), "clamped must be numbers from 0 to 1, not 2"),
        (dict(joints=[Joint(rods=(0, 3), ends=(-1, 0), stiffness=1.0)]), "rods of a joint must be numbers .* not 3"),
    ],
)
def test_missing_rods_are_named(wrong, message):
    with pytest.raises(ValueError, match=message):
        build_model([straight(), straight()], **wrong)


def test_arguments_of_a_joint_are_checked():
    with pytest.raises(ValueError, match="with ends 0 or -1, not"):
        Joint(rods=(0, 1), ends=(1, 0), stiffness=1.0)
    with pytest.raises(ValueError, match="stiffness must be"):
        Joint(rods=(0, 1), ends=(0, 0), stiffness=0.0)
