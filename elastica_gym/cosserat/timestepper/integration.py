"""Integrate a simulator over time."""

import time as clock
from collections.abc import Callable
from contextlib import nullcontext
from typing import Any

from ...progress import Bar
from ..modules.base_system import BaseSystemCollection
from .symplectic_steppers import SymplecticStepper

ENTRY_TIME = 0.1
"""Longest time in compiled code, so that Ctrl-C works and progress is shown [s]"""


def integrate(
    stepper: SymplecticStepper,
    systems: Any,
    final_time: float,
    n_steps: int = 1000,
    restart_time: float = 0.0,
    progress_bar: bool = True,
) -> float:
    """Run a simulator for a time, and return the time afterwards [s].

    Compiled code is entered once between callbacks, or every tenth of a second.

    Parameters
    ----------
    stepper : SymplecticStepper
        Such as ``PositionVerlet()``.
    systems : BaseSystemCollection
        A finalized simulator, or a single rod outside any simulator.
    final_time : float
        Duration [s]; the time step is ``final_time / n_steps``.
    n_steps : int
        Number of steps.
    restart_time : float
        Start time [s].
    progress_bar : bool
        Whether to show progress on standard error.
    """
    if not final_time > 0.0:
        raise ValueError(f"final_time must be a positive number, not {final_time}")
    if not int(n_steps) > 0:
        raise ValueError(f"n_steps must be a positive integer, not {n_steps}")
    n_steps, dt, time = int(n_steps), float(final_time) / int(n_steps), float(restart_time)
    simulation = _collection(systems).simulation
    done, most = 0, 1
    with Bar("integrating") if progress_bar else nullcontext() as bar:
        while done < n_steps:
            number = round(time / dt)
            count = min(n_steps - done, simulation.callbacks.steps_to_next(number), most)
            started = clock.perf_counter()
            time = simulation.advance(stepper.scheme, dt, count, time)
            most = max(1, int(count * ENTRY_TIME / max(clock.perf_counter() - started, 1e-9)))
            simulation.warn_of_divergence()
            simulation.callbacks.call(time, round(time / dt))
            simulation.clear_loads()
            done += count
            if bar is not None:
                bar.show(done / n_steps, {"steps": done, "time": time})
    return time


def extend_stepper_interface(stepper: SymplecticStepper, systems: Any) -> tuple[Callable, Any]:
    """Return ``do_step`` and its argument ``stages``, for scripts with their own loop."""
    return stepper.do_step, stepper.steps_and_prefactors


def _collection(systems: Any) -> BaseSystemCollection:
    if isinstance(systems, BaseSystemCollection):
        return systems
    alone = BaseSystemCollection()
    alone.append(systems)
    alone.finalize()
    return alone
