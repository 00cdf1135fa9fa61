"""Rods that cross cylinders and rods in the middle of elements, against PyElastica 1.0.0.

Only there do both put half of a force on each node of an element; elsewhere PyElastica's contact gains energy.
"""

import numpy as np
import pytest

from elastica_gym.engine import Rod, advance, at_rest, build_model
from elastica_gym.engine.model import Array, State
from elastica_gym.engine.surroundings import Contact, Cylinder

from .scenes import loop, without_contact

K, NU, MU, C = 1e3, 1e-3, 0.3, 2.0
SMOOTH = Contact(stiffness=K, damping=NU)
ROUGH = Contact(stiffness=K, damping=NU, friction=MU, slip_damping=C)
# so soft that only contact matters
SOFT = dict(density=1000.0, youngs_modulus=1e-3, shear_modulus=1e-3)


def straight(n: int, start: tuple, direction: tuple, **material: float) -> Rod:
    tangent = np.asarray(direction) / np.linalg.norm(direction)
    normal = np.cross(tangent, (0.3, 0.5, -0.8))
    return Rod.straight(
        n, start=start, direction=direction, normal=normal, length=1.0, radius=0.02, **{**SOFT, **material}
    )


def knot() -> Rod:
    """Return a rod that crosses itself at a right angle, 0.03 m higher."""
    return loop(60, size=0.2, gap=0.03, radius=0.02, **SOFT)


def object_in_the_way(rods: Contact) -> Cylinder:
    return Cylinder(
        start=(-0.1, 0.0, 0.0),
        direction=(1.0, 0.0, 0.0),
        normal=(0.0, 1.0, 0.0),
        length=0.2,
        radius=0.05,
        mass=4.0,
        rods=rods,
        ground_stiffness=1e4,
    )


def nodes_of(model, rod: int) -> slice:
    start = int(model.first_slot[rod])
    return slice(start, start + int(model.n_elements[rod]) + 1)


def shake(model, state: State, rods, rng: np.random.Generator, size: float) -> None:
    """Displace nodes by ``size`` [m] and give them velocities of 0.1 m/s."""
    for number, rod in enumerate(rods):
        where = nodes_of(model, number)
        state.x[0][:, where] = rod.position + size * rng.standard_normal(rod.position.shape)
        state.v[0][:, where] = 0.1 * rng.standard_normal(rod.position.shape)


def contact_forces(model, state: State, control) -> Array:
    """Return the nodal forces of contact in a state, computed by a step of zero duration."""
    advance(without_contact(model), state, control, 0, 1, 0.0, 1)
    internal = state.force[0].copy()
    advance(model, state, control, 0, 1, 0.0, 1)
    return state.force[0] - internal


def elements(model, state, rod: int) -> tuple[Array, Array, Array, Array, Array]:
    """Return starts, radii, lengths, tangents and nodal velocities of a rod, contiguous."""
    where = nodes_of(model, rod)
    x = state.x[0][:, where]
    edge = np.diff(x, axis=1)
    length = np.linalg.norm(edge, axis=0)
    own = slice(where.start, where.stop - 1)
    return (
        np.ascontiguousarray(x[:, :-1]),
        state.radius[0, own].copy(),
        length,
        edge / length,
        np.ascontiguousarray(state.v[0][:, where]),
    )


def compare(ours: Array, theirs: Array) -> float:
    return float(np.abs(ours - theirs).max() / np.abs(theirs).max())


@pytest.fixture(scope="module")
def oracle():
    return pytest.importorskip("elastica._contact_functions", reason="pip install 'elastica-gym[bench]'")


def oblique(rng: np.random.Generator) -> Array:
    """Return a horizontal direction, not too close to the x-axis."""
    turn = rng.uniform(0.9, 2.2)
    return np.array([np.cos(turn), 0.0, np.sin(turn)])


