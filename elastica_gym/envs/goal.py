"""SnakeReachGoal and OctopusReachGoal: bring the head to a place; goal-conditioned, for hindsight experience replay.

Description
-----------
The animals and starts of `.tasks.snake_reach` and `.tasks.octopus_reach`, as environments
whose goal can be changed afterwards (Andrychowicz et al. 2017): an episode that went elsewhere is a good one for
the place where it went. The snake's goal is its target, the octopus's the place where its object stands at the start.

Action
------
``Box(-1, 1, (42,), float32)``, as there.

Observation
-----------
``Dict(observation, achieved_goal, desired_goal)`` of ``Box(float32)``:

- ``observation``: what those tasks observe without the numbers about the goal (of the octopus, 0 to 205, of the snake,
  0 to 156), and last the heading, which they do without: a unit vector along x and z of the lab, -1 to 1.
- ``achieved_goal``: the head's place on the ground, as x and z of the lab, in body lengths, -4 to 4.
- ``desired_goal``: the place where it should be, likewise.

Nothing in ``observation`` depends on the goal.

Rewards
-------
1 where the head is at the goal, within 0.05 body lengths for the snake; for the octopus within 0.225 m, where the
surfaces of its head and of the object are no more than 0.05 m apart; else 0. Of any goals, (..., 2), this is what
``compute_reward(achieved_goal, desired_goal, info)`` tells, which does not look at the info. A failure ends the
episode, and costs that there is no more reward.

Episode end
-----------
Terminated at the goal; where the octopus topples; and where the simulation diverges. Truncated after 20 s for the snake
and 10 s for the octopus.

Arguments
---------
Those of `elastica_gym.envs.BatchEnv`, but for ``weights``, of which ``compute_reward`` would know nothing; ``spread``
as there.

Training
--------
The observations are for Stable-Baselines3's ``MultiInputPolicy`` and its replay buffer with hindsight, through the
adapter of this package::

    from stable_baselines3 import SAC, HerReplayBuffer
    from elastica_gym.rl import make_batch_vec_env

    envs = make_batch_vec_env("elastica_gym/SnakeReachGoal-v1", n_envs=16)
    model = SAC("MultiInputPolicy", envs, replay_buffer_class=HerReplayBuffer, learning_starts=6400, train_freq=4)
    model.learn(300_000)

``python -m agents.train`` takes the flat ids only; ``python -m agents.evaluate`` these too, for policies that do not
look at observations. Neither has been trained to success here.

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
    """A task that makes environments whose goals can be changed afterwards; see `goal_conditioned`.

    Attributes
    ----------
    base : str
        Name of the task whose animal and starts it has.
    tolerance : float
        Distance of the head from the goal that is near enough, in body lengths.
    """

    base: str
    tolerance: float


def sample_object(rng: np.random.Generator, situation: Situation) -> Goal:
    """Return where the object stands."""
    place, head = situation.pose.objects[0, 0, [0, 2]], situation.pose.head[0, [0, 2]]
    return Goal._make([*place, np.hypot(*(place - head))])


def observe_goal(situation: Situation) -> Array:
    """Return the heading, the head's place and the goal, each as x and z of the lab, (B, 6)."""
    s, length = situation, situation.body.sensors.length
    goal = np.stack([s.goal.x, s.goal.z], axis=1)
    return np.concatenate([s.pose.heading, s.pose.head[:, [0, 2]] / length, goal / length], axis=1)


def is_near(achieved: ArrayLike, desired: ArrayLike, tolerance: float) -> Mask:
    """Return whether places (..., 2) are no further than a tolerance from others, in single precision, (...) bool."""
    way = np.asarray(achieved, dtype=np.float32) - np.asarray(desired, dtype=np.float32)
    return way[..., 0] * way[..., 0] + way[..., 1] * way[..., 1] <= np.float32(tolerance * tolerance)


def succeeds(situation: Situation, tolerance: float) -> Mask:
    """Return whether the head is at the goal, as one who sees them can tell, (B,) bool."""
    seen = np.clip(observe_goal(situation), -4.0, 4.0).astype(np.float32)
    return is_near(seen[:, 2:4], seen[:, 4:], tolerance)


def reached(situation: Situation, tolerance: float) -> Array:
    """Return 1 where the head is at the goal, (B,)."""
    return succeeds(situation, tolerance).astype(np.float64)


def distance(situation: Situation) -> Array:
    """Return how much nearer the head is to the goal than at reset [m], (B,)."""
    goal, head = situation.goal, situation.pose.head
    return goal.way - distance_from(head, goal.x, goal.z)


def goal_conditioned(
    task: Task, *, sample_goal: Callable[[np.random.Generator, Situation], Goal], tolerance: float
) -> GoalTask:
    """Return the goal-conditioned form of a task: bring the head to a place, with the animal and the starts of another.

    Parameters
    ----------
    task : Task
        Its name gets ``Goal`` at the end. Its failures must not depend on its own goal.
    sample_goal : callable
        As of a `Task`; it returns a `Goal`.
    tolerance : float
        Distance of the head from the place that is near enough, in body lengths.
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
            "weights cannot be given where goals can be changed: the reward is 1 at the goal and else 0, "
            f"as compute_reward tells it, not {arguments['weights']!r}"
        )


# libraries such as skrl tell an environment by its class's direct bases, of which Gymnasium's has to be one
class GoalBatchEnv(BatchEnv, VectorEnv):
    """A batch of animals, each with a goal that can be changed afterwards.

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
        """Return the rewards of achieved goals when others were desired, (..., 2) to (...)."""
        return is_near(achieved_goal, desired_goal, self.tolerance).astype(np.float64)


class GoalEnv(SingleEnv, gymnasium.Env):
    """One animal with a goal that can be changed afterwards; what ``gymnasium.make`` returns."""

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
        """Return the rewards of achieved goals when others were desired, (..., 2) to (...)."""
        return is_near(achieved_goal, desired_goal, self.tolerance).astype(np.float64)
