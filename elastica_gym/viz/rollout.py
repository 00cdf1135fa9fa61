"""Rollouts: the history of one environment, step by step, as arrays."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, Self

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

from ..bodies.body import Body, Pose
from ..engine.model import Array, Index, State

HOME_RADIUS = 0.1
"""Radius of the disc that marks home: within it, the head counts as being there [m]"""

Policy = Callable[[Array, Any], Array]
"""Maps observations (B, d) and the batch to actions (B, 42)"""


class Batch(Protocol):
    """The attributes needed to draw a batch of environments, such as `elastica_gym.envs.BatchEnv`."""

    num_envs: int
    body: Body
    state: State
    activations: Array
    control_dt: float
    render_size: tuple[int, int]
    task: Any
    spec: Any

    @property
    def target(self) -> Array | None:
        """Positions of the targets [m], (B, 3), or None."""

    @property
    def pose(self) -> Pose:
        """The animals' current pose."""

    def situation(self) -> Any:
        """Return the environments' current situation."""


@dataclass(frozen=True, kw_only=True)
class Rollout:
    """T moments of an animal and the C objects around it: the start of an episode and the end of each control step.

    Attributes
    ----------
    name : str
        Name of the rollout, such as the id of the environment.
    body_length : float
        Length of the animal at rest, the unit of the scene [m].
    elements_per_rod : tuple of int
        Number of elements n of each rod; rods follow one another in `nodes` (n + 1 each), `radii` and `normal_force`.
    step : Array
        Control steps done, (T,) int64.
    sim_time : Array
        Simulated time [s], (T,).
    nodes : Array
        Positions of nodes [m], lab frame with y up, (T, N, 3).
    radii : Array
        Radii of elements [m], (T, M).
    normal_force : Array
        Normal force of the ground on each element [N], (T, M).
    head_node : int
        Index of the head's node.
    object_centre : Array
        Centres of mass of the objects, which are cylinders [m], (T, C, 3).
    object_axis : Array
        Unit vectors along their axes, (T, C, 3).
    object_length, object_radius : Array
        [m], (C,) each.
    object_force : Array
        Normal force between each element and the objects [N], (T, M).
    direction : Array or None
        Horizontal unit vector in which the animal has to go, (T, 3), if its goal has a direction.
    target : Array or None
        Position of the target [m], (T, 3), if the task has one.
    target_radius : float
        Radius of the ball that marks it [m].
    home : Array or None
        Place on the ground to which the animal has to return [m], (T, 3), if the task has one.
    rewards : dict of str to Array
        Weighted reward of each term, zero at the start, (T,) each.
    activations : Array
        Activations applied during the step, (T, A).
    activation_names : tuple of str
        Name of each activation, as ``direction/arm/place``.
    """

    name: str
    body_length: float
    elements_per_rod: tuple[int, ...]
    step: Index
    sim_time: Array
    nodes: Array
    radii: Array
    normal_force: Array
    head_node: int
    object_centre: Array
    object_axis: Array
    object_length: Array
    object_radius: Array
    object_force: Array
    direction: Array | None
    target: Array | None
    target_radius: float
    home: Array | None = None
    rewards: dict[str, Array]
    activations: Array
    activation_names: tuple[str, ...]

    @property
    def head(self) -> Array:
        """Position of the head [m], (T, 3)."""
        return self.nodes[:, self.head_node]

    @property
    def head_radius(self) -> Array:
        """Radius of the body at the head [m], (T,)."""
        return self.radii[:, element_at(self.head_node, self.elements_per_rod)]

    @property
    def head_is_an_end(self) -> bool:
        """Whether the head is a rod's end, which looks like any other end, rather than a part in between."""
        ends = np.cumsum([n + 1 for n in self.elements_per_rod])
        return self.head_node + 1 in ends or self.head_node in (0, *ends)

    @property
    def episode_return(self) -> Array:
        """Sum of all rewards so far, (T,)."""
        return np.cumsum(np.sum(list(self.rewards.values()), axis=0) + np.zeros(self.step.size))

    @property
    def duration(self) -> float:
        """Simulated time from the first to the last moment [s]."""
        return float(self.sim_time[-1] - self.sim_time[0])

    def segments(self) -> tuple[Array, Array]:
        """Return the beginning and end of each element [m], two of (T, M, 3)."""
        first = first_nodes(self.elements_per_rod)
        return self.nodes[:, first], self.nodes[:, first + 1]

    def objects(self) -> tuple[Array, Array]:
        """Return the centres of the first and second ends of each object [m], two of (T, C, 3)."""
        half = 0.5 * self.object_length[:, None] * self.object_axis
        return self.object_centre - half, self.object_centre + half


