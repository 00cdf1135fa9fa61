"""SnakeForward: go as far as you can along your initial heading in 10 s.

Description
-----------
A snake of 0.35 m (`elastica_gym.bodies.snake`) lies on ground that holds it harder sideways than forward.
It crawls by what waves of bending it finds.

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
| 157-158 | direction to go: forward and right component of a unit vector | 1 | -1 to 1 |

Rewards
-------
The sum of these terms, each of which is in the info as ``reward_<term>`` with its weight:

| term | weight | formula, a control step |
|---|---|---|
| forward | 10 | way of the centre of mass along the initial heading, in body lengths |
| heading | 3 | by how much the angle between heading and initial heading has shrunk, in radians |
| effort | 0.1 | minus the mean square of the commanded activations, times the step's duration in seconds |
| diverged | -10 | 1 where the simulation has diverged, and then all other terms are 0 |

The info also has ``distance``, the way so far [m]; ``is_success``, whether that is a body length or more; and
``termination_reason``, a number: 0 running, 1 time_limit or 3 diverged.

Starting state
--------------
All is drawn from the environment's own generator: the heading, uniform; the shape, bent in the plane by
three sine waves of curvature with normal amplitudes of 2, 1 and 0.5 1/m, which the body straightens as
it is let go; and a horizontal velocity with a standard deviation of 0.02 m/s. Muscles are at rest.

Episode end
-----------
Truncated after 10 s, which are 200 control steps. Terminated if numbers stop being finite or a node is
faster than 10 m/s; the last sound observation is returned.

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
from ..task import Mask, Situation, Task, effort, in_heading_frame, no_target


def draw_goal(rng: np.random.Generator, situation: Situation) -> Array:
    """Return the direction to go (x, z), which is the initial heading, and the point to go from (x, z), (4,)."""
    return np.concatenate([situation.pose.heading[0], situation.pose.centre[0, [0, 2]]])


def see_goal(situation: Situation) -> Array:
    """Return the direction to go as cosine and sine, forward and right, (B, 2)."""
    return np.stack(in_heading_frame(situation, situation.goal[:, 0], situation.goal[:, 1]), axis=1)


def _along(goal: Array, centre: Array) -> Array:
    return (centre[:, 0] - goal[:, 2]) * goal[:, 0] + (centre[:, 2] - goal[:, 3]) * goal[:, 1]


def distance(situation: Situation) -> Array:
    """Return how far the centre of mass has come along the initial heading [m], (B,)."""
    return _along(situation.goal, situation.pose.centre)


def forward(situation: Situation) -> Array:
    """Return the way made along the initial heading in this step, in body lengths, (B,)."""
    made = distance(situation) - _along(situation.goal, situation.before.centre)
    return made / situation.body.senses.length


def _off_course(goal: Array, heading: Array) -> Array:
    x, z = heading[:, 0], heading[:, 1]
    return np.abs(np.arctan2(goal[:, 0] * z - goal[:, 1] * x, goal[:, 0] * x + goal[:, 1] * z))


def heading(situation: Situation) -> Array:
    """Return by how much the angle between heading and initial heading has shrunk in this step [rad], (B,)."""
    return _off_course(situation.goal, situation.before.heading) - _off_course(situation.goal, situation.pose.heading)


def succeeds(situation: Situation) -> Mask:
    """Return whether the animal has come a body length, (B,) bool."""
    return distance(situation) >= situation.body.senses.length


def direction_of_goal(situation: Situation) -> Array:
    """Return the direction to go as an angle from the heading, positive to the right [rad], (B,)."""
    seen = see_goal(situation)
    return np.arctan2(seen[:, 1], seen[:, 0])


TASK = Task(
    name="SnakeForward",
    make_body=snake,
    duration=10.0,
    starts={"bent": draw_start},
    goal_size=4,
    draw_goal=draw_goal,
    goal_names=("goal/forward", "goal/right"),
    goal_bounds=((-1.0, 1.0), (-1.0, 1.0)),
    see_goal=see_goal,
    reward_terms={"forward": forward, "heading": heading, "effort": effort},
    reward_weights={"forward": 10.0, "heading": 3.0, "effort": 0.1, "diverged": -10.0},
    distance=distance,
    succeeds=succeeds,
    ends_on_success=False,
    target=no_target,
)
