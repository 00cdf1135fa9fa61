"""Statistics of training episodes, without bias towards short ones."""

from collections import deque
from typing import Any

import numpy as np
from stable_baselines3.common.callbacks import BaseCallback


class Episodes(BaseCallback):
    """Collects the episodes of a batch while an algorithm steps it.

    Short episodes, such as successes, end first, so a mean over ended episodes is biased towards them. An episode
    therefore counts only once the longest possible episode that began at the same step would have ended, and means
    are over the last `window` of these, ordered by when they began.

    Parameters
    ----------
    longest
        Control steps of the longest episode.
    window
        Number of episodes to average over.
    """

    def __init__(self, *, longest: int, window: int):
        super().__init__()
        self._longest, self._window = longest, window
        self._steps = 0
        self._ended: deque[tuple[int, dict[str, float]]] = deque()

    def _on_step(self) -> bool:
        self.add(self.locals["infos"])
        return True

    def add(self, infos: list[dict[str, Any]]) -> None:
        """Add the infos of all environments at one control step."""
        self._steps += 1
        for info in infos:
            if "episode" in info:
                told = {**info["episode"], "success": float(info["is_success"])}
                self._ended.append((self._steps - int(told["l"]), told))

    def settled(self) -> list[dict[str, float]]:
        """Return the last episodes, by when they began, that began at least `longest` steps ago."""
        last = self._steps - self._longest
        whole = sorted((each for each in self._ended if each[0] <= last), key=lambda each: each[0])[-self._window :]
        self._ended = deque([*whole, *(each for each in self._ended if each[0] > last)])
        return [told for _, told in whole]

    def mean(self, name: str) -> float:
        """Return the mean of a quantity over the settled episodes, NaN if there are none."""
        values = [told[name] for told in self.settled()]
        return float(np.mean(values)) if values else float("nan")

    def get_state(self) -> tuple[int, list[tuple[int, dict[str, float]]]]:
        """Return the state for a checkpoint."""
        return self._steps, list(self._ended)

    def set_state(self, state: tuple[int, list[tuple[int, dict[str, float]]]]) -> None:
        """Restore the state that `get_state` returned."""
        self._steps, self._ended = state[0], deque(state[1])
