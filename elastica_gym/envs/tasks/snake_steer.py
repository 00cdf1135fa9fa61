"""SnakeSteer: go in a commanded direction at a commanded speed, both of which change on the way, for 20 s.

Description
-----------
A snake of 0.35 m (`elastica_gym.bodies.snake`) lies on ground that holds it harder sideways than forward.
It is told a direction and a speed, and once or twice on the way others.

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
| 159 | speed to go at | body lengths/s | 0 to 1 |
| 160-161 | velocity of the centre of mass, as it is followed: forward and right | body lengths/s | -4 to 4 |

Rewards
-------
The sum of these terms, each of which is in the info as ``reward_<term>`` with its weight:

| term | weight | formula, a control step |
|---|---|---|
| follow | 1 | exp(-(u / 0.05)^2), times the step's duration in seconds, with u the error in body lengths/s |
| heading | 3 | by how much the angle between heading and commanded direction has shrunk, in radians |
| effort | 0.1 | minus the mean square of the commanded activations, times the step's duration in seconds |
| diverged | -10 | 1 where the simulation has diverged, and then all other terms are 0 |

The error is the length of the difference between the velocity of the centre of mass and the commanded one, with the
former smoothed over a time constant of 1 s, since a gait goes faster and slower within its period. A new command
changes the angle at once, which is not paid for. The info also has ``distance``, the way made in the directions
commanded at the time [m]; ``is_success``, whether the error, over the time so far, is on average a quarter of the
commanded speed or less; and ``termination_reason``, a number: 0 running, 1 time_limit or 3 diverged.

Starting state
--------------
All is drawn from the environment's own generator: the heading, uniform; the shape, bent in the plane by
three sine waves of curvature with normal amplitudes of 2, 1 and 0.5 1/m, which the body straightens as
it is let go; a horizontal velocity with a standard deviation of 0.02 m/s; and the commands. Their speeds are uniform
from 0.05 to 0.15 body lengths/s. The first direction is within 45 degrees of the heading, each later one within 90
degrees of that before it. The first change comes when 0.3 to 0.5 of the episode are over; every other episode has a
second one, at 0.65 to 0.85. Muscles are at rest.

Episode end
-----------
Truncated after 20 s, which are 400 control steps. Terminated if numbers stop being finite or a node is
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

from typing import NamedTuple

import numpy as np

from ...bodies import snake
from ...engine.model import Array, State
from ..starts import draw_start
from ..task import Mask, Situation, Task, effort, in_heading_frame, no_target

SPEEDS = (0.05, 0.15)
"""Least and largest commanded speed [body lengths/s]"""
FIRST_TURN, NEXT_TURN = 0.25 * np.pi, 0.5 * np.pi
"""Largest angle between the heading and the first direction, and between a direction and the next [rad]"""
CHANGES = ((0.3, 0.5), (0.65, 0.85))
"""When the first and second change of command come, as part of the episode"""
SMOOTHING = 1.0
"""Time constant over which velocity is smoothed [s]"""
TOLERANCE = 0.05
"""Error at which following pays 1/e [body lengths/s]"""
CLOSE = 0.25
"""Mean error that counts as success, in parts of the commanded speed"""


class Course(NamedTuple):
    """How each of B snakes follows its commands: the columns of a situation's ``progress``, (B,) each."""

    velocity_x: Array
    """Smoothed velocity of the centre of mass along x [body lengths/s]"""
    velocity_z: Array
    """The same along z [body lengths/s]"""
    error: Array
    """Integral over time of how far it is from the commanded one [body lengths]"""
    asked: Array
    """Integral over time of the commanded speed [body lengths]"""
    along: Array
    """Way of the centre of mass in the directions commanded at the time [body lengths]"""


def draw_goal(rng: np.random.Generator, situation: Situation) -> Array:
    """Return three commands, each a direction as an angle from x to z [rad] and a speed, and when they change, (8,)."""
    x, z = situation.pose.heading[0]
    turns = rng.uniform(-1.0, 1.0, 3) * np.array([FIRST_TURN, NEXT_TURN, NEXT_TURN])
    directions = np.arctan2(z, x) + np.cumsum(turns)
    speeds = rng.uniform(*SPEEDS, 3)
    changes = [rng.uniform(*times) for times in CHANGES]
    if rng.random() < 0.5:
        # never
        changes[1] = 2.0
    return np.array([*np.stack([directions, speeds], axis=1).ravel(), *changes])


