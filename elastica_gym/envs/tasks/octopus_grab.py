"""OctopusGrab: wrap an arm around the object by 200 degrees and hold it like that for 0.5 s, within 10 s.

The two-arm octopus of 1 m (`elastica_gym.bodies.octopus`) on ground with isotropic friction, and a free-standing
cylinder of 4 kg, 0.6 m high and 0.1 m thick. An arm that bends at full strength with the object in its bend holds
it, but the object has to be in the bend first.

Notes
-----
An arm's inner half is the one next to the head. An arm spans the angle around the object's axis from the first to
the last of its touching elements, at least five, followed along the arm; the larger angle of two arms counts.
Elements touch if the gap between surfaces is less than 2 mm. The angle that an arm winds is the same over all its
elements, each part weighted by proximity: 1 where they touch, falling to 0 at a gap of 0.15 m. The object is grabbed
when an arm spans 200 degrees or more at the ends of all control steps in 0.5 s. Approach, wind and wrap are
increments of progress so far, so releasing and grabbing again earns nothing.

Version history
---------------
v1: contact that conserves energy (contact forces act on nodes, by the weights of the closest points).
v0: the first; withdrawn.
"""

import numpy as np

from ...engine.model import Array
from ..handling import TO_OBJECT, approach, fallen, handling_task, observe_object, wind, wrap
from ..initial_states import WITH_OBJECT, with_object_nearby
from ..task import HOME, Mask, Situation, effort, toppled


def succeeds(situation: Situation) -> Mask:
    """Return whether the object is grabbed, (B,) bool."""
    return situation.progress.grabbed == 1.0


def success(situation: Situation) -> Array:
    """Return 1 if the object is grabbed, (B,)."""
    return succeeds(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the fraction of the episode that is left if the object is grabbed, else 0, (B,)."""
    return success(situation) * situation.time_left


def distance(situation: Situation) -> Array:
    """Return the length of the object's circumference that is wrapped [m], (B,)."""
    return situation.progress.span * situation.body.cylinders[0].radius


TASK = handling_task(
    name="OctopusGrab",
    description=__doc__,
    duration=10.0,
    initial_states={name: WITH_OBJECT[name] for name in ("default", "arc", "anywhere")} | {"near": with_object_nearby},
    goal_blocks=(TO_OBJECT, HOME),
    observe_goal=observe_object,
    reward_terms={
        "approach": approach,
        "wind": wind,
        "wrap": wrap,
        "success": success,
        "early": early,
        "effort": effort,
        "toppled": toppled,
        "fallen": fallen,
    },
    reward_weights={
        "approach": 10.0,
        "wind": 5.0,
        "wrap": 5.0,
        "success": 10.0,
        "early": 10.0,
        "effort": 0.1,
        "toppled": -10.0,
        "fallen": -10.0,
        "diverged": -10.0,
    },
    distance=distance,
    succeeds=succeeds,
)
