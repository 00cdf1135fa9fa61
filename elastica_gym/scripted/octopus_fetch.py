"""A scripted octopus: walks to its object, turns an arm's inner side to it, wraps the arm around it, carries it home.

Inputs are the observation, the time, and whether the object is grabbed. Bent at full strength, an arm grips an object
inside its bend, within some 15 cm of its base and to its right, the side away from the other arm. Positions are
relative to the head: ahead and to the right [m]. Rules are for the second arm, which points ahead; those of the first
arm are mirrored, with the same activations, since twisting activations are zero.
"""

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..bodies.muscles import N_FUNCTIONS, OCTOPUS
from ..bodies.observation import Layout
from ..bodies.octopus import BASE_RADIUS, OBJECT_LENGTH, OBJECT_RADIUS, octopus
from ..engine.model import Array, Index
from ..envs.batch import BatchEnv
from ..envs.task import Mask
from ..envs.tasks.octopus_fetch import TASK
from .gaits import OCTOPUS_FUNCTIONS, OCTOPUS_STROKES

STROKING = OCTOPUS_FUNCTIONS
"""The first arm's activations used by a stroke"""
BENDING = OCTOPUS.columns("normal", "first")
"""The first arm's activations that bend it sideways"""
LIFTING = OCTOPUS.columns("binormal", "first")[:3]
"""The first arm's activations of the first three functions, which lift it"""
STEERING = 0.5
"""Angle off course at which one arm rests while the other turns the animal [rad]"""
LEAST = -0.5
"""Minimum stroke factor of an arm; negative is a reversed stroke"""
CLOSE = (0.28, 0.3)
"""Distance from the head below which it turns instead of walking: for an object at the side, and elsewhere [m]"""
BEHIND = -0.12
"""Minimum position of the object to the right for turning [m]"""
BOUT = (3, 5)
"""Strokes of turning per bout near the object, and strokes per bout including the rest for observing"""
NEAR = 0.13
"""Gap between the object and an arm's inner half below which it turns in bouts [m]"""
UNSTROKED = slice(3, None)
"""Activations that bend an arm sideways and are not part of a stroke"""
BENT = 0.05
"""Mean of these above which the whole arm is bent"""
LEAST_BEND = 0.1
"""Initial bending activation"""
STILL = (0.1, 0.1)
"""Largest activation and node speed at which the animal counts as still [1, m/s]"""
BEND = ((0.18, 0.345), -0.04, 0.07)
"""Object position at which a still arm begins to bend: range ahead, minimum to the right, maximum gap to its inner half
[m]"""
REACH = ((0.1, 0.4), (-0.15, 0.2))
"""Object position at which it continues to bend: ranges ahead and to the right [m]"""
RAMP = 0.04
"""Lead of the commanded bending activation over the reached one: a larger lead knocks the object over"""
LEANING = 0.05
"""Tilt of the object above which the bending arm yields until the object is upright again [rad]"""
EMPTY = (0.9, 1)
"""An arm has missed, and lets go, above this activation if at most this many parts touch the object"""

CARRYING = {
    "ahead": (
        (0.41, 0.16),
        0.25,
        (
            (1.56, 0.67, -0.66, -0.76, 0.98, 1.83, 0.44, -3.43, -1.56),
            (1.85, 1.95, -0.02, -1.18, -2.22, -1.44, 1.38, -1.8, -0.22),
            (-1.72, 1.12, -1.87, 1.27, -2.6, 0.0, -0.51, 0.95, -0.73),
        ),
    ),
    "right": (
        (-0.05, 0.49),
        0.25,
        (
            (1.14, 0.32, -1.12, -0.67, 0.95, 3.2, -0.05, -3.46, -1.86),
            (1.81, 1.3, -0.58, -0.85, -2.76, -1.94, 1.45, -2.27, 0.02),
            (-0.67, 0.78, -0.54, 0.74, -2.8, 0.01, -0.79, 1.3, -1.7),
        ),
    ),
}
"""The slow gaits that carry an object in the second arm: displacement of the head in 4 s [m], period [s], and offset,
sine and cosine of the free arm's stroke and of the three activations that lift the holding arm. Found by CMA-ES, 24
generations of 12 trials in each direction, on the displacement while the object stays wrapped"""


class Gait(NamedTuple):
    """A steerable gait that carries an object in the second arm."""

    course: float
    """Direction of travel, to the right of straight ahead [rad]"""
    width: float
    """Maximum deviation from its course at which it is used [rad]"""
    period: float
    """[s]"""
    table: tuple[tuple[float, ...], ...]
    """Offset, sine and cosine of the activations, as in `CARRYING`"""
    steering: tuple[float, ...]
    """Added to the activations per angle from course to goal [1/rad], clipped to 1 rad"""


