"""Free rigid cylinders, alone and on planes, against theory."""

import numpy as np
import pytest

from elastica_gym.engine import Rod, advance, at_rest, build_model
from elastica_gym.engine.model import Array, Model, State
from elastica_gym.engine.surroundings import Contact, Cylinder, Plane

G = 9.80665
DT = 1e-4
LENGTH, RADIUS, MASS = 0.6, 0.05, 4.0
# far from everything, since a model needs a rod
BYSTANDER = Rod.straight(
    2,
    start=(50.0, 50.0, 50.0),
    direction=(1.0, 0.0, 0.0),
    normal=(0.0, 1.0, 0.0),
    length=0.1,
    radius=0.01,
    density=1000.0,
    youngs_modulus=1e3,
    shear_modulus=1e3,
)


def cylinder(**options: object) -> Cylinder:
    """Return the object, lying along +z on the plane y = 0."""
    given = dict(
        start=(0.0, RADIUS, -0.5 * LENGTH),
        direction=(0.0, 0.0, 1.0),
        normal=(0.0, 1.0, 0.0),
        length=LENGTH,
        radius=RADIUS,
        mass=MASS,
        rods=Contact(stiffness=1e3),
        ground_stiffness=1e5,
        ground_damping=300.0,
        ground_friction=0.4,
    )
    return Cylinder(**{**given, **options})


def scene(body: Cylinder, *, slope: float = 0.0, along: tuple[float, float] = (0.0, 1.0), ground: bool = True):
    """Return a cylinder under gravity tilted by ``slope`` [rad], downhill along (x, z)."""
    gravity = G * np.array([np.sin(slope) * along[0], -np.cos(slope), np.sin(slope) * along[1]])
    model = build_model([BYSTANDER], planes=[Plane()] if ground else [], gravity=gravity, cylinders=[body])
    return model, *at_rest(model, [BYSTANDER], cylinders=[body])


def angular_momentum(model: Model, state: State) -> Array:
    """Return the body's angular momentum about its centre, in the lab [N m s]."""
    return state.body_Q[0, 0].T @ (model.cylinders.inertia[0] * state.body_w[0, 0])


def test_inertia_depends_on_the_square_of_the_length():
    # uniform cylinder, by summing slices: J = int (r^2/4 + z^2) dm
    z = (np.arange(2000) + 0.5) / 2000 * LENGTH - 0.5 * LENGTH
    J = cylinder().inertia
    assert J[0] == pytest.approx(MASS * np.mean(0.25 * RADIUS**2 + z**2), rel=1e-6)
    assert J[2] == pytest.approx(0.5 * MASS * RADIUS**2)


def test_free_fall_and_free_spin():
    model, state, control = scene(cylinder(), ground=False)
    state.body_v[0, 0], state.body_w[0, 0] = (1.0, 2.0, -1.0), (3.0, -2.0, 5.0)
    start, before, w = state.body_x[0, 0].copy(), angular_momentum(model, state), state.body_w[0, 0].copy()
    n = 2000
    advance(model, state, control, 0, 1, DT, n)
    t = n * DT
    fallen = t * np.array([1.0, 2.0 - 0.5 * G * t, -1.0])
    assert state.body_x[0, 0] == pytest.approx(start + fallen, abs=1e-9)
    np.testing.assert_allclose(angular_momentum(model, state), before, rtol=1e-3)
    # Euler's equations of a symmetric top: the transverse part rotates at w3 (J1 - J3)/J1
    J = model.cylinders.inertia[0]
    angle = w[2] * (J[0] - J[2]) / J[0] * t
    c, s = np.cos(angle), np.sin(angle)
    expected = np.array([w[0] * c + w[1] * s, w[1] * c - w[0] * s, w[2]])
    np.testing.assert_allclose(state.body_w[0, 0], expected, rtol=1e-3)
    np.testing.assert_allclose(state.body_Q[0, 0] @ state.body_Q[0, 0].T, np.eye(3), atol=1e-12)


@pytest.mark.parametrize("excess", [-0.05, 0.05])
def test_sticks_and_slips_at_its_threshold_on_an_incline(excess):
    slope = np.arctan(0.4) + excess
    model, state, control = scene(cylinder(), slope=slope)
    advance(model, state, control, 0, 1, DT, 5000)
    settled, v = state.body_x[0, 0, 2], state.body_v[0, 0, 2]
    advance(model, state, control, 0, 1, DT, 5000)
    travelled, t = state.body_x[0, 0, 2] - settled, 5000 * DT
    if excess < 0.0:
        assert abs(travelled) < 1e-6
    else:
        acceleration = G * (np.sin(slope) - 0.4 * np.cos(slope))
        assert travelled == pytest.approx(v * t + 0.5 * acceleration * t**2, rel=1e-3)


def test_rolls_down_an_incline_without_slip():
    slope = 0.2
    model, state, control = scene(cylinder(), slope=slope, along=(1.0, 0.0))
    advance(model, state, control, 0, 1, DT, 5000)
    t = 5000 * DT
    # a solid cylinder: g sin / (1 + 1/2)
    assert state.body_v[0, 0, 0] == pytest.approx(G * np.sin(slope) / 1.5 * t, rel=0.01)
    # rolling, w3 r = -v: +z is the axis, +x downhill, y up
    assert state.body_w[0, 0, 2] * RADIUS == pytest.approx(-state.body_v[0, 0, 0], rel=1e-3)


def upright(tilt: float) -> Cylinder:
    """Return the object on the rim of its end, tilted towards +x [rad]."""
    axis = np.array([np.sin(tilt), np.cos(tilt), 0.0])
    start = RADIUS * np.array([-np.cos(tilt), np.sin(tilt), 0.0])
    return cylinder(start=tuple(start), direction=tuple(axis), normal=(0.0, 0.0, 1.0))


@pytest.mark.parametrize(("share", "stands"), [(0.0, True), (0.7, True), (1.3, False)])
def test_stands_or_tips_over(share, stands):
    model, state, control = scene(upright(share * np.arctan(2.0 * RADIUS / LENGTH)))
    advance(model, state, control, 0, 1, DT, 20000)
    height = state.body_x[0, 0, 1]
    assert height == pytest.approx(0.5 * LENGTH if stands else RADIUS, abs=2e-3)
    assert np.isfinite(state.body_Q).all()


def test_lies_at_rest():
    model, state, control = scene(cylinder())
    advance(model, state, control, 0, 1, DT, 5000)
    # two points carry the weight
    assert state.body_x[0, 0, 1] == pytest.approx(RADIUS - 0.5 * MASS * G / 1e5, abs=1e-6)
    assert np.abs(state.body_v).max() < 1e-6


def test_ground_never_pulls():
    model, state, control = scene(cylinder(ground_damping=1e4))
    state.body_v[0, 0, 1] = 1.0
    state.body_x[0, 0, 1] -= 1e-4
    advance(model, state, control, 0, 1, 1e-6, 1)
    assert state.body_force[0, 0, 1] == pytest.approx(-MASS * G)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (dict(mass=0.0), "mass must be a positive number, not 0.0"),
        (dict(ground_friction=-0.1), "ground_friction must be zero or a positive number, not -0.1"),
        (dict(normal=(0.0, 0.0, 2.0)), "must be perpendicular to direction"),
    ],
)
def test_errors_of_cylinders(options, message):
    with pytest.raises(ValueError, match=message):
        cylinder(**options)


def test_a_model_requires_its_cylinders():
    model, *_ = scene(cylinder())
    with pytest.raises(ValueError, match="cylinders must be 1, as in the model, not 0"):
        at_rest(model, [BYSTANDER])
