"""SnakeReach: bring the head to a target around you within 20 s."""

from typing import TYPE_CHECKING

import numpy as np

from ..bodies import snake
from ..cosserat.model import Array
from .gaits import snake_crawl
from .task import Situation, Task, effort, in_heading_frame

if TYPE_CHECKING:
    from .batch import BatchEnv

NEAR = 0.05
"""Distance between head and target that counts as success, in body lengths"""
RING = (0.5, 1.5)
"""Least and largest distance of the target from the centre of mass at reset, in body lengths"""


def draw_goal(rng: np.random.Generator, situation: Situation) -> Array:
    """Return a target, uniform over the ring around the body, as (x, z) [m], (2,)."""
    inner, outer = RING
    # uniform over area: the square of the radius is uniform
    radius = np.sqrt(rng.uniform(inner**2, outer**2)) * situation.body.senses.length
    bearing = rng.uniform(-np.pi, np.pi)
    return situation.pose.centre[0, [0, 2]] + radius * np.array([np.cos(bearing), np.sin(bearing)])


def _gap(goal: Array, head: Array, length: float) -> Array:
    x, z = goal[:, 0] - head[:, 0], goal[:, 1] - head[:, 2]
    return np.sqrt(x * x + z * z) / length


def gap(situation: Situation) -> Array:
    """Return the horizontal distance of the head from the target, in body lengths, (B,)."""
    return _gap(situation.goal, situation.pose.head, situation.body.senses.length)


def see_goal(situation: Situation) -> Array:
    """Return the way from head to target, forward and right, and its length, in body lengths, (B, 3)."""
    s, length = situation, situation.body.senses.length
    x, z = (s.goal[:, 0] - s.pose.head[:, 0]) / length, (s.goal[:, 1] - s.pose.head[:, 2]) / length
    return np.stack([*in_heading_frame(s, x, z), gap(s)], axis=1)


def approach(situation: Situation) -> Array:
    """Return how much nearer the head has come in this step, in body lengths, (B,)."""
    return _gap(situation.goal, situation.before.head, situation.body.senses.length) - gap(situation)


def succeeds(situation: Situation) -> Array:
    """Return whether the head is at the target, (B,) bool."""
    return gap(situation) <= NEAR


def success(situation: Situation) -> Array:
    """Return 1 where the head is at the target, (B,)."""
    return succeeds(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the part of the episode that is left where the head is at the target, else 0, (B,)."""
    return success(situation) * situation.time_left


def distance(situation: Situation) -> Array:
    """Return minus the horizontal distance of the head from the target [m], (B,)."""
    return -gap(situation) * situation.body.senses.length


def target(goal: Array) -> Array:
    """Return the targets' positions on the ground [m], (B, 3)."""
    return np.stack([goal[:, 0], np.zeros(len(goal)), goal[:, 1]], axis=1)


def direction_of_goal(situation: Situation) -> Array:
    """Return the direction from centre of mass to target as an angle from the heading [rad], (B,)."""
    s = situation
    forward, right = in_heading_frame(s, s.goal[:, 0] - s.pose.centre[:, 0], s.goal[:, 1] - s.pose.centre[:, 2])
    return np.arctan2(right, forward)


def scripted_policy(env: "BatchEnv") -> Array:
    """Return the actions of a crawl that turns towards the goal, (B, 42)."""
    return snake_crawl(env, direction_of_goal(env.situation()))


TASK = Task(
    name="SnakeReach",
    make_body=snake,
    duration=20.0,
    draw_goal=draw_goal,
    goal_names=("goal/forward", "goal/right", "goal/gap"),
    goal_bounds=(4.0, 4.0, 4.0),
    see_goal=see_goal,
    reward_terms={"approach": approach, "success": success, "early": early, "effort": effort},
    reward_weights={"approach": 10.0, "success": 10.0, "early": 10.0, "effort": 0.1, "diverged": -10.0},
    distance=distance,
    succeeds=succeeds,
    ends_on_success=True,
    target=target,
    scripted_policy=scripted_policy,
)
