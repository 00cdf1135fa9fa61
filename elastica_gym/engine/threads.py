"""Compiled code on several threads: it does not hold Python's lock while it runs."""

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
"""From one environment to the next that is taken: a CPU reads ahead, and would fetch what another writes beside"""


def available_cpus() -> int:
    """Return how many CPUs this process may run on, which may be fewer than there are."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def side_by_side(functions: Sequence[Callable[[], Result]]) -> list[Result]:
    """Call functions at the same time, the first in this thread, and return what they return."""
    pool = _pool(os.getpid(), len(functions) - 1)
    futures = [pool.submit(function) for function in functions[1:]]
    try:
        first = functions[0]()
    finally:
        # also after Ctrl-C: when this returns or raises, nobody writes any more
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
        How many there are at most.
    """

    def __init__(self, model: Model, state: State, control: Control, n_threads: int) -> None:
        self._advance = Bound(advance_queue, model, state, control)
        self._n_threads = n_threads

    def advance(self, n_envs: int, dt: float, n_substeps: int, then: Callable[[Index], None] | None = None) -> None:
        """Advance the first environments, as `advance` does.

        Each thread then calls ``then``, if it is given, with those that it has advanced, (k,).
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
    """Return the order in which environments are taken; not to be changed."""
    return np.argsort(np.arange(n_envs) % APART, kind="stable")


@functools.lru_cache(maxsize=8)
def _pool(process: int, n_threads: int) -> ThreadPoolExecutor:
    """Return this process's threads; a forked child makes its own, for its parent's did not come along."""
    return ThreadPoolExecutor(max_workers=max(1, n_threads), thread_name_prefix="elastica_gym")
