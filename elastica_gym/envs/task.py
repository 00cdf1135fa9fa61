"""The parts of a task: its goal, the goal's observation, and the rewards. Small pure functions over a batch."""

import functools
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..bodies.body import Body, Pose
from ..bodies.observation import Block, Layout, single
from ..engine.model import Array, State

Mask = NDArray[np.bool_]


DIRECTION = Block("goal", ("forward", "right"), -1.0, 1.0, "1", "direction to go: forward and right of a unit vector")
"""Observed direction to go"""
HOME = Block("home", ("forward", "right"), -4.0, 4.0, "body length",
             "vector from the head to its home, its place at the start: forward and right")  # fmt: skip
"""Observed place to return to"""
CLOCK_PERIOD = 1.0
"""Period of the observed clock [s]"""


class TerminationReason(IntEnum):
    """Why an episode ended, as ``termination_reason`` in the info; the numbers of a task's own failures follow."""

    RUNNING = 0
    """The episode has not ended"""
    TIME_LIMIT = 1
    SUCCESS = 2
    DIVERGED = 3
    """The simulation has diverged"""


class Situation(NamedTuple):
    """The situation of a batch of B environments after a control step."""

    pose: Pose
    """The animals' current pose"""
    before: Pose
    """Their pose one control step ago"""
    goal: Any
    """The goal sampled at reset: the task's ``goal_type``, each field (B,)"""
    progress: Any
    """Current progress through the episode: the task's ``progress_type``, each field (B,)"""
    progress_before: Any
    """The progress one control step ago"""
    activations: Array
    """Activations commanded in this step, (B, 42)"""
    time_left: Array
    """Fraction of the episode that is left, 1 at its start and 0 at its end, (B,)"""
    control_dt: float
    """Duration of a control step [s]"""
    body: Body

    def only(self, envs: slice) -> "Situation":
        """Return views of some environments."""
        s = self
        return s._replace(
            pose=s.pose.only(envs),
            before=s.before.only(envs),
            goal=_only(s.goal, envs),
            progress=_only(s.progress, envs),
            progress_before=_only(s.progress_before, envs),
            activations=s.activations[envs],
            time_left=s.time_left[envs],
        )


def _only(columns: Any, envs: slice) -> Any:
    return type(columns)(*(column[envs] for column in columns))


class NoProgress(NamedTuple):
    """The progress of tasks that use only poses."""


