"""What tasks with an object follow: how it is gripped, what it has been through, and what of that is rewarded.

All is told from where things are at the end of each control step (`elastica_gym.bodies.grip`), not from forces.
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
"""Angle around the object's axis that the touching elements of an arm span where it has grabbed it [rad]"""
KEPT = np.radians(150.0)
"""And where it still holds it [rad]"""
FEWEST = 5
"""Touching elements without which an arm counts as spanning nothing"""
GRABBING_TIME = 0.5
"""How long an arm has to have it wrapped without a break [s]"""
SLACK_TIME = 0.2
"""How long it may then hold less [s]"""
UPRIGHT = np.radians(45.0)
"""Tilt up to which the object stands [rad]"""
MOVED = 0.1
"""Way of the object that counts as moved [m]"""
CRAWLED = (0.2, 0.1)
"""Distance of the head and of the centre of mass from their start that counts as crawled [m]"""
AT_HOME = 0.1
"""Distance of the head from home that counts as being there [m]"""
BROUGHT = 0.3
"""Distance of the object from the head that counts as having brought it [m]"""
TO_OBJECT = DIRECTION._replace(meaning="direction from the head to the object: forward and right of a unit vector")
"""Where to go, as animals observe it that shall go to their object"""


class Goal(NamedTuple):
    """Where to bring the object, and how all was at the start."""

    home_x: Array
    """Where home is [m]"""
    home_z: Array
    """The same [m]"""
    start_x: Array
    """Where the centre of mass was at the start [m]"""
    start_z: Array
    """The same [m]"""
    away: Array
    """Distance of the object from home at the start [m]"""


class Handling(NamedTuple):
    """How each of B animals handles its object: a situation's ``progress``, (B,) each."""

    reach: Array
    """Least distance of the object's surface from the half of an arm that is next to the head [m]"""
    span: Array
    """The larger of the angles around the object's axis that an arm's touching elements span [rad]"""
    winding: Array
    """The larger of the angles that an arm winds around it, near as it is (`Grip.windings`) [rad]"""
    first: Array
    """Steps in a row at whose end the first arm has had it wrapped"""
    second: Array
    """Steps in a row at whose end the second arm has had it wrapped"""
    slack: Array
    """Steps in a row at whose end neither arm has held it"""
    grabbed: Array
    """1 from when an arm has grabbed it until it is let go, else 0; what is held at the start is grabbed"""
    moved_x: Array
    """Way that the centre of its base has made while it stood and was touched, along x [m]"""
    moved_z: Array
    """The same along z [m]"""
    base_x: Array
    """Where the centre of its base is [m]"""
    base_z: Array
    """The same [m]"""
    tilt: Array
    """Angle of its axis from upright [rad]"""
    head_way: Array
    """Furthest that the head has been from home, which is where it starts but in OctopusReturn [m]"""
    crawled: Array
    """1 from when both head and centre of mass have been `CRAWLED` from there, at the same moment, else 0"""


