"""OctopusFetch: crawl to the object, grab it and bring it home, within 20 s.

The two-arm octopus of 1 m (`elastica_gym.bodies.octopus`) on ground with isotropic friction, and a free-standing
cylinder of 4 kg, 0.6 m high and 0.1 m thick, somewhere around it. Home is the place of the head at the start: the
animal has to crawl to the object, move it, wrap an arm around it and return with it.

Notes
-----
The terms are those of OctopusMove, OctopusGrab and OctopusReturn, where they are explained. The object is grabbed
when an arm spans 200 degrees or more around its axis at the ends of all control steps in 0.5 s, and released when no
arm has spanned 150 degrees for more than 0.2 s. Success requires all of the following: the head has been 0.2 m and
the centre of mass 0.1 m from its start at the same time; the object has been moved by 0.1 m while it stood and was
touched; it is held; the head is within 0.1 m of home, and the object within 0.3 m of the head. ``scripts/score.py``
requires more: the surfaces of head and object have been within 0.05 m, and the arm that grabbed is the one that holds.
All but the last six terms are increments of progress so far, so repeating an action earns nothing.

Version history
---------------
v1: contact that conserves energy (contact forces act on nodes, by the weights of the closest points).
v0: the first; withdrawn.
"""

import numpy as np

from ...engine.model import Array
from ..handling import (
    approach,
    brought,
    crawl,
    direction_home,
    direction_to_object,
    fallen,
    grab,
    handling_task,
    has_crawled,
    has_moved,
    home,
    is_at_home,
    move,
    way_home,
    wrap,
)
from ..initial_states import WITH_OBJECT
from ..task import Mask, Situation, effort, toppled


def observe_goal(situation: Situation) -> Array:
    """Return the direction to go and the vector home, forward and right each, (B, 4)."""
    there, back = np.stack(direction_to_object(situation)), np.stack(direction_home(situation))
    back = np.where(has_crawled(situation), back, -back)
    return np.stack([*np.where(situation.progress.grabbed == 1.0, back, there), *way_home(situation)], axis=1)


def succeeds(situation: Situation) -> Mask:
    """Return whether the animal has crawled, moved the object, and is at home with it, (B,) bool."""
    return has_crawled(situation) & has_moved(situation) & is_at_home(situation)


def success(situation: Situation) -> Array:
    """Return 1 if the object has been fetched, (B,)."""
    return succeeds(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the fraction of the episode that is left if the object has been fetched, else 0, (B,)."""
    return success(situation) * situation.time_left


TASK = handling_task(
    name="OctopusFetch",
    description=__doc__,
    duration=20.0,
    initial_states={name: WITH_OBJECT[name] for name in ("anywhere", "arc", "default")},
    observe_goal=observe_goal,
    reward_terms={
        "crawl": crawl,
        "approach": approach,
        "move": move,
        "wrap": wrap,
        "grab": grab,
        "home": home,
        "success": success,
        "early": early,
        "effort": effort,
        "toppled": toppled,
        "fallen": fallen,
    },
    reward_weights={
        "crawl": 5.0,
        "approach": 10.0,
        "move": 5.0,
        "wrap": 5.0,
        "grab": 10.0,
        "home": 20.0,
        "success": 10.0,
        "early": 10.0,
        "effort": 0.1,
        "toppled": -10.0,
        "fallen": -10.0,
        "diverged": -10.0,
    },
    distance=brought,
    succeeds=succeeds,
)
