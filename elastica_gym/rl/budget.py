"""How long a run may take."""

import time


class Budget:
    """The limit of a run: environment steps, minutes, or whichever is reached first.

    Parameters
    ----------
    steps
        Environment steps, or None for no limit.
    minutes
        Wall-clock time of training and its evaluations, or None for no limit.
    seconds_before
        Time [s] spent before this process started.
    free_steps
        Environment steps of imitation, which the budget does not count.
    """

    def __init__(self, *, steps: int | None, minutes: float | None, seconds_before: float = 0.0, free_steps: int = 0):
        self.steps = steps
        self.minutes = minutes
        self.free_steps = free_steps
        self._started = time.monotonic() - seconds_before

    @property
    def seconds(self) -> float:
        """Time spent [s]."""
        return time.monotonic() - self._started

    def fraction(self, steps_done: int, *, seconds_ahead: float = 0.0) -> float:
        """Return the fraction of the budget spent, or that will be spent in `seconds_ahead`."""
        by_steps = 0.0
        if self.steps is not None:
            by_steps = (steps_done - self.free_steps) / self.steps if self.steps else 1.0
        by_time = 0.0 if self.minutes is None else (self.seconds + seconds_ahead) / (60.0 * self.minutes)
        return min(1.0, max(by_steps, by_time))
