"""Policies in Python files. Imports little, since each policy starts a process."""

import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
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

    Raises
    ------
    BadInputError
        When it is used, if the file fails or returns actions of another shape; the message has file and line.
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
        with self._blamed():
            actions = np.stack([np.asarray(policy(observation), dtype=np.float32) for policy, observation in pairs])
        if batch is not None and actions.shape[1:] != batch.single_action_space.shape:
            raise BadInputError(
                f"{self._path} must return actions of shape {batch.single_action_space.shape}, not {actions.shape[1:]}"
            )
        return actions

    def _run(self, number: int) -> Callable[[np.ndarray], Any]:
        spec = spec_from_file_location(f"{self._path.stem}_{number}", self._path)
        assert spec is not None and spec.loader is not None
        module = module_from_spec(spec)
        sys.modules[spec.name] = module
        with self._blamed():
            spec.loader.exec_module(module)
        if not callable(getattr(module, "policy", None)):
            raise BadInputError(f"{self._path} has no function policy(observation)")
        if hasattr(module, "reset"):
            with self._blamed():
                module.reset()
        return module.policy

    @contextmanager
    def _blamed(self) -> Iterator[None]:
        """Turn errors of the file into ``BadInputError`` with their place in it."""
        try:
            yield
        except Exception as error:
            lines = [
                frame.lineno
                for frame in traceback.extract_tb(error.__traceback__)
                if Path(frame.filename) == self._path
            ]
            if isinstance(error, SyntaxError):
                lines = [error.lineno]
            place = f", line {lines[-1]}" if lines else ""
            raise BadInputError(f"{self._path}{place}: {type(error).__name__}: {error}") from error
