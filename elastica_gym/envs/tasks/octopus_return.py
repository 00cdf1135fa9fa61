"""OctopusReturn: carry the object home, held in an arm, within 10 s.

Description
-----------
The two-arm octopus of 1 m (`elastica_gym.bodies.octopus`) on ground that holds it alike in all directions, and
a cylinder of 4 kg, 0.6 m high and 0.1 m thick, that one of its arms holds from the start. Home is elsewhere:
the head has to get there without letting go.

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
| 206-207 | direction from the head to its home: forward and right component of a unit vector | 1 | -1 to 1 |
| 208-209 | way from the head to its home: forward and right | body length | -4 to 4 |

Rewards
-------
The sum of these terms, each of which is in the info as ``reward_<term>`` with its weight:

| term | weight | formula, a control step |
|---|---|---|
| home | 20 | by how much 1 - d, but at least 0, has grown, with d the way of the head to its home in body lengths |
| success | 10 | 1 where the head is within 0.1 m of home, and the object within 0.3 m of the head |
| early | 10 | at success, the part of the episode that is left |
| effort | 0.1 | minus the mean square of the commanded activations, times the step's duration in seconds |
| toppled | -10 | 1 where the head has rolled or pitched by more than 60 degrees |
| fallen | -10 | 1 where the object leans by more than 45 degrees |
| dropped | -10 | 1 in the step in which the object is let go |
| diverged | -10 | 1 where the simulation has diverged, and then all other terms are 0 |

The object is held where the touching elements of an arm, at least five, span 150 degrees around its axis (see
`.octopus_grab`), and let go when they have spanned less at the end of each control step for more than
0.2 s. Home is a difference of what is so far, so going to and fro earns nothing; what is let go costs what it had
earned. The info also has ``distance``, by how much the object is nearer to home than at the start [m]; ``is_success``;
and ``termination_reason``, a number: 0 running, 1 time_limit, 2 success, 3 diverged, 4 toppled or 5 fallen.

Starting state
--------------
All is drawn from the environment's own generator: which arm holds the object, and in which of three ways, at
rest with that arm's muscles that bend it sideways fully active; the heading, uniform; a horizontal velocity
with a standard deviation of 0.02 m/s; and home, at 0.2 to 0.6 m from the head, in any direction.

Episode end
-----------
Terminated at success. Truncated after 10 s, which are 200 control steps. Terminated if the head rolls or
pitches by more than 60 degrees, since a ball rolls further than it crawls; if the object leans by more than 45
degrees, since what has fallen cannot be set up again; and if numbers stop being finite, or a node or the
object is faster than 50 m/s: then the last sound observation is returned. What is let go may be grabbed again.

Arguments
---------
Those of `elastica_gym.envs.BatchEnv`: ``control_dt`` (0.05 s), ``sim_dt`` (0.00016 s), ``duration``,
``max_episode_steps``, ``n_threads``, ``weights``, ``spread`` ("held"), ``render_mode``, ``render_size``; and of
`make_vec` ``autoreset_mode``.

Version history
---------------
v1: contact that conserves energy (contact forces act on nodes, by the weights of the closest points).
v0: the first; withdrawn.
"""

import numpy as np

from ...engine.model import Array
from ..handling import before, brought, direction_home, fallen, goal_with_home, handling_task, home, is_at_home, now
from ..starts import with_object_held
from ..task import Situation, effort, toppled, way_to_goal

AWAY = (0.2, 0.6)
"""Least and largest distance of the head from home at reset [m]"""


def draw_goal(rng: np.random.Generator, situation: Situation) -> Array:
    """Return a goal whose home is somewhere around the head, (5,)."""
    away, bearing = rng.uniform(*AWAY), rng.uniform(-np.pi, np.pi)
    x, _, z = situation.pose.head[0]
    return goal_with_home(situation, x + away * np.cos(bearing), z + away * np.sin(bearing))


def see_goal(situation: Situation) -> Array:
    """Return the direction home, forward and right, and the way home, forward and right, (B, 4)."""
    return np.stack([*direction_home(situation), *way_to_goal(situation)], axis=1)


def success(situation: Situation) -> Array:
    """Return 1 where the animal is at home with its object, (B,)."""
    return is_at_home(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the part of the episode that is left where the animal is at home with its object, else 0, (B,)."""
    return success(situation) * situation.time_left


def dropped(situation: Situation) -> Array:
    """Return 1 where the object has been let go in this step, (B,)."""
    return np.maximum(before(situation).grabbed - now(situation).grabbed, 0.0)


def target(goal: Array) -> Array:
    """Return where home is, on the ground [m], (B, 3)."""
    return np.stack([goal[:, 0], np.zeros(len(goal)), goal[:, 1]], axis=1)


TASK = handling_task(
    name="OctopusReturn",
    duration=10.0,
    starts={"held": with_object_held},
    draw_goal=draw_goal,
    see_goal=see_goal,
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
