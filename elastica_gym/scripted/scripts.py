"""A script for each task: a function from a batch, with access to its whole state, to actions."""

from collections.abc import Callable

import numpy as np

from ..engine.model import Array
from ..envs.batch import BatchEnv
from ..envs.goal import GoalTask
from ..envs.handling import direction_to_object
from ..envs.task import Task, in_heading_frame
from ..envs.tasks import octopus_crawl as crawl
from ..envs.tasks import snake_forward, snake_steer
from .gaits import octopus_crawl, octopus_reach, snake_crawl
from .octopus_fetch import HOMEWARD, fetch, play, see

Script = Callable[[BatchEnv], Array]
"""Function from a batch of B environments to actions (B, A)"""


def forward(env: BatchEnv) -> Array:
    """Return the actions of a crawl that turns towards the initial heading, (B, 42)."""
    return snake_crawl(env, _bearing(snake_forward.observe_goal(env.situation())))


def reach(env: BatchEnv) -> Array:
    """Return the actions of a crawl that turns towards the target, (B, 42)."""
    s = env.situation()
    # relative to the centre of mass, not the head
    forward, right = in_heading_frame(s, s.goal.x - s.pose.centre[:, 0], s.goal.z - s.pose.centre[:, 2])
    return snake_crawl(env, np.arctan2(right, forward))


def steer(env: BatchEnv) -> Array:
    """Return the actions of a crawl in the commanded direction, weaker if it is too fast, (B, 42)."""
    forward, right, speed, along, across = snake_steer.observe_goal(env.situation()).T
    lag = speed - (along * forward + across * right)
    strength = np.clip(speed / snake_steer.SPEEDS[1] + 10.0 * lag, 0.0, 1.0)
    return strength[:, None] * snake_crawl(env, np.arctan2(right, forward))


def crawl_to_the_commanded_side(env: BatchEnv) -> Array:
    """Return the actions of the octopus' crawl in the commanded direction, (B, 42)."""
    return octopus_crawl(env, _bearing(crawl.observe_goal(env.situation())))


def reach_for_the_object(env: BatchEnv) -> Array:
    """Return the actions that bend an arm to the object or crawl to it, (B, 42)."""
    forward, right = direction_to_object(env.situation())
    return octopus_reach(env, np.arctan2(right, forward))


def move(env: BatchEnv) -> Array:
    """Return the actions that grab the object and carry it in the gait's natural direction, (B, 42)."""
    sight = see(env.observations)
    # mirrored for the first arm
    side = np.where(sight.ahead >= 0.0, 1.0, -1.0)
    course = np.stack([side * np.cos(HOMEWARD.course), np.full(env.num_envs, np.sin(HOMEWARD.course))], axis=1)
    return play(env, sight._replace(goal=course))


def _bearing(observed: Array) -> Array:
    """Return the angle from the heading to an observed goal, positive to the right [rad], (B,)."""
    return np.arctan2(observed[:, 1], observed[:, 0])


_scripts: dict[str, Script] = {
    "SnakeForward": forward,
    "SnakeReach": reach,
    "SnakeSteer": steer,
    "OctopusCrawl": crawl_to_the_commanded_side,
    "OctopusReach": reach_for_the_object,
    "OctopusMove": move,
    **dict.fromkeys(("OctopusGrab", "OctopusReturn", "OctopusFetch"), fetch),
}
"""Scripts by task name"""


def register_script(task_name: str, script: Script) -> None:
    """Register the script of a task, which ``agents`` then runs as the policy ``scripted`` and imitates.

    Parameters
    ----------
    task_name : str
        Name of the `Task`; the script also applies to its goal-conditioned variant.
    script : callable
        Function from a `BatchEnv` of B environments to actions (B, A).
    """
    _scripts[task_name] = script


def scripted_policy(task: Task) -> Script:
    """Return the script of a task.

    Raises
    ------
    ValueError
        If it has none.
    """
    name = task.base if isinstance(task, GoalTask) else task.name
    if name not in _scripts:
        raise ValueError(
            f"{name} has no script; register one with elastica_gym.scripted.register_script. "
            f"Tasks with a script: {', '.join(_scripts)}"
        )
    return _scripts[name]
