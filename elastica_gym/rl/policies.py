"""Policies behind one interface: zero, random, scripted, and trained runs."""

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
"""A network is always evaluated on this many rows at once: matrix products of other sizes round differently, and what
an episode does must not depend on how many others run beside it."""


class Policy(Protocol):
    """What evaluation asks of a policy."""

    def reset(self, seeds: Sequence[int]) -> None:
        """Begin one episode in each environment; `seeds` has one seed per environment."""

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return the actions (n, A) for `observations` (n, d) of the environment `batch`."""


class ZeroPolicy:
    """Every muscle at rest."""

    def reset(self, seeds: Sequence[int]) -> None:
        """Nothing to begin."""

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return zeros."""
        return np.zeros((batch.num_envs, *batch.single_action_space.shape), np.float32)


class RandomPolicy:
    """Actions drawn uniformly, afresh at every control step, from a generator per episode."""

    def reset(self, seeds: Sequence[int]) -> None:
        """Seed one generator per environment, not that which draws its start."""
        self._generators = [np.random.default_rng([seed, 1]) for seed in seeds]

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return uniform draws from [-1, 1]."""
        shape = batch.single_action_space.shape
        return np.stack([rng.uniform(-1.0, 1.0, shape) for rng in self._generators]).astype(np.float32)


class FullStrengthPolicy:
    """Every muscle at full strength: groups of one arm and direction pull together, in signs drawn every 0.4 s."""

    HOLD = 8
    """Control steps between two draws"""

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
    """A script, which may look at the whole state.

    Parameters
    ----------
    script
        From a batch, its actions (n, A); by default the task's own.
    """

    def __init__(self, script: Callable[[Any], np.ndarray] | None = None):
        self._script = script

    def reset(self, seeds: Sequence[int]) -> None:
        """Nothing to begin: a script looks at the clock of its environment."""

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return what the script does."""
        return (self._script or scripted_policy(batch.task))(batch).astype(np.float32)


@dataclasses.dataclass(frozen=True)
class Statistics:
    """The normalisation of observations of a ``VecNormalize``, without the rest of it; its fields are arrays (d,)."""

    mean: np.ndarray
    variance: np.ndarray
    epsilon: float
    clip: float

    def normalize_obs(self, observations: np.ndarray) -> np.ndarray:
        """Return observations with mean 0 and variance 1, clipped, as ``VecNormalize`` computes them."""
        scaled = (observations - self.mean) / np.sqrt(self.variance + self.epsilon)
        return np.clip(scaled, -self.clip, self.clip).astype(np.float32)


class TrainedPolicy:
    """A Stable-Baselines3 model with the normalisation it was trained with; its mean action, without exploration.

    Parameters
    ----------
    model
        A PPO or SAC model.
    normalization
        The ``VecNormalize`` of its training, or its `Statistics`, or None.
    """

    def __init__(self, model: Any, normalization: Any | None):
        self.model = model
        self.normalization = normalization

    def reset(self, seeds: Sequence[int]) -> None:
        """Nothing to begin: the network has no memory."""

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
    """Load a run's final model, or while there is none, that of its last whole checkpoint.

    Parameters
    ----------
    run
        A folder that ``python -m agents.train`` wrote, or one with its ``config.yml``, ``model.zip`` and, if it
        normalises, ``vecnormalize.pkl``.

    Returns
    -------
    policy
        The model with its normalisation.
    config
        What the run was started with: ``env``, ``algo``, ``hyperparameters`` and more.
    """
    from .checkpoints import last_whole_checkpoint

    config = read_config(run)
    folder = run if (run / "model.zip").exists() else last_whole_checkpoint(run / "checkpoints")
    if folder is None:
        raise BadInputError(f"The run {run} has neither a model.zip nor a whole checkpoint.")
    model = load_model(folder / "model.zip", config["algo"])
    normalize = normalize_arguments(config["hyperparameters"])
    sees_scaled = normalize is not None and normalize.get("norm_obs", True)
    normalization = load_normalization(folder / "vecnormalize.pkl") if sees_scaled else None
    return TrainedPolicy(model, normalization), config


def read_config(run: Path) -> dict[str, Any]:
    """Return what ``config.yml`` of the run says."""
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
    """Load a Stable-Baselines3 model; `arguments` go to its ``load``."""
    use_one_thread()
    try:
        return algorithm_class(algo).load(path, device="cpu", **arguments)
    except Exception as error:  # a damaged archive fails in as many ways as there are bytes in it
        raise BadInputError(f"The model {path} is missing or damaged: {type(error).__name__}: {error}") from error


def use_one_thread() -> None:
    """Let torch compute on one thread.

    Networks this small gain nothing from a second thread, and lose much where other processes keep it waiting.
    """
    import torch

    torch.set_num_threads(1)


def load_normalization(path: Path) -> Any:
    """Load a ``VecNormalize`` without environments."""
    try:
        return pickle.loads(path.read_bytes())
    except Exception as error:  # as above
        raise BadInputError(f"The statistics {path} are missing or damaged: {type(error).__name__}: {error}") from error
