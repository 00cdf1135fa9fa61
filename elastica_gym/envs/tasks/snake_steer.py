"""SnakeSteer: go in a commanded direction at a commanded speed, both of which change on the way, for 20 s.

A snake of 0.35 m (`elastica_gym.bodies.snake`) lies on ground with higher friction sideways than forward.
It observes a commanded direction and speed, which change once or twice on the way.

Notes
-----
The error is the length of the difference between the velocity of the centre of mass and the commanded one, with the
former smoothed over a time constant of 1 s, since a gait's speed varies within its period. A new command changes the
angle at once, which is not rewarded.

Version history
---------------
v1: firm ground (stiffness and damping), into which no part of the body sinks; self-contact.
v0: the first; withdrawn.
"""

from typing import NamedTuple

import numpy as np

from ...bodies import snake
from ...bodies.observation import Block, single
from ...engine.model import Array, State
from ..initial_states import bent
from ..task import DIRECTION, Mask, Situation, Task, effort, in_heading_frame, no_target

SPEEDS = (0.05, 0.15)
"""Least and largest commanded speed [body lengths/s]"""
FIRST_TURN, NEXT_TURN = 0.25 * np.pi, 0.5 * np.pi
"""Largest angle between the heading and the first direction, and between a direction and the next [rad]"""
CHANGES = ((0.3, 0.5), (0.65, 0.85))
"""Ranges of the times of the first and second change of command, as fractions of the episode"""
SMOOTHING = 1.0
"""Time constant over which velocity is smoothed [s]"""
TOLERANCE = 0.05
"""Error at which the reward for following is 1/e [body lengths/s]"""
CLOSE = 0.25
"""Mean error that counts as success, as a fraction of the commanded speed"""


class Goal(NamedTuple):
    """Three commands, each a direction and a speed, and the times at which they change."""

    first: Array
    """First direction, as an angle from x to z [rad]"""
    first_speed: Array
    """Its speed [body lengths/s]"""
    second: Array
    """Second direction [rad]"""
    second_speed: Array
    """Its speed [body lengths/s]"""
    third: Array
    """Third direction [rad]"""
    third_speed: Array
    """Its speed [body lengths/s]"""
    first_change: Array
    """Time of the second command, as a fraction of the episode"""
    second_change: Array
    """Time of the third command, likewise; above 1 for never"""


class Course(NamedTuple):
    """How well each of B snakes follows its commands, as a situation's ``progress``, (B,) each."""

    velocity_x: Array
    """Smoothed velocity of the centre of mass along x [body lengths/s]"""
    velocity_z: Array
    """The same along z [body lengths/s]"""
    error: Array
    """Integral over time of its distance from the commanded velocity [body lengths]"""
    asked: Array
    """Integral over time of the commanded speed [body lengths]"""
    along: Array
    """Displacement of the centre of mass along the directions commanded at the time [body lengths]"""


def sample_goal(rng: np.random.Generator, situation: Situation) -> Goal:
    """Return commands that turn from the heading, and from one to the next, by random angles.

    The first direction is within 45 degrees of the heading, each later one within 90 degrees of the one before; speeds
    are uniform from 0.05 to 0.15 body lengths/s. The first change comes at 0.3 to 0.5 of the episode; half of the
    episodes have a second one, at 0.65 to 0.85.
    """
    x, z = situation.pose.heading[0]
    turns = rng.uniform(-1.0, 1.0, 3) * np.array([FIRST_TURN, NEXT_TURN, NEXT_TURN])
    directions = np.arctan2(z, x) + np.cumsum(turns)
    speeds = rng.uniform(*SPEEDS, 3)
    changes = [rng.uniform(*times) for times in CHANGES]
    if rng.random() < 0.5:
        # never
        changes[1] = 2.0
    return Goal._make([*np.stack([directions, speeds], axis=1).ravel(), *changes])


