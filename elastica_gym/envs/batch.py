"""The batched environment: all logic, over a leading environment axis."""

import functools
from collections.abc import Sequence
from copy import deepcopy
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import logger
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ..bodies.body import activate, make_pose, observe
from ..engine import advance, at_rest
from ..engine.jit.compiler import Bound
from ..engine.model import Array
from ..engine.rod import require_positive, require_stable
from ..engine.stability import require_stable_model
from ..engine.threads import Team, available_cpus
from .spaces import NamedBox
from .task import CLOCK_PERIOD, Mask, Situation, Task, TerminationReason

if TYPE_CHECKING:
    from ..viz import View
    from ..viz.frames import Image

CONTROL_DT = 0.05
"""Default duration of a control step [s]"""
RENDER_MODES = ("rgb_array",)
"""Supported render modes; for a single animal, Gymnasium's wrappers show or collect the pictures"""

PHYSICAL_STATE = (
    "x",
    "v",
    "Q",
    "w",
    "couple",
    "time",
    "step",
    "kappa",
    "normal_force",
    "radius",
    "length",
    "body_x",
    "body_v",
    "body_Q",
    "body_w",
    "body_contact",
    "body_touch",
    "rod_touch",
)
# neighbour lists are left out: they are checked against the positions, and any valid list gives the same result


Observations = NDArray[np.float32]


