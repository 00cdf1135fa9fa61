"""OctopusCrawl: crawl as far as you can in a commanded direction in 10 s.

Description
-----------
The two-arm octopus of 1 m (`elastica_gym.bodies.octopus`) on ground that holds it alike in all
directions. It is told a direction, any one, and has to pull its heavy head there with two arms. Its object
stands somewhere on the other side.

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
| 206-207 | direction to go: forward and right component of a unit vector | 1 | -1 to 1 |
| 208-209 | way from the head to where it was at the start, its home: forward and right | body length | -4 to 4 |

Rewards
-------
The sum of these terms, each of which is in the info as ``reward_<term>`` with its weight:

| term | weight | formula, a control step |
|---|---|---|
| forward | 10 | way of the centre of mass along the commanded direction, in body lengths |
| effort | 0.1 | minus the mean square of the commanded activations, times the step's duration in seconds |
| toppled | -10 | 1 where the head has rolled or pitched by more than 60 degrees |
| diverged | -10 | 1 where the simulation has diverged, and then all other terms are 0 |

The info also has ``distance``, the way so far [m]; ``is_success``, whether that is half a body length or more; and
``termination_reason``, a number: 0 running, 1 time_limit, 3 diverged or 4 toppled.

Starting state
--------------
All is drawn from the environment's own generator: the heading, uniform; the shape, the resting one bent
sideways by three sine waves of couple, whose curvature at the tips has normal amplitudes of 0.7, 0.35 and 0.175
1/m; a horizontal velocity with a standard deviation of 0.02 m/s; the object, upright, at 0.4 to
0.8 m from the head in any direction, drawn again where it would stand in the animal; and the commanded direction,
uniform within 90 degrees of straight away from the object. Muscles are at rest.

Episode end
-----------
Truncated after 10 s, which are 200 control steps. Terminated if the head rolls
or pitches by more than 60 degrees, since a ball rolls further than it crawls; and if numbers stop being
finite, or a node or the object is faster than 50 m/s: then the last sound observation is returned.

Arguments
---------
Those of `elastica_gym.envs.BatchEnv`: ``control_dt`` (0.05 s), ``sim_dt`` (0.00016 s), ``duration``,
``max_episode_steps``, ``n_threads``, ``weights``, ``spread`` ("anywhere"), ``render_mode``, ``render_size``; and of
`make_vec` ``autoreset_mode``.

Version history
---------------
v1: contact that conserves energy (contact forces act on nodes, by the weights of the closest points).
v0: the first; withdrawn.
"""

import numpy as np

from ...bodies import octopus
from ...engine.model import Array
from ..starts import with_object_anywhere
from ..task import (
    GOAL_BOUNDS,
    GOAL_NAMES,
    Mask,
    Situation,
    Task,
    effort,
    has_toppled,
    in_heading_frame,
    no_target,
    toppled,
    way_to_goal,
)

FAR = 0.5
"""Way that counts as success, in body lengths"""


def draw_goal(rng: np.random.Generator, situation: Situation) -> Array:
    """Return home (x, z), the direction to go (x, z), away from the object, and the point to go from (x, z), (6,)."""
    head, centre = situation.pose.head[0, [0, 2]], situation.pose.centre[0, [0, 2]]
    x, z = situation.pose.objects[0, 0, [0, 2]] - head
    angle = np.arctan2(-z, -x) + rng.uniform(-0.5 * np.pi, 0.5 * np.pi)
    return np.array([*head, np.cos(angle), np.sin(angle), *centre])


def see_goal(situation: Situation) -> Array:
    """Return the direction to go, forward and right, and the way home, forward and right, (B, 4)."""
    direction = in_heading_frame(situation, situation.goal[:, 2], situation.goal[:, 3])
    return np.stack([*direction, *way_to_goal(situation)], axis=1)


def _along(goal: Array, centre: Array) -> Array:
    return (centre[:, 0] - goal[:, 4]) * goal[:, 2] + (centre[:, 2] - goal[:, 5]) * goal[:, 3]


def distance(situation: Situation) -> Array:
    """Return how far the centre of mass has come in the commanded direction [m], (B,)."""
    return _along(situation.goal, situation.pose.centre)


def forward(situation: Situation) -> Array:
    """Return the way made in the commanded direction in this step, in body lengths, (B,)."""
    made = distance(situation) - _along(situation.goal, situation.before.centre)
    return made / situation.body.senses.length


def succeeds(situation: Situation) -> Mask:
    """Return whether the animal has come half a body length, (B,) bool."""
    return distance(situation) >= FAR * situation.body.senses.length


TASK = Task(
    name="OctopusCrawl",
    make_body=octopus,
    duration=10.0,
    starts={"anywhere": with_object_anywhere},
    goal_size=6,
    draw_goal=draw_goal,
    goal_names=GOAL_NAMES,
    goal_bounds=GOAL_BOUNDS,
    see_goal=see_goal,
    reward_terms={"forward": forward, "effort": effort, "toppled": toppled},
    reward_weights={"forward": 10.0, "effort": 0.1, "toppled": -10.0, "diverged": -10.0},
    distance=distance,
    succeeds=succeeds,
    ends_on_success=False,
    failures={"toppled": has_toppled},
    target=no_target,
)
