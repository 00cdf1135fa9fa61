"""What a task is: a goal, what is seen of it, and what is rewarded. Small pure functions over a batch."""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..bodies.body import Body, Pose
from ..engine.model import Array, State

Mask = NDArray[np.bool_]


GOAL_NAMES = ("goal/forward", "goal/right", "home/forward", "home/right")
"""What the octopus sees of its goals: a direction to go, and the way home"""
GOAL_BOUNDS = ((-1.0, 1.0), (-1.0, 1.0), (-4.0, 4.0), (-4.0, 4.0))
"""Least and largest value of each"""


class TerminationReason(IntEnum):
    """Why an episode has ended, as ``termination_reason`` in the info; a task's own failures have the numbers after."""

    RUNNING = 0
    """It has not ended"""
    TIME_LIMIT = 1
    SUCCESS = 2
    DIVERGED = 3
    """The physics has failed"""


class Situation(NamedTuple):
    """Where a batch of B environments stands after a control step."""

    pose: Pose
    """Where the animals are now"""
    before: Pose
    """Where they were a control step ago"""
    goal: Array
    """What the task drew at reset, (B, G)"""
    progress: Array
    """What the task follows through the episode, as of now, (B, M)"""
    progress_before: Array
    """And a control step ago, (B, M)"""
    activations: Array
    """Activations commanded in this step, (B, 42)"""
    time_left: Array
    """Part of the episode that is left, 1 at its start and 0 at its end, (B,)"""
    control_dt: float
    """Duration of a control step [s]"""
    body: Body

    def only(self, envs: slice) -> "Situation":
        """Return views of some environments."""
        s = self
        return s._replace(
            pose=s.pose.only(envs),
            before=s.before.only(envs),
            goal=s.goal[envs],
            progress=s.progress[envs],
            progress_before=s.progress_before[envs],
            activations=s.activations[envs],
            time_left=s.time_left[envs],
        )


def follow_nothing(situation: Situation, state: State) -> Array:
    """Return no numbers: what such a task asks for is in the poses, (B, 0)."""
    return situation.progress


