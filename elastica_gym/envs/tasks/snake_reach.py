"""SnakeReach: bring the head to a target around you within 20 s.

Description
-----------
The snake of SnakeForward, and a place on the ground, drawn uniformly over the ring between 0.5 and 1.5
body lengths around its centre of mass, in any direction: behind it as often as before it.

Action
------
``Box(-1, 1, (42,), float32)``: the activations that the muscles are commanded to, held for a control
step and clipped to the range. Muscles follow with a time constant of 0.06 s. See `elastica_gym.bodies.muscles`.

| index | direction | half of the body | function |
|---|---|---|---|
| 0-6, 7-13 | about the normal: bends sideways | front, rear | level 0, then 2 of level 1, then 4 of level 2 |
| 14-20, 21-27 | about the binormal: lifts | front, rear | the same |
| 28-34, 35-41 | about the tangent: twists | front, rear | the same |

An action of another shape, or one that holds NaN, raises ValueError.

Observation
-----------
``Box(float32)``, clipped to its range. All directions are in the frame of the heading: forward is the
horizontal direction from the middle of the rear half to that of the front half, right is to its right
seen from above with y up.

| index | meaning | unit | range |
|---|---|---|---|
| 0-26 | position of 9 nodes, tail to head, from the centre of mass: forward, up, right | body length | -1 to 1 |
| 27-53 | their velocity: forward, up, right of each | body lengths/s | -20 to 20 |
| 54-83 | curvature about the normal and binormal, and twist, at 10 places, tail to head | 10/m | -10 to 10 |
| 84-103 | up component of normal and binormal there: how the body has rolled | 1 | -1 to 1 |
| 104-111 | force with which the ground carries each of 8 parts, tail to head | an 8th of the weight | 0 to 50 |
| 112-153 | activation that each muscle has reached, in the order of the actions | 1 | -1 to 1 |
| 154-155 | sine and cosine of a clock with a period of 1 s | 1 | -1 to 1 |
| 156 | part of the episode that is left | 1 | 0 to 1 |
| 157-158 | way from head to target: forward and right | body length | -4 to 4 |
| 159 | its length | body length | 0 to 4 |

Rewards
-------
The sum of these terms, each of which is in the info as ``reward_<term>`` with its weight:

| term | weight | formula, a control step |
|---|---|---|
| approach | 10 | how much nearer the head has come to the target, in body lengths |
| success | 10 | 1 where the head is within 0.05 body lengths of the target |
| early | 10 | at success, the part of the episode that is left |
| effort | 0.1 | minus the mean square of the commanded activations, times the step's duration in seconds |
| diverged | -10 | 1 where the simulation has diverged, and then all other terms are 0 |

Approaches add up to the way made, wherever the head went between, so hovering earns nothing. The info also has
``distance``, how much nearer the head is to the target than at reset [m]; ``is_success``; and ``termination_reason``,
a number: 0 running, 1 time_limit, 2 success or 3 diverged. Distances are horizontal.

Starting state
--------------
All is drawn from the environment's own generator: the heading, uniform; the shape, bent in the plane by
three sine waves of curvature with normal amplitudes of 2, 1 and 0.5 1/m, which the body straightens as
it is let go; and a horizontal velocity with a standard deviation of 0.02 m/s. Muscles are at rest.

Episode end
-----------
Terminated at success, and if numbers stop being finite or a node is faster than 10 m/s; then the last
sound observation is returned. Truncated after 20 s, which are 400 control steps.

Arguments
---------
Those of `elastica_gym.envs.BatchEnv`: ``control_dt`` (0.05 s), ``sim_dt`` (0.00011 s), ``duration``,
``max_episode_steps``, ``n_threads``, ``weights``, ``spread`` ("bent"), ``body_kwargs``, ``render_mode``,
``render_size``; and of `make_vec` ``autoreset_mode``.

Version history
---------------
v1: firm ground (stiffness and damping), on which no part of the body sinks in.
v0: the first; withdrawn.
"""

