"""Gymnasium's batches of environments, ours or any other, as a Stable-Baselines3 ``VecEnv``."""

import time
from collections.abc import Iterable, Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import VecEnv

import elastica_gym  # noqa: F401  registers the environments

from ..envs.batch import BatchEnv

VecEnvIndices = None | int | Iterable[int]


class BatchVecEnv(VecEnv):
    """A Gymnasium ``VectorEnv`` as a Stable-Baselines3 ``VecEnv``, without a loop over environments.

    Rollouts are bit-identical to those of a ``DummyVecEnv`` of the same environments, each in a ``Monitor``, and seeds.

    Parameters
    ----------
    batch : gymnasium.vector.VectorEnv
        With ``AutoresetMode.SAME_STEP`` and spaces that Stable-Baselines3 supports, such as ``SyncVectorEnv``,
        ``AsyncVectorEnv`` or a batch of this package, with or without Gymnasium's wrappers for vector environments.

    Attributes
    ----------
    batch : gymnasium.vector.VectorEnv
        As given.
    term_keys : tuple of str
        ``reward_<term>`` of every reward term of a batch of this package, else empty.

    Raises
    ------
    TypeError
        If `batch` is not a ``VectorEnv``.
    ValueError
        If its autoreset mode is another.

    Notes
    -----
    The info of an environment has the entries that its masks say are its own. When an episode ends, it is that of the
    last step (``final_info``) with ``terminal_observation``, ``TimeLimit.truncated`` and ``episode``: return ``r``,
    length ``l``, and seconds ``t`` since this object was created. The info of the reset is then in ``reset_infos``.

    For a batch of this package, environments in mid-episode share one info dictionary with nothing but
    ``TimeLimit.truncated``: treat it as read-only. At the end of an episode, ``termination_reason`` is the name of the
    batch's code, ``is_success`` and ``distance`` are as in the last step, and ``episode`` also has ``distance``
    and ``reward_<term>``, the sum of each term over the episode.
    """

    batch: Any
    _actions: np.ndarray

    def __init__(self, batch: VectorEnv):
        _require_same_step(batch)
        self.batch = batch
        super().__init__(batch.num_envs, batch.single_observation_space, batch.single_action_space)
        self.metadata = batch.metadata
        self._animals = batch.unwrapped if isinstance(batch.unwrapped, BatchEnv) else None
        self._running: dict[str, Any] = {"TimeLimit.truncated": False}
        self.term_keys = tuple(f"reward_{term}" for term in self._animals.weights) if self._animals else ()
        self._sums = {key: np.zeros(self.num_envs) for key in ("r", *self.term_keys)}
        self._lengths = np.zeros(self.num_envs, np.int64)
        self._started = time.time()

    def seed(self, seed: int | Sequence[int] | None = None) -> Sequence[int | None]:
        """Seed environment i with ``seed + i``, or with entry i of a sequence, at the next reset."""
        if seed is None or isinstance(seed, (int, np.integer)):
            return super().seed(None if seed is None else int(seed))
        if len(seed) != self.num_envs:
            raise ValueError(f"seed must have one number for each of {self.num_envs} environments, got {len(seed)}")
        self._seeds = list(seed)
        return self._seeds

    def reset(self) -> Any:
        """Reset every environment, with the seeds given to ``seed`` if any, and return the observations.

        Returns
        -------
        np.ndarray or dict of str to np.ndarray
            (n, ...).
        """
        options = self._options[0]
        if any(other != options for other in self._options):
            raise ValueError(f"options must be the same for all environments of a batch, got {self._options}")
        observations, infos = self.batch.reset(seed=_as_one(self._seeds), options=options or None)
        self.reset_infos = [_info_of(infos, i) for i in range(self.num_envs)]
        self._reset_seeds()
        self._reset_options()
        for total in self._sums.values():
            total[:] = 0.0
        self._lengths[:] = 0
        return observations

    def step_async(self, actions: np.ndarray) -> None:
        """Store the actions, one for each environment, for ``step_wait``."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Advance by one step.

        Returns
        -------
        observations
            (n, ...), or a dictionary of them; after the end of an episode, the first of the next.
        rewards
            (n,) float32, as ``DummyVecEnv`` rounds them.
        dones
            (n,) bool.
        infos
            One dictionary per environment; see the notes of the class.
        """
        observations, rewards, terminated, truncated, infos = self.batch.step(self._actions)
        dones = terminated | truncated
        ended = np.flatnonzero(dones)
        last = infos.get("final_info", {}) if ended.size else infos
        self._sums["r"] += rewards
        for key in self.term_keys:
            self._sums[key] += last[key]
        self._lengths += 1
        env_infos = self._running_infos(infos)
        for i in ended.tolist():
            env_infos[i] = self._episode_info(i, bool(truncated[i] and not terminated[i]), _info_of(last, i))
            env_infos[i]["terminal_observation"] = _row_of(infos["final_obs"], i)
            self.reset_infos[i] = _info_of(infos, i, without=("final_obs", "final_info"))
        self._lengths[ended] = 0
        for total in self._sums.values():
            total[ended] = 0.0
        return observations, rewards.astype(np.float32), dones, env_infos

    def _running_infos(self, infos: dict[str, Any]) -> list[dict[str, Any]]:
        if self._animals:
            return [self._running] * self.num_envs
        return [{**_info_of(infos, i), **self._running} for i in range(self.num_envs)]

    def _episode_info(self, i: int, timed_out: bool, last: dict[str, Any]) -> dict[str, Any]:
        episode = {key: float(total[i]) for key, total in self._sums.items()}
        episode |= {"l": int(self._lengths[i]), "t": round(time.time() - self._started, 6)}
        if self._animals:
            last = {key: value for key, value in last.items() if key not in self.term_keys}
            last["termination_reason"] = self._animals.termination_reasons[last["termination_reason"]]
            last["is_success"] = bool(last["is_success"])
            episode["distance"] = float(last["distance"])
        return {**last, "TimeLimit.truncated": timed_out, "episode": episode}

    def get_images(self) -> Sequence[np.ndarray | None]:
        """Render every environment, (height, width, 3) uint8 each, or None without a ``render_mode``."""
        return self.batch.render() or [None] * self.num_envs

    def get_state(self) -> dict[str, Any]:
        """Everything that the next step depends on, picklable; of batches of this package."""
        return {
            "batch": self.batch.get_state(),
            "sums": {key: total.copy() for key, total in self._sums.items()},
            "lengths": self._lengths.copy(),
        }

    def set_state(self, state: dict[str, Any]) -> None:
        """Continue, bit for bit, from what ``get_state`` returned."""
        self.batch.set_state(state["batch"])
        for key, total in state["sums"].items():
            self._sums[key][:] = total
        self._lengths[:] = state["lengths"]

    def close(self) -> None:
        """Close the batch."""
        self.batch.close()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Return an attribute of each of `indices`; the batch's, unless it has an object per environment."""
        batch = self.batch.unwrapped
        each = batch.get_attr(attr_name) if _has_objects(batch) else [getattr(batch, attr_name)] * self.num_envs
        return [each[i] for i in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Set an attribute of all environments."""
        if indices is not None:
            raise ValueError(f"indices must be None: the environments of a batch share {attr_name!r}, got {indices}")
        batch = self.batch.unwrapped
        if _has_objects(batch):
            batch.set_attr(attr_name, [value] * self.num_envs)
        else:
            setattr(batch, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: VecEnvIndices = None, **kwargs: Any) -> list[Any]:
        """Call a method of the batch, or of its object per environment, and return the results for `indices`."""
        batch = self.batch.unwrapped
        if _has_objects(batch):
            each = batch.call(method_name, *args, **kwargs)
        else:
            each = [getattr(batch, method_name)(*args, **kwargs)] * self.num_envs
        return [each[i] for i in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type[gym.Wrapper], indices: VecEnvIndices = None) -> list[bool]:
        """Return whether the environments act as `wrapper_class`; true only for ``Monitor``."""
        return [wrapper_class is Monitor] * len(list(self._get_indices(indices)))


def make_batch_vec_env(env_id: str, *, n_envs: int, n_threads: int = 2, **env_kwargs: Any) -> BatchVecEnv:
    """Make a batch of `n_envs` environments, stepped by `n_threads` threads, for Stable-Baselines3."""
    batch = gym.make_vec(
        env_id, num_envs=n_envs, autoreset_mode=AutoresetMode.SAME_STEP, n_threads=n_threads, **env_kwargs
    )
    return BatchVecEnv(batch)


def _require_same_step(batch: VectorEnv) -> None:
    if not isinstance(batch, VectorEnv):
        raise TypeError(f"batch must be a gymnasium.vector.VectorEnv, not {type(batch).__name__}")
    mode = batch.metadata.get("autoreset_mode")
    if mode != AutoresetMode.SAME_STEP:
        raise ValueError(f"batch has autoreset_mode {mode}; Stable-Baselines3 needs AutoresetMode.SAME_STEP")


def _has_objects(batch: VectorEnv) -> bool:
    """Return whether there is an object per environment."""
    return isinstance(batch, (gym.vector.SyncVectorEnv, gym.vector.AsyncVectorEnv))


def _as_one(seeds: Sequence[int | None]) -> int | list[int | None] | None:
    """Return the integer that Gymnasium spreads to these seeds, None if there are none, or else the seeds.

    Batches with one generator for all environments take only an integer.
    """
    first = seeds[0]
    if all(seed is None for seed in seeds):
        return None
    if first is not None and all(seed == first + i for i, seed in enumerate(seeds)):
        return first
    return list(seeds)


def _info_of(infos: dict[str, Any], i: int, without: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return the info of environment i: what its masks ``_<key>`` mark, and what has no mask."""
    found = {}
    for key, value in infos.items():
        is_mask = key[0] == "_" and key[1:] in infos
        if not is_mask and key not in without and (f"_{key}" not in infos or infos[f"_{key}"][i]):
            found[key] = _info_of(value, i) if isinstance(value, dict) else value[i]
    return found


def _row_of(observations: Any, i: int) -> Any:
    """Return the observation of environment i."""
    if isinstance(observations, dict):
        return {key: value[i] for key, value in observations.items()}
    return observations[i]
