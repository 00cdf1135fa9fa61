"""SnakeForward: go as far as you can along your initial heading in 10 s."""

from typing import TYPE_CHECKING

import numpy as np

from ..bodies import snake
from ..cosserat.model import Array
from .gaits import snake_crawl
from .task import Situation, Task, effort, in_heading_frame

if TYPE_CHECKING:
    from .batch import BatchEnv

FAR = 0.35
"""Distance that counts as success: a body length [m]"""


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


def succeeds(situation: Situation) -> Array:
    """Return whether the animal has come a body length, (B,) bool."""
    return distance(situation) >= FAR


def no_target(goal: Array) -> None:
    """Return None: there is a direction, but no place to show."""


def direction_of_goal(situation: Situation) -> Array:
    """Return the direction to go as an angle from the heading, positive to the right [rad], (B,)."""
    seen = see_goal(situation)
    return np.arctan2(seen[:, 1], seen[:, 0])


def scripted_policy(env: "BatchEnv") -> Array:
    """Return the actions of a crawl that turns towards the goal, (B, 42)."""
    return snake_crawl(env, direction_of_goal(env.situation()))


TASK = Task(
    name="SnakeForward",
    make_body=snake,
    duration=10.0,
    draw_goal=draw_goal,
    goal_names=("goal/forward", "goal/right"),
    goal_bounds=(1.0, 1.0),
    see_goal=see_goal,
    reward_terms={"forward": forward, "effort": effort},
    reward_weights={"forward": 10.0, "effort": 0.1, "diverged": -10.0},
    distance=distance,
    succeeds=succeeds,
    ends_on_success=False,
    target=no_target,
    scripted_policy=scripted_policy,
)
