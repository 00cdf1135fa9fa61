"""Wrapping and contact, computed from hand-made configurations."""

from dataclasses import replace

import numpy as np
import pytest

from elastica_gym.bodies import grip, octopus, snake
from elastica_gym.bodies.body import make_pose, observe
from elastica_gym.bodies.grip import DEEPEST, TOUCH, arm_elements
from elastica_gym.bodies.observation import Layout
from elastica_gym.engine import at_rest
from elastica_gym.engine.model import make_state

RADIUS, LENGTH = 0.05, 0.6
STEP = 1.0 / 120.0
PLACE = np.array([0.3, 0.3, -0.2])


@pytest.fixture
def body():
    """Return an octopus with its own radii, which tests may change."""
    whole = octopus()
    return replace(whole, model=whole.model._replace(contact_radius=whole.model.contact_radius.copy()))


def first_of(body):
    return int(body.model.first_slot[0])


def apart(body, n_envs=1):
    """Straight animals far from upright objects at PLACE."""
    state = make_state(body.model, n_envs)
    first, rod = first_of(body), body.rods[0]
    state.x[:, 0, first : first + 121] = 5.0 + np.arange(121) * STEP
    body.model.contact_radius[first : first + 120] = rod.radius
    state.body_x[:, 0] = PLACE
    state.body_Q[:, 0] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
    return state


def lay(body, state, i, elements, gap, *, pitch=0.0, turns_back_at=None):
    """Lay an arm's elements around the upright object with equal gaps; return the angle between their centres."""
    first, (begin, end) = first_of(body), elements
    radius = body.rods[0].radius[begin]
    # so thin that the neighbouring elements do not touch
    body.model.contact_radius[first : first + 120] = 0.001
    body.model.contact_radius[first + begin : first + end] = radius
    # a chord is closer to the centre than its circle
    reach = np.sqrt((RADIUS + radius + gap) ** 2 + (0.5 * STEP) ** 2)
    turn = 2.0 * np.arcsin(0.5 * STEP / reach)
    steps = np.ones(end - begin)
    if turns_back_at is not None:
        steps[turns_back_at:] = -1.0
    angle = np.concatenate([[0.0], np.cumsum(steps)]) * turn
    height = PLACE[1] + pitch * np.arange(end - begin + 1)
    ring = np.stack([PLACE[0] + reach * np.cos(angle), height, PLACE[2] + reach * np.sin(angle)])
    state.x[i, :, first + begin : first + end + 1] = ring
    # the rest of the animal extends straight away from the object
    for node, rest in ((0, begin - 1 - np.arange(begin)), (-1, np.arange(end + 1, 121))):
        tip = ring[:, node]
        outwards = (tip - PLACE) * [1.0, 0.0, 1.0] / reach
        state.x[i, :, first + rest] = tip + STEP * np.arange(1, rest.size + 1)[:, None] * outwards
    return turn


def turned(vectors, by):
    """Turn vectors (3, ...) from y towards x."""
    matrix = np.array([[np.cos(by), np.sin(by), 0.0], [-np.sin(by), np.cos(by), 0.0], [0.0, 0.0, 1.0]])
    return np.einsum("ij,j...->i...", matrix, vectors)


def test_arms_and_head(body):
    np.testing.assert_array_equal(arm_elements(body), [[0, 50], [70, 120]])


@pytest.mark.parametrize("arm", [0, 1])
@pytest.mark.parametrize("count", [1, 2, 5, 30, 44])
@pytest.mark.parametrize("gap", [-0.004, 0.0, 0.0019])
def test_an_arm_on_a_circle(body, arm, count, gap):
    state = apart(body)
    begin = 70 * arm + 3
    turn = lay(body, state, 0, (begin, begin + count), gap)
    found = grip(body, state)
    np.testing.assert_allclose(found.gaps[0, begin : begin + count], gap, atol=1e-12)
    assert found.counts[0].tolist() == [count * (arm == 0), count * (arm == 1)]
    assert found.spans[0, arm] == pytest.approx((count - 1) * turn, abs=1e-9)
    assert found.spans[0, 1 - arm] == 0.0
    np.testing.assert_array_equal(np.flatnonzero(found.touching[0]), np.arange(begin, begin + count))


@pytest.mark.parametrize(("gap", "near"), [(-0.004, 1.0), (0.03, 0.8), (0.12, 0.2), (0.16, 0.0)])
def test_windings_of_an_arm_on_a_circle(body, gap, near):
    state = apart(body)
    turn = lay(body, state, 0, (73, 103), gap)
    windings = grip(body, state).windings[0]
    # the straight parts at the first and last element may also be near
    assert near * 29 * turn - 1e-9 <= windings[1] <= near * 31 * turn + 0.2
    assert windings[0] == 0.0


def test_more_than_a_full_turn(body):
    state = apart(body)
    body.model.contact_radius[:] = 0.01
    first = first_of(body)
    reach, turn = RADIUS + 0.01, np.radians(9.0)
    angle = turn * np.arange(51)
    state.x[0, :, first : first + 51] = [
        PLACE[0] + reach * np.cos(angle),
        PLACE[1] + 0.0005 * np.arange(51),
        PLACE[2] - reach * np.sin(angle),
    ]
    assert np.degrees(grip(body, state).spans[0, 0]) == pytest.approx(49 * 9.0, abs=1e-6)


