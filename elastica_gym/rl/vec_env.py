"""The batched environment as a Stable-Baselines3 ``VecEnv``."""

import time
from collections.abc import Iterable, Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import VecEnv

import elastica_gym  # noqa: F401  registers the environments

VecEnvIndices = None | int | Iterable[int]


class BatchVecEnv(VecEnv):
    """A batch of environments as a ``VecEnv``.

    Rollouts are bit-identical to those of a ``DummyVecEnv`` of the same environments and seeds. Like ``Monitor``, it
    sums the reward, and also every reward term, over the episode.

    Parameters
    ----------
    batch
        An ``elastica_gym`` environment made by ``gymnasium.make_vec`` with ``AutoresetMode.SAME_STEP``.

    Attributes
    ----------
    term_keys : tuple of str
        ``reward_<term>`` of every reward term.

    Notes
    -----
    Environments in mid-episode share one info dictionary: treat it as read-only. When an episode ends, its environment
    gets a separate one with ``terminal_observation``, ``TimeLimit.truncated``, ``is_success``, ``termination_reason``
    (the name of the batch's code), ``distance`` and ``episode``: return ``r``, length ``l``, seconds ``t`` since this
    object was created, ``distance``, and ``reward_<term>``, the sum of each term over the episode.
    """

    def __init__(self, batch: Any):
        mode = batch.metadata["autoreset_mode"]
        if mode != AutoresetMode.SAME_STEP:
            raise ValueError(f"batch has autoreset_mode {mode}; Stable-Baselines3 needs AutoresetMode.SAME_STEP")
        self.batch = batch
        super().__init__(batch.num_envs, batch.single_observation_space, batch.single_action_space)
        self.metadata = batch.metadata
        self._actions: np.ndarray = np.zeros((self.num_envs, *self.action_space.shape), np.float32)  # type: ignore[misc]
        self._running: dict[str, Any] = {"TimeLimit.truncated": False}
        self.term_keys = tuple(f"reward_{term}" for term in batch.weights)
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

    def reset(self) -> np.ndarray:
        """Reset every environment, with the seeds given to ``seed`` if any, and return observations (n, d) float32."""
        seeds = None if all(s is None for s in self._seeds) else list(self._seeds)
        options = self._options[0]
        if any(other != options for other in self._options):
            raise ValueError(f"options must be the same for all environments of a batch, got {self._options}")
        observations, infos = self.batch.reset(seed=seeds, options=options or None)
        self.reset_infos = [{key: value[i] for key, value in infos.items()} for i in range(self.num_envs)]
        self._reset_seeds()
        self._reset_options()
        for total in self._sums.values():
            total[:] = 0.0
        self._lengths[:] = 0
        return observations

    def step_async(self, actions: np.ndarray) -> None:
        """Store the actions, (n, 42), for ``step_wait``."""
        self._actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Advance by one control step.

        Returns
        -------
        observations
            (n, d) float32; after the end of an episode, the first observation of the next.
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
        last = infos["final_info"] if ended.size else infos
        self._sums["r"] += rewards
        for key in self.term_keys:
            self._sums[key] += last[key]
        self._lengths += 1
        env_infos = [self._running] * self.num_envs
        for i in ended.tolist():
            env_infos[i] = self._episode_info(i, bool(truncated[i] and not terminated[i]), infos)
        self._lengths[ended] = 0
        for total in self._sums.values():
            total[ended] = 0.0
        return observations, rewards.astype(np.float32), dones, env_infos

    def _episode_info(self, i: int, timed_out: bool, infos: dict[str, Any]) -> dict[str, Any]:
        last = {key: infos["final_info"][key][i] for key in ("is_success", "termination_reason", "distance")}
        last["termination_reason"] = self.batch.termination_reasons[last["termination_reason"]]
        episode = {key: float(total[i]) for key, total in self._sums.items()}
        episode |= {"l": int(self._lengths[i]), "t": round(time.time() - self._started, 6)}
        episode["distance"] = float(last["distance"])
        return {
            **last,
            "is_success": bool(last["is_success"]),
            "TimeLimit.truncated": timed_out,
            "terminal_observation": infos["final_obs"][i],
            "episode": episode,
        }

    def get_images(self) -> Sequence[np.ndarray | None]:
        """Render every environment, (height, width, 3) uint8 each, or None without a ``render_mode``."""
        return self.batch.render() or [None] * self.num_envs

    def get_state(self) -> dict[str, Any]:
        """Everything that the next step depends on, picklable."""
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
        """Return the batch's attribute, once for each of `indices`."""
        return [getattr(self.batch, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Set the batch's attribute, which all environments share."""
        if indices is not None:
            raise ValueError(f"indices must be None: the environments of a batch share {attr_name!r}, got {indices}")
        setattr(self.batch, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: VecEnvIndices = None, **kwargs: Any) -> list[Any]:
        """Call the batch's method once, and return its result for each of `indices`."""
        return [getattr(self.batch, method_name)(*args, **kwargs)] * len(list(self._get_indices(indices)))

    def env_is_wrapped(self, wrapper_class: type[gym.Wrapper], indices: VecEnvIndices = None) -> list[bool]:
        """Return whether the environments act as `wrapper_class`; true only for ``Monitor``."""
        return [wrapper_class is Monitor] * len(list(self._get_indices(indices)))


def make_batch_vec_env(env_id: str, *, n_envs: int, n_threads: int = 2, **env_kwargs: Any) -> BatchVecEnv:
    """Make a batch of `n_envs` environments, stepped by `n_threads` threads, for Stable-Baselines3."""
    batch = gym.make_vec(
        env_id, num_envs=n_envs, autoreset_mode=AutoresetMode.SAME_STEP, n_threads=n_threads, **env_kwargs
    )
    return BatchVecEnv(batch)
