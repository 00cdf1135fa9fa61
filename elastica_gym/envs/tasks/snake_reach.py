"""SnakeReach: bring the head to a target around you within 20 s.

The snake of SnakeForward, and a place on the ground, drawn uniformly over the ring between 0.5 and 1.5
body lengths around its centre of mass, in any direction: behind it as often as in front of it.

Notes
-----
Approaches add up to the total decrease in distance, whatever path the head takes, so hovering earns nothing. Distances
are horizontal.

Version history
---------------
v1: firm ground (stiffness and damping), into which no part of the body sinks; self-contact.
v0: the first; withdrawn.
"""

from typing import NamedTuple

import numpy as np

from ...bodies import snake
from ...bodies.observation import Block, single
from ...engine.model import Array
from ..initial_states import bent
from ..task import Mask, Situation, Task, distance_from, effort, on_the_ground, way_to

NEAR = 0.05
"""Distance between head and target that counts as success, in body lengths"""
RING = (0.5, 1.5)
"""Least and largest distance of the target from the centre of mass at reset, in body lengths"""


class Goal(NamedTuple):
    """A target."""

    x: Array
    """Its place along x [m]"""
    z: Array
    """The same along z [m]"""
    way: Array
    """Distance of the head from it at the start [m]"""


def sample_goal(rng: np.random.Generator, situation: Situation) -> Goal:
    """Return a target, uniform over the ring around the body."""
    inner, outer = RING
    # uniform over area: the square of the radius is uniform
    radius = np.sqrt(rng.uniform(inner**2, outer**2)) * situation.body.sensors.length
    bearing = rng.uniform(-np.pi, np.pi)
    x, z = situation.pose.centre[0, [0, 2]] + radius * np.array([np.cos(bearing), np.sin(bearing)])
    return Goal._make([x, z, *distance_from(situation.pose.head, x, z)])


def _gap(goal: Goal, head: Array, length: float) -> Array:
    return distance_from(head, goal.x, goal.z) / length


def gap(situation: Situation) -> Array:
    """Return the horizontal distance of the head from the target, in body lengths, (B,)."""
    return _gap(situation.goal, situation.pose.head, situation.body.sensors.length)


def observe_goal(situation: Situation) -> Array:
    """Return the vector from head to target, forward and right, and its length, in body lengths, (B, 3)."""
    return np.stack([*way_to(situation, situation.goal.x, situation.goal.z), gap(situation)], axis=1)


def approach(situation: Situation) -> Array:
    """Return how much nearer the head has come in this step, in body lengths, (B,)."""
    return _gap(situation.goal, situation.before.head, situation.body.sensors.length) - gap(situation)


def succeeds(situation: Situation) -> Mask:
    """Return whether the head is at the target, (B,) bool."""
    return gap(situation) <= NEAR


def success(situation: Situation) -> Array:
    """Return 1 if the head is at the target, (B,)."""
    return succeeds(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the fraction of the episode that is left if the head is at the target, else 0, (B,)."""
    return success(situation) * situation.time_left


def distance(situation: Situation) -> Array:
    """Return how much nearer the head is to the target than at reset [m], (B,)."""
    return situation.goal.way - _gap(situation.goal, situation.pose.head, 1.0)


def target(goal: Goal) -> Array:
    """Return the targets' positions on the ground [m], (B, 3)."""
    return on_the_ground(goal.x, goal.z)


TASK = Task(
    name="SnakeReach",
    description=__doc__,
    make_body=snake,
    duration=20.0,
    initial_states={"bent": bent},
    goal_type=Goal,
    sample_goal=sample_goal,
    goal_blocks=(
        Block("goal", ("forward", "right"), -4.0, 4.0, "body length", "vector from head to target: forward and right"),
        single("goal/gap", 0.0, 4.0, "body length", "its length"),
    ),
    observe_goal=observe_goal,
    reward_terms={"approach": approach, "success": success, "early": early, "effort": effort},
    reward_weights={"approach": 10.0, "success": 10.0, "early": 10.0, "effort": 0.1, "diverged": -10.0},
    distance=distance,
    succeeds=succeeds,
    ends_on_success=True,
    target=target,
)