@dataclass(frozen=True, kw_only=True)
class Task:
    """A task for a body: with keyword arguments, it makes an environment.

    Attributes
    ----------
    name : str
    make_body : callable
        Returns the `Body`; called with the environment's ``body_kwargs``.
    duration : float
        Simulated time of an episode [s].
    starts : dict of str to callable
        By name of the ``spread``, what writes a new start into an environment and returns the activations that the
        muscles have reached in it, (42,), or None where they are at rest; see `elastica_gym.envs.starts`.
    goal_size : int
        How many numbers G a goal is.
    draw_goal : callable
        From a generator and the situation of one environment at reset, its goal, (G,).
    goal_names : tuple of str
        Names of what ``see_goal`` returns.
    goal_bounds : tuple of tuple of float
        Least and largest value of each.
    see_goal : callable
        From a situation, what the animal sees of its goal in the frame of its heading, (B, g).
    reward_terms : dict of str to callable
        From a situation, each term before its weight, (B,).
    reward_weights : dict of str to float
        Weight of each term, and of ``diverged``, which is 1 where the simulation has diverged.
    progress_names : tuple of str
        Names of the M numbers that the task follows through an episode; by default none.
    follow : callable
        From a situation and the State, those numbers, (B, M), with ``progress`` as of the last step. It is asked at
        reset too, when all of the episode is left and ``progress`` is zero.
    distance : callable
        From a situation, how far the animal has come [m], (B,).
    succeeds : callable
        From a situation, whether the task is done, (B,) bool.
    ends_on_success : bool
        Whether an episode ends with success.
    failures : dict of str to callable
        By its name among the ``termination_reasons``, from a situation, whether the task has failed, which ends the
        episode, (B,) bool.
    target : callable
        From goals, the target's position in the lab [m], (B, 3), or None where there is none to show.
    """

    name: str
    make_body: Callable[..., Body]
    duration: float
    starts: dict[str, Callable[[np.random.Generator, Body, State, int], Array | None]]
    goal_size: int
    draw_goal: Callable[[np.random.Generator, Situation], Array]
    goal_names: tuple[str, ...]
    goal_bounds: tuple[tuple[float, float], ...]
    see_goal: Callable[[Situation], Array]
    reward_terms: dict[str, Callable[[Situation], Array]]
    reward_weights: dict[str, float]
    distance: Callable[[Situation], Array]
    succeeds: Callable[[Situation], Mask]
    ends_on_success: bool
    progress_names: tuple[str, ...] = ()
    follow: Callable[[Situation, State], Array] = follow_nothing
    failures: dict[str, Callable[[Situation], Mask]] = field(default_factory=dict)
    target: Callable[[Array], Array | None]

    def __post_init__(self) -> None:
        if not self.starts:
            raise ValueError("starts must have at least one way to draw a start")
        if len(self.goal_bounds) != len(self.goal_names):
            raise ValueError(
                f"goal_bounds must have a least and a largest value for each of {self.goal_names}, "
                f"not {self.goal_bounds}"
            )
        weighted = {*self.reward_terms, "diverged"}
        if set(self.reward_weights) != weighted:
            raise ValueError(
                f"reward_weights must have a weight for each of {', '.join(sorted(weighted))}, not for "
                f"{', '.join(self.reward_weights)}"
            )
        reasons = self.termination_reasons
        if len(set(reasons)) < len(reasons):
            raise ValueError(
                f"failures must have other names than {', '.join(reasons[: len(TerminationReason)])}, "
                f"not {', '.join(self.failures)}"
            )

    @property
    def termination_reasons(self) -> tuple[str, ...]:
        """Names of the reasons why an episode ends, by number: those of `TerminationReason`, then the failures."""
        return (*(reason.name.lower() for reason in TerminationReason), *self.failures)

    def observations(self, body: Body) -> list[tuple[str, float, float]]:
        """Return the name and the least and largest value of each number that an animal of this task observes."""
        clock = [("clock/sine", -1.0, 1.0), ("clock/cosine", -1.0, 1.0), ("time_left", 0.0, 1.0)]
        goal = [(name, *bounds) for name, bounds in zip(self.goal_names, self.goal_bounds, strict=True)]
        return body.readings() + clock + goal


def in_heading_frame(situation: Situation, x: Array, z: Array) -> tuple[Array, Array]:
    """Return the forward and right component of horizontal vectors (x, z), in the frame of the heading, (B,) each."""
    hx, hz = situation.pose.heading[:, 0], situation.pose.heading[:, 1]
    return x * hx + z * hz, z * hx - x * hz


def way_to_goal(situation: Situation) -> tuple[Array, Array]:
    """Return the way from the head to the place that a goal begins with, forward and right, in body lengths."""
    s, length = situation, situation.body.senses.length
    x, z = (s.goal[:, 0] - s.pose.head[:, 0]) / length, (s.goal[:, 1] - s.pose.head[:, 2]) / length
    return in_heading_frame(s, x, z)


def no_target(goal: Array) -> None:
    """Return None: there is no place to show, but a direction or an object."""


def has_toppled(situation: Situation) -> Mask:
    """Return whether the animal has rolled or pitched by more than 60 degrees, (B,) bool."""
    return situation.pose.upright < 0.5


def toppled(situation: Situation) -> Array:
    """Return 1 where the animal has rolled or pitched by more than 60 degrees, (B,)."""
    return has_toppled(situation).astype(np.float64)


def effort(situation: Situation) -> Array:
    """Return minus the mean square activation times the duration of the step [s], (B,)."""
    a = situation.activations
    # one after the other: the order of summation must not depend on the size of the batch
    return -(a * a).cumsum(axis=1)[:, -1] / a.shape[1] * situation.control_dt
