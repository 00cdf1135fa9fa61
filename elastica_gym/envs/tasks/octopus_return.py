"""OctopusReturn: carry the object home, held in an arm, within 10 s.

The two-arm octopus of 1 m (`elastica_gym.bodies.octopus`) on ground with isotropic friction, and a cylinder of 4 kg,
0.6 m high and 0.1 m thick, which one of its arms holds from the start. Home is elsewhere: the head has to get there
without releasing the object.

Notes
-----
The object is held while the touching elements of an arm, at least five, span 150 degrees around its axis (see
`.octopus_grab`), and released when they have spanned less at the end of each control step for more than 0.2 s. The
term home is an increment of progress so far, so moving back and forth earns nothing; a release costs what had been
earned.

Version history
---------------
v1: contact that conserves energy (contact forces act on nodes, by the weights of the closest points).
v0: the first; withdrawn.
"""

import numpy as np

from ...engine.model import Array
from ..handling import (
    Goal,
    brought,
    direction_home,
    fallen,
    goal_with_home,
    handling_task,
    home,
    is_at_home,
    way_home,
)
from ..initial_states import with_object_held
from ..task import DIRECTION, HOME, Situation, effort, on_the_ground, toppled

AWAY = (0.2, 0.6)
"""Least and largest distance of the head from home at reset [m]"""


def sample_goal(rng: np.random.Generator, situation: Situation) -> Goal:
    """Return a goal with its home at 0.2 to 0.6 m from the head, in any direction."""
    away, bearing = rng.uniform(*AWAY), rng.uniform(-np.pi, np.pi)
    x, _, z = situation.pose.head[0]
    return goal_with_home(situation, x + away * np.cos(bearing), z + away * np.sin(bearing))


def observe_goal(situation: Situation) -> Array:
    """Return the direction home and the vector home, forward and right each, (B, 4)."""
    return np.stack([*direction_home(situation), *way_home(situation)], axis=1)


def success(situation: Situation) -> Array:
    """Return 1 if the animal is at home with its object, (B,)."""
    return is_at_home(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the fraction of the episode that is left if the animal is at home with its object, else 0, (B,)."""
    return success(situation) * situation.time_left


def dropped(situation: Situation) -> Array:
    """Return 1 if the object was released in this step, (B,)."""
    return np.maximum(situation.progress_before.grabbed - situation.progress.grabbed, 0.0)


def target(goal: Goal) -> Array:
    """Return the place of home on the ground [m], (B, 3)."""
    return on_the_ground(goal.home_x, goal.home_z)


TASK = handling_task(
    name="OctopusReturn",
    description=__doc__,
    duration=10.0,
    initial_states={"held": with_object_held},
    sample_goal=sample_goal,
    goal_blocks=(
        DIRECTION._replace(meaning="direction home: forward and right of a unit vector"),
        HOME._replace(meaning="vector from the head to its home: forward and right"),
    ),
    observe_goal=observe_goal,
    reward_terms={
        "home": home,
        "success": success,
        "early": early,
        "effort": effort,
        "toppled": toppled,
        "fallen": fallen,
        "dropped": dropped,
    },
    reward_weights={
        "home": 20.0,
        "success": 10.0,
        "early": 10.0,
        "effort": 0.1,
        "toppled": -10.0,
        "fallen": -10.0,
        "dropped": -10.0,
        "diverged": -10.0,
    },
    distance=brought,
    succeeds=is_at_home,
    target=target,
)