HOMEWARD = Gait(
    -2.25,
    1.4,
    0.272,
    (
        (1.09, 1.26, -0.93, -0.99, 1.01, -0.04, 0.92, -1.55, -1.31),
        (-1.43, 3.46, 0.43, -1.73, -2.12, -2.95, 1.02, -0.33, 0.49),
        (-2.34, 0.84, -0.5, 0.1, -2.02, 1.34, 0.11, 0.34, 0.1),
    ),
    (-0.35, 0.09, -0.55, -0.09, -0.03, -0.62, -0.21, -0.27, 0.24),
)
"""The fast gait home, which is mostly to the left and somewhat behind; more than twice as fast as the others. Found by
CMA-ES in `scripts/search_carrying.py`, on the time to bring the object home. The course was then set by hand to the
gait's direction near home, and the width to the most successful one in OctopusReturn (28 of 48 with 1.4, 23 with 2, 21
with 4)"""


class Sight(NamedTuple):
    """The inputs of the script, from the observations of B octopuses with an object."""

    ahead: Array
    """Position of the object's base ahead of the head [m], (B,)"""
    right: Array
    """Position of the object's base to the right of the head [m], (B,)"""
    gap: Array
    """Gap between the object and the inner half of the nearer arm, by its observed nodes [m], (B,)"""
    touched: Index
    """Number of body parts that touch the object, (B,) int64"""
    levels: Array
    """Activations reached by the muscles, (B, 42)"""
    tilt: Array
    """Angle of the object's axis from upright [rad], (B,)"""
    speed: Array
    """Speed of the fastest node [m/s], (B,)"""
    goal: Array
    """Displacement for carrying, ahead and to the right [m], (B, 2): goal direction times distance to home"""


@functools.cache
def _layout() -> tuple[Layout, int]:
    """Return the layout of observations, and the index of the head's centre among the observed nodes."""
    body = octopus()
    return TASK.layout(body), body.sensors.nodes.tolist().index(body.sensors.head)


def see(observations: NDArray[np.float32]) -> Sight:
    """Return the inputs of the script, from observations (B, 210) of a task with an object."""
    layout, head = _layout()
    o: Array = observations.astype(np.float64)
    # observations are in body lengths, 1 m here
    axis = o[:, layout["object/0/axis"]]
    base = o[:, layout["object/0/position"]] - 0.5 * OBJECT_LENGTH * axis
    places = o[:, layout["position"]].reshape(len(o), -1, 3)
    from_head = places - places[:, [head]]
    speeds = np.linalg.norm(o[:, layout["velocity"]].reshape(len(o), -1, 3), axis=2)
    return Sight(
        ahead=base[:, 0],
        right=base[:, 2],
        gap=_gap(from_head, base),
        touched=np.sum(o[:, layout["touch"]] > 0.0, axis=1),
        levels=o[:, layout["activation"]],
        tilt=np.arccos(np.clip(axis[:, 1], -1.0, 1.0)),
        speed=speeds.max(axis=1),
        goal=o[:, layout["goal"]] * np.linalg.norm(o[:, layout["home"]], axis=1, keepdims=True),
    )


def _gap(nodes: Array, base: Array) -> Array:
    """Return the horizontal gap between an object and the arms' inner halves, from nodes (B, 11, 3), (B,)."""
    plane, foot = nodes[..., [0, 2]], base[:, None, [0, 2]]
    gaps = []
    for inner in (slice(2, 5), slice(6, 9)):
        begin, end = plane[:, inner][:, :-1], plane[:, inner][:, 1:]
        along, way = end - begin, foot - begin
        part = np.clip((along * way).sum(axis=2) / (along * along).sum(axis=2), 0.0, 1.0)
        gaps.append(np.linalg.norm(way - part[..., None] * along, axis=2).min(axis=1))
    return np.minimum(*gaps) - OBJECT_RADIUS - BASE_RADIUS


def fetch(env: BatchEnv) -> Array:
    """Return the actions of the script in a task that tracks how the object is handled, (B, 42)."""
    return play(env, see(env.observations))


def play(env: BatchEnv, sight: Sight) -> Array:
    """Return the actions of the script for given inputs, at the time of each environment, (B, 42)."""
    time = env.elapsed.astype(np.float64) * env.control_dt
    return act(sight, time, env.situation().progress.grabbed == 1.0)


def act(sight: Sight, time: Array, grabbed: Mask) -> Array:
    """Return the actions of the script, (B, 42).

    Parameters
    ----------
    sight : Sight
    time : Array
        Time since the start of the episode [s], (B,).
    grabbed : Mask
        Whether an arm has grabbed the object, (B,) bool.
    """
    ahead, right = sight.ahead, sight.right
    bearing = np.arctan2(right, ahead)
    sideways = np.abs(bearing - 0.5 * np.pi) < 0.4
    # the second arm for objects ahead, the first for objects behind
    arm = np.where(ahead >= 0.0, 1, 0)
    is_close = np.sqrt(ahead * ahead + right * right) < np.where(sideways, *CLOSE)
    actions = walk(time, bearing)
    for chosen, play in (
        (is_close & (right > BEHIND), turn(sight, time, arm)),
        (is_close & (right > BEHIND) & _is_in_the_bend(sight, arm), bend(sight, arm)),
        (grabbed, carry(sight.goal, time, arm)),
    ):
        actions[chosen] = play[chosen]
    return actions