def first_nodes(elements_per_rod: tuple[int, ...]) -> Index:
    """Return the node at which each element begins, for rods that follow one another, (M,)."""
    starts = np.cumsum([0, *(n + 1 for n in elements_per_rod)])
    return np.concatenate([start + np.arange(n) for start, n in zip(starts, elements_per_rod, strict=False)])


def element_at(node: int, elements_per_rod: tuple[int, ...]) -> int:
    """Return the element that begins at a node, or at a rod's last node, the one that ends there."""
    return max(int(np.searchsorted(first_nodes(elements_per_rod), node, side="right")) - 1, 0)


class Recorder:
    """Collects the rollout of one environment of a batch, one moment at a time.

    Call `capture` after ``reset`` and after every ``step``, up to the end of the episode. If numbers
    are not finite, as after a divergence, the previous moment's positions are repeated.

    Parameters
    ----------
    env : Batch
        The environment, possibly wrapped.
    index : int
        Index of the environment in the batch.
    keep : int, optional
        Number of latest moments to keep; all if omitted.
    """

    def __init__(self, env: Any, index: int = 0, *, keep: int | None = None) -> None:
        self.env: Batch = _batch(env)
        if not 0 <= index < self.env.num_envs:
            raise ValueError(f"index must be from 0 to {self.env.num_envs - 1}, not {index}")
        model = self.env.body.model
        spans = list(zip(model.first_slot.tolist(), model.n_elements.tolist(), strict=True))
        self._index = index
        self._nodes = np.concatenate([np.arange(s, s + n + 1) for s, n in spans])
        self._elements = np.concatenate([np.arange(s, s + n) for s, n in spans])
        self._head_node = self._nodes.tolist().index(self.env.body.sensors.head)
        self._root_section = np.concatenate([rod.radius * np.sqrt(rod.rest_length) for rod in self.env.body.rods])
        self._moments: deque[dict[str, Array]] = deque(maxlen=keep)
        self._rewards: deque[dict[str, float]] = deque(maxlen=keep)

    def capture(self, infos: dict[str, Any] | None = None) -> Self:
        """Append the environment's current moment.

        Parameters
        ----------
        infos : dict, optional
            The info from ``step``; its ``reward_<term>`` arrays are the rewards. Omit it after ``reset``.
        """
        env, i, state = self.env, self._index, self.env.state
        lengths = np.linalg.norm(np.diff(state.x[i], axis=1), axis=0)[self._elements]
        moment = {
            "nodes": state.x[i].T[self._nodes],
            # at constant volume, from the current nodes: State.radius lags by half a time step
            "radii": self._root_section / np.sqrt(lengths),
            "normal_force": state.normal_force[i, self._elements],
            "object_centre": state.body_x[i].copy(),
            "object_axis": state.body_Q[i, :, 2].copy(),
            "object_force": state.body_touch[i, self._elements],
            "direction": _direction(env, i),
        }
        if self._moments and not all(np.isfinite(values).all() for values in moment.values()):
            moment = dict(self._moments[-1])
        target = env.target
        moment["target"] = np.full(3, np.nan) if target is None else np.array(target[i])
        moment["home"] = _home(env, i)
        moment["activations"] = np.array(env.activations[i], dtype=float)
        self._moments.append(moment)
        terms = {} if infos is None else {k[7:]: v[i] for k, v in infos.items() if k.startswith("reward_")}
        self._rewards.append({name: float(value) for name, value in terms.items()})
        return self

    def rollout(self) -> Rollout:
        """Return the captured rollout.

        Raises
        ------
        RuntimeError
            If nothing was captured.
        """
        if not self._moments:
            raise RuntimeError("nothing was captured: call capture() after reset() and after every step()")
        env = self.env
        series = {name: np.stack([m[name] for m in self._moments]) for name in self._moments[0]}
        step = np.arange(len(self._moments), dtype=np.int64)
        terms = dict.fromkeys(term for rewards in self._rewards for term in rewards)
        target, direction, home = series.pop("target"), series.pop("direction"), series.pop("home")
        return Rollout(
            name=env.spec.id if env.spec else env.task.name,
            body_length=env.body.sensors.length,
            elements_per_rod=tuple(env.body.model.n_elements.tolist()),
            step=step,
            sim_time=np.asarray(step * env.control_dt, dtype=np.float64),
            head_node=self._head_node,
            object_length=np.array([thing.length for thing in env.body.cylinders]),
            object_radius=np.array([thing.radius for thing in env.body.cylinders]),
            direction=direction if direction.size else None,
            target=None if np.isnan(target).any() else target,
            target_radius=0.05 * env.body.sensors.length,
            home=home if home.size else None,
            rewards={term: np.array([r.get(term, 0.0) for r in self._rewards]) for term in terms},
            activation_names=env.body.activation_names,
            **series,
        )


