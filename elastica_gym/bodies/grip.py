"""The grip of an animal with two arms on its object: gaps, and the angle by which each arm wraps it.

Both are computed from positions, not from forces. Surfaces are those of contact
(`elastica_gym.engine.kernels.contact.cylinders`): an element is its axis swept by a ball of its radius, and so is the
object.
"""

import functools
from math import atan2
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..engine import State
from ..engine.jit.compiler import entry
from ..engine.kernels.contact.law import middle, overlap
from ..engine.kernels.math.vectors import column, cross, dot, plus, times, vector
from ..engine.model import Array, Index
from .body import Body

TOUCH = 0.002
"""Gap up to which surfaces touch [m]"""
DEEPEST = 0.005
"""Overlap up to which surfaces touch; contact forces allow no more, so deeper overlap does not count [m]"""

NEARBY = 0.15
"""Gap from which an element no longer counts as near the object [m]"""


class Grip(NamedTuple):
    """The grip of each of B animals of E elements on its first object."""

    gaps: Array
    """Distance between each element's surface and the object's, negative where they overlap [m], (B, E)"""
    head_gap: Array
    """The smallest gap of the head's elements [m], (B,)"""
    spans: Array
    """Angle about the object's axis from the first to the last touching element of each arm, followed along the arm
    [rad], (B, 2)"""
    windings: Array
    """The same angle over all elements, each part weighted by proximity: 1 where they touch, falling to 0 at a gap of
    `NEARBY` [rad], (B, 2)"""
    counts: Index
    """Number of elements of each arm that touch it, (B, 2) int64"""
    base: Array
    """Centre of the object's base, the end on which it stands at the start [m], (B, 3)"""
    tilt: Array
    """Angle of its axis from upright [rad], (B,)"""

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Whether each element touches the object, (B, E) bool; none does if any overlaps it by more than `DEEPEST`."""
        sound = self.gaps.min(axis=1, keepdims=True) >= -DEEPEST
        return sound & (self.gaps <= TOUCH)


def grip(body: Body, state: State) -> Grip:
    """Return the grip of animals, each one rod with its head between its arms, on their first object.

    An arm that overlaps the object by more than `DEEPEST` anywhere does not count as touching it. An arm's azimuth is
    that of its elements' centres about the object's axis; between neighbours it changes by less than half a turn.
    """
    if not body.cylinders:
        raise ValueError(f"body {body.name!r} has no object to grip")
    arms, first = arm_elements(body), int(body.model.first_slot[0])
    thing, n_envs = body.model.cylinders, len(state.x)
    gaps = np.zeros((n_envs, int(body.model.n_elements[0])))
    spans, windings, counts = np.zeros((n_envs, 2)), np.zeros((n_envs, 2)), np.zeros((n_envs, 2), dtype=np.int64)
    _measure(
        state.x,
        body.model.contact_radius,
        first,
        arms,
        state.body_x,
        state.body_Q,
        float(thing.length[0]),
        float(thing.radius[0]),
        gaps,
        spans,
        windings,
        counts,
    )
    centre, axis = state.body_x[:, 0], state.body_Q[:, 0, 2]
    return Grip(
        gaps=gaps,
        head_gap=gaps[:, arms[0, 1] : arms[1, 0]].min(axis=1),
        spans=spans,
        windings=windings,
        counts=counts,
        base=centre - 0.5 * thing.length[0] * axis,
        tilt=np.arctan2(np.hypot(axis[:, 0], axis[:, 2]), axis[:, 1]),
    )


@functools.lru_cache(maxsize=4)
def arm_elements(body: Body) -> Index:
    """Return the first element and the last + 1 of each arm along the rod, (2, 2); the head is between.

    Do not modify the result.
    """
    ends = np.sort([arm[:2] for arm in body.muscles.arms.values()], axis=1) * body.rods[0].n_elements
    return np.round(ends).astype(np.int64)


@entry
def _measure(x, radius, slot, arms, body_x, body_Q, length, thickness, gaps, spans, windings, counts):
    """Compute the gaps of all elements, and the span, winding and count of each arm, environment by environment.

    ``slot`` is the slot of the first element in the Model.
    """
    for i in range(x.shape[0]):
        centre, axis = vector(body_x[i, 0]), vector(body_Q[i, 0, 2])
        start, edge = plus(centre, -0.5 * length, axis), times(length, axis)
        for k in range(gaps.shape[1]):
            first = column(x[i], slot + k)
            way = plus(column(x[i], slot + k + 1), -1.0, first)
            depth, _, _, _ = overlap(first, way, radius[slot + k], start, edge, thickness, False)
            gaps[i, k] = -depth
        for arm in range(arms.shape[0]):
            azimuth = winding = begin = end = deepest = 0.0
            last, count = (0.0, 0.0, 0.0), 0
            for k in range(arms[arm, 0], arms[arm, 1]):
                way = plus(middle(x[i], slot + k), -1.0, centre)
                turn = atan2(dot(axis, cross(last, way)), dot(last, way) - dot(axis, last) * dot(axis, way))
                azimuth += turn
                winding += turn * min(max(1.0 - gaps[i, k] / NEARBY, 0.0), 1.0)
                last, deepest = way, min(deepest, gaps[i, k])
                if gaps[i, k] <= TOUCH:
                    begin, end = azimuth if count == 0 else begin, azimuth
                    count += 1
            spans[i, arm] = abs(end - begin) if deepest >= -DEEPEST else 0.0
            windings[i, arm] = abs(winding)
            counts[i, arm] = count if deepest >= -DEEPEST else 0
