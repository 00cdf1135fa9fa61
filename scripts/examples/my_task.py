"""A task of one's own: a snake that turns on the spot to a direction.

``elastica-gym train --env my_task:my_lab/SnakeTurn-v0`` finds it in the current folder.
"""

from typing import NamedTuple

import numpy as np

import elastica_gym
from elastica_gym.bodies import snake
from elastica_gym.envs import Task
from elastica_gym.envs.initial_states import bent
from elastica_gym.envs.task import DIRECTION, effort, in_heading_frame, no_target

CLOSE = np.radians(10.0)
"""Angle that counts as success [rad]"""


class Goal(NamedTuple):
    """The direction to turn to; fields have shape (B,)."""

    x: np.ndarray
    """Its component along x"""
    z: np.ndarray
    """Its component along z"""


def sample_goal(rng, situation):
    """Return a direction, uniform over the circle."""
    angle = rng.uniform(-np.pi, np.pi)
    return Goal(np.cos(angle), np.sin(angle))


def observe_goal(situation):
    """Return the direction in the frame of the heading, forward and right, (B, 2)."""
    return np.stack(in_heading_frame(situation, situation.goal.x, situation.goal.z), axis=1)


def _off(goal, heading):
    """Return the angle between heading and goal [rad], (B,)."""
    cross, dot = goal.x * heading[:, 1] - goal.z * heading[:, 0], goal.x * heading[:, 0] + goal.z * heading[:, 1]
    return np.abs(np.arctan2(cross, dot))


def turn(situation):
    """Return the decrease of the angle in this step [rad], (B,)."""
    return _off(situation.goal, situation.before.heading) - _off(situation.goal, situation.pose.heading)


def turned(situation):
    """Return whether the heading is within 10 degrees of the goal, (B,) bool."""
    return _off(situation.goal, situation.pose.heading) <= CLOSE


def distance(situation):
    """Return the displacement of the centre of mass in this step [m], (B,)."""
    return np.linalg.norm(situation.pose.centre - situation.before.centre, axis=1)


TASK = Task(
    name="SnakeTurn",
    description="SnakeTurn: turn to a direction within 10 s.",
    make_body=snake,
    duration=10.0,
    initial_states={"bent": bent},
    goal_type=Goal,
    sample_goal=sample_goal,
    goal_blocks=(DIRECTION,),
    observe_goal=observe_goal,
    reward_terms={"turn": turn, "effort": effort},
    reward_weights={"turn": 3.0, "effort": 0.1, "diverged": -10.0},
    distance=distance,
    succeeds=turned,
    ends_on_success=True,
    target=no_target,
)

elastica_gym.register("my_lab/SnakeTurn-v0", TASK)