def follow(situation: Situation, state: State) -> Handling:
    """Return how the object is handled at the end of this step."""
    s, old, begins = situation, situation.progress, situation.time_left >= 1.0
    held = grip(s.body, state)
    arms = np.where(held.counts >= FEWEST, held.spans, 0.0)
    span = np.maximum(arms[:, 0], arms[:, 1])
    first, second = (np.where(arms[:, a] >= WRAPPED, n + 1.0, 0.0) for a, n in enumerate((old.first, old.second)))
    slack = np.where(span >= KEPT, 0.0, old.slack + 1.0)
    # n looks in a row are n - 1 steps apart
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
    """Return the least gap of the half of either arm that is next to the head, 0 where it touches [m], (B,)."""
    (tip, base), (other_base, other_tip) = arms
    inner = gaps[:, (tip + base) // 2 : base].min(axis=1)
    other = gaps[:, other_base : (other_base + other_tip) // 2].min(axis=1)
    return np.maximum(np.minimum(inner, other), 0.0)


def sample_goal(rng: np.random.Generator, situation: Situation) -> Goal:
    """Return a goal whose home is where the head is."""
    return goal_with_home(situation, situation.pose.head[0, 0], situation.pose.head[0, 2])


def goal_with_home(situation: Situation, x: float, z: float) -> Goal:
    """Return the goal of one environment whose home is there."""
    pose = situation.pose
    away = distance_from(pose.objects[:, 0], np.array([x]), np.array([z]))
    return Goal._make([x, z, *pose.centre[0, [0, 2]], *away])


def brought(situation: Situation) -> Array:
    """Return by how much the object is nearer to home than at the start [m], (B,)."""
    goal = situation.goal
    return goal.away - distance_from(situation.pose.objects[:, 0], goal.home_x, goal.home_z)


def direction_to_object(situation: Situation) -> tuple[Array, Array]:
    """Return the direction from the head to the object, forward and right, (B,) each."""
    pose = situation.pose
    x, z = pose.objects[:, 0, 0] - pose.head[:, 0], pose.objects[:, 0, 2] - pose.head[:, 2]
    away = np.maximum(np.sqrt(x * x + z * z), 1e-9)
    return in_heading_frame(situation, x / away, z / away)


def observe_object(situation: Situation) -> Array:
    """Return the direction to the object, forward and right, and the way home, forward and right, (B, 4)."""
    return np.stack([*direction_to_object(situation), *way_home(situation)], axis=1)


def way_home(situation: Situation) -> tuple[Array, Array]:
    """Return the way from the head to its home, forward and right, in body lengths, (B,) each."""
    return way_to(situation, situation.goal.home_x, situation.goal.home_z)


def direction_home(situation: Situation) -> tuple[Array, Array]:
    """Return the direction from the head to its home, forward and right, (B,) each; at home it is 0."""
    forward, right = way_home(situation)
    away = np.maximum(np.sqrt(forward * forward + right * right), 1e-9)
    return forward / away, right / away


# what is rewarded: each is by how much a function of where things are has grown, and adds up to nothing over a detour


def approach(situation: Situation) -> Array:
    """Return by how much an arm's inner half has come nearer to the object in this step, in body lengths, (B,)."""
    return (situation.progress_before.reach - situation.progress.reach) / situation.body.sensors.length


def crawl(situation: Situation) -> Array:
    """Return by how much the furthest way of the head from its start has grown, in parts of 0.2 m, up to 1, (B,)."""
    least, _ = CRAWLED
    new, old = (np.minimum(h.head_way, least) for h in (situation.progress, situation.progress_before))
    return (new - old) / least


def moved(progress: Handling) -> Array:
    """Return how far the object has been moved [m], (B,)."""
    return np.sqrt(progress.moved_x * progress.moved_x + progress.moved_z * progress.moved_z)


def move(situation: Situation) -> Array:
    """Return by how much the way of the object has grown, in parts of 0.1 m, up to 1, (B,)."""
    new, old = (np.minimum(moved(h), MOVED) for h in (situation.progress, situation.progress_before))
    return (new - old) / MOVED


def wrap(situation: Situation) -> Array:
    """Return by how much the angle around the object has grown, up to 200 degrees [rad], (B,)."""
    return np.minimum(situation.progress.span, WRAPPED) - np.minimum(situation.progress_before.span, WRAPPED)


def wind(situation: Situation) -> Array:
    """Return by how much the angle that an arm winds around the object has grown, up to 200 degrees [rad], (B,)."""
    return np.minimum(situation.progress.winding, WRAPPED) - np.minimum(situation.progress_before.winding, WRAPPED)


def grab(situation: Situation) -> Array:
    """Return 1 where the object has been grabbed in this step, -1 where it has been let go, (B,)."""
    return situation.progress.grabbed - situation.progress_before.grabbed


def home(situation: Situation) -> Array:
    """Return by how much g max(0, 1 - d) has grown, with g whether the object is held, d the way home, (B,).

    The way home is that of the head, in body lengths.
    """
    s = situation

    def near(head: Array) -> Array:
        return np.maximum(1.0 - distance_from(head, s.goal.home_x, s.goal.home_z) / s.body.sensors.length, 0.0)

    return s.progress.grabbed * near(s.pose.head) - s.progress_before.grabbed * near(s.before.head)


def is_at_home(situation: Situation) -> Mask:
    """Return whether the head is at home, and the object, in the animal's hold, near it, (B,) bool."""
    s, h = situation, situation.progress
    at_home = distance_from(s.pose.head, s.goal.home_x, s.goal.home_z) <= AT_HOME
    return (h.grabbed == 1.0) & at_home & (distance_from(s.pose.head, h.base_x, h.base_z) <= BROUGHT)


def has_crawled(situation: Situation) -> Mask:
    """Return whether the head and the centre of mass have been far enough from their starts at once, (B,) bool."""
    return situation.progress.crawled == 1.0


def has_moved(situation: Situation) -> Mask:
    """Return whether the object has been moved by 0.1 m, (B,) bool."""
    return moved(situation.progress) >= MOVED


def has_fallen(situation: Situation) -> Mask:
    """Return whether the object leans by more than 45 degrees, (B,) bool."""
    return situation.progress.tilt > UPRIGHT


def fallen(situation: Situation) -> Array:
    """Return 1 where the object leans by more than 45 degrees, (B,)."""
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
"""Make a task of handling the object; what these have in common is given, and may be given otherwise"""
