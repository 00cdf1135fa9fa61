"""No tunnelling: an arm at full strength against itself, another arm, an object and the ground."""

import numpy as np
import pytest

from elastica_gym.engine import Rod, advance, at_rest, build_model
from elastica_gym.engine.model import NEAR, Array, Model, State
from elastica_gym.engine.surroundings import Contact, Cylinder, Plane

from .scenes import GRAVITY

N, LENGTH, BASE, TIP = 50, 0.4, 0.03, 0.025
FULL = 2.0 * np.pi * 1.15 / LENGTH
"""Curvature of a free arm at full muscle strength: more than a turn [1/m]"""
STEP = 4e-5
LAW = Contact(stiffness=1e5, damping=20.0, friction=0.4, slip_damping=50.0)
LARGEST = 5e-3
"""Allowed penetration [m]"""


def arm(start: tuple, direction: tuple, normal: tuple) -> Rod:
    return Rod.straight(
        N,
        start=start,
        direction=direction,
        normal=normal,
        length=LENGTH,
        radius=np.linspace(BASE, TIP, N),
        density=1000.0,
        youngs_modulus=1e6,
        shear_modulus=1e6 / 1.5,
        damping_rate=5.0,
    )


def segments(model: Model, state: State, rod: int) -> tuple[Array, Array, Array, Array]:
    """Return starts, edges, radii and arc lengths of a rod's elements."""
    start, n = int(model.first_slot[rod]), int(model.n_elements[rod])
    x = state.x[0][:, start : start + n + 1].T
    edge = np.diff(x, axis=0)
    return x[:-1], edge, state.radius[0, start : start + n], np.cumsum(model.rest_length[start : start + n])


def depth(a: Array, e: Array, r1: Array, b: Array, f: Array, r2: Array) -> Array:
    """Return the pairwise overlaps of segments, by the smallest distance over 33 points of each first one."""
    s = np.linspace(0.0, 1.0, 33)[:, None, None]
    points = a + s * e
    t = np.clip(((points - b) * f).sum(axis=-1) / (f * f).sum(axis=-1), 0.0, 1.0)
    return r1 + r2 - np.linalg.norm(points - b - t[..., None] * f, axis=-1).min(axis=0)


def among_rods(model: Model, state: State) -> float:
    """Return the largest overlap of elements that are not close along the same rod."""
    deepest = 0.0
    for one in range(model.n_elements.size):
        for two in range(one, model.n_elements.size):
            (a, e, r1, s1), (b, f, r2, s2) = segments(model, state, one), segments(model, state, two)
            between = np.linalg.norm((a + 0.5 * e)[:, None] - (b + 0.5 * f), axis=-1)
            close = between < r1[:, None] + r2 + 2.0 * LENGTH / N
            if one == two:
                close &= s2 - s1[:, None] > NEAR * np.pi * 0.5 * (r1[:, None] + r2) + 1.5 * LENGTH / N
            i, j = np.nonzero(close)
            deepest = max(deepest, float(depth(a[i], e[i], r1[i], b[j], f[j], r2[j]).max(initial=0.0)))
    return deepest


def with_object(model: Model, state: State) -> float:
    axis, length = state.body_Q[0, 0, 2], model.cylinders.length[0]
    a, e, r, _ = segments(model, state, 0)
    start = np.broadcast_to(state.body_x[0, 0] - 0.5 * length * axis, a.shape)
    return float(depth(a, e, r, start, np.broadcast_to(length * axis, a.shape), model.cylinders.radius[0]).max())


def with_ground(model: Model, state: State) -> float:
    a, e, r, _ = segments(model, state, 0)
    return float((r - a[:, 1] - 0.5 * e[:, 1]).max())


GROUND = Plane(
    stiffness=1e4, damping=10.0, kinetic_friction=(0.5, 0.5, 0.5), static_friction=(0.5, 0.5, 0.5), slip_tolerance=1e-3
)
OBJECT = Cylinder(
    start=(0.2, -0.3, 0.078),
    direction=(0.0, 1.0, 0.0),
    normal=(1.0, 0.0, 0.0),
    length=0.6,
    radius=0.05,
    mass=4.0,
    rods=LAW,
    ground_stiffness=1e5,
)
ALONG = arm((0.0, 0.03, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
ACROSS = arm((0.2, -0.2, 0.057), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
CASES = {
    "itself": ([ALONG], dict(rod_contact=LAW), 0, among_rods),
    "another arm": ([ALONG, ACROSS], dict(rod_contact=LAW), 0, among_rods),
    "object": ([ALONG], dict(cylinders=[OBJECT]), 0, with_object),
    "ground": ([ALONG], dict(planes=[GROUND], gravity=GRAVITY), 1, with_ground),
}


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("rods", "surroundings", "axis", "measure"), CASES.values(), ids=CASES.keys())
def test_full_strength_does_not_tunnel(rods, surroundings, axis, measure, sign):
    model = build_model(rods, activation_time=0.05, **surroundings)
    state, control = at_rest(model, rods, cylinders=surroundings.get("cylinders", ()))
    joints = slice(int(model.first_slot[0]), int(model.first_slot[0]) + N - 1)
    control.couple[:, axis, joints] = sign * FULL * model.bend[axis, joints]
    deepest, touched = 0.0, 0.0
    for _ in range(400):
        advance(model, state, control, 0, 1, STEP, 40)
        deepest = max(deepest, measure(model, state))
        touched = max(touched, float((state.body_touch + state.rod_touch + state.normal_force).max()))
    assert np.isfinite(state.x).all() and deepest > 1e-4
    # there was strong contact
    turns = abs(state.kappa[0, axis] @ model.rest_voronoi_length) / (2.0 * np.pi)
    assert touched > 10.0 and turns > 0.7
    assert deepest < LARGEST