def command(situation: Situation) -> tuple[Array, Array, Array]:
    """Return the current direction to go (x, z) and speed [body lengths/s], (B,) each."""
    goal, part = situation.goal, 1.0 - situation.time_left

    def current(first: Array, second: Array, third: Array) -> Array:
        return np.where(part < goal.first_change, first, np.where(part < goal.second_change, second, third))

    direction = current(goal.first, goal.second, goal.third)
    speed = current(goal.first_speed, goal.second_speed, goal.third_speed)
    return np.cos(direction), np.sin(direction), speed


def _off(situation: Situation, course: Course) -> Array:
    """Return the length of the difference between smoothed and commanded velocity [body lengths/s], (B,)."""
    x, z, speed = command(situation)
    dx, dz = course.velocity_x - speed * x, course.velocity_z - speed * z
    return np.sqrt(dx * dx + dz * dz)


def follow(situation: Situation, state: State) -> Course:
    """Return how well the commands are followed."""
    s, old = situation, situation.progress
    x, z, speed = command(s)
    way = (s.pose.centre - s.before.centre) / s.body.sensors.length
    # at reset, integrals and smoothed velocity are zero
    lasted = np.where(s.time_left < 1.0, s.control_dt, 0.0)
    share = 1.0 - np.exp(-lasted / SMOOTHING)
    new = old._replace(
        velocity_x=(1.0 - share) * old.velocity_x + share * way[:, 0] / s.control_dt,
        velocity_z=(1.0 - share) * old.velocity_z + share * way[:, 2] / s.control_dt,
    )
    return new._replace(
        error=old.error + _off(s, new) * lasted,
        asked=old.asked + speed * lasted,
        along=old.along + np.where(lasted > 0.0, way[:, 0] * x + way[:, 2] * z, 0.0),
    )


def observe_goal(situation: Situation) -> Array:
    """Return the direction to go, the speed, and the smoothed velocity, directions as forward and right, (B, 5)."""
    x, z, speed = command(situation)
    course = situation.progress
    velocity = in_heading_frame(situation, course.velocity_x, course.velocity_z)
    return np.stack([*in_heading_frame(situation, x, z), speed, *velocity], axis=1)


def following(situation: Situation) -> Array:
    """Return how well velocity follows the command, 1 if exactly, times the duration of the step [s], (B,)."""
    off = _off(situation, situation.progress) / TOLERANCE
    return np.exp(-off * off) * situation.control_dt


def heading(situation: Situation) -> Array:
    """Return the decrease of the angle between heading and commanded direction in this step [rad], (B,)."""
    x, z, _ = command(situation)

    def angle(heading: Array) -> Array:
        return np.abs(np.arctan2(x * heading[:, 1] - z * heading[:, 0], x * heading[:, 0] + z * heading[:, 1]))

    return angle(situation.before.heading) - angle(situation.pose.heading)


def succeeds(situation: Situation) -> Mask:
    """Return whether the mean error is at most a quarter of the commanded speed, (B,) bool."""
    course = situation.progress
    return (course.error <= CLOSE * course.asked) & (course.asked > 0.0)


def distance(situation: Situation) -> Array:
    """Return the displacement along the directions commanded at the time [m], (B,)."""
    return situation.progress.along * situation.body.sensors.length


TASK = Task(
    name="SnakeSteer",
    description=__doc__,
    make_body=snake,
    duration=20.0,
    initial_states={"bent": bent},
    goal_type=Goal,
    sample_goal=sample_goal,
    goal_blocks=(
        DIRECTION,
        single("goal/speed", 0.0, 1.0, "body lengths/s", "commanded speed"),
        Block(
            "pace",
            ("forward", "right"),
            -4.0,
            4.0,
            "body lengths/s",
            "smoothed velocity of the centre of mass: forward and right",
        ),
    ),
    observe_goal=observe_goal,
    progress_type=Course,
    follow=follow,
    reward_terms={"follow": following, "heading": heading, "effort": effort},
    reward_weights={"follow": 1.0, "heading": 3.0, "effort": 0.1, "diverged": -10.0},
    distance=distance,
    succeeds=succeeds,
    ends_on_success=False,
    target=no_target,
)
