"""OctopusReach: crawl to the object and touch it with the head or an arm within 10 s.

Description
-----------
The two-arm octopus of 1 m (`elastica_gym.bodies.octopus`) on ground that holds it alike in all
directions, and a cylinder of 4 kg, 0.6 m high and 0.1 m thick, that stands free: on the arc from straight
ahead of the head to its right, the side away from the arms, or anywhere around it.

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
| approach | 10 | by how much the gap between the surfaces of animal and object has shrunk, in body lengths |
| success | 10 | 1 where the gap is 2 mm or less |
| early | 10 | at success, the part of the episode that is left |
| effort | 0.1 | minus the mean square of the commanded activations, times the step's duration in seconds |
| toppled | -10 | 1 where the head has rolled or pitched by more than 60 degrees |
| diverged | -10 | 1 where the simulation has diverged, and then all other terms are 0 |

The gap is to the object as rods meet it, with domes of 0.05 m on its ends. Approaches add up to what it has shrunk in
all, so hovering earns nothing. The info also has ``distance``, by how much it has shrunk since reset [m];
``is_success``; and ``termination_reason``, a number: 0 running, 1 time_limit, 2 success, 3 diverged or 4 toppled.

Starting state
--------------
All is drawn from the environment's own generator: the heading, uniform; the shape, the resting one bent
sideways by three sine waves of couple, whose curvature at the tips has normal amplitudes of 0.7, 0.35 and 0.175
1/m; a horizontal velocity with a standard deviation of 0.02 m/s; and the object, upright, at 0.4 m from the
head, its bearing uniform from straight ahead to straight to the right (``spread="arc"``), or at 0.4 to 0.8 m and any
bearing (``spread="anywhere"``), drawn again where it would stand in the animal; or at 0.4 m straight to the right
(``spread="default"``). Muscles are at rest.

Episode end
-----------
Terminated at success. Truncated after 10 s, which are 200 control steps. Terminated if the head rolls
or pitches by more than 60 degrees, since a ball rolls further than it crawls; and if numbers stop being
finite, or a node or the object is faster than 50 m/s: then the last sound observation is returned.

Arguments
---------
Those of `elastica_gym.envs.BatchEnv`: ``control_dt`` (0.05 s), ``sim_dt`` (0.00016 s), ``duration``,
``max_episode_steps``, ``n_threads``, ``weights``, ``spread`` ("arc", "anywhere" or "default"), ``render_mode``,
``render_size``; and of `make_vec` ``autoreset_mode``.

Version history
---------------
v1: contact that conserves energy (contact forces act on nodes, by the weights of the closest points).
v0: the first; withdrawn.
"""

import numpy as np

from ...bodies import octopus
from ...bodies.grip import TOUCH
from ...engine.model import Array
from ..handling import see_object
from ..starts import OBJECT_STARTS
from ..task import GOAL_BOUNDS, GOAL_NAMES, Mask, Situation, Task, effort, has_toppled, no_target, toppled


def draw_goal(rng: np.random.Generator, situation: Situation) -> Array:
    """Return home (x, z) and the gap at the start [m], (3,)."""
    return np.array([*situation.pose.head[0, [0, 2]], situation.pose.gaps[0, 0]])


def approach(situation: Situation) -> Array:
    """Return by how much the gap to the object has shrunk in this step, in body lengths, (B,)."""
    return (situation.before.gaps[:, 0] - situation.pose.gaps[:, 0]) / situation.body.senses.length


def succeeds(situation: Situation) -> Mask:
    """Return whether the animal touches the object, (B,) bool."""
    return situation.pose.gaps[:, 0] <= TOUCH


def success(situation: Situation) -> Array:
    """Return 1 where the animal touches the object, (B,)."""
    return succeeds(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the part of the episode that is left where the animal touches the object, else 0, (B,)."""
    return success(situation) * situation.time_left


def distance(situation: Situation) -> Array:
    """Return by how much the gap has shrunk since reset [m], (B,)."""
    return situation.goal[:, 2] - situation.pose.gaps[:, 0]


TASK = Task(
    name="OctopusReach",
    make_body=octopus,
    duration=10.0,
    starts=OBJECT_STARTS,
    goal_size=3,
    draw_goal=draw_goal,
    goal_names=GOAL_NAMES,
    goal_bounds=GOAL_BOUNDS,
    see_goal=see_object,
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
