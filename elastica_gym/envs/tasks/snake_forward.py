"""SnakeForward: go as far as you can along your initial heading in 10 s.

A snake of 0.35 m (`elastica_gym.bodies.snake`) lies on ground with higher friction sideways than forward.
It has to find waves of bending by which it crawls.

Version history
---------------
v1: firm ground (stiffness and damping), into which no part of the body sinks; self-contact.
v0: the first; withdrawn.
"""

from typing import NamedTuple

import numpy as np

from ...bodies import snake
from ...engine.model import Array
from ..initial_states import bent
from ..task import DIRECTION, Mask, Situation, Task, effort, in_heading_frame, no_target


class Goal(NamedTuple):
    """Direction to go, and place of the start."""

    direction_x: Array
    """Direction to go, which is the initial heading, along x"""
    direction_z: Array
    """The same along z"""
    start_x: Array
    """Place of the centre of mass at the start along x [m]"""
    start_z: Array
    """The same along z [m]"""


def sample_goal(rng: np.random.Generator, situation: Situation) -> Goal:
    """Return the initial heading, and the place of the centre of mass."""
    return Goal._make([*situation.pose.heading[0], *situation.pose.centre[0, [0, 2]]])


def observe_goal(situation: Situation) -> Array:
    """Return the direction to go as cosine and sine, forward and right, (B, 2)."""
    goal = situation.goal
    return np.stack(in_heading_frame(situation, goal.direction_x, goal.direction_z), axis=1)


def _along(goal: Goal, centre: Array) -> Array:
    return (centre[:, 0] - goal.start_x) * goal.direction_x + (centre[:, 2] - goal.start_z) * goal.direction_z


def distance(situation: Situation) -> Array:
    """Return how far the centre of mass has moved along the initial heading [m], (B,)."""
    return _along(situation.goal, situation.pose.centre)


def forward(situation: Situation) -> Array:
    """Return the displacement along the initial heading in this step, in body lengths, (B,)."""
    made = distance(situation) - _along(situation.goal, situation.before.centre)
    return made / situation.body.sensors.length


def _off_course(goal: Goal, heading: Array) -> Array:
    x, z, to_x, to_z = heading[:, 0], heading[:, 1], goal.direction_x, goal.direction_z
    return np.abs(np.arctan2(to_x * z - to_z * x, to_x * x + to_z * z))


def heading(situation: Situation) -> Array:
    """Return the decrease of the angle between heading and initial heading in this step [rad], (B,)."""
    return _off_course(situation.goal, situation.before.heading) - _off_course(situation.goal, situation.pose.heading)


def succeeds(situation: Situation) -> Mask:
    """Return whether the animal has moved one body length, (B,) bool."""
    return distance(situation) >= situation.body.sensors.length


TASK = Task(
    name="SnakeForward",
    description=__doc__,
    make_body=snake,
    duration=10.0,
    initial_states={"bent": bent},
    goal_type=Goal,
    sample_goal=sample_goal,
    goal_blocks=(DIRECTION,),
    observe_goal=observe_goal,
    reward_terms={"forward": forward, "heading": heading, "effort": effort},
    reward_weights={"forward": 10.0, "heading": 3.0, "effort": 0.1, "diverged": -10.0},
    distance=distance,
    succeeds=succeeds,
    ends_on_success=False,
    target=no_target,
)
