"""Contact against theory: action and reaction, conservation laws, and the cost of the broad phase."""

import numba
import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from elastica_gym.engine import Rod, advance, at_rest, build_model
from elastica_gym.engine.kernels.contact.broad_phase import build_neighbour_list
from elastica_gym.engine.model import Array, Model, State, aligned_zeros
from elastica_gym.engine.surroundings import Contact, Cylinder, Plane

from .scenes import disturb, disturb_body, loop, motion, rotations, without_contact

# so soft that only contact matters
SOFT = dict(density=1000.0, youngs_modulus=1e-3, shear_modulus=1e-3)

seeds = st.integers(0, 2**32 - 1)
laws = st.builds(
    Contact,
    stiffness=st.floats(1.0, 1e5),
    damping=st.floats(0.0, 100.0),
    friction=st.floats(0.0, 2.0),
    slip_damping=st.floats(0.0, 100.0),
)
many = settings(max_examples=100)


def direction(rng: np.random.Generator) -> Array:
    a = rng.standard_normal(3)
    return a / np.linalg.norm(a)


def rod_through(point: Array, rng: np.random.Generator, n: int = 12, radius: float = 0.02, length: float = 0.5) -> Rod:
    """Return a straight rod in a random direction through a point."""
    along = direction(rng)
    start = point - rng.uniform(0.1, 0.9) * length * along
    normal = np.cross(along, direction(rng))
    return Rod.straight(n, start=start, direction=along, normal=normal, length=length, radius=radius, **SOFT)


def cylinder_through(point: Array, law: Contact, rng: np.random.Generator) -> Cylinder:
    along = direction(rng)
    start = point - rng.uniform(-0.1, 1.1) * 0.3 * along
    return Cylinder(
        start=tuple(start),
        direction=tuple(along),
        normal=tuple(np.cross(along, direction(rng))),
        length=0.3,
        radius=0.04,
        mass=0.7,
        rods=law,
        ground_stiffness=1e4,
    )


def contact_loads(model: Model, state: State, control) -> tuple[Array, Array, float]:
    """Return the total force and moment about the origin of contact on rods and bodies, and their size.

    A step of zero duration computes the loads; the small loads without contact are subtracted.
    """
    advance(without_contact(model), state, control, 0, 1, 0.0, 1)
    internal, internal_torque = state.force[0].copy(), state.torque[0].copy()
    advance(model, state, control, 0, 1, 0.0, 1)
    force, torque = state.force[0] - internal, state.torque[0] - internal_torque
    moment = np.cross(state.x[0], force, axis=0).sum(axis=1) + np.einsum("ijk,ik->j", state.Q[0], torque)
    for b in range(model.cylinders.mass.size):
        moment += np.cross(state.body_x[0, b], state.body_force[0, b])
        moment += state.body_Q[0, b].T @ state.body_torque[0, b]
    total = force.sum(axis=1) + state.body_force[0].sum(axis=0)
    return total, moment, float(np.abs(force).sum())


def require_balance(model: Model, state: State, control) -> None:
    total, moment, size = contact_loads(model, state, control)
    assume(size > 1e-3)
    np.testing.assert_allclose(total, 0.0, atol=1e-12 * size)
    np.testing.assert_allclose(moment, 0.0, atol=1e-12 * size)


def shake(rods, model: Model, state: State, rng: np.random.Generator, cylinders=()) -> None:
    for number, rod in enumerate(rods):
        disturb(rod, model, state, rng, number=number)
        Q = motion(model, state, rod=number)[2]
        # also directors not aligned with the tangent
        Q[:] = np.einsum("kij,jlk->ilk", rotations(0.5 * rng.standard_normal((rod.n_elements, 3))), Q.copy())
    for number, cylinder in enumerate(cylinders):
        disturb_body(cylinder, state, rng, number=number)
        state.body_w[0, number] *= 50.0


@many
@given(seed=seeds, law=laws)
def test_action_and_reaction_of_rod_and_cylinder(seed, law):
    rng = np.random.default_rng(seed)
    point = rng.uniform(-0.3, 0.3, 3)
    rods = [rod_through(point + 0.03 * direction(rng), rng)]
    cylinders = [cylinder_through(point, law, rng)]
    model = build_model(rods, cylinders=cylinders)
    state, control = at_rest(model, rods, cylinders=cylinders)
    shake(rods, model, state, rng, cylinders)
    require_balance(model, state, control)
    # apart from friction, the forces on elements balance the force on the cylinder
    pushes = np.abs(state.body_force[0, 0])
    assert state.body_touch[0].sum() * np.sqrt(1.0 + law.friction**2) * (1.0 + 1e-9) > np.linalg.norm(pushes)


