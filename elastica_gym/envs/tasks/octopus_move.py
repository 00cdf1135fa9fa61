"""OctopusMove: push or pull the object 10 cm without knocking it over, within 10 s.

The two-arm octopus of 1 m (`elastica_gym.bodies.octopus`) on ground with isotropic friction, and a free-standing
cylinder of 4 kg, 0.6 m high and 0.1 m thick. It has to be moved while it stands and is touched: toppling and
sliding on by itself do not count.

Notes
-----
An arm's inner half is the one next to the head. The object's displacement is that of its base, summed over the steps
that end with the animal touching it and with a lean of at most 45 degrees. Approach and move are increments of
progress so far, so moving back and forth earns nothing.

Version history
---------------
v1: contact that conserves energy (contact forces act on nodes, by the weights of the closest points).
v0: the first; withdrawn.
"""

import numpy as np

from ...engine.model import Array
from ..handling import TO_OBJECT, approach, fallen, handling_task, has_moved, move, moved, observe_object
from ..initial_states import WITH_OBJECT
from ..task import HOME, Situation, effort, toppled


def success(situation: Situation) -> Array:
    """Return 1 if the object has been moved far enough, (B,)."""
    return has_moved(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the fraction of the episode that is left if the object has been moved far enough, else 0, (B,)."""
    return success(situation) * situation.time_left


def distance(situation: Situation) -> Array:
    """Return how far the object has been moved while it stood and was touched [m], (B,)."""
    return moved(situation.progress)


TASK = handling_task(
    name="OctopusMove",
    description=__doc__,
    duration=10.0,
    initial_states={name: WITH_OBJECT[name] for name in ("default", "arc", "anywhere")},
    goal_blocks=(TO_OBJECT, HOME),
    observe_goal=observe_object,
    reward_terms={
        "approach": approach,
        "move": move,
        "success": success,
        "early": early,
        "effort": effort,
        "toppled": toppled,
        "fallen": fallen,
    },
    reward_weights={
        "approach": 10.0,
        "move": 10.0,
        "success": 10.0,
        "early": 10.0,
        "effort": 0.1,
        "toppled": -10.0,
        "fallen": -10.0,
        "diverged": -10.0,
    },
    distance=distance,
    succeeds=has_moved,
)
