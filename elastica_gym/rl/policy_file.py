"""Policies in Python files. Imports little, since each policy starts a process."""

import sys
from collections.abc import Callable, Sequence
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import numpy as np

from ..console.bad_input import BadInputError


class FilePolicy:
    """A Python file with a function ``policy(observation)``, from an observation (d,) to an action (42,).

    The file is executed once per episode, so global variables are its memory of that episode. If it has a function
    ``reset()``, that is called at the start of the episode.

    Parameters
    ----------
    path
        The file.
    """

    def __init__(self, path: Path):
        self._path = path
        self._episodes: list[Callable[[np.ndarray], Any]] = []
        # the file may import modules next to it
        sys.path.insert(0, str(path.resolve().parent))

    def reset(self, seeds: Sequence[int]) -> None:
        """Execute the file once per seed; the seeds themselves are not passed on."""
        self._episodes = [self._run(i) for i in range(len(seeds))]

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return the actions (n, 42) for observations (n, d)."""
        pairs = zip(self._episodes, observations, strict=True)
        return np.stack([np.asarray(policy(observation), dtype=np.float32) for policy, observation in pairs])

    def _run(self, number: int) -> Callable[[np.ndarray], Any]:
        spec = spec_from_file_location(f"{self._path.stem}_{number}", self._path)
        assert spec is not None and spec.loader is not None
        module = module_from_spec(spec)
        sys.modules[spec.name] = module
        spec.loader.exec_module(module)
        if not callable(getattr(module, "policy", None)):
            raise BadInputError(f"{self._path} has no function policy(observation)")
        if hasattr(module, "reset"):
            module.reset()
        return module.policy