import numpy as np

from ...bodies import snake
from ...engine.model import Array
from ..starts import draw_start
from ..task import Mask, Situation, Task, effort, in_heading_frame, way_to_goal

NEAR = 0.05
"""Distance between head and target that counts as success, in body lengths"""
RING = (0.5, 1.5)
"""Least and largest distance of the target from the centre of mass at reset, in body lengths"""


def draw_goal(rng: np.random.Generator, situation: Situation) -> Array:
    """Return a target, uniform over the ring around the body, as (x, z), and the head's way to it [m], (3,)."""
    inner, outer = RING
    # uniform over area: the square of the radius is uniform
    radius = np.sqrt(rng.uniform(inner**2, outer**2)) * situation.body.senses.length
    bearing = rng.uniform(-np.pi, np.pi)
    target = situation.pose.centre[0, [0, 2]] + radius * np.array([np.cos(bearing), np.sin(bearing)])
    return np.array([*target, *_gap(target[None], situation.pose.head, 1.0)])


def _gap(goal: Array, head: Array, length: float) -> Array:
    x, z = goal[:, 0] - head[:, 0], goal[:, 1] - head[:, 2]
    return np.sqrt(x * x + z * z) / length


def gap(situation: Situation) -> Array:
    """Return the horizontal distance of the head from the target, in body lengths, (B,)."""
    return _gap(situation.goal, situation.pose.head, situation.body.senses.length)


def see_goal(situation: Situation) -> Array:
    """Return the way from head to target, forward and right, and its length, in body lengths, (B, 3)."""
    return np.stack([*way_to_goal(situation), gap(situation)], axis=1)


def approach(situation: Situation) -> Array:
    """Return how much nearer the head has come in this step, in body lengths, (B,)."""
    return _gap(situation.goal, situation.before.head, situation.body.senses.length) - gap(situation)


def succeeds(situation: Situation) -> Mask:
    """Return whether the head is at the target, (B,) bool."""
    return gap(situation) <= NEAR


def success(situation: Situation) -> Array:
    """Return 1 where the head is at the target, (B,)."""
    return succeeds(situation).astype(np.float64)


def early(situation: Situation) -> Array:
    """Return the part of the episode that is left where the head is at the target, else 0, (B,)."""
    return success(situation) * situation.time_left


def distance(situation: Situation) -> Array:
    """Return how much nearer the head is to the target than at reset [m], (B,)."""
    return situation.goal[:, 2] - _gap(situation.goal, situation.pose.head, 1.0)


def target(goal: Array) -> Array:
    """Return the targets' positions on the ground [m], (B, 3)."""
    return np.stack([goal[:, 0], np.zeros(len(goal)), goal[:, 1]], axis=1)


def direction_of_goal(situation: Situation) -> Array:
    """Return the direction from centre of mass to target as an angle from the heading [rad], (B,)."""
    s = situation
    forward, right = in_heading_frame(s, s.goal[:, 0] - s.pose.centre[:, 0], s.goal[:, 1] - s.pose.centre[:, 2])
    return np.arctan2(right, forward)


TASK = Task(
    name="SnakeReach",
    make_body=snake,
    duration=20.0,
    starts={"bent": draw_start},
    goal_size=3,
    draw_goal=draw_goal,
    goal_names=("goal/forward", "goal/right", "goal/gap"),
    goal_bounds=((-4.0, 4.0), (-4.0, 4.0), (0.0, 4.0)),
    see_goal=see_goal,
    reward_terms={"approach": approach, "success": success, "early": early, "effort": effort},
    reward_weights={"approach": 10.0, "success": 10.0, "early": 10.0, "effort": 0.1, "diverged": -10.0},
    distance=distance,
    succeeds=succeeds,
    ends_on_success=True,
    target=target,
)