@many
@given(seed=seeds, law=laws)
def test_action_and_reaction_of_two_rods(seed, law):
    rng = np.random.default_rng(seed)
    point = rng.uniform(-0.3, 0.3, 3)
    rods = [rod_through(point, rng), rod_through(point + 0.02 * direction(rng), rng, n=9, radius=0.03)]
    model = build_model(rods, rod_contact=law)
    state, control = at_rest(model, rods)
    shake(rods, model, state, rng)
    require_balance(model, state, control)


@many
@given(seed=seeds, law=laws, gap=st.floats(0.005, 0.035))
def test_action_and_reaction_of_a_rod_with_itself(seed, law, gap):
    rng = np.random.default_rng(seed)
    rods = [loop(40, size=0.2, gap=gap, radius=0.02, **SOFT)]
    model = build_model(rods, rod_contact=law)
    state, control = at_rest(model, rods)
    shake(rods, model, state, rng)
    require_balance(model, state, control)


@many
@given(seed=seeds, friction=st.floats(0.0, 2.0), damping=st.floats(0.0, 1e3))
def test_ground_reaction_on_a_cylinder_is_within_the_friction_cone(seed, friction, damping):
    rng = np.random.default_rng(seed)
    along = direction(rng)
    body = Cylinder(
        start=(0.0, rng.uniform(-0.02, 0.05), 0.0),
        direction=tuple(along),
        length=0.3,
        radius=0.05,
        normal=tuple(np.cross(along, direction(rng))),
        mass=0.7,
        rods=Contact(stiffness=1.0),
        ground_stiffness=1e4,
        ground_damping=damping,
        ground_friction=friction,
    )
    rods = [rod_through(np.full(3, 9.0), rng)]
    model = build_model(rods, planes=[Plane()], cylinders=[body])
    state, control = at_rest(model, rods, cylinders=[body])
    shake(rods, model, state, rng, [body])
    x, Q = state.body_x[0, 0].copy(), state.body_Q[0, 0].copy()
    h = 1e-4
    # move to the middle of the step, where loads are computed
    x += 0.5 * h * state.body_v[0, 0]
    Q = rotations(-0.5 * h * state.body_w[0])[0] @ Q
    advance(model, state, control, 0, 1, h, 1)
    N, rubbing, point = (state.body_contact[0, 0][:, part] for part in (0, slice(1, 4), slice(4, 7)))
    assert (N >= 0.0).all() and (np.abs(rubbing[:, 1]) < 1e-9).all()
    # squares of subnormal forces underflow to zero
    assert (np.linalg.norm(rubbing, axis=1) <= friction * N * (1.0 + 1e-9) + 1e-100).all()
    each = rubbing + N[:, None] * [0.0, 1.0, 0.0]
    size = 1e-12 * (1.0 + np.abs(each).sum())
    np.testing.assert_allclose(state.body_force[0, 0], each.sum(axis=0), atol=size)
    np.testing.assert_allclose(state.body_torque[0, 0], Q @ np.cross(point, each).sum(axis=0), atol=size)
    # forces act only at points in the ground
    assert ((x + point)[N > 0.0, 1] < 1e-12).all()


def momenta(model: Model, state: State) -> tuple[Array, Array]:
    """Return momentum, and angular momentum about the origin, of rods and bodies."""
    dilatation = np.where(state.length[0] > 0.0, state.length[0] * model.inv_rest_length, 1.0)
    p, spin = model.mass * state.v[0], model.inertia * state.w[0] / dilatation
    linear = p.sum(axis=1)
    angular = np.cross(state.x[0], p, axis=0).sum(axis=1) + np.einsum("ijk,ik->j", state.Q[0], spin)
    for b in range(model.cylinders.mass.size):
        q = model.cylinders.mass[b] * state.body_v[0, b]
        linear = linear + q
        angular = angular + np.cross(state.body_x[0, b], q)
        angular += state.body_Q[0, b].T @ (model.cylinders.inertia[b] * state.body_w[0, b])
    return linear, angular