def _is_in_the_bend(sight: Sight, arm: Index) -> Mask:
    """Return whether the object is where an arm should begin or continue to bend, (B,)."""
    ahead, right = np.abs(sight.ahead), sight.right
    bent = np.take_along_axis(sight.levels, BENDING + arm[:, None] * N_FUNCTIONS, axis=1)
    level = bent[:, UNSTROKED].mean(axis=1)
    (nearest, furthest), left, gap = BEND
    begins = (ahead > nearest) & (ahead < furthest) & (right > left) & (sight.gap < gap)
    most, fastest = STILL
    begins &= (np.abs(sight.levels).max(axis=1) < most) & (sight.speed < fastest)
    (nearest, furthest), (left, rightmost) = REACH
    goes_on = (ahead > nearest) & (ahead < furthest) & (right > left) & (right < rightmost)
    # the whole arm is bent, not only by a stroke
    goes_on &= level > BENT
    goes_on &= (level < EMPTY[0]) | (sight.touched > EMPTY[1])
    return begins | goes_on


def walk(time: Array, bearing: Array) -> Array:
    """Return the actions of a walk to the right that turns towards a bearing from the head's axis [rad], (B, 42)."""
    off = (bearing + 0.5 * np.pi) % (2.0 * np.pi) - np.pi
    first, second = (np.clip(1.0 - np.maximum(sign * off, 0.0) / STEERING, LEAST, 1.0) for sign in (-1.0, 1.0))
    return _play(time, first, second)


def turn(sight: Sight, time: Array, arm: Index) -> Array:
    """Return the actions of a turn that moves a resting arm to the right, in bouts near the object, (B, 42)."""
    strokes, bout = BOUT
    strength: Array = ((sight.gap > NEAR) | (time / OCTOPUS_STROKES["right"][0] % bout < strokes)).astype(np.float64)
    return _play(time, strength * arm, strength * (1.0 - arm))


def _play(time: Array, first: Array, second: Array) -> Array:
    """Return the actions of the stroke to the right, scaled by a factor (B,) for each arm, (B, 42)."""
    period, table = OCTOPUS_STROKES["right"]
    level = np.clip(_wave(time, np.full(len(time), period), np.array(table)), -1.0, 1.0)
    actions = np.zeros((len(time), OCTOPUS.n_activations))
    actions[:, STROKING], actions[:, STROKING + N_FUNCTIONS] = first[:, None] * level, second[:, None] * level
    return actions


def _wave(time: Array, period: Array, table: Array) -> Array:
    """Return offset + sine + cosine with the rows of a table (3, n) or (B, 3, n) as amplitudes, (B, n)."""
    phase = (2.0 * np.pi * time / period)[:, None]
    return table[..., 0, :] + table[..., 1, :] * np.sin(phase) + table[..., 2, :] * np.cos(phase)


def bend(sight: Sight, arm: Index) -> Array:
    """Return the actions that bend an arm further, or less if the object leans, (B, 42)."""
    columns = BENDING + arm[:, None] * N_FUNCTIONS
    level = np.take_along_axis(sight.levels, columns, axis=1).mean(axis=1)
    level = np.maximum(level + np.where(sight.tilt > LEANING, -RAMP, RAMP), LEAST_BEND)
    actions = np.zeros((len(arm), OCTOPUS.n_activations))
    np.put_along_axis(actions, columns, np.minimum(level, 1.0)[:, None], axis=1)
    return actions


def carry(way: Array, time: Array, arm: Index, homeward: Gait = HOMEWARD) -> Array:
    """Return the actions that carry the object in an arm by a displacement (B, 2) [m], (B, 42)."""
    # mirrored for the first arm
    ahead, right = np.where(arm == 1, 1.0, -1.0) * way[:, 0], way[:, 1]
    ways, periods, tables = (np.array(column) for column in zip(*CARRYING.values(), strict=True))
    along = ahead[:, None] * ways[:, 0] + right[:, None] * ways[:, 1]
    astray = np.abs(ahead[:, None] * ways[:, 1] - right[:, None] * ways[:, 0])
    best = (along - 0.5 * astray).argmax(axis=1)
    off = (np.arctan2(right, ahead) - homeward.course + np.pi) % (2.0 * np.pi) - np.pi
    hurried = _wave(time, np.full(len(time), homeward.period), np.array(homeward.table))
    hurried += np.clip(off, -1.0, 1.0)[:, None] * np.array(homeward.steering)
    is_hurried = (np.abs(off) < homeward.width)[:, None]
    level = np.clip(np.where(is_hurried, hurried, _wave(time, periods[best], tables[best])), -1.0, 1.0)
    actions = np.zeros((len(arm), OCTOPUS.n_activations))
    own, other = arm[:, None] * N_FUNCTIONS, (1 - arm)[:, None] * N_FUNCTIONS
    np.put_along_axis(actions, BENDING + own, 1.0, axis=1)
    np.put_along_axis(actions, STROKING + other, level[:, :6], axis=1)
    np.put_along_axis(actions, LIFTING + own, level[:, 6:], axis=1)
    return actions
