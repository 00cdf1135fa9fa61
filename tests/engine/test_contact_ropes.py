"""Static contact against theory: ropes that cross, hang over a post or lie in a pile."""

import numpy as np
import pytest

import elastica_gym.cosserat as ea
from elastica_gym.engine import Rod, advance, at_rest, build_model, stable_time_step
from elastica_gym.engine.model import Array
from elastica_gym.engine.surroundings import Contact, Cylinder

from .scenes import motion

X, Y, Z = np.eye(3)
YOUNG = 3e5
GRAVITY = -9.80665 * Y


class Simulator(ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Contact, ea.Damping):
    pass


def add_rope(sim: Simulator, nodes: Array, radius: float, damping: float) -> ea.CosseratRod:
    """Add a rope through nodes, straight at rest, with gravity."""
    edges = np.diff(nodes, axis=1)
    tangent = edges[:, 0] / np.linalg.norm(edges[:, 0])
    rope = ea.CosseratRod.straight_rod(
        edges.shape[1],
        nodes[:, 0],
        tangent,
        np.cross(tangent, Y),
        float(np.linalg.norm(edges, axis=0).sum()),
        radius,
        1000.0,
        youngs_modulus=YOUNG,
        shear_modulus=YOUNG / 3.0,
        position=nodes,
    )
    sim.append(rope)
    sim.add_forcing_to(rope).using(ea.GravityForces, GRAVITY)
    dt = step_of(rope)
    sim.dampen(rope).using(ea.AnalyticalLinearDamper, uniform_damping_constant=damping, time_step=dt)
    return rope


def step_of(rope: ea.CosseratRod) -> float:
    """Return half the stable step of a rope [s]."""
    return 0.5 * ea.stable_time_step(rope)


def run(sim: Simulator, dt: float, duration: float) -> None:
    n_steps = round(duration / dt)
    ea.integrate(ea.PositionVerlet(), sim, n_steps * dt, n_steps, progress_bar=False)


# two ropes that cross


def crossing(one: Array, two: Array) -> tuple[float, float]:
    """Return the crossing of two polygons seen from above, in elements from the middle of each."""
    for i in range(one.shape[1] - 1):
        for j in range(two.shape[1] - 1):
            e, f = one[[0, 2], i + 1] - one[[0, 2], i], two[[0, 2], j + 1] - two[[0, 2], j]
            s, t = np.linalg.solve(np.stack([e, -f], axis=1), two[[0, 2], j] - one[[0, 2], i])
            if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0:
                return i + s - 0.5 * (one.shape[1] - 1), j + t - 0.5 * (two.shape[1] - 1)
    raise AssertionError("the ropes do not cross")


@pytest.mark.parametrize(
    ("n", "within"), [pytest.param(20, 0.2, id="at a node"), pytest.param(21, 0.55, id="in the middle of an element")]
)
def test_crossing_ropes_stay_where_statics_puts_them(n, within):
    """By symmetry at the middle; if that is inside an element, the load slides to a node (docs/differences.md)."""
    s, span, radius, sim = np.linspace(-0.5, 0.5, n + 1), 0.3, 2e-3, Simulator()
    below = np.array([span * s, -0.05 * (1.0 - 4.0 * s**2), 0.0 * s])
    # initially slightly to one side
    above = np.array([0.0 * s + 0.1 * span / n, -0.05 + 2.1 * radius - 0.12 * s**2, span * s])
    ropes = [add_rope(sim, nodes, radius, damping=5.0) for nodes in (below, above)]
    for rope in ropes:
        sim.constrain(rope).using(ea.FixedConstraint, constrained_position_idx=(0, -1))
    dt, m = step_of(ropes[0]), ropes[0].mass[1]
    sim.detect_contact_between(*ropes).using(ea.RodRodContact, k=0.05 * m / dt**2, nu=0.05 * m / dt)
    sim.finalize()
    run(sim, dt, 6.0)
    found = crossing(*(rope.position_collection for rope in ropes))
    run(sim, dt, 1.0)
    assert crossing(*(rope.position_collection for rope in ropes)) == pytest.approx(found, abs=1e-3)
    assert max(np.abs(rope.velocity_collection).max() for rope in ropes) < 1e-4
    assert np.abs(found).max() < within


# a rope over a post

POST, ROPE, TAIL, N = 0.04, 1e-3, 0.04, 60
"""Radii of post and rope, free length on either side [m], and elements"""
PULL = 0.03
"""Force at the less loaded end [N]"""


