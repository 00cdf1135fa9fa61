"""SnakeReachGoal and OctopusReachGoal: bring the head to a place; goal-conditioned, for hindsight experience replay.

Description
-----------
The animals and initial states of `.tasks.snake_reach` and `.tasks.octopus_reach`, as environments whose goals can be
relabelled (Andrychowicz et al. 2017): an episode that ended elsewhere is a success for the place where it ended. The
snake's goal is its target, the octopus's the initial place of its object.

Action
------
``Box(-1, 1, (42,), float32)``, as in those tasks.

Observation
-----------
``Dict(observation, achieved_goal, desired_goal)`` of ``Box(float32)``:

- ``observation``: the observation of those tasks without the goal (0 to 205 for the octopus, 0 to 156 for the snake),
  followed by the heading: a unit vector along x and z of the lab, -1 to 1.
- ``achieved_goal``: the head's place on the ground, as x and z of the lab, in body lengths, -4 to 4.
- ``desired_goal``: the place where the head should be, likewise.

Nothing in ``observation`` depends on the goal.

Rewards
-------
1 if the head is at the goal, within 0.05 body lengths for the snake and within 0.225 m for the octopus, at which the
surfaces of its head and of the object are at most 0.05 m apart; else 0. For any goals, (..., 2),
``compute_reward(achieved_goal, desired_goal, info)`` returns this reward; it ignores the info. A failure ends the
episode without reward.

Episode end
-----------
Terminated at the goal, if the octopus topples, and if the simulation diverges. Truncated after 20 s for the snake
and 10 s for the octopus.

Arguments
---------
Those of `elastica_gym.envs.BatchEnv` except ``weights``, which ``compute_reward`` does not use; ``spread`` as in those
tasks.

Training
--------
The observations suit Stable-Baselines3's ``MultiInputPolicy`` and its hindsight replay buffer, through this package's
adapter::

    from stable_baselines3 import SAC, HerReplayBuffer
    from elastica_gym.rl import make_batch_vec_env

    envs = make_batch_vec_env("elastica_gym/SnakeReachGoal-v1", n_envs=16)
    model = SAC("MultiInputPolicy", envs, replay_buffer_class=HerReplayBuffer, learning_starts=6400, train_freq=4)
    model.learn(300_000)

``python -m agents.train`` accepts only flat ids; ``python -m agents.evaluate`` also accepts these, for policies that
ignore observations. Neither environment has been trained to success here.

Version history
---------------
v1: firm ground for the snake; contact of the octopus that conserves energy.
v0: the first; withdrawn.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Dict
from gymnasium.vector import VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from ..bodies.observation import Block
from ..engine.model import Array
from .batch import BatchEnv
from .single import SingleEnv
from .task import Mask, Situation, Task, distance_from
from .tasks import octopus_reach, snake_reach
from .tasks.snake_reach import Goal

Parts = dict[str, NDArray[np.float32]]


@dataclass(frozen=True, kw_only=True)
class GoalTask(Task):
    """A task for environments whose goals can be relabelled; see `goal_conditioned`.

    Attributes
    ----------
    base : str
        Name of the task whose animal and initial states it uses.
    tolerance : float
        Distance of the head from the goal that counts as success, in body lengths.
    """

    base: str
    tolerance: float


def sample_object(rng: np.random.Generator, situation: Situation) -> Goal:
    """Return a goal at the place of the object."""
    place, head = situation.pose.objects[0, 0, [0, 2]], situation.pose.head[0, [0, 2]]
    return Goal._make([*place, np.hypot(*(place - head))])


def observe_goal(situation: Situation) -> Array:
    """Return the heading, the head's place and the goal, each as x and z of the lab, (B, 6)."""
    s, length = situation, situation.body.sensors.length
    goal = np.stack([s.goal.x, s.goal.z], axis=1)
    return np.concatenate([s.pose.heading, s.pose.head[:, [0, 2]] / length, goal / length], axis=1)


def is_near(achieved: ArrayLike, desired: ArrayLike, tolerance: float) -> Mask:
    """Return whether places (..., 2) are within a tolerance of others, in single precision, (...) bool."""
    way = np.asarray(achieved, dtype=np.float32) - np.asarray(desired, dtype=np.float32)
    return way[..., 0] * way[..., 0] + way[..., 1] * way[..., 1] <= np.float32(tolerance * tolerance)


def succeeds(situation: Situation, tolerance: float) -> Mask:
    """Return whether the head is at the goal, as observed, (B,) bool."""
    seen = np.clip(observe_goal(situation), -4.0, 4.0).astype(np.float32)
    return is_near(seen[:, 2:4], seen[:, 4:], tolerance)


def reached(situation: Situation, tolerance: float) -> Array:
    """Return 1 if the head is at the goal, (B,)."""
    return succeeds(situation, tolerance).astype(np.float64)


def distance(situation: Situation) -> Array:
    """Return how much nearer the head is to the goal than at reset [m], (B,)."""
    goal, head = situation.goal, situation.pose.head
    return goal.way - distance_from(head, goal.x, goal.z)