def test_just_out_of_reach(body):
    state = apart(body)
    lay(body, state, 0, (5, 45), TOUCH + 1e-6)
    found = grip(body, state)
    assert not found.touching.any() and not found.counts.any() and not found.spans.any()


def test_too_deep_penetration_is_not_contact(body):
    state = apart(body)
    lay(body, state, 0, (5, 45), -0.001)
    assert grip(body, state).counts[0, 0] == 40
    # one element alone
    first = first_of(body)
    body.model.contact_radius[first + 20] += DEEPEST
    found = grip(body, state)
    assert found.gaps.min() == pytest.approx(-0.001 - DEEPEST)
    assert not found.touching.any() and not found.counts.any() and not found.spans.any()


def test_the_span_includes_elements_between_contacts(body):
    """Only the ends touch; the arm between them passes around the object."""
    state = apart(body)
    turn = lay(body, state, 0, (3, 43), -0.001)
    first = first_of(body)
    body.model.contact_radius[first + 6 : first + 40] -= 0.01
    found = grip(body, state)
    assert found.counts[0, 0] == 6
    assert found.spans[0, 0] == pytest.approx(39 * turn)


def test_an_arm_that_turns_back(body):
    state = apart(body)
    turn = lay(body, state, 0, (3, 43), -0.001, turns_back_at=30)
    # thirty angle steps forward and ten back: twenty from the first element to the last
    assert grip(body, state).spans[0, 0] == pytest.approx(20 * turn)


def test_a_straight_arm_next_to_the_object_hardly_wraps(body):
    state = apart(body)
    first = first_of(body)
    state.x[0, :, first : first + 51] = [
        PLACE[0] + STEP * (np.arange(51) - 25),
        np.full(51, PLACE[1]),
        np.full(51, PLACE[2] + RADIUS + 0.025),
    ]
    body.model.contact_radius[first : first + 50] = 0.025
    found = grip(body, state)
    assert 1 < found.counts[0, 0] < 8
    assert np.degrees(found.spans[0, 0]) < 40.0


def test_grip_does_not_depend_on_the_orientation_of_the_object(body):
    """A helix around a tilted object, and the same scene turned upright."""
    state = apart(body, 2)
    for i in range(2):
        lay(body, state, i, (72, 112), -0.002, pitch=0.001)
    lean = np.radians(70.0)
    state.x[1] = turned(state.x[1], lean)
    state.body_x[1, 0] = turned(state.body_x[1, 0], lean)
    state.body_Q[1, 0] = turned(state.body_Q[1, 0].T, lean).T
    found = grip(body, state)
    assert np.degrees(found.tilt) == pytest.approx([0.0, 70.0], abs=1e-9)
    np.testing.assert_allclose(found.gaps[0], found.gaps[1], atol=1e-12)
    np.testing.assert_allclose(found.spans[0], found.spans[1], atol=1e-12)
    np.testing.assert_array_equal(found.counts[0], found.counts[1])
    np.testing.assert_allclose(found.base[0], PLACE - [0.0, 0.5 * LENGTH, 0.0], atol=1e-15)
    np.testing.assert_allclose(found.base[1], turned(found.base[0], lean), atol=1e-12)


@pytest.mark.parametrize("tilt", [0.0, 44.9, 90.0, 180.0])
def test_tilt(body, tilt):
    state = apart(body)
    state.body_Q[0, 0] = turned(state.body_Q[0, 0].T, np.radians(tilt)).T
    assert np.degrees(grip(body, state).tilt[0]) == pytest.approx(tilt, abs=1e-6)


def test_gaps_are_those_in_the_observation(body):
    n = 16
    state, _ = at_rest(body.model, body.rods, n, cylinders=body.cylinders)
    for field, resting in zip(state, body.rest, strict=True):
        field[...] = resting
    rng = np.random.default_rng(0)
    state.body_x[:, 0, [0, 2]] = rng.uniform(-0.8, 0.8, (n, 2))
    axis = rng.normal(size=(n, 3))
    state.body_Q[:, 0, 2] = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    pose = make_pose(n, 1)
    layout = Layout(body.blocks())
    low, high = layout.low, layout.high
    readings = np.zeros((n, low.size), dtype=np.float32)
    observe(body.model, state, np.zeros((n, 42)), body.sensors, pose, low, high, readings, np.arange(n))
    found = grip(body, state)
    np.testing.assert_allclose(found.gaps.min(axis=1), pose.gaps[:, 0], atol=1e-14)
    np.testing.assert_array_equal(found.head_gap, found.gaps[:, 50:70].min(axis=1))
    alone = [grip(body, type(state)._make(field[i : i + 1] for field in state)) for i in range(n)]
    np.testing.assert_array_equal(found.spans, np.concatenate([each.spans for each in alone]))


def test_a_snake_has_no_object_to_grip():
    with pytest.raises(ValueError, match="body 'snake' has no object to grip"):
        grip(snake(), make_state(snake().model))