def follow_nothing(situation: Situation, state: State) -> NoProgress:
    """Return no progress."""
    return NoProgress()


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
    initial_states : dict of str to callable
        By name of the ``spread``, functions that write an initial state into an environment and return the muscles'
        activations in it, (42,), or None if they are at rest; see `elastica_gym.envs.initial_states`.
    goal_type : type
        A NamedTuple of the numbers of a goal.
    sample_goal : callable
        From a generator and the situation of one environment at reset, returns its goal: a ``goal_type`` of floats.
    goal_blocks : tuple of Block
        The blocks that ``observe_goal`` returns.
    observe_goal : callable
        From a situation, returns the observation of the goal, in the frame of the animal's heading, (B, g).
    reward_terms : dict of str to callable
        From a situation, each returns an unweighted term, (B,).
    reward_weights : dict of str to float
        Weight of each term, and of ``diverged``, which is 1 if the simulation has diverged.
    progress_type : type
        A NamedTuple of the numbers that the task updates through an episode; by default none.
    follow : callable
        From a situation and the State, returns those numbers, (B,) each; the situation's ``progress`` is that of the
        last step. Also called at reset, when all of the episode is left and ``progress`` is zero.
    distance : callable
        From a situation, returns how far the animal has come [m], (B,).
    succeeds : callable
        From a situation, returns whether the task is done, (B,) bool.
    ends_on_success : bool
        Whether an episode ends with success.
    failures : dict of str to callable
        By their names in ``termination_reasons``, functions that return from a situation whether the task has failed,
        which ends the episode, (B,) bool.
    target : callable
        From a ``goal_type`` of (B,) each, returns the target's position in the lab [m], (B, 3), or None if it has none.
    description : str
        Description of the task, in Markdown, with which `elastica_gym.envs.document` begins.
    """

    name: str
    make_body: Callable[..., Body]
    duration: float
    initial_states: dict[str, Callable[[np.random.Generator, Body, State, int], Array | None]]
    goal_type: type[Any]
    sample_goal: Callable[[np.random.Generator, Situation], Any]
    goal_blocks: tuple[Block, ...]
    observe_goal: Callable[[Situation], Array]
    reward_terms: dict[str, Callable[[Situation], Array]]
    reward_weights: dict[str, float]
    distance: Callable[[Situation], Array]
    succeeds: Callable[[Situation], Mask]
    ends_on_success: bool
    progress_type: type[Any] = NoProgress
    follow: Callable[[Situation, State], Any] = follow_nothing
    failures: dict[str, Callable[[Situation], Mask]] = field(default_factory=dict)
    target: Callable[[Any], Array | None]
    description: str = ""

    def __post_init__(self) -> None:
        if not self.initial_states:
            raise ValueError("initial_states must have at least one entry, not none")
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
        """Names of the termination reasons by number: those of `TerminationReason`, then the failures."""
        return (*(reason.name.lower() for reason in TerminationReason), *self.failures)

    @functools.cached_property
    def goal_layout(self) -> Layout:
        """Layout of the goal's observation."""
        return Layout(self.goal_blocks)

    def layout(self, body: Body) -> Layout:
        """Return the layout of the observations in this task."""
        clock = f"sine and cosine of a clock with a period of {CLOCK_PERIOD:g} s"
        return Layout(
            [
                *body.blocks(),
                Block("clock", ("sine", "cosine"), -1.0, 1.0, "1", clock),
                single("time_left", 0.0, 1.0, "1", "fraction of the episode that is left"),
                *self.goal_blocks,
            ]
        )


def in_heading_frame(situation: Situation, x: Array, z: Array) -> tuple[Array, Array]:
    """Return the forward and right components of horizontal vectors (x, z), in the frame of the heading, (B,) each."""
    hx, hz = situation.pose.heading[:, 0], situation.pose.heading[:, 1]
    return x * hx + z * hz, z * hx - x * hz


def way_to(situation: Situation, x: Array, z: Array) -> tuple[Array, Array]:
    """Return the vector from the head to a place, forward and right, in body lengths, (B,) each."""
    s, length = situation, situation.body.sensors.length
    return in_heading_frame(s, (x - s.pose.head[:, 0]) / length, (z - s.pose.head[:, 2]) / length)


def distance_from(place: Array, x: Array, z: Array) -> Array:
    """Return the horizontal distance of places (B, 3) from others [m], (B,)."""
    dx, dz = place[:, 0] - x, place[:, 2] - z
    return np.sqrt(dx * dx + dz * dz)


def on_the_ground(x: Array, z: Array) -> Array:
    """Return places on the ground [m], (B, 3)."""
    return np.stack([x, np.zeros_like(x), z], axis=1)


def no_target(goal: Any) -> None:
    """Return None: the task has a direction or an object, but no place to show."""


def has_toppled(situation: Situation) -> Mask:
    """Return whether the animal has rolled or pitched by more than 60 degrees, (B,) bool."""
    return situation.pose.upright < 0.5


def toppled(situation: Situation) -> Array:
    """Return 1 if the animal has rolled or pitched by more than 60 degrees, (B,)."""
    return has_toppled(situation).astype(np.float64)


def effort(situation: Situation) -> Array:
    """Return minus the mean square activation times the duration of the step [s], (B,)."""
    a = situation.activations
    # summed one by one: the order of summation must not depend on the size of the batch
    return -(a * a).cumsum(axis=1)[:, -1] / a.shape[1] * situation.control_dt