def goal_conditioned(
    task: Task, *, sample_goal: Callable[[np.random.Generator, Situation], Goal], tolerance: float
) -> GoalTask:
    """Return the goal-conditioned form of a task: bring the head to a place, with the task's animal and initial states.

    Parameters
    ----------
    task : Task
        ``Goal`` is appended to its name. Its failures must not depend on its own goal.
    sample_goal : callable
        As in a `Task`; it returns a `Goal`.
    tolerance : float
        Distance of the head from the place that counts as success, in body lengths.
    """
    own = dict(
        name=f"{task.name}Goal",
        description=f"{task.name}Goal: bring the head to a place; goal-conditioned, for hindsight experience replay.",
        base=task.name,
        goal_type=Goal,
        sample_goal=sample_goal,
        observe_goal=observe_goal,
        goal_blocks=(
            Block("heading", ("x", "z"), -1.0, 1.0, "1", "heading, in the lab"),
            Block("achieved", ("x", "z"), -4.0, 4.0, "body length", "place of the head, in the lab"),
            Block("desired", ("x", "z"), -4.0, 4.0, "body length", "place where it should be, in the lab"),
        ),
        reward_terms={"reached": partial(reached, tolerance=tolerance)},
        reward_weights={"reached": 1.0, "diverged": 0.0},
        distance=distance,
        succeeds=partial(succeeds, tolerance=tolerance),
        ends_on_success=True,
        target=snake_reach.target,
        tolerance=tolerance,
    )
    return GoalTask(**{each.name: getattr(task, each.name) for each in fields(task)} | own)


GOAL_TASKS = (
    goal_conditioned(snake_reach.TASK, sample_goal=snake_reach.sample_goal, tolerance=0.05),
    goal_conditioned(octopus_reach.TASK, sample_goal=sample_object, tolerance=0.225),
)


def _parts(flat: NDArray[np.float32]) -> Parts:
    """Return observation, achieved and desired goal of flat observations (..., d)."""
    return {
        "observation": flat[..., :-4].copy(),
        "achieved_goal": flat[..., -4:-2].copy(),
        "desired_goal": flat[..., -2:].copy(),
    }


def _space(flat: Any) -> Dict:
    low, high = _parts(flat.low), _parts(flat.high)
    return Dict({name: Box(low[name], high[name], dtype=np.float32) for name in low})


def _refuse_weights(arguments: dict[str, Any]) -> None:
    if "weights" in arguments:
        raise ValueError(
            "weights cannot be given for goal-conditioned environments, whose reward is 1 at the goal and 0 elsewhere, "
            f"not {arguments['weights']!r}"
        )


# libraries such as skrl identify environments by their direct base classes, which must include Gymnasium's
class GoalBatchEnv(BatchEnv, VectorEnv):
    """A batch of animals, each with a goal that can be relabelled.

    Made by ``gymnasium.make_vec("elastica_gym/<Name>ReachGoal-v1", num_envs=...)``. Observations are a dict of
    arrays; that of an episode's last step in ``final_obs`` is an array of dicts, as in Gymnasium's own batches.
    """

    def __init__(self, task: GoalTask, num_envs: int = 1, **kwargs: Any) -> None:
        _refuse_weights(kwargs)
        self.tolerance = task.tolerance
        super().__init__(task, num_envs, **kwargs)

    def _make_spaces(self) -> None:
        super()._make_spaces()
        self.single_observation_space = _space(self.single_observation_space)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)

    def reset(self, *, seed=None, options=None):
        """Start new episodes; see `BatchEnv.reset`."""
        observations, info = super().reset(seed=seed, options=options)
        return _parts(observations), info

    def step(self, actions: Array):
        """Advance by one control step; see `BatchEnv.step`."""
        observations, *rest, info = super().step(actions)
        if "final_obs" in info:
            flat, info["final_obs"] = info["final_obs"], np.full(self.num_envs, None, dtype=object)
            for i in np.flatnonzero(info["_final_obs"]):
                info["final_obs"][i] = _parts(flat[i])
        return _parts(observations), *rest, info

    def compute_reward(self, achieved_goal: ArrayLike, desired_goal: ArrayLike, info: Any) -> Array:
        """Return the rewards of achieved goals for desired goals, (..., 2) to (...)."""
        return is_near(achieved_goal, desired_goal, self.tolerance).astype(np.float64)


class GoalEnv(SingleEnv, gymnasium.Env):
    """One animal with a goal that can be relabelled, as returned by ``gymnasium.make``."""

    def __init__(self, task: GoalTask, **kwargs: Any) -> None:
        _refuse_weights(kwargs)
        self.tolerance = task.tolerance
        super().__init__(task, **kwargs)
        self.observation_space = _space(self.batch.single_observation_space)

    def reset(self, *, seed=None, options=None):
        """Start a new episode; see `BatchEnv.reset`."""
        observation, info = super().reset(seed=seed, options=options)
        return _parts(observation), info

    def step(self, action: Array):
        """Advance by one control step; see `BatchEnv.step`."""
        observation, *rest = super().step(action)
        return _parts(observation), *rest

    def compute_reward(self, achieved_goal: ArrayLike, desired_goal: ArrayLike, info: Any) -> Array:
        """Return the rewards of achieved goals for desired goals, (..., 2) to (...)."""
        return is_near(achieved_goal, desired_goal, self.tolerance).astype(np.float64)