class BatchEnv(VectorEnv):
    """A batch of animals, each performing the task.

    Made by ``gymnasium.make_vec("elastica_gym/<Name>-v1", num_envs=...)``.

    Parameters
    ----------
    task : Task
    num_envs : int
        1 to 4,096.
    control_dt : float
        Duration of a control step [s].
    sim_dt : float, optional
        Largest time step of the physics [s]; a control step is divided into as few equal ones as possible.
        By default the body's, which keeps divergence rare.
    duration : float, optional
        Simulated time of an episode [s], to the nearest control step; by default the task's. The observation
        ``time_left`` refers to it.
    max_episode_steps : int, optional
        Control steps after which an episode is truncated, if ``duration`` does not end it earlier: as with
        ``gymnasium.make``, observations do not depend on it. None and -1 leave it to ``duration``.
    n_threads : int, optional
        Threads that share the environments; by default one per available CPU. Results do not depend on it.
    autoreset_mode : AutoresetMode
        How an environment is reset after its episode has ended.
    weights : dict of str to float, optional
        Weights of reward terms that differ from the task's.
    spread : str, optional
        Distribution of initial states: one of ``task.initial_states``, by default the first.
    body_kwargs : dict, optional
        Passed to the function that makes the body, such as ``n_elements`` for the snake.
    render_mode : str, optional
        ``"rgb_array"``, with which `render` draws pictures.
    render_size : tuple of int
        Width and height of the pictures [pixels].

    Raises
    ------
    ValueError
        If an argument is invalid, or ``sim_dt`` is above the stable time step.
    """

    def __init__(
        self,
        task: Task,
        num_envs: int = 1,
        *,
        control_dt: float = CONTROL_DT,
        sim_dt: float | None = None,
        duration: float | None = None,
        max_episode_steps: int | None = None,
        n_threads: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        weights: dict[str, float] | None = None,
        spread: str | None = None,
        body_kwargs: dict[str, Any] | None = None,
        render_mode: str | None = None,
        render_size: tuple[int, int] = (640, 360),
    ) -> None:
        _require_count("num_envs", num_envs, 4096)
        if render_mode not in (None, *RENDER_MODES):
            raise ValueError(
                f"render_mode must be 'rgb_array' or None, not {render_mode!r}: gymnasium.make takes "
                "'human' and 'rgb_array_list', for one animal"
            )
        _require_size(render_size)
        self.task, self.num_envs, self.render_mode, self.render_size = task, num_envs, render_mode, render_size
        self._view: View | None = None
        try:
            self.body = task.make_body(**(body_kwargs or {}))
        except TypeError as error:
            raise ValueError(f"body_kwargs: {error}") from None
        self.weights = _merge_weights(task, weights or {})
        self.spread = next(iter(task.initial_states)) if spread is None else spread
        if self.spread not in task.initial_states:
            raise ValueError(f"spread must be one of {', '.join(task.initial_states)}, not {spread!r}")
        self._sample_initial_state = task.initial_states[self.spread]
        self.n_threads = available_cpus() if n_threads is None else n_threads
        _require_count("n_threads", self.n_threads, 4096)
        self.autoreset_mode = _autoreset_mode(autoreset_mode)
        self._set_times(
            control_dt,
            self.body.sim_dt if sim_dt is None else sim_dt,
            task.duration if duration is None else duration,
            max_episode_steps,
        )
        frames_per_second = round(1.0 / control_dt)
        self.metadata = {
            "render_modes": list(RENDER_MODES),
            "render_fps": frames_per_second,
            "autoreset_mode": self.autoreset_mode,
        }
        self._make_spaces()
        self._allocate()

    def _set_times(self, control_dt: float, sim_dt: float, duration: float, max_episode_steps: int | None) -> None:
        require_positive("control_dt", control_dt)
        require_positive("sim_dt", sim_dt)
        require_positive("duration", duration)
        try:
            require_stable(self.body.rods, sim_dt)
            require_stable_model(self.body.model, sim_dt)
        except ValueError as error:
            raise ValueError(f"sim_dt: {error}") from None
        self.control_dt = control_dt
        # slightly less, so that rounding in the quotient costs no extra step
        self.n_substeps = max(1, int(np.ceil(control_dt / sim_dt - 1e-9)))
        self.sim_dt = control_dt / self.n_substeps
        self._n_steps = max(1, round(duration / control_dt))
        self.duration = self._n_steps * control_dt
        self.max_episode_steps = self._n_steps
        # in Gymnasium, -1 means no limit
        if max_episode_steps not in (None, -1):
            _require_count("max_episode_steps", max_episode_steps, 2**31 - 1)
            self.max_episode_steps = min(self._n_steps, max_episode_steps)

    def _make_spaces(self) -> None:
        self.layout = self.task.layout(self.body)
        self.observation_names, self._low, self._high = self.layout.names, self.layout.low, self.layout.high
        about: dict[str, Any] = {"mirror": self.body.mirror, "duration": self.duration}
        most = np.ones(self.body.n_activations, dtype=np.float32)
        self.single_observation_space = NamedBox(self._low, self._high, names=self.observation_names, **about)
        self.single_action_space = NamedBox(-most, most, names=self.body.activation_names, **about)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    def _allocate(self) -> None:
        n = self.num_envs
        n_objects = len(self.body.cylinders)
        self.state, self.control = at_rest(self.body.model, self.body.rods, n, cylinders=self.body.cylinders)
        self.pose, self._before = make_pose(n, n_objects), make_pose(n, n_objects)
        self.goal = np.zeros((n, len(self.task.goal_type._fields)))
        self.progress, self._progress_before = (np.zeros((n, len(self.task.progress_type._fields))) for _ in range(2))
        self.elapsed = np.zeros(n, dtype=np.int64)
        self.activations = np.zeros((n, self.body.n_activations))
        self.levels = np.zeros((n, self.body.n_activations))
        self._observations = np.zeros((n, len(self.observation_names)), dtype=np.float32)
        self.integrator = Team(self.body.model, self.state, self.control, self.n_threads)
        self._sense = Bound(
            observe,
            self.body.model,
            self.state,
            self.levels,
            self.body.sensors,
            self.pose,
            self._low,
            self._high,
            self._observations,
        )
        self._distance = np.zeros(n)
        self._ended = np.zeros(n, dtype=bool)
        self._generators: list[np.random.Generator] | None = None
        self._seeds: list[int] = []

    # the interface of gymnasium.vector.VectorEnv

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Start new episodes.

        Parameters
        ----------
        seed : int or sequence of int, optional
            An integer s seeds environment i with s + i. If omitted, the existing generators continue; at the first
            reset, they are seeded by the operating system.
        options : dict, optional
            ``{"reset_mask": (B,) bool}`` resets only where it is true.

        Returns
        -------
        tuple
            Observations (B, d) and an info of the new episodes, with the keys of `step`.

        Raises
        ------
        ValueError
            If there is another option, or the first reset leaves out an environment.
        """
        mask = _reset_mask(options or {}, self.num_envs)
        if self._generators is None and not mask.all():
            raise ValueError(
                "the first reset must start every environment, but reset_mask leaves out "
                f"{np.flatnonzero(~mask).tolist()}"
            )
        self._seed(seed, mask)
        self._start(mask)
        info = self._first_info()
        return self._observations.copy(), {**info, **{f"_{name}": mask.copy() for name in info}}

    def step(self, actions: Array) -> tuple[Observations, Array, Mask, Mask, dict[str, Any]]:
        """Advance every environment by one control step.

        If an episode has ended and there is no automatic reset, further steps continue the physics, and their results
        have no meaning.

        Parameters
        ----------
        actions : Array
            Activations, (B, A); clipped to [-1, 1].

        Returns
        -------
        tuple
            Observations (B, d), rewards (B,), terminated (B,), truncated (B,) and info, arrays over the batch:
            ``reward_<term>``, ``distance``, ``is_success`` and ``termination_reason``, a `TerminationReason` or the
            index of one of the task's failures in ``termination_reasons``.

        Raises
        ------
        ValueError
            If the actions have the wrong shape or contain NaN.
        """
        if self._generators is None:
            raise RuntimeError("call reset before step")
        begin = self._ended & (self.autoreset_mode == AutoresetMode.NEXT_STEP)
        self._command(actions, begin)
        self._advance()
        now, sound = self.situation(), self.pose.sound == 1
        self._follow(now, sound)
        rewards, info = self._compute_rewards(now, sound)
        ends = {name: failed(now) for name, failed in self.task.failures.items()}
        ends |= {"success": info["is_success"] & self.task.ends_on_success, "diverged": ~sound}
        terminated = functools.reduce(np.logical_or, ends.values())
        truncated = ~terminated & (self.elapsed >= self.max_episode_steps)
        info["termination_reason"] = self._reasons({"time_limit": truncated, **ends})
        self._observe(now, sound)
        if begin.any():
            self._start(begin)
            for values in (rewards, terminated, truncated):
                values[begin] = 0
            self._begin_info(begin, info)
        self._ended = terminated | truncated
        if self.autoreset_mode == AutoresetMode.SAME_STEP and self._ended.any():
            info = self._restart(self._ended.copy(), info)
        else:
            info |= {f"_{name}": np.ones(self.num_envs, dtype=bool) for name in info}
        return self._observations.copy(), rewards, terminated, truncated, info

    def render(self) -> "tuple[Image, ...] | None":
        """Draw the current state of every environment; see `elastica_gym.viz.View`.

        Returns
        -------
        tuple of Image, or None
            For each environment (height, width, 3) uint8; without a ``render_mode``, None and a warning.

        Raises
        ------
        ImportError
            If MuJoCo is not installed.
        RuntimeError
            If there was no reset, or MuJoCo has no graphics library.
        """
        if self.render_mode is None:
            logger.warn("render draws nothing without a render_mode: make the environment with render_mode='rgb_array'")
            return None
        if self._generators is None:
            raise RuntimeError("call reset before render")
        if self._view is None:
            # imported only when rendering
            from ..viz import View

            self._view = View(self)
        return self._view.draw()

    def close_extras(self, **kwargs: Any) -> None:
        """Close the renderer; nothing else is open, as threads belong to the process."""
        if self._view is not None:
            self._view.close()
        self._view = None

    def __getstate__(self) -> dict[str, Any]:
        # a copy, here or in another process, creates its own view
        return {**self.__dict__, "_view": None}

    # one control step

    def _command(self, actions: Array, ignored: Mask) -> None:
        """Set the activations to the actions, and to zero where these are ignored."""
        values = np.array(actions, dtype=np.float64)
        if values.shape != self.action_space.shape:
            raise ValueError(f"actions must have shape {self.action_space.shape}, not {values.shape}")
        values[ignored] = 0.0
        wrong = np.isnan(values).any(axis=1)
        if wrong.any():
            raise ValueError(f"actions must be numbers, but those of environment {int(wrong.argmax())} hold NaN")
        values.clip(-1.0, 1.0, out=self.activations)

    def _advance(self) -> None:
        """Move the animals, and observe them."""
        for old, new in zip(self._before, self.pose, strict=True):
            old[...] = new
        self._progress_before[:] = self.progress
        activate(self.body.couples, self.activations, self.control.couple)
        # the physics does the same with couples, in n_substeps parts
        tau = self.body.muscles.activation_time
        self.levels += (self.activations - self.levels) * (1.0 - np.exp(-self.control_dt / tau))
        self.elapsed += 1
        self.integrator.advance(self.num_envs, self.sim_dt, self.n_substeps, self._sense)

    def _follow(self, now: Situation, where: Mask) -> None:
        """Update the progress of some environments."""
        for column, value in zip(self.progress.T, self.task.follow(now, self.state), strict=True):
            np.copyto(column, value, where=where)

    @property
    def observations(self) -> Observations:
        """Current observations, (B, d)."""
        return self._observations.copy()

    def situation(self) -> Situation:
        """Return the current situation of the batch."""
        left = np.maximum(1.0 - self.elapsed / self._n_steps, 0.0)
        return Situation(
            self.pose,
            self._before,
            self.task.goal_type(*self.goal.T),
            self.task.progress_type(*self.progress.T),
            self.task.progress_type(*self._progress_before.T),
            self.activations,
            left,
            self.control_dt,
            self.body,
        )

    def _compute_rewards(self, now: Situation, sound: Mask) -> tuple[Array, dict[str, Any]]:
        """Return the rewards and an info with each term; where the simulation has diverged, only the penalty."""
        rewards, info = np.zeros(self.num_envs), {}
        for name, term in self.task.reward_terms.items():
            value = np.where(sound, self.weights[name] * term(now), 0.0)
            info[f"reward_{name}"] = value
            rewards += value
        info["reward_diverged"] = np.where(sound, 0.0, self.weights["diverged"])
        rewards += info["reward_diverged"]
        self._distance = np.where(sound, self.task.distance(now), self._distance)
        info["distance"] = self._distance.copy()
        info["is_success"] = sound & self.task.succeeds(now)
        return rewards, info

    def _reasons(self, ends: dict[str, Mask]) -> NDArray[np.int64]:
        """Return the index of each termination reason in ``termination_reasons``, (B,); of several, the last."""
        reasons = np.full(self.num_envs, TerminationReason.RUNNING, dtype=np.int64)
        for name, ended in ends.items():
            reasons[ended] = self.termination_reasons.index(name)
        return reasons

    def _observe(self, now: Situation, where: Mask) -> None:
        """Write clock, time left and goal to the observations of some environments; the others keep their last ones."""
        angle = 2.0 * np.pi / CLOCK_PERIOD * self.control_dt * self.elapsed
        goal = self.task.observe_goal(now)
        wanted = (self.num_envs, len(self.task.goal_layout.names))
        if goal.shape != wanted:
            raise ValueError(
                f"observe_goal of {self.task.name} must return {wanted}, as in goal_blocks, not {goal.shape}"
            )
        columns = np.concatenate(
            [np.sin(angle)[:, None], np.cos(angle)[:, None], now.time_left[:, None], goal], axis=1, dtype=np.float32
        )
        n = columns.shape[1]
        columns.clip(self._low[-n:], self._high[-n:], out=self._observations[:, -n:], where=where[:, None])

    # episodes

    def _seed(self, seed: int | Sequence[int | None] | None, mask: Mask) -> None:
        wanted: Sequence[int | None] = [None] * self.num_envs
        if isinstance(seed, (int, np.integer)):
            wanted = [int(seed) + i for i in range(self.num_envs)]
        elif seed is not None:
            wanted = _checked_seeds(seed, self.num_envs)
        if self._generators is None:
            made = [seeding.np_random(each) for each in wanted]
            self._generators, self._seeds = [g for g, _ in made], [s for _, s in made]
            return
        renewed = {i: seeding.np_random(wanted[i]) for i in np.flatnonzero(mask).tolist() if wanted[i] is not None}
        for i, (generator, used) in renewed.items():
            self._generators[i], self._seeds[i] = generator, used

    def _start(self, mask: Mask) -> None:
        """Start new episodes where the mask is true, and observe them."""
        assert self._generators is not None
        begun = np.flatnonzero(mask)
        self.control.couple[begun] = 0.0
        self.elapsed[begun] = 0
        self.activations[begun] = self.levels[begun] = 0.0
        self._ended[begun] = False
        for i in begun.tolist():
            levels = self._sample_initial_state(self._generators[i], self.body, self.state, i)
            if levels is not None:
                self.activations[i] = self.levels[i] = levels
            # a step of zero duration moves nothing, but computes curvature and contact for the sensors
            advance(self.body.model, self.state, self.control, i, i + 1, 0.0, 1)
            self.state.step[i] = 0
        self._sense(begun)
        for old, new in zip(self._before, self.pose, strict=True):
            old[begun] = new[begun]
        now = self.situation()
        for i in begun.tolist():
            self.goal[i] = self.task.sample_goal(self._generators[i], now.only(slice(i, i + 1)))
        self.progress[begun] = 0.0
        self._follow(now, mask)
        self._progress_before[begun] = self.progress[begun]
        self._distance[begun] = self.task.distance(now)[begun]
        self._observe(now, mask)

    def _first_info(self) -> dict[str, Any]:
        """Return the info of new episodes: the keys of every step, with zero rewards."""
        n = self.num_envs
        return {
            **{f"reward_{name}": np.zeros(n) for name in self.weights},
            "distance": self._distance.copy(),
            "is_success": np.zeros(n, dtype=bool),
            "termination_reason": np.full(n, TerminationReason.RUNNING, dtype=np.int64),
        }

    def _begin_info(self, begun: Mask, info: dict[str, Any]) -> None:
        """Overwrite the info of the last step with that of the episodes that have just begun."""
        for name, first in self._first_info().items():
            info[name][begun] = first[begun]

    def _restart(self, ended: Mask, info: dict[str, Any]) -> dict[str, Any]:
        """Start new episodes where old ones ended, with the last observation in the info (SAME_STEP)."""
        aside = {name: value.copy() for name, value in info.items()}
        final = {"final_obs": self._observations.copy(), "final_info": aside | {f"_{name}": ended for name in aside}}
        self._start(ended)
        self._begin_info(ended, info)
        masks = {f"_{name}": np.ones(self.num_envs, dtype=bool) for name in info}
        return {**info, **masks, **final, **{f"_{name}": ended for name in final}}

    # checkpoints

    def get_state(self) -> dict[str, Any]:
        """Return copies of everything that determines the future; `set_state` continues from it bit for bit."""
        return deepcopy(
            {
                "made_as": self._made_as(),
                "physics": {name: getattr(self.state, name) for name in PHYSICAL_STATE},
                "control": tuple(self.control),
                "episodes": {name: getattr(self, name) for name in _EPISODE_STATE},
                "poses": [tuple(self.pose), tuple(self._before)],
                "generators": None if self._generators is None else [g.bit_generator.state for g in self._generators],
                "seeds": self._seeds,
            }
        )

    def _made_as(self) -> dict[str, Any]:
        names = ("spread", "num_envs", "control_dt", "sim_dt", "duration", "max_episode_steps")
        elements = self.body.model.n_elements.tolist()
        return {"task": self.task.name, "n_elements": elements, **{name: getattr(self, name) for name in names}}

    def set_state(self, saved: dict[str, Any]) -> None:
        """Continue from a result of `get_state`, here or in another process.

        Raises
        ------
        ValueError
            If it comes from an environment with a different task, size, body or time step.
        """
        for name, mine in self._made_as().items():
            if (other := saved["made_as"].get(name)) != mine:
                raise ValueError(f"the state is of an environment whose {name} is {other}; here it is {mine}")
        for array, value in zip(self.control, saved["control"], strict=True):
            array[...] = value
        for name, value in saved["physics"].items():
            getattr(self.state, name)[...] = value
        for name in _EPISODE_STATE:
            getattr(self, name)[...] = saved["episodes"][name]
        for pose, values in zip((self.pose, self._before), saved["poses"], strict=True):
            for mine, value in zip(pose, values, strict=True):
                mine[...] = value
        self._seeds, self._generators = list(saved["seeds"]), None
        if saved["generators"] is not None:
            self._generators = [np.random.Generator(np.random.PCG64(0)) for _ in range(self.num_envs)]
            for generator, state in zip(self._generators, saved["generators"], strict=True):
                generator.bit_generator.state = state

    # for observers

    @property
    def termination_reasons(self) -> tuple[str, ...]:
        """Names of the reasons, indexed by ``termination_reason`` in the info; see `Task`."""
        return self.task.termination_reasons

    @property  # type: ignore[misc]
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override]
        """The generator of each environment; none before the first reset."""
        return tuple(self._generators or ())

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override]
        """The seed of each generator."""
        return tuple(self._seeds)

    @property
    def target(self) -> Array | None:
        """The targets' positions in the lab [m], (B, 3), or None if the task has none."""
        return self.task.target(self.task.goal_type(*self.goal.T))