def collide(dt: float) -> tuple[Array, Array, float]:
    """Return the changes of momentum and angular momentum as an arm strikes a free cylinder, and the largest force."""
    law = Contact(stiffness=1e4, damping=2.0, friction=0.4, slip_damping=5.0)
    arm = Rod.straight(
        20,
        start=(-0.2, 0.1, -0.4),
        direction=(0.4, 0.0, 0.8),
        normal=(0.0, 1.0, 0.0),
        length=0.4,
        radius=0.025,
        density=1000.0,
        youngs_modulus=1e5,
        shear_modulus=4e4,
    )
    body = Cylinder(
        start=(-0.1, 0.0, -0.1),
        direction=(1.0, 0.0, 0.0),
        normal=(0.0, 1.0, 0.0),
        length=0.3,
        radius=0.05,
        mass=0.5,
        rods=law,
        ground_stiffness=1e4,
    )
    model = build_model([arm], cylinders=[body], is_balanced=True)
    state, control = at_rest(model, [arm], cylinders=[body])
    motion(model, state)[1][:] = np.array([[0.3], [-1.0], [0.2]])
    advance(model, state, control, 0, 1, 0.0, 1)
    before = momenta(model, state)
    hardest = 0.0
    for _ in range(40):
        advance(model, state, control, 0, 1, dt, round(0.001 / dt))
        hardest = max(hardest, float(state.body_touch.max()))
    after = momenta(model, state)
    linear, angular = (np.linalg.norm(b - a) / np.linalg.norm(a) for a, b in zip(before, after, strict=True))
    return linear, angular, hardest


def test_arm_and_object_conserve_their_total_momentum():
    linear, angular, hardest = collide(5e-5)
    assert hardest > 10.0
    assert linear < 1e-12
    # loads conserve angular momentum equally well, but kicks of angular velocity in the rotating frame are first order
    assert angular < 1e-6
    assert collide(2.5e-5)[1] < 0.55 * angular


def coil(n: int) -> Rod:
    """Return a coiled rod with turns 1 cm apart: the number of neighbours does not depend on its length."""
    t = np.arange(n + 1) * 0.2
    nodes = np.array([0.1 * np.cos(t), 0.1 * np.sin(t), 0.03 * t / (2.0 * np.pi)])
    return Rod.through(nodes, normal=(0.0, 0.0, 1.0), radius=np.full(n, 0.01), **SOFT)


@numba.njit
def listed_and_met(contact, state):
    s = state
    begin, end, reach = s.scratch[0, 0], s.scratch[0, 1], s.neighbour_reach[0]
    return build_neighbour_list(
        s.order[0], begin, end, s.x[0], reach, contact.last_clear, 2.0 * contact.stray, s.neighbours[0]
    )


def test_pairs_of_the_broad_phase_grow_with_the_rod():
    counts = []
    for n in (200, 400, 800):
        rod = coil(n)
        model = build_model([rod], rod_contact=Contact(stiffness=1.0))
        state, control = at_rest(model, [rod])
        advance(model, state, control, 0, 1, 0.0, 1)
        counts.append(listed_and_met(model.rod_contact, state))
    for short, middling, long in zip(*counts, strict=True):
        assert 0 < long - middling < 2.2 * (middling - short)
        assert long < 0.15 * 800 * 799 / 2


def test_rebuilding_the_neighbour_list_changes_nothing():
    """An old and a new list hold different pairs, but give bitwise the same result."""
    rod = coil(80)
    law = Contact(stiffness=50.0, friction=0.3, slip_damping=1e-3)
    model = build_model([rod], rod_contact=law, gravity=(0.0, 0.0, -1.0))
    ends = []
    for lists_anew in (False, True):
        state, control = at_rest(model, [rod])
        state.v[0, 2] = np.linspace(1.0, -1.0, state.v.shape[2])
        for _ in range(100):
            if lists_anew:
                state.n_neighbours[:] = -1
            advance(model, state, control, 0, 1, 1e-5, 20)
        assert state.rod_touch.max() > 0.0
        ends.append([field.copy() for field in (state.x, state.v, state.Q, state.w)])
    for old, new in zip(*ends, strict=True):
        np.testing.assert_array_equal(old, new)


def test_more_pairs_than_fit_the_list():
    rod = coil(80)
    model = build_model([rod], rod_contact=Contact(stiffness=50.0))
    state, control = at_rest(model, [rod])
    cramped = state._replace(
        neighbours=aligned_zeros((1, 4), np.int64),
        **{name: getattr(state, name).copy() for name in State._fields if name != "neighbours"},
    )
    for each in (state, cramped):
        each.v[0, 2] = np.linspace(1.0, -1.0, state.v.shape[2])
        advance(model, each, control, 0, 1, 1e-5, 2000)
    assert cramped.n_neighbours[0] > 4 and state.rod_touch.max() > 0.0
    np.testing.assert_array_equal(state.x, cramped.x)
