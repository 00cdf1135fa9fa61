"""The octopus: its shape, rest position, arm strength, and absence of penetration."""

import numba
import numpy as np
import pytest

from elastica_gym.bodies import octopus
from elastica_gym.bodies.body import make_pose, observe
from elastica_gym.bodies.observation import Layout
from elastica_gym.bodies.octopus import HEAD, HEAD_RADIUS, MIDDLE
from elastica_gym.engine import advance, at_rest, build_model
from elastica_gym.engine.kernels.contact.law import overlap

SUBSTEPS = 313
CONTROL_DT = 0.05


@pytest.fixture(scope="module")
def body():
    return octopus()


@pytest.fixture
def scene(body):
    """State and Control of one octopus at rest on the ground."""
    state, control = at_rest(body.model, body.rods, cylinders=body.cylinders)
    for field, resting in zip(state, body.rest, strict=True):
        field[...] = resting
    return state, control


def slots(body):
    first = int(body.model.first_slot[0])
    return slice(first, first + 121), slice(first, first + 120)


def play(body, state, control, activations, seconds, ramp=0.0, parts=1):
    """Advance with activations that rise from zero over a ramp [s]; yield ``parts`` times per control step."""
    couples = np.einsum("a,acl->cl", activations, body.couples)
    for step in range(round(seconds / CONTROL_DT)):
        control.couple[0] = couples * min(1.0, (step + 1) * CONTROL_DT / ramp if ramp else 1.0)
        for part in range(parts):
            substeps = SUBSTEPS * (part + 1) // parts - SUBSTEPS * part // parts
            advance(body.model, state, control, 0, 1, CONTROL_DT / SUBSTEPS, substeps)
            yield step


def all_of(direction, arm):
    """Return full activation of one direction (0 normal, 1 binormal, 2 tangent) of one arm."""
    activations = np.zeros(42)
    activations[14 * direction + 7 * arm :][:7] = 1.0
    return activations


def ground_clearance(body, state):
    """Return the smallest height of the surface above the ground [m]."""
    nodes, elements = slots(body)
    y = state.x[0, 1, nodes]
    return float((0.5 * (y[1:] + y[:-1]) - state.radius[0, elements]).min())


@numba.njit
def depth(a, e, r1, b, f, r2):
    return overlap(a, e, r1, b, f, r2, True)[0]


def self_overlap(body, state):
    """Return the penetration between elements in self contact [m]."""
    x, radius, slots = state.x[0], body.model.contact_radius, state.x.shape[2]
    deepest = 0.0
    for pair in state.neighbours[0, : state.n_neighbours[0]]:
        low, high = divmod(int(pair), slots)
        if state.rod_touch[0, low] > 0.0 and state.rod_touch[0, high] > 0.0:
            a, b, c, d = (tuple(x[:, k]) for k in (low, low + 1, high, high + 1))
            along, across = tuple(np.subtract(b, a)), tuple(np.subtract(d, c))
            deepest = max(deepest, depth(a, along, radius[low], c, across, radius[high]))
    return deepest


def test_shape(body):
    rod = body.rods[0]
    x = rod.position
    assert x.shape == (3, 121)
    assert rod.rest_length.sum() == pytest.approx(1.0, rel=1e-12)
    assert rod.radius[[0, -1]] == pytest.approx(0.025, abs=1e-4)
    assert rod.radius[[48, 71]] == pytest.approx(0.03, abs=2e-4)
    assert rod.radius.max() == pytest.approx(HEAD_RADIUS, rel=0.01)
    # y up, the head along +z, both tips towards +x, mirror images of each other
    np.testing.assert_allclose(rod.directors[2, :, MIDDLE], [0.0, 0.0, 1.0], atol=0.1)
    np.testing.assert_allclose(x[:, ::-1] * np.array([[1.0], [1.0], [-1.0]]), x, atol=1e-12)
    tips = x[:, [0, 120]] - x[:, [20, 100]]
    np.testing.assert_allclose(np.degrees(np.arctan2(tips[0], np.abs(tips[2]))), 30.0, atol=0.1)


def test_it_rests_on_its_own_surface(body, scene):
    state, control = scene
    nodes, elements = slots(body)
    before = state.x[0, :, nodes].copy()
    for _ in play(body, state, control, np.zeros(42), 2.0):
        pass
    assert np.abs(state.x[0, :, nodes] - before).max() < 5e-3
    assert -1e-3 < ground_clearance(body, state) < 1e-4
    assert before[1, MIDDLE] == pytest.approx(HEAD_RADIUS, abs=2e-3)
    touching = state.normal_force[0, elements] > 0.0
    assert touching[:15].any() and touching[-15:].any() and touching[57:63].any()
    np.testing.assert_allclose(state.body_Q[0, 0, 2], [0.0, 1.0, 0.0], atol=1e-9)


@pytest.mark.parametrize("direction", [0, 1])
def test_full_activation_curls_a_free_arm_by_more_than_a_turn(body, direction):
    rod = body.rods[0]
    model = build_model([rod], activation_time=0.06, is_balanced=True)
    state, control = at_rest(model, [rod])
    control.couple[0] = np.einsum("a,acl->cl", all_of(direction, 0), body.couples)[:, : model.mass.size]
    advance(model, state, control, 0, 1, 1e-4, 40_000)
    first = int(model.first_slot[0])
    bent = (state.kappa[0, direction, first : first + 119] - rod.rest_kappa[direction]) * rod.rest_voronoi_length
    assert 1.1 < np.abs(bent[:50].sum()) / (2.0 * np.pi) < 1.2
    assert np.abs(state.v).max() < 1e-3


