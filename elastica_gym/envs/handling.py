"""The common part of tasks with an object: its grip, its progress through an episode, and the reward terms.

All is computed from positions at the end of each control step (`elastica_gym.bodies.grip`), not from forces.
"""

import functools
from typing import NamedTuple

import numpy as np

from ..bodies import octopus
from ..bodies.grip import arm_elements, grip
from ..engine.model import Array, Index, State
from .task import (
    DIRECTION,
    HOME,
    Mask,
    Situation,
    Task,
    distance_from,
    has_toppled,
    in_heading_frame,
    no_target,
    way_to,
)

WRAPPED = np.radians(200.0)
"""Angle around the object's axis that an arm's touching elements must span to grab it [rad]"""
KEPT = np.radians(150.0)
"""Angle that they must span to keep holding it [rad]"""
FEWEST = 5
"""Number of touching elements below which an arm's span counts as zero"""
GRABBING_TIME = 0.5
"""Time for which an arm must wrap it without interruption [s]"""
SLACK_TIME = 0.2
"""Time for which a holding arm may then span less [s]"""
UPRIGHT = np.radians(45.0)
"""Tilt up to which the object stands [rad]"""
MOVED = 0.1
"""Displacement of the object that counts as moved [m]"""
CRAWLED = (0.2, 0.1)
"""Distances of the head and of the centre of mass from their start that count as crawled [m]"""
AT_HOME = 0.1
"""Distance of the head from home that counts as being there [m]"""
BROUGHT = 0.3
"""Distance of the object from the head that counts as brought along [m]"""
TO_OBJECT = DIRECTION._replace(meaning="direction from the head to the object: forward and right of a unit vector")
"""Observed direction to the object"""


class Goal(NamedTuple):
    """Where to bring the object, and the situation at the start."""

    home_x: Array
    """Place of home along x [m]"""
    home_z: Array
    """The same along z [m]"""
    start_x: Array
    """Place of the centre of mass at the start along x [m]"""
    start_z: Array
    """The same along z [m]"""
    away: Array
    """Distance of the object from home at the start [m]"""


class Handling(NamedTuple):
    """The progress of each of B animals with its object, as a situation's ``progress``, (B,) each."""

    reach: Array
    """Least distance of the object's surface from the inner half of an arm, the one next to the head [m]"""
    span: Array
    """Angle around the object's axis that an arm's touching elements span; the larger of two arms [rad]"""
    winding: Array
    """Angle that an arm winds around it, weighted by proximity (`Grip.windings`); the larger of two arms [rad]"""
    first: Array
    """Number of consecutive steps that ended with the first arm wrapped around it"""
    second: Array
    """Number of consecutive steps that ended with the second arm wrapped around it"""
    slack: Array
    """Number of consecutive steps that ended with neither arm holding it"""
    grabbed: Array
    """1 from the grab until the release, else 0; an object held at the start counts as grabbed"""
    moved_x: Array
    """Displacement of the centre of its base while it stood and was touched, along x [m]"""
    moved_z: Array
    """The same along z [m]"""
    base_x: Array
    """Place of the centre of its base along x [m]"""
    base_z: Array
    """The same along z [m]"""
    tilt: Array
    """Angle of its axis from upright [rad]"""
    head_way: Array
    """Largest distance of the head from home so far; home is where it starts, except in OctopusReturn [m]"""
    crawled: Array
    """1 once head and centre of mass have been `CRAWLED` away from there at the same time, else 0"""