@pytest.mark.parametrize("contact", [SMOOTH, ROUGH], ids=["smooth", "rough"])
def test_rod_on_cylinder_agrees_with_the_oracle(oracle, contact):
    rng = np.random.default_rng(0)
    body, rods = object_in_the_way(contact), [straight(21, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))]
    model = build_model(rods, cylinders=[body])
    state, control = at_rest(model, rods, cylinders=[body])
    for _ in range(1000):
        height, across, direction = rng.uniform(0.068, 0.0695), rng.uniform(-0.03, 0.03), oblique(rng)
        rods = [straight(21, tuple(np.array([across, height, 0.0]) - 0.5 * direction), tuple(direction))]
        shake(model, state, rods, rng, 0.0)
        state.body_v[0, 0] = 0.1 * rng.standard_normal(3)
        ours = contact_forces(model, state, control)[:, nodes_of(model, 0)]
        start, radius, length, tangent, velocity = elements(model, state, 0)
        force, body_force, body_torque = np.zeros((3, 22)), np.zeros((3, 1)), np.zeros((3, 1))
        # PyElastica computes friction per half contact, so its slip damping is half of ours
        oracle._calculate_contact_forces_rod_cylinder(
            start,
            length * tangent,
            body.centre,
            body.centre - 0.5 * body.length * body.directors[2],
            body.length * body.directors[2],
            radius + body.radius,
            length + body.length,
            force,
            force,
            body_force,
            body_torque,
            np.ascontiguousarray(state.body_Q[0, 0]),
            velocity,
            state.body_v[0, 0][:, None].copy(),
            K,
            NU,
            0.5 * contact.slip_damping,
            contact.friction,
        )
        assert compare(ours, force) < 1e-11
        assert compare(state.body_force[0, 0], body_force[:, 0]) < 1e-11
        if contact is SMOOTH:
            lever = body.radius * np.abs(body_force).max()
            assert np.abs(state.body_torque[0, 0] - body_torque[:, 0]).max() < 1e-11 * lever


def end_to_end(model, state) -> list[Array]:
    """Return the first two rods as one, joined by a thin element far away."""
    far = (np.full((3, 1), 1e6), np.full(1, 1e-9), np.ones(1), np.eye(3)[:, :1], np.zeros((3, 0)))
    return [
        np.concatenate(parts, axis=-1)
        for parts in zip(elements(model, state, 0), far, elements(model, state, 1), strict=True)
    ]


def test_rod_on_rod_agrees_with_the_oracle(oracle):
    # as self contact: between rods the oracle adds the loads that press them together, including contact's own
    rng = np.random.default_rng(1)
    rods = [straight(n, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)) for n in (15, 19)]
    model = build_model(rods, rod_contact=SMOOTH)
    state, control = at_rest(model, rods)
    for _ in range(1000):
        direction = oblique(rng)
        start = np.array([0.0, rng.uniform(0.036, 0.039), 0.0]) - 0.5 * direction
        rods = [straight(15, (-0.5, 0.0, 0.0), (1.0, 0.0, 0.0)), straight(19, tuple(start), tuple(direction))]
        shake(model, state, rods, rng, 0.0)
        ours = contact_forces(model, state, control)
        theirs = np.zeros((3, 36))
        oracle._calculate_contact_forces_self_rod(*end_to_end(model, state), theirs, K, NU)
        assert compare(ours[:, nodes_of(model, 0)], theirs[:, :16]) < 1e-11
        assert compare(ours[:, nodes_of(model, 1)], theirs[:, 16:]) < 1e-11


def test_contact_never_pulls():
    rods = [straight(15, (-0.5, 0.0, 0.0), (1.0, 0.0, 0.0)), straight(20, (0.0, 0.039, -0.5), (0.0, 0.0, 1.0))]
    contact = Contact(stiffness=1.0, damping=100.0)
    model = build_model(rods, rod_contact=contact)
    state, control = at_rest(model, rods)
    state.v[0, 1, nodes_of(model, 1)] = 1.0
    assert np.abs(contact_forces(model, state, control)).max() < 1e-12


def test_order_of_the_sweep_does_not_matter():
    rng = np.random.default_rng(3)
    rods = [knot()]
    model = build_model(rods, rod_contact=ROUGH)
    state, control = at_rest(model, rods)
    shake(model, state, rods, rng, 5e-4)
    first = contact_forces(model, state, control)
    state.order[0] = rng.permutation(state.order[0])
    np.testing.assert_array_equal(contact_forces(model, state, control), first)


def test_models_without_bodies_and_contacts_allocate_nothing_for_them():
    model = build_model([knot()])
    state, _ = at_rest(model, [knot()])
    assert state.body_x.size == state.body_contact.size == state.order.size == 0