def test_an_arm_keeps_the_object_wrapped(body, scene):
    state, control = scene
    nodes, elements = slots(body)
    x, k = state.x[0, :, nodes], 86
    beside = np.cross(x[:, k + 1] - x[:, k], [0.0, 1.0, 0.0])
    beside *= (state.radius[0, elements][k] + body.cylinders[0].radius + 0.003) / np.linalg.norm(beside)
    state.body_x[0, 0, [0, 2]] = (0.5 * (x[:, k] + x[:, k + 1]) + beside)[[0, 2]]
    wrapped = []
    for _ in play(body, state, control, all_of(0, 1), 3.0, ramp=1.0):
        touching = np.flatnonzero(state.body_touch[0, elements] > 0.0)
        way = (0.5 * (x[:, touching] + x[:, touching + 1]) - state.body_x[0, 0][:, None])[[0, 2]]
        wrapped.append(np.degrees(np.ptp(np.unwrap(np.arctan2(*way)))) if touching.size else 0.0)
    assert min(wrapped[-20:]) > 200.0
    assert state.body_Q[0, 0, 2, 1] > 0.9


@pytest.mark.parametrize("seed", range(4))
def test_there_is_no_tunnelling(body, scene, seed):
    """Arms at full strength in alternating directions strike ground, object, head and each other."""
    state, control = scene
    rng = np.random.default_rng(seed)
    state.body_x[0, 0, [0, 2]] = [[0.02, 0.32], [0.06, -0.36], [-0.2, 0.1], [0.2, -0.2]][seed]
    layout = Layout(body.blocks())
    low, high = layout.low, layout.high
    pose, readings = make_pose(1, 1), np.zeros((1, low.size), dtype=np.float32)
    rod_touched = body_touched = 0.0
    for _ in range(6):
        # at 5 m/s an arm moves 8 mm between checks
        for _ in play(body, state, control, np.sign(rng.uniform(-1.0, 1.0, 42)), 0.3, parts=31):
            observe(body.model, state, np.zeros((1, 42)), body.sensors, pose, low, high, readings, np.arange(1))
            assert pose.sound[0] == 1
            assert pose.gaps[0, 0] > -5e-3
            assert ground_clearance(body, state) > -5e-3
            assert self_overlap(body, state) < 5e-3
            rod_touched = max(rod_touched, state.rod_touch[0].max())
            body_touched = max(body_touched, state.body_touch[0].max())
    assert rod_touched > 0.0
    assert body_touched > 0.0


def sides(first, second):
    """Return activations that bend the arms at their bases, (42,)."""
    activations = np.zeros(42)
    activations[[0, 1, 3, 4]], activations[[7, 8, 10, 11]] = first, second
    return activations


def part_of(body, slot):
    """Return the part of the body that an element belongs to."""
    k = slot - int(body.model.first_slot[0])
    return "head" if HEAD[0] <= k < HEAD[1] else "first" if k < HEAD[0] else "second"


def overlaps(body, state):
    """Return the penetration between parts of the body, by their names [m]."""
    x, radius, found = state.x[0], body.model.contact_radius, {}
    for pair in state.neighbours[0, : state.n_neighbours[0]]:
        low, high = divmod(int(pair), state.x.shape[2])
        if state.rod_touch[0, low] > 0.0 and state.rod_touch[0, high] > 0.0:
            a, b, c, d = (tuple(x[:, k]) for k in (low, low + 1, high, high + 1))
            deep = depth(a, tuple(np.subtract(b, a)), radius[low], c, tuple(np.subtract(d, c)), radius[high])
            both = frozenset((part_of(body, low), part_of(body, high)))
            found[both] = max(found.get(both, 0.0), deep)
    return found


@pytest.mark.parametrize(
    ("activations", "struck"),
    [
        pytest.param(-all_of(0, 1), {"second", "head"}, id="head"),
        pytest.param(all_of(0, 1), {"second"}, id="itself"),
        pytest.param(-all_of(0, 0) - all_of(0, 1), {"first", "second"}, id="other arm"),
        pytest.param(sides(-1.0, -1.0), {"first", "second"}, id="other arm, swung from the base"),
    ],
)
def test_an_arm_at_full_strength_stops_at(body, scene, activations, struck):
    state, control = scene
    state.body_x[0, 0, [0, 2]] = 3.0
    deepest, touched = 0.0, 0.0
    for _ in play(body, state, control, activations, 0.8, parts=62):
        found = overlaps(body, state)
        deepest = max([deepest, *found.values(), -ground_clearance(body, state)])
        touched = max(touched, found.get(frozenset(struck), 0.0))
    assert touched > 2e-4
    assert deepest < 5e-3


def test_forty_microseconds(body, scene):
    state, control = scene
    control.couple[0] = np.einsum("a,acl->cl", all_of(0, 0), body.couples)
    advance(body.model, state, control, 0, 1, 4e-5, 5000)
    assert np.isfinite(state.x).all() and np.abs(state.v).max() < body.sensors.fastest
