"""OctopusCrawl: crawl as far as you can in a commanded direction in 10 s.

The two-arm octopus of 1 m (`elastica_gym.bodies.octopus`) on ground with isotropic friction. It observes
a commanded direction and has to pull its heavy head there with two arms. Its object stands somewhere on
the other side.

Version history
---------------
v1: contact that conserves energy (contact forces act on nodes, by the weights of the closest points).
v0: the first; withdrawn.
"""

from typing import NamedTuple

import numpy as np

from ...bodies import octopus
from ...engine.model import Array
from ..initial_states import with_object_anywhere
from ..task import (
    DIRECTION,
    HOME,
    Mask,
    Situation,
    Task,
    effort,
    has_toppled,
    in_heading_frame,
    no_target,
    toppled,
    way_to,
)

FAR = 0.5
"""Distance that counts as success, in body lengths"""


class Goal(NamedTuple):
    """Direction to go, and place of the start."""

    home_x: Array
    """Place of the head at the start along x [m]"""
    home_z: Array
    """The same along z [m]"""
    direction_x: Array
    """Direction to go, along x"""
    direction_z: Array
    """The same along z"""
    start_x: Array
    """Place of the centre of mass at the start along x [m]"""
    start_z: Array
    """The same along z [m]"""


def sample_goal(rng: np.random.Generator, situation: Situation) -> Goal:
    """Return a direction to go, uniform within 90 degrees of directly away from the object."""
    head, centre = situation.pose.head[0, [0, 2]], situation.pose.centre[0, [0, 2]]
    x, z = situation.pose.objects[0, 0, [0, 2]] - head
    angle = np.arctan2(-z, -x) + rng.uniform(-0.5 * np.pi, 0.5 * np.pi)
    return Goal._make([*head, np.cos(angle), np.sin(angle), *centre])


def observe_goal(situation: Situation) -> Array:
    """Return the direction to go and the vector home, forward and right each, (B, 4)."""
    goal = situation.goal
    direction = in_heading_frame(situation, goal.direction_x, goal.direction_z)
    return np.stack([*direction, *way_to(situation, goal.home_x, goal.home_z)], axis=1)


def _along(goal: Goal, centre: Array) -> Array:
    return (centre[:, 0] - goal.start_x) * goal.direction_x + (centre[:, 2] - goal.start_z) * goal.direction_z


def distance(situation: Situation) -> Array:
    """Return how far the centre of mass has moved in the commanded direction [m], (B,)."""
    return _along(situation.goal, situation.pose.centre)


def forward(situation: Situation) -> Array:
    """Return the displacement in the commanded direction in this step, in body lengths, (B,)."""
    made = distance(situation) - _along(situation.goal, situation.before.centre)
    return made / situation.body.sensors.length


def succeeds(situation: Situation) -> Mask:
    """Return whether the animal has moved half a body length, (B,) bool."""
    return distance(situation) >= FAR * situation.body.sensors.length


TASK = Task(
    name="OctopusCrawl",
    description=__doc__,
    make_body=octopus,
    duration=10.0,
    initial_states={"anywhere": with_object_anywhere},
    goal_type=Goal,
    sample_goal=sample_goal,
    goal_blocks=(DIRECTION, HOME),
    observe_goal=observe_goal,
    reward_terms={"forward": forward, "effort": effort, "toppled": toppled},
    reward_weights={"forward": 10.0, "effort": 0.1, "toppled": -10.0, "diverged": -10.0},
    distance=distance,
    succeeds=succeeds,
    ends_on_success=False,
    failures={"toppled": has_toppled},
    target=no_target,
)
