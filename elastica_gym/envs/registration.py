"""Ids: each is a task with keyword arguments."""

from typing import Any

import gymnasium

from . import (
    octopus_crawl,
    octopus_fetch,
    octopus_grab,
    octopus_move,
    octopus_reach,
    octopus_return,
    snake_forward,
    snake_reach,
    snake_steer,
)
from .batch import BatchEnv
from .goal import GOAL_TASKS, GoalBatchEnv, GoalEnv
from .single import SingleEnv
from .task import Task

NAMESPACE = "elastica_gym"
TASKS: dict[str, Task] = {
    module.TASK.name: module.TASK
    for module in (snake_forward, snake_reach, snake_steer, octopus_crawl, octopus_reach, octopus_move, octopus_grab,
                   octopus_return, octopus_fetch)
}
IDS = tuple(f"{NAMESPACE}/{name}-v1" for name in TASKS)
GOAL_IDS = tuple(f"{NAMESPACE}/{name}-v1" for name in GOAL_TASKS)
"""Those whose observation is a dict with an achieved and a desired goal"""


def make_single(*, task: str, **kwargs: Any) -> SingleEnv:
    """Make the single environment of a task; what ``gymnasium.make`` calls."""
    return SingleEnv(TASKS[task], **kwargs)


def make_batch(*, task: str, num_envs: int = 1, **kwargs: Any) -> BatchEnv:
    """Make the batched environment of a task; what ``gymnasium.make_vec`` calls."""
    return BatchEnv(TASKS[task], num_envs, **kwargs)


def make_goal_single(*, task: str, **kwargs: Any) -> GoalEnv:
    """Make the single environment of a goal-conditioned task."""
    return GoalEnv(GOAL_TASKS[task], **kwargs)


def make_goal_batch(*, task: str, num_envs: int = 1, **kwargs: Any) -> GoalBatchEnv:
    """Make the batched environment of a goal-conditioned task."""
    return GoalBatchEnv(GOAL_TASKS[task], num_envs, **kwargs)


def register_all() -> None:
    """Register every id. No ``max_episode_steps``: the batch truncates, and make would add a second limit."""
    for names, single, batch in ((TASKS, make_single, make_batch), (GOAL_TASKS, make_goal_single, make_goal_batch)):
        for name in names:
            gymnasium.register(
                f"{NAMESPACE}/{name}-v1",
                entry_point=f"{__name__}:{single.__name__}",
                vector_entry_point=f"{__name__}:{batch.__name__}",
                kwargs={"task": name},
            )
