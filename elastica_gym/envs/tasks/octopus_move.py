"""OctopusMove: push or pull the object 10 cm without felling it, within 10 s.

Description
-----------
The two-arm octopus of 1 m (`elastica_gym.bodies.octopus`) on ground that holds it alike in all directions, and
a cylinder of 4 kg, 0.6 m high and 0.1 m thick, that stands free. It has to be moved while it stands and is
touched: what topples, or slides on by itself, does not count.

Action
------
``Box(-1, 1, (42,), float32)``: the activations that the muscles are commanded to, held for a control
step and clipped to the range. Muscles follow with a time constant of 0.06 s. See `elastica_gym.bodies.muscles`.

| index | direction | arm | function |
|---|---|---|---|
| 0-6, 7-13 | about the normal: bends sideways | first, second | level 0, then 2 of level 1, then 4 of level 2 |
| 14-20, 21-27 | about the binormal: lifts | first, second | the same |
| 28-34, 35-41 | about the tangent: twists | first, second | the same |

Functions are counted from the head to the tip. An action of another shape, or one that holds NaN, raises ValueError.

Observation
-----------
``Box(float32)``, clipped to its range. All directions are in the frame of the head: forward is the
horizontal direction of its axis, from the first arm to the second, right is to its right seen from above
with y up. At rest the arms point half to the left.

| index | meaning | unit | range |
|---|---|---|---|
| 0-32 | position of 11 nodes, tip to tip, from the centre of mass: forward, up, right | body length | -1 to 1 |
| 33-65 | their velocity: forward, up, right of each | body lengths/s | -20 to 20 |
| 66-101 | curvature about the normal and binormal, and twist, at 12 places, from tip to tip | 10/m | -10 to 10 |
| 102-125 | up component of normal and binormal there: how the body has rolled | 1 | -1 to 1 |
| 126-136 | force with which the ground carries each of 11 parts, tip to tip | an 11th of the weight | 0 to 50 |
| 137-147 | force with which the object touches each of them | an 11th of the weight | 0 to 50 |
| 148-150 | the object's centre, from the head: forward, up, right | body length | -4 to 4 |
| 151-153 | its axis, from foot to top at the start: forward, up, right | 1 | -1 to 1 |
| 154-156 | its velocity: forward, up, right | body lengths/s | -20 to 20 |
| 157-159 | its angular velocity: about forward, up, right | rad/s | -50 to 50 |
| 160 | gap between its surface and the animal's | body length | -1 to 4 |
| 161-202 | activation that each muscle has reached, in the order of the actions | 1 | -1 to 1 |
| 203-204 | sine and cosine of a clock with a period of 1 s | 1 | -1 to 1 |
| 205 | part of the episode that is left | 1 | 0 to 1 |
| 206-207 | direction from the head to the object: forward and right component of a unit vector | 1 | -1 to 1 |
| 208-209 | way from the head to where it was at the start, its home: forward and right | body length | -4 to 4 |

Rewards
-------
The sum of these terms, each of which is in the info as ``reward_<term>`` with its weight:

| term | weight | formula, a control step |
|---|---|---|
| approach | 10 | by how much the gap between an arm's inner half and the object has shrunk, in body lengths |
| move | 10 | by how much the way of the object has grown, in parts of 0.1 m, up to 1 |
| success | 10 | 1 where that way is 0.1 m or more |
| early | 10 | at success, the part of the episode that is left |
| effort | 0.1 | minus the mean square of the commanded activations, times the step's duration in seconds |
| toppled | -10 | 1 where the head has rolled or pitched by more than 60 degrees |
| fallen | -10 | 1 where the object leans by more than 45 degrees |
| diverged | -10 | 1 where the simulation has diverged, and then all other terms are 0 |

An arm's inner half is the one next to the head. The way of the object is from where its base was: steps add to it at
whose end the animal touches it, and it leans by no more than 45 degrees. Approach and move are differences of what is
so far, so going to and fro earns nothing. The info also has ``distance``, that way [m]; ``is_success``; and
``termination_reason``, a number: 0 running, 1 time_limit, 2 success, 3 diverged, 4 toppled or 5 fallen.

Starting state
--------------
All is drawn from the environment's own generator: the heading, uniform; the shape, the resting one bent
sideways by three sine waves of couple, whose curvature at the tips has normal amplitudes of 0.7, 0.35 and 0.175
1/m; a horizontal velocity with a standard deviation of 0.02 m/s; and the object, upright, at 0.4 m straight to
the right of the head (``spread="default"``), at 0.4 m and a bearing uniform from straight ahead to straight to
the right (``"arc"``), at 0.4 to 0.8 m and any bearing (``"anywhere"``), drawn again where it would stand in the
animal. Muscles are at rest.

Episode end
-----------
Terminated at success. Truncated after 10 s, which are 200 control steps. Terminated if the head rolls or
pitches by more than 60 degrees, since a ball rolls further than it crawls; if the object leans by more than 45
degrees, since what has fallen cannot be set up again; and if numbers stop being finite, or a node or the object
is faster than 50 m/s: then the last sound observation is returned.

Arguments
---------
Those of `elastica_gym.envs.BatchEnv`: ``control_dt`` (0.05 s), ``sim_dt`` (0.00016 s), ``duration``,
``max_episode_steps``, ``n_threads``, ``weights``, ``spread`` ("default", "arc" or "anywhere"), ``render_mode``,
``render_size``; and of `make_vec` ``autoreset_mode``.

Version history
---------------
v1: contact that conserves energy (contact forces act on nodes, by the weights of the closest points).
v0: the first; withdrawn.
"""

import numpy as np

from ...engine.model import Array
from ..handling import approach, fallen, handling_task, has_moved, move, moved, now, see_object
from ..starts import OBJECT_STARTS
from ..task import Situation, effort, toppled


def success(situation: Situation) -> Array:
    """Return 1 where the object has been moved far enough, (B,)."""
    return has_moved(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the part of the episode that is left where the object has been moved far enough, else 0, (B,)."""
    return success(situation) * situation.time_left


def distance(situation: Situation) -> Array:
    """Return how far the object has been moved while it stood and was touched [m], (B,)."""
    return moved(now(situation))


TASK = handling_task(
    name="OctopusMove",
    duration=10.0,
    starts={name: OBJECT_STARTS[name] for name in ("default", "arc", "anywhere")},
    see_goal=see_object,
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