_EPISODE_STATE = (
    "goal",
    "progress",
    "_progress_before",
    "elapsed",
    "activations",
    "levels",
    "_observations",
    "_distance",
    "_ended",
)


def _require_count(name: str, value: int, most: int) -> None:
    if not isinstance(value, (int, np.integer)) or not 1 <= value <= most:
        raise ValueError(f"{name} must be a whole number from 1 to {most}, not {value!r}")


def _require_size(size: tuple[int, int]) -> None:
    counts = [n for n in size if isinstance(n, (int, np.integer)) and 1 <= n <= 2048] if np.iterable(size) else []
    if len(counts) != 2 or len(size) != 2:
        raise ValueError(f"render_size must be a width and a height from 1 to 2048, whole numbers, not {size!r}")


def _autoreset_mode(mode: AutoresetMode | str) -> AutoresetMode:
    try:
        return AutoresetMode(mode)
    except ValueError:
        allowed = ", ".join(repr(each.value) for each in AutoresetMode)
        raise ValueError(f"autoreset_mode must be an AutoresetMode or one of {allowed}, not {mode!r}") from None


def _merge_weights(task: Task, changed: dict[str, float]) -> dict[str, float]:
    for name, value in changed.items():
        if name not in task.reward_weights:
            raise ValueError(f"weights has no term {name!r}; there are {', '.join(task.reward_weights)}")
        if not isinstance(value, (int, float)) or not np.isfinite(value):
            raise ValueError(f"weights[{name!r}] must be a finite number, not {value!r}")
    return {**task.reward_weights, **changed}


def _reset_mask(options: dict[str, Any], num_envs: int) -> Mask:
    for name in options:
        if name != "reset_mask":
            raise ValueError(f"options has no {name!r}; there is 'reset_mask'")
    mask = np.asarray(options.get("reset_mask", np.ones(num_envs, dtype=bool)))
    if mask.shape != (num_envs,) or mask.dtype != np.bool_ or not mask.any():
        raise ValueError(f"reset_mask must be {num_envs} booleans, at least one of them true, not {mask!r}")
    return mask


def _checked_seeds(seeds: Sequence[int | None], num_envs: int) -> list[int | None]:
    listed = list(seeds) if isinstance(seeds, Sequence) or np.ndim(seeds) == 1 else []
    if len(listed) != num_envs or not all(each is None or isinstance(each, (int, np.integer)) for each in listed):
        raise ValueError(f"seed must be a whole number or {num_envs} of them, any of which may be None, not {seeds!r}")
    return [None if each is None else int(each) for each in listed]