def command(situation: Situation) -> tuple[Array, Array, Array]:
    """Return the direction to go (x, z) and the speed [body lengths/s] of the time, (B,) each."""
    goal, part = situation.goal, 1.0 - situation.time_left
    direction, speed = (
        np.where(part < goal[:, 6], goal[:, k], np.where(part < goal[:, 7], goal[:, k + 2], goal[:, k + 4]))
        for k in (0, 1)
    )
    return np.cos(direction), np.sin(direction), speed


def _off(situation: Situation, course: Course) -> Array:
    """Return the length of the difference between smoothed and commanded velocity [body lengths/s], (B,)."""
    x, z, speed = command(situation)
    dx, dz = course.velocity_x - speed * x, course.velocity_z - speed * z
    return np.sqrt(dx * dx + dz * dz)


def follow(situation: Situation, state: State) -> Array:
    """Return how the commands are followed, (B, 5)."""
    s, old = situation, Course(*situation.progress.T)
    x, z, speed = command(s)
    way = (s.pose.centre - s.before.centre) / s.body.senses.length
    # at reset nothing has been done yet, and velocity starts from rest
    lasted = np.where(s.time_left < 1.0, s.control_dt, 0.0)
    share = 1.0 - np.exp(-lasted / SMOOTHING)
    new = old._replace(
        velocity_x=(1.0 - share) * old.velocity_x + share * way[:, 0] / s.control_dt,
        velocity_z=(1.0 - share) * old.velocity_z + share * way[:, 2] / s.control_dt,
    )
    return np.stack(
        new._replace(
            error=old.error + _off(s, new) * lasted,
            asked=old.asked + speed * lasted,
            along=old.along + np.where(lasted > 0.0, way[:, 0] * x + way[:, 2] * z, 0.0),
        ),
        axis=1,
    )


def now(situation: Situation) -> Course:
    """Return how the commands are followed."""
    return Course(*situation.progress.T)


def see_goal(situation: Situation) -> Array:
    """Return the direction to go, the speed, and the smoothed velocity, directions as forward and right, (B, 5)."""
    x, z, speed = command(situation)
    course = now(situation)
    velocity = in_heading_frame(situation, course.velocity_x, course.velocity_z)
    return np.stack([*in_heading_frame(situation, x, z), speed, *velocity], axis=1)


def following(situation: Situation) -> Array:
    """Return how well velocity follows the command, 1 where it does, times the duration of the step [s], (B,)."""
    off = _off(situation, now(situation)) / TOLERANCE
    return np.exp(-off * off) * situation.control_dt


def heading(situation: Situation) -> Array:
    """Return by how much the angle between heading and commanded direction has shrunk in this step [rad], (B,)."""
    x, z, _ = command(situation)

    def angle(heading: Array) -> Array:
        return np.abs(np.arctan2(x * heading[:, 1] - z * heading[:, 0], x * heading[:, 0] + z * heading[:, 1]))

    return angle(situation.before.heading) - angle(situation.pose.heading)


def succeeds(situation: Situation) -> Mask:
    """Return whether the error is a quarter of the commanded speed or less on average, (B,) bool."""
    course = now(situation)
    return (course.error <= CLOSE * course.asked) & (course.asked > 0.0)


def distance(situation: Situation) -> Array:
    """Return the way made in the directions commanded at the time [m], (B,)."""
    return now(situation).along * situation.body.senses.length


TASK = Task(
    name="SnakeSteer",
    make_body=snake,
    duration=20.0,
    starts={"bent": draw_start},
    goal_size=8,
    draw_goal=draw_goal,
    goal_names=("goal/forward", "goal/right", "goal/speed", "pace/forward", "pace/right"),
    goal_bounds=((-1.0, 1.0), (-1.0, 1.0), (0.0, 1.0), (-4.0, 4.0), (-4.0, 4.0)),
    see_goal=see_goal,
    progress_names=Course._fields,
    follow=follow,
    reward_terms={"follow": following, "heading": heading, "effort": effort},
    reward_weights={"follow": 1.0, "heading": 3.0, "effort": 0.1, "diverged": -10.0},
    distance=distance,
    succeeds=succeeds,
    ends_on_success=False,
    target=no_target,
)
