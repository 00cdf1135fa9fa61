"""OctopusReach: crawl to the object and touch it with the head or an arm within 10 s.

The two-arm octopus of 1 m (`elastica_gym.bodies.octopus`) on ground with isotropic friction, and a
free-standing cylinder of 4 kg, 0.6 m high and 0.1 m thick: on the arc from straight ahead of the head to
its right, the side away from the arms, or anywhere around it.

Notes
-----
The gap is to the object as rods touch it, with domes of 0.05 m on its ends. Approaches add up to the total decrease of
the gap, so hovering earns nothing.

From most places on the arc, one lunge of half a second reaches the object; with ``spread="anywhere"`` the octopus has
to turn or crawl.

Version history
---------------
v1: contact that conserves energy (contact forces act on nodes, by the weights of the closest points).
v0: the first; withdrawn.
"""

from typing import NamedTuple

import numpy as np

from ...bodies import octopus
from ...bodies.grip import TOUCH
from ...engine.model import Array
from ..handling import TO_OBJECT, observe_object
from ..initial_states import WITH_OBJECT
from ..task import HOME, Mask, Situation, Task, effort, has_toppled, no_target, toppled


class Goal(NamedTuple):
    """The situation at the start."""

    home_x: Array
    """Place of the head at the start along x [m]"""
    home_z: Array
    """The same along z [m]"""
    gap: Array
    """Gap to the object at the start [m]"""


def sample_goal(rng: np.random.Generator, situation: Situation) -> Goal:
    """Return the place of the head, and the gap to the object."""
    return Goal._make([*situation.pose.head[0, [0, 2]], situation.pose.gaps[0, 0]])


def approach(situation: Situation) -> Array:
    """Return the decrease of the gap to the object in this step, in body lengths, (B,)."""
    return (situation.before.gaps[:, 0] - situation.pose.gaps[:, 0]) / situation.body.sensors.length


def succeeds(situation: Situation) -> Mask:
    """Return whether the animal touches the object, (B,) bool."""
    return situation.pose.gaps[:, 0] <= TOUCH


def success(situation: Situation) -> Array:
    """Return 1 if the animal touches the object, (B,)."""
    return succeeds(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the fraction of the episode that is left if the animal touches the object, else 0, (B,)."""
    return success(situation) * situation.time_left


def distance(situation: Situation) -> Array:
    """Return the decrease of the gap since reset [m], (B,)."""
    return situation.goal.gap - situation.pose.gaps[:, 0]


TASK = Task(
    name="OctopusReach",
    description=__doc__,
    make_body=octopus,
    duration=10.0,
    initial_states=WITH_OBJECT,
    goal_type=Goal,
    sample_goal=sample_goal,
    goal_blocks=(TO_OBJECT, HOME),
    observe_goal=observe_object,
    reward_terms={"approach": approach, "success": success, "early": early, "effort": effort, "toppled": toppled},
    reward_weights={
        "approach": 10.0,
        "success": 10.0,
        "early": 10.0,
        "effort": 0.1,
        "toppled": -10.0,
        "diverged": -10.0,
    },
    distance=distance,
    succeeds=succeeds,
    ends_on_success=True,
    failures={"toppled": has_toppled},
    target=no_target,
)