def follow(situation: Situation, state: State) -> Handling:
    """Return the progress with the object at the end of this step."""
    s, old, begins = situation, situation.progress, situation.time_left >= 1.0
    held = grip(s.body, state)
    arms = np.where(held.counts >= FEWEST, held.spans, 0.0)
    span = np.maximum(arms[:, 0], arms[:, 1])
    first, second = (np.where(arms[:, a] >= WRAPPED, n + 1.0, 0.0) for a, n in enumerate((old.first, old.second)))
    slack = np.where(span >= KEPT, 0.0, old.slack + 1.0)
    # n consecutive observations span n - 1 steps
    grabs = (np.maximum(first, second) - 1.0) * s.control_dt >= GRABBING_TIME - 1e-9
    keeps = (old.grabbed == 1.0) & (slack * s.control_dt <= SLACK_TIME + 1e-9)
    grabbed = np.where(begins, span >= KEPT, grabs | keeps)
    base_x, base_z = held.base[:, 0], held.base[:, 2]
    head_away = distance_from(s.pose.head, s.goal.home_x, s.goal.home_z)
    crawls = (head_away >= CRAWLED[0]) & (distance_from(s.pose.centre, s.goal.start_x, s.goal.start_z) >= CRAWLED[1])
    carried = held.touching.any(axis=1) & (held.tilt <= UPRIGHT) & ~begins
    return Handling(
        reach=_reach(held.gaps, arm_elements(s.body)),
        span=span,
        winding=held.windings.max(axis=1),
        first=first,
        second=second,
        slack=slack,
        grabbed=grabbed.astype(np.float64),
        base_x=base_x,
        base_z=base_z,
        tilt=held.tilt,
        moved_x=old.moved_x + np.where(carried, base_x - old.base_x, 0.0),
        moved_z=old.moved_z + np.where(carried, base_z - old.base_z, 0.0),
        head_way=np.maximum(old.head_way, head_away),
        crawled=np.maximum(old.crawled, crawls),
    )


