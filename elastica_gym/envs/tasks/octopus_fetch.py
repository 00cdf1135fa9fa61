"""OctopusFetch: crawl to the object, grab it and bring it home, within 20 s.

Description
-----------
The two-arm octopus of 1 m (`elastica_gym.bodies.octopus`) on ground that holds it alike in all directions, and
a cylinder of 4 kg, 0.6 m high and 0.1 m thick, that stands free somewhere around it. Home is where the head is
at the start: the animal has to crawl to the object, move it, wrap an arm around it and come back with it.

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
| 206-207 | direction to go (below): forward and right component of a unit vector | 1 | -1 to 1 |
| 208-209 | way from the head to where it was at the start, its home: forward and right | body length | -4 to 4 |

The direction to go is to the object; once that is grabbed, it is home, or away from there until the animal has
crawled as far as success asks for.

Rewards
-------
The sum of these terms, each of which is in the info as ``reward_<term>`` with its weight:

| term | weight | formula, a control step |
|---|---|---|
| crawl | 5 | by how much the furthest way of the head from its start has grown, in parts of 0.2 m, up to 1 |
| approach | 10 | by how much the gap between an arm's inner half and the object has shrunk, in body lengths |
| move | 5 | by how much the way of the object has grown, in parts of 0.1 m, up to 1 |
| wrap | 5 | by how much the angle around the object has grown, up to 200 degrees, in radians |
| grab | 10 | 1 where the object is grabbed, -1 where it is let go |
| home | 20 | by how much g max(0, 1 - d) has grown, with g whether it is held, d the way home in body lengths |
| success | 10 | 1 at success |
| early | 10 | at success, the part of the episode that is left |
| effort | 0.1 | minus the mean square of the commanded activations, times the step's duration in seconds |
| toppled | -10 | 1 where the head has rolled or pitched by more than 60 degrees |
| fallen | -10 | 1 where the object leans by more than 45 degrees |
| diverged | -10 | 1 where the simulation has diverged, and then all other terms are 0 |

These are the terms of OctopusMove, OctopusGrab and OctopusReturn, where they are explained. The object is grabbed when
an arm spans 200 degrees or more around its axis at the ends of all control steps in 0.5 s, and let go when no arm has
spanned 150 degrees for more than 0.2 s. Success is when all of this is so: at one moment the head has been 0.2 m and
the centre of mass 0.1 m from where it was at the start; the object has been moved by 0.1 m while it stood and was
touched; it is held; the head is within 0.1 m of home, and the object within 0.3 m of the head. ``scripts/score.py``
asks for more: that the surfaces of head and object have been within 0.05 m, and that the arm that has grabbed is the
one that holds. All but the last six terms are differences of what is so far, so doing a thing again earns nothing. The
info also has ``distance``, by how much the object is nearer to home than at the start [m]; ``is_success``; and
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
Terminated at success. Truncated after 20 s, which are 400 control steps. Terminated if the head rolls or
pitches by more than 60 degrees, since a ball rolls further than it crawls; if the object leans by more than 45
degrees, since what has fallen cannot be set up again; and if numbers stop being finite, or a node or the object
is faster than 50 m/s: then the last sound observation is returned.

Arguments
---------
Those of `elastica_gym.envs.BatchEnv`: ``control_dt`` (0.05 s), ``sim_dt`` (0.00016 s), ``duration``,
``max_episode_steps``, ``n_threads``, ``weights``, ``spread`` ("anywhere", "arc" or "default"), ``render_mode``,
``render_size``; and of `make_vec` ``autoreset_mode``.

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
    now,
    wrap,
)
from ..starts import OBJECT_STARTS
from ..task import Mask, Situation, effort, toppled, way_to_goal


def see_goal(situation: Situation) -> Array:
    """Return the direction to go and the way home, forward and right, (B, 4)."""
    there, back = np.stack(direction_to_object(situation)), np.stack(direction_home(situation))
    back = np.where(has_crawled(situation), back, -back)
    return np.stack([*np.where(now(situation).grabbed == 1.0, back, there), *way_to_goal(situation)], axis=1)


def succeeds(situation: Situation) -> Mask:
    """Return whether the animal has crawled, moved the object, and is at home with it, (B,) bool."""
    return has_crawled(situation) & has_moved(situation) & is_at_home(situation)


def success(situation: Situation) -> Array:
    """Return 1 where the object has been fetched, (B,)."""
    return succeeds(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the part of the episode that is left where the object has been fetched, else 0, (B,)."""
    return success(situation) * situation.time_left


TASK = handling_task(
    name="OctopusFetch",
    duration=20.0,
    starts={name: OBJECT_STARTS[name] for name in ("anywhere", "arc", "default")},
    see_goal=see_goal,
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
