"""Policies with a common interface: zero, random, scripted, and trained."""

import dataclasses
import pickle
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import yaml

from ..bodies.muscles import N_FUNCTIONS
from ..console.bad_input import BadInputError, choose
from ..scripted import scripted_policy
from ..scripted.gaits import seed_gait
from .hyperparameters import algorithm_class, normalize_arguments

BASELINES = ("zero", "random", "scripted", "seed_gait")

ROWS_PER_FORWARD = 64
"""Batch size of every forward pass: matrix products of other sizes round differently, and an episode must not depend on
the number of parallel episodes."""


class Policy(Protocol):
    """The interface of a policy."""

    def reset(self, seeds: Sequence[int]) -> None:
        """Begin one episode in each environment, with one seed each."""

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return the actions (n, A) for `observations` (n, d) of the environment `batch`."""


class ZeroPolicy:
    """Every muscle at rest."""

    def reset(self, seeds: Sequence[int]) -> None:
        """Do nothing."""

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return zeros."""
        return np.zeros((batch.num_envs, *batch.single_action_space.shape), np.float32)


class RandomPolicy:
    """Actions drawn uniformly at every control step, from one generator per episode."""

    def reset(self, seeds: Sequence[int]) -> None:
        """Seed one generator per environment, independent of its initial state."""
        self._generators = [np.random.default_rng([seed, 1]) for seed in seeds]

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return uniform draws from [-1, 1]."""
        shape = batch.single_action_space.shape
        return np.stack([rng.uniform(-1.0, 1.0, shape) for rng in self._generators]).astype(np.float32)


class FullStrengthPolicy:
    """Every muscle at full strength; each group of one arm and direction has a common sign, redrawn every 0.4 s."""

    HOLD = 8
    """Control steps between draws"""

    def reset(self, seeds: Sequence[int]) -> None:
        """Seed one generator per environment, as `RandomPolicy` does."""
        self._generators = [np.random.default_rng([seed, 2]) for seed in seeds]
        self._step = 0

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return activations of -1 and 1."""
        if self._step % self.HOLD == 0:
            groups = (batch.body.n_activations // N_FUNCTIONS, 1)
            signs = np.stack([rng.choice([-1.0, 1.0], groups) for rng in self._generators])
            self._actions = np.broadcast_to(signs, (*signs.shape[:2], N_FUNCTIONS)).reshape(len(signs), -1)
        self._step += 1
        return self._actions.astype(np.float32)


class ScriptedPolicy:
    """A script, which has access to the whole state.

    Parameters
    ----------
    script
        Function from a batch to actions (n, A); by default the task's script.
    """

    def __init__(self, script: Callable[[Any], np.ndarray] | None = None):
        self._script = script

    def reset(self, seeds: Sequence[int]) -> None:
        """Do nothing: a script reads the clock of its environment."""

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return the actions of the script."""
        return (self._script or scripted_policy(batch.task))(batch).astype(np.float32)


@dataclasses.dataclass(frozen=True)
class Statistics:
    """The observation statistics of a ``VecNormalize``; arrays are (d,)."""

    mean: np.ndarray
    variance: np.ndarray
    epsilon: float
    clip: float

    def normalize_obs(self, observations: np.ndarray) -> np.ndarray:
        """Scale observations to mean 0 and variance 1 and clip them, like ``VecNormalize``."""
        scaled = (observations - self.mean) / np.sqrt(self.variance + self.epsilon)
        return np.clip(scaled, -self.clip, self.clip).astype(np.float32)


class TrainedPolicy:
    """The mean action, without exploration, of a Stable-Baselines3 model with its normalisation.

    Parameters
    ----------
    model
        A PPO or SAC model.
    normalization
        The ``VecNormalize`` or `Statistics` of its training, or None.
    """

    def __init__(self, model: Any, normalization: Any | None):
        self.model = model
        self.normalization = normalization

    def reset(self, seeds: Sequence[int]) -> None:
        """Do nothing: the network has no memory."""

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return the mean actions of the model."""
        n, d = observations.shape
        if self.normalization is not None:
            observations = self.normalization.normalize_obs(observations)
        padded = np.zeros((-(-n // ROWS_PER_FORWARD) * ROWS_PER_FORWARD, d), np.float32)
        padded[:n] = observations
        blocks = padded.reshape(-1, ROWS_PER_FORWARD, d)
        return np.concatenate([self.model.predict(block, deterministic=True)[0] for block in blocks])[:n]


def baseline(name: str) -> Policy:
    """Return the policy called `name`: zero, random, scripted, or seed_gait, the snake's published gait."""
    match choose("policy", name, BASELINES):
        case "zero":
            return ZeroPolicy()
        case "random":
            return RandomPolicy()
        case "scripted":
            return ScriptedPolicy()
    return ScriptedPolicy(seed_gait)


def load_run(run: Path) -> tuple[TrainedPolicy, dict[str, Any]]:
    """Load a run's final model, or if there is none yet, that of its last intact checkpoint.

    Parameters
    ----------
    run
        A folder written by ``python -m agents.train``, or one with its ``config.yml``, ``model.zip`` and, if it
        normalises, ``vecnormalize.pkl``.

    Returns
    -------
    policy
        The model with its normalisation.
    config
        The run's configuration: ``env``, ``algo``, ``hyperparameters`` and more.
    """
    from .checkpoints import last_whole_checkpoint

    config = read_config(run)
    folder = run if (run / "model.zip").exists() else last_whole_checkpoint(run / "checkpoints")
    if folder is None:
        raise BadInputError(f"The run {run} has neither a model.zip nor an intact checkpoint.")
    model = load_model(folder / "model.zip", config["algo"])
    normalize = normalize_arguments(config["hyperparameters"])
    sees_scaled = normalize is not None and normalize.get("norm_obs", True)
    normalization = load_normalization(folder / "vecnormalize.pkl") if sees_scaled else None
    return TrainedPolicy(model, normalization), config


def read_config(run: Path) -> dict[str, Any]:
    """Return the ``config.yml`` of a run."""
    try:
        config = yaml.safe_load((run / "config.yml").read_text())
    except OSError as error:
        raise BadInputError(f"{run} is not the folder of a run: {error.strerror}: {error.filename}") from error
    except yaml.YAMLError as error:
        raise BadInputError(f"{run / 'config.yml'} is damaged: {error}") from error
    absent = {"env", "algo", "seed", "hyperparameters"} - set(config if isinstance(config, dict) else ())
    if absent:
        raise BadInputError(f"{run / 'config.yml'} is damaged: no {', '.join(sorted(absent))}.")
    return config


def load_model(path: Path, algo: str, **arguments: Any) -> Any:
    """Load a Stable-Baselines3 model; `arguments` are passed to its ``load``."""
    use_one_thread()
    try:
        return algorithm_class(algo).load(path, device="cpu", **arguments)
    except Exception as error:  # a damaged archive can raise almost anything
        raise BadInputError(f"The model {path} is missing or damaged: {type(error).__name__}: {error}") from error


def use_one_thread() -> None:
    """Make torch use one thread.

    Networks this small gain nothing from a second thread, and are slowed down by it on a busy machine.
    """
    import torch

    torch.set_num_threads(1)


def load_normalization(path: Path) -> Any:
    """Load a ``VecNormalize`` without environments."""
    try:
        return pickle.loads(path.read_bytes())
    except Exception as error:  # as above
        raise BadInputError(f"The statistics {path} are missing or damaged: {type(error).__name__}: {error}") from error