def _reach(gaps: Array, arms: Index) -> Array:
    """Return the least gap of the inner half of either arm, 0 if it touches [m], (B,)."""
    (tip, base), (other_base, other_tip) = arms
    inner = gaps[:, (tip + base) // 2 : base].min(axis=1)
    other = gaps[:, other_base : (other_base + other_tip) // 2].min(axis=1)
    return np.maximum(np.minimum(inner, other), 0.0)


def sample_goal(rng: np.random.Generator, situation: Situation) -> Goal:
    """Return a goal whose home is at the head."""
    return goal_with_home(situation, situation.pose.head[0, 0], situation.pose.head[0, 2])


def goal_with_home(situation: Situation, x: float, z: float) -> Goal:
    """Return the goal of one environment with its home at (x, z)."""
    pose = situation.pose
    away = distance_from(pose.objects[:, 0], np.array([x]), np.array([z]))
    return Goal._make([x, z, *pose.centre[0, [0, 2]], *away])


def brought(situation: Situation) -> Array:
    """Return how much nearer to home the object is than at the start [m], (B,)."""
    goal = situation.goal
    return goal.away - distance_from(situation.pose.objects[:, 0], goal.home_x, goal.home_z)


def direction_to_object(situation: Situation) -> tuple[Array, Array]:
    """Return the direction from the head to the object, forward and right, (B,) each."""
    pose = situation.pose
    x, z = pose.objects[:, 0, 0] - pose.head[:, 0], pose.objects[:, 0, 2] - pose.head[:, 2]
    away = np.maximum(np.sqrt(x * x + z * z), 1e-9)
    return in_heading_frame(situation, x / away, z / away)


def observe_object(situation: Situation) -> Array:
    """Return the direction to the object and the vector home, forward and right each, (B, 4)."""
    return np.stack([*direction_to_object(situation), *way_home(situation)], axis=1)


def way_home(situation: Situation) -> tuple[Array, Array]:
    """Return the vector from the head to its home, forward and right, in body lengths, (B,) each."""
    return way_to(situation, situation.goal.home_x, situation.goal.home_z)


def direction_home(situation: Situation) -> tuple[Array, Array]:
    """Return the direction from the head to its home, forward and right, (B,) each; at home it is 0."""
    forward, right = way_home(situation)
    away = np.maximum(np.sqrt(forward * forward + right * right), 1e-9)
    return forward / away, right / away


# reward terms: each is the increase of a function of positions, so it sums to zero over a detour


def approach(situation: Situation) -> Array:
    """Return how much nearer an arm's inner half has come to the object in this step, in body lengths, (B,)."""
    return (situation.progress_before.reach - situation.progress.reach) / situation.body.sensors.length


def crawl(situation: Situation) -> Array:
    """Return the increase of the head's largest distance from its start, in units of 0.2 m, up to 1, (B,)."""
    least, _ = CRAWLED
    new, old = (np.minimum(h.head_way, least) for h in (situation.progress, situation.progress_before))
    return (new - old) / least


def moved(progress: Handling) -> Array:
    """Return how far the object has been moved [m], (B,)."""
    return np.sqrt(progress.moved_x * progress.moved_x + progress.moved_z * progress.moved_z)


def move(situation: Situation) -> Array:
    """Return the increase of the object's displacement, in units of 0.1 m, up to 1, (B,)."""
    new, old = (np.minimum(moved(h), MOVED) for h in (situation.progress, situation.progress_before))
    return (new - old) / MOVED


def wrap(situation: Situation) -> Array:
    """Return the increase of the angle that an arm spans around the object, up to 200 degrees [rad], (B,)."""
    return np.minimum(situation.progress.span, WRAPPED) - np.minimum(situation.progress_before.span, WRAPPED)


def wind(situation: Situation) -> Array:
    """Return the increase of the angle that an arm winds around the object, up to 200 degrees [rad], (B,)."""
    return np.minimum(situation.progress.winding, WRAPPED) - np.minimum(situation.progress_before.winding, WRAPPED)


def grab(situation: Situation) -> Array:
    """Return 1 if the object was grabbed in this step, -1 if it was released, (B,)."""
    return situation.progress.grabbed - situation.progress_before.grabbed


def home(situation: Situation) -> Array:
    """Return the increase of g max(0, 1 - d), g being 1 while the object is held and d the distance to home, (B,).

    The distance is the head's, in body lengths.
    """
    s = situation

    def near(head: Array) -> Array:
        return np.maximum(1.0 - distance_from(head, s.goal.home_x, s.goal.home_z) / s.body.sensors.length, 0.0)

    return s.progress.grabbed * near(s.pose.head) - s.progress_before.grabbed * near(s.before.head)


def is_at_home(situation: Situation) -> Mask:
    """Return whether the head is at home, with the object held and near it, (B,) bool."""
    s, h = situation, situation.progress
    at_home = distance_from(s.pose.head, s.goal.home_x, s.goal.home_z) <= AT_HOME
    return (h.grabbed == 1.0) & at_home & (distance_from(s.pose.head, h.base_x, h.base_z) <= BROUGHT)


def has_crawled(situation: Situation) -> Mask:
    """Return whether the head and the centre of mass have been far enough from their starts together, (B,) bool."""
    return situation.progress.crawled == 1.0


def has_moved(situation: Situation) -> Mask:
    """Return whether the object has been moved by 0.1 m, (B,) bool."""
    return moved(situation.progress) >= MOVED


def has_fallen(situation: Situation) -> Mask:
    """Return whether the object leans by more than 45 degrees, (B,) bool."""
    return situation.progress.tilt > UPRIGHT


def fallen(situation: Situation) -> Array:
    """Return 1 if the object leans by more than 45 degrees, (B,)."""
    return has_fallen(situation).astype(np.float64)


handling_task = functools.partial(
    Task,
    make_body=octopus,
    goal_type=Goal,
    sample_goal=sample_goal,
    goal_blocks=(DIRECTION, HOME),
    progress_type=Handling,
    follow=follow,
    ends_on_success=True,
    failures={"toppled": has_toppled, "fallen": has_fallen},
    target=no_target,
)
"""Make a task of handling the object; arguments override the common defaults"""
