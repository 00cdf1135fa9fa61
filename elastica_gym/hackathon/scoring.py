"""The hackathon's goals: pure functions of samples of the State.

| goal | points | holds when |
|---|---|---|
| crawl | 5 | the head's centre is 0.2 m or more from its start, and the body's centre of mass 0.1 m |
| reach | 7.5 | the head's surface comes within 0.05 m of the object's |
| move | 7.5 | the base of the object moves 0.1 m while the body touches it and it is within 45 degrees of upright |
| grab | 10 | one arm's elements that touch the object span 200 degrees or more, at least five of them, for 0.5 s |
| return | 20 | an arm that has grabbed it keeps 150 degrees, and after all other goals, the head is back within 0.1 m \
of its start and the object's base within 0.3 m of the head |
| general | 50 | 25 times the fraction of targets on which all others hold, on the arc, and the same anywhere |

Distances are in the plane, and between centres except for ``reach``. Displacements of the object add up as vectors
over pairs of consecutive samples that both count, so moving to and fro cancels. A grab lasts from its first to its last
sample, without a break; an arm that keeps the object may lapse for 0.2 s, from the last good sample to the last bad
one. Touch and the angle that an arm spans are defined in `elastica_gym.bodies.grip`.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

CRAWL_HEAD, CRAWL_CENTRE = 0.2, 0.1
"""Minimum displacement of head and centre of mass [m]"""
REACH = 0.05
"""Maximum gap between the surfaces of head and object [m]"""
MOVE, UPRIGHT = 0.1, np.radians(45.0)
"""Minimum displacement of the object [m], and its maximum tilt while it counts [rad]"""
GRAB, GRAB_COUNT, GRAB_TIME = np.radians(200.0), 5, 0.5
"""Minimum angle [rad], number of elements and time [s] of a grab"""
HOLD, LAPSE = np.radians(150.0), 0.2
"""Minimum angle of a holding arm [rad], and the longest lapse [s]"""
HOME, BESIDE = 0.1, 0.3
"""Maximum distance of the head from its start, and of the object from the head [m]"""
ROUNDING = 1e-9
"""Tolerance of times and angles for rounding [s, rad]"""

POINTS = {"crawl": 5.0, "reach": 7.5, "move": 7.5, "grab": 10.0, "return": 20.0}
GOALS = tuple(POINTS)
GENERAL = 25.0
"""Points for all targets on the arc, and the same for all targets anywhere"""


class Samples(NamedTuple):
    """B episodes at T times, starting with their initial states; positions in the plane are (x, z)."""

    time: Array
    """Simulated time [s], (T,)"""
    counted: Mask
    """Whether the episode was still running, (T, B) bool"""
    head: Array
    """The head's centre in the plane [m], (T, B, 2)"""
    centre: Array
    """The body's centre of mass in the plane [m], (T, B, 2)"""
    head_gap: Array
    """Minimum distance between the surfaces of head and object [m], (T, B)"""
    touched: Mask
    """Whether the body touches the object, (T, B) bool"""
    base: Array
    """Centre of the object's base in the plane [m], (T, B, 2)"""
    tilt: Array
    """Angle of its axis from upright [rad], (T, B)"""
    spans: Array
    """Angle that each arm spans around the object [rad], (T, B, 2)"""
    counts: NDArray[np.int64]
    """Number of elements of each arm that touch the object, (T, B, 2)"""


def crawled(s: Samples) -> Mask:
    """Return whether the animal has crawled by each sample, (T, B) bool."""
    return _held_by(s, (_apart(s.head, s.head[0]) >= CRAWL_HEAD) & (_apart(s.centre, s.centre[0]) >= CRAWL_CENTRE))


def reached(s: Samples) -> Mask:
    """Return whether the head has reached the object by each sample, (T, B) bool."""
    return _held_by(s, s.head_gap <= REACH)


def moved(s: Samples) -> Mask:
    """Return whether the animal has moved the object by each sample, (T, B) bool."""
    pushed = s.counted & s.touched & (s.tilt <= UPRIGHT)
    steps = np.where((pushed[1:] & pushed[:-1])[..., None], np.diff(s.base, axis=0), 0.0)
    way = np.concatenate([np.zeros_like(s.base[:1]), np.cumsum(steps, axis=0)])
    return _held_by(s, _apart(way, way[0]) >= MOVE)


def grabbed(s: Samples) -> Mask:
    """Return whether an arm has grabbed the object by each sample, (T, B) bool."""
    return _held_by(s, np.logical_or.reduce(_grabbing(s), axis=2))


def returned(s: Samples) -> Mask:
    """Return whether the animal has returned home with the object by each sample, (T, B) bool."""
    before = crawled(s) & reached(s) & moved(s)
    home = (_apart(s.head, s.head[0]) <= HOME) & (_apart(s.base, s.head) <= BESIDE)
    return _held_by(s, before & home & np.logical_or.reduce(_holding(s) & _spans(s, HOLD), axis=2))


def goals_held(s: Samples) -> Mask:
    """Return whether each goal and all goals before it are achieved by the end of each episode, (5, B) bool."""
    each = [goal(s)[-1] for goal in (crawled, reached, moved, grabbed, returned)]
    return np.logical_and.accumulate(np.array(each))


def _held_by(s: Samples, now: Mask) -> Mask:
    return np.logical_or.accumulate(now & s.counted, axis=0)


def _apart(a: Array, b: Array) -> Array:
    return np.hypot(a[..., 0] - b[..., 0], a[..., 1] - b[..., 1])


def _spans(s: Samples, angle: float) -> Mask:
    return s.counted[..., None] & (s.spans >= angle - ROUNDING)


def _grabbing(s: Samples) -> Mask:
    """Return whether each arm has met the angle, count and time of a grab, (T, B, 2) bool."""
    now = _spans(s, GRAB) & (s.counts >= GRAB_COUNT)
    begin = _last(~now) + 1
    since = s.time[np.minimum(begin, len(s.time) - 1)]
    return now & (s.time[:, None, None] - since >= GRAB_TIME - ROUNDING)


def _holding(s: Samples) -> Mask:
    """Return whether each arm has grabbed the object and kept it since, (T, B, 2) bool."""
    last = _last(_spans(s, HOLD))
    is_lost = (last < 0) | (s.time[:, None, None] - s.time[np.maximum(last, 0)] > LAPSE + ROUNDING)
    return _last(_grabbing(s)) > _last(is_lost)


def _last(true: Mask) -> NDArray[np.int64]:
    """Return the index of the last true sample up to each sample, -1 if none, with the shape of the mask."""
    moments = np.arange(len(true)).reshape(-1, *[1] * (true.ndim - 1))
    return np.maximum.accumulate(np.where(true, moments, -1), axis=0)


def score(held: Mapping[str, Mask]) -> dict[str, Any]:
    """Return the points of each goal and their ``total``.

    Parameters
    ----------
    held : dict of str to Mask
        Results of `goals_held` for the ``default`` target, where each goal has to be achieved in all episodes, and for
        targets on the ``arc`` and ``anywhere``.
    """
    solid = np.logical_and.reduce(held["default"], axis=1)
    points: dict[str, Any] = {goal: POINTS[goal] * bool(ok) for goal, ok in zip(GOALS, solid, strict=True)}
    points["general"] = GENERAL * sum(float(held[where][-1].mean()) for where in ("arc", "anywhere"))
    return {"total": sum(points.values()), **points}