def slip_over_post(friction: float, wrap: float, ratio: float) -> float:
    """Return the mean velocity along a rope over a post, 0.05 s after applying a force ratio at its ends [m/s].

    Before, it settles at a lower ratio with strong damping.
    """
    bend, along = POST + ROPE, np.array([np.sin(wrap), np.cos(wrap), 0.0])
    s = np.linspace(0.0, wrap * bend + 2.0 * TAIL, N + 1) - TAIL
    angle = np.clip(s / bend, 0.0, wrap)
    nodes = np.array([-bend * np.cos(angle), bend * np.sin(angle), 0.0 * s])
    nodes += np.minimum(s, 0.0) * Y[:, None] + np.maximum(s - wrap * bend, 0.0) * along[:, None]
    ropes = [
        Rod.through(
            nodes,
            normal=(0.0, 0.0, 1.0),
            radius=np.full(N, ROPE),
            density=1000.0,
            youngs_modulus=YOUNG,
            shear_modulus=YOUNG / 3.0,
            damping_rate=rate,
        )
        for rate in (100.0, 0.0)
    ]
    dt, m = 0.5 * stable_time_step(ropes[0]), ropes[0].nodal_mass[1]
    law = Contact(stiffness=0.1 * m / dt**2, damping=0.3 * m / dt, friction=friction, slip_damping=0.2 * m / dt)
    post = Cylinder(
        start=(0.0, 0.0, -0.1),
        direction=(0.0, 0.0, 1.0),
        normal=(1.0, 0.0, 0.0),
        length=0.2,
        radius=POST,
        mass=1e6,
        rods=law,
        ground_stiffness=1.0,
    )
    settling, free = (build_model([rope], cylinders=[post], is_loaded=True) for rope in ropes)
    state, control = at_rest(settling, ropes[:1], cylinders=[post])
    first = int(settling.first_slot[0])

    def pull(share: float, ratio: float) -> None:
        control.force[0, :, first] = -share * PULL * Y
        control.force[0, :, first + N] = share * PULL * ratio * along

    for step in range(20):
        pull(min(1.0, 0.1 * (step + 1)), 1.0 + 0.8 * (np.exp(friction * wrap) - 1.0))
        advance(settling, state, control, 0, 1, dt, round(0.02 / dt))
    pull(1.0, ratio)
    advance(free, state, control, 0, 1, dt, round(0.05 / dt))
    x, v, _, _ = motion(free, state)
    edges = np.diff(x, axis=1)
    return float(np.mean((0.5 * (v[:, 1:] + v[:, :-1]) * edges).sum(axis=0) / np.linalg.norm(edges, axis=0)))


@pytest.mark.parametrize(("friction", "wrap"), [(0.2, np.pi), (0.3, 0.5 * np.pi), (0.1, 1.5 * np.pi)])
def test_a_rope_over_a_post_holds_up_to_the_capstan_ratio(friction, wrap):
    """Below it, the rope creeps at Coulomb's bound over the slip damping; above it, the rope accelerates."""
    held, slipping = (slip_over_post(friction, wrap, share * np.exp(friction * wrap)) for share in (0.95, 1.05))
    assert 0.0 < held < 0.03
    assert slipping > 0.12


# a pile


@pytest.mark.parametrize(("stiffness", "damping"), [(0.05, 0.05), (0.25, 0.1), (0.25, 0.2)])
def test_a_pile_of_ropes_comes_to_rest(stiffness, damping):
    """Twenty dropped ropes; stiffness and damping are relative to m/dt^2 and m/dt of a node."""
    rng, n, radius, length, sim = np.random.default_rng(0), 12, 3e-3, 0.12, Simulator()
    ropes = []
    for number in range(20):
        turn = rng.uniform(0.0, np.pi)
        direction = np.array([np.cos(turn), 0.02 * rng.standard_normal(), np.sin(turn)])
        centre = 0.01 * rng.standard_normal(3) * (X + Z) + (0.01 + 2.2 * radius * number) * Y
        ropes.append(
            add_rope(
                sim, centre[:, None] + length * direction[:, None] * np.linspace(-0.5, 0.5, n + 1), radius, damping=10.0
            )
        )
    ground = ea.Plane(np.zeros(3), Y)
    sim.append(ground)
    dt, m = step_of(ropes[0]), ropes[0].mass[1]
    law = dict(k=stiffness * m / dt**2, nu=damping * m / dt)
    for number, rope in enumerate(ropes):
        sim.detect_contact_between(rope, ground).using(ea.RodPlaneContact, k=0.02 * m / dt**2, nu=0.05 * m / dt)
        for other in ropes[number + 1 :]:
            sim.detect_contact_between(rope, other).using(ea.RodRodContact, **law)
    sim.finalize()
    run(sim, dt, 0.2)
    falling = sum(float(rope.compute_translational_energy()) for rope in ropes)
    run(sim, dt, 3.8)
    assert sum(float(rope.compute_translational_energy()) for rope in ropes) < 1e-4 * falling
    assert max(np.abs(rope.velocity_collection).max() for rope in ropes) < 0.01
    nodes = np.concatenate([rope.position_collection for rope in ropes], axis=1)
    assert nodes[1].min() > 0.5 * radius and np.abs(nodes).max() < 1.0
