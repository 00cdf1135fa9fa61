"""Compiled code on several threads; it runs without Python's global lock."""

import functools
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import numpy as np

from .jit.compiler import Bound
from .kernels.step import advance_queue
from .model import Control, Index, Model, State

Result = TypeVar("Result")
APART = 5
"""Stride between environments taken in turn: prefetching CPUs would fetch adjacent memory that another one writes"""


def available_cpus() -> int:
    """Return how many CPUs this process may run on, possibly fewer than the machine has."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def side_by_side(functions: Sequence[Callable[[], Result]]) -> list[Result]:
    """Call functions concurrently, the first in this thread, and return their results."""
    pool = _pool(os.getpid(), len(functions) - 1)
    futures = [pool.submit(function) for function in functions[1:]]
    try:
        first = functions[0]()
    finally:
        # also after Ctrl-C: no thread may still write when this returns or raises
        for future in futures:
            future.exception()
    return [first, *(future.result() for future in futures)]


class Team:
    """Threads that advance the environments of a State.

    Parameters
    ----------
    model : Model
    state : State
    control : Control
    n_threads : int
        Maximum number of threads.
    """

    def __init__(self, model: Model, state: State, control: Control, n_threads: int) -> None:
        self._advance = Bound(advance_queue, model, state, control)
        self._n_threads = n_threads

    def advance(self, n_envs: int, dt: float, n_substeps: int, then: Callable[[Index], None] | None = None) -> None:
        """Advance the first environments, as `advance` does.

        Each thread then calls ``then``, if given, with the environments that it has advanced, (k,).
        """
        order, queue = _order(n_envs), np.zeros(1, dtype=np.int64)

        def work() -> None:
            mine = np.empty_like(order)
            n_mine = self._advance(order, queue, dt, n_substeps, mine)
            if then is not None:
                then(mine[:n_mine])

        side_by_side([work] * max(1, min(self._n_threads, n_envs)))


@functools.lru_cache(maxsize=8)
def _order(n_envs: int) -> Index:
    """Return the order in which environments are taken; do not modify it."""
    return np.argsort(np.arange(n_envs) % APART, kind="stable")


@functools.lru_cache(maxsize=8)
def _pool(process: int, n_threads: int) -> ThreadPoolExecutor:
    """Return this process's threads; a forked child creates its own, as threads do not survive a fork."""
    return ThreadPoolExecutor(max_workers=max(1, n_threads), thread_name_prefix="elastica_gym")