def run_rollout(env: Any, policy: Policy, *, seed: int = 0, index: int = 0, **env_kwargs: Any) -> Rollout:
    """Run one episode and return it.

    Parameters
    ----------
    env : str or Batch
        Id of a registered environment, for a batch of one, or an existing batch. A batch must not
        reset in the step that ends an episode (``AutoresetMode.SAME_STEP``), since the last moment
        would be lost.
    policy : callable
        ``policy(observations (B, d), env) -> actions (B, 42)``.
    seed : int
        Seed of the episode.
    index : int
        Index of the environment in the batch.
    **env_kwargs
        Passed to ``gymnasium.make_vec`` with an id.
    """
    if isinstance(env, str):
        env_kwargs = {"autoreset_mode": AutoresetMode.DISABLED, "num_envs": 1, **env_kwargs}
        vector = gymnasium.make_vec(env, vectorization_mode="vector_entry_point", **env_kwargs)
        try:
            return run_rollout(vector, policy, seed=seed, index=index)
        finally:
            vector.close()
    batch = _batch(env)
    if batch.metadata["autoreset_mode"] == AutoresetMode.SAME_STEP:
        raise ValueError("env must have the autoreset_mode DISABLED or NEXT_STEP, not SAME_STEP")
    recorder = Recorder(batch, index)
    observations, _ = env.reset(seed=seed)
    recorder.capture()
    done = False
    while not done:
        observations, _, terminated, truncated, infos = env.step(policy(observations, batch))
        recorder.capture(infos)
        done = bool(terminated[index] or truncated[index])
    return recorder.rollout()


def _direction(env: Batch, i: int) -> Array:
    """Return the observed direction of the goal, in the lab, (3,), or (0,) if there is none."""
    layout = env.task.goal_layout
    if not {"goal/forward", "goal/right"} <= set(layout.names):
        return np.zeros(0)
    observed, (hx, hz) = env.task.observe_goal(env.situation())[i], env.pose.heading[i]
    forward, right = observed[layout["goal"]][:2]
    size = max(float(np.hypot(forward, right)), 1e-9)
    return np.array([forward * hx - right * hz, 0.0, forward * hz + right * hx]) / size


def _home(env: Batch, i: int) -> Array:
    """Return the place to which the animal has to return, on the ground, (3,), or (0,) if there is none."""
    if "home" not in env.task.goal_layout:
        return np.zeros(0)
    goal = env.situation().goal
    return np.array([goal.home_x[i], 0.0, goal.home_z[i]])


def _batch(env: Any) -> Any:
    """Return the batch inside wrappers or inside a single environment."""
    inner = getattr(env, "unwrapped", env)
    return getattr(inner, "batch", inner)
