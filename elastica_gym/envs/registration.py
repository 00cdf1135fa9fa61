"""Ids and their tasks, registered with Gymnasium here and by other packages."""

import os
from typing import Any

import gymnasium
from gymnasium.wrappers import HumanRendering

from .batch import RENDER_MODES, BatchEnv
from .goal import GOAL_TASKS, GoalBatchEnv, GoalEnv, GoalTask
from .single import SingleEnv
from .task import Task
from .tasks import (
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

SHIPPED = {
    f"elastica_gym/{task.name}-v1": task
    for task in (
        *(
            module.TASK
            for module in (
                snake_forward,
                snake_reach,
                snake_steer,
                octopus_crawl,
                octopus_reach,
                octopus_move,
                octopus_grab,
                octopus_return,
                octopus_fetch,
            )
        ),
        *GOAL_TASKS,
    )
}
IDS = tuple(env_id for env_id, task in SHIPPED.items() if not isinstance(task, GoalTask))
GOAL_IDS = tuple(env_id for env_id, task in SHIPPED.items() if isinstance(task, GoalTask))
"""Ids whose observation is a dict with an achieved and a desired goal"""

_tasks: dict[str, Task] = {}
"""Tasks by registered id"""


def register(env_id: str, task: Task) -> None:
    """Register a task, for ``gymnasium.make``, ``gymnasium.make_vec`` and the commands in ``agents``.

    Parameters
    ----------
    env_id : str
        Such as ``my_lab/SnakeTurn-v0``.
    task : Task
        A `GoalTask` makes environments whose goals can be relabelled.

    Notes
    -----
    Spawned processes and ``agents`` must import the registering module: as with Gymnasium, the id
    ``my_module:my_lab/SnakeTurn-v0`` does so. Environments can be pickled if the task's functions are at module level.
    """
    _tasks[env_id] = task
    # no max_episode_steps: the batch truncates, and make would add a second limit
    gymnasium.register(env_id, entry_point=f"{__name__}:make_single", vector_entry_point=BATCH, kwargs={"task": env_id})


def register_all() -> None:
    """Register every id of this package."""
    for env_id, task in SHIPPED.items():
        register(env_id, task)


def registered_ids() -> tuple[str, ...]:
    """Return all ids registered by `register`, or with the same entry points and other arguments."""
    return tuple(env_id for env_id, spec in gymnasium.registry.items() if spec.vector_entry_point == BATCH)


def task_of(env_id: str) -> Task:
    """Return the task of one of `registered_ids`, optionally prefixed with ``my_module:``.

    Raises
    ------
    ValueError
        If the id is not registered.
    """
    spec = gymnasium.registry.get(env_id.rpartition(":")[2])
    if spec is None or spec.vector_entry_point != BATCH:
        raise ValueError(f"env_id must be one of {', '.join(registered_ids())}, not {env_id!r}")
    return _registered(spec.kwargs["task"])


def observation_names(env_id: str) -> tuple[str, ...]:
    """Return the names of the numbers of an environment's observation, without making one."""
    task = task_of(env_id)
    return task.layout(task.make_body()).names


def make_single(*, task: str, render_mode: str | None = None, **kwargs: Any) -> gymnasium.Env:
    """Make the single environment of a registered task, as called by ``gymnasium.make``."""
    if render_mode == "human":
        _require_window()
        return HumanRendering(make_single(task=task, render_mode="rgb_array", **kwargs))
    found = _registered(task)
    kwargs["render_mode"] = render_mode
    return GoalEnv(found, **kwargs) if isinstance(found, GoalTask) else SingleEnv(found, **kwargs)


def make_batch(*, task: str, num_envs: int = 1, **kwargs: Any) -> BatchEnv:
    """Make the batched environment of a registered task, as called by ``gymnasium.make_vec``."""
    found = _registered(task)
    if isinstance(found, GoalTask):
        return GoalBatchEnv(found, num_envs, **kwargs)
    return BatchEnv(found, num_envs, **kwargs)


BATCH = f"{__name__}:{make_batch.__name__}"
"""Entry point that identifies our environments in Gymnasium's registry"""

# Gymnasium reads render modes from the entry point, and derives rgb_array_list from rgb_array
make_single.metadata = {"render_modes": ["human", *RENDER_MODES]}  # type: ignore[attr-defined]


def _registered(env_id: str) -> Task:
    if env_id not in _tasks:
        raise ValueError(f"task must be a registered id, not {env_id!r}: import the module that registers it")
    return _tasks[env_id]


def _require_window() -> None:
    """Make sure that windows can be opened."""
    from ..viz.viewer import has_display

    instead = "render_mode='rgb_array' draws without a window, as does elastica_gym.viz.record_rollout"
    try:
        import pygame
    except ImportError as error:
        raise ImportError(f"render_mode='human' needs pygame (pip install pygame); {instead}") from error
    # without a display pygame may open an invisible one, whose end breaks MuJoCo's renderer
    if not has_display() and "SDL_VIDEODRIVER" not in os.environ:
        raise RuntimeError(f"render_mode='human' finds no display; {instead}")
    try:
        pygame.display.init()
    except pygame.error as error:
        raise RuntimeError(f"render_mode='human' finds no display ({error}); {instead}") from error
