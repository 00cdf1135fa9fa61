"""What the episodes of a training came to, without favour for those that end soon."""

from collections import deque
from typing import Any

import numpy as np
from stable_baselines3.common.callbacks import BaseCallback


class Episodes(BaseCallback):
    """Collects the episodes of a batch while an algorithm steps it.

    Episodes that end soon, as with success, are the first to be known: until those that began with them have ended too,
    a mean over the known ones is one over the soon ended. So an episode counts from when even the longest that began
    at the same step has ended, and means are over the last ones by their beginning.

    Parameters
    ----------
    longest
        Control steps of the longest episode.
    window
        How many episodes to take the mean over.
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
        """Take what the environments, which begun together, told at one control step."""
        self._steps += 1
        for info in infos:
            if "episode" in info:
                told = {**info["episode"], "success": float(info["is_success"])}
                self._ended.append((self._steps - int(told["l"]), told))

    def settled(self) -> list[dict[str, float]]:
        """Return the last episodes, by their beginning, of those of whose beginning no episode is still running."""
        last = self._steps - self._longest
        whole = sorted((each for each in self._ended if each[0] <= last), key=lambda each: each[0])[-self._window :]
        self._ended = deque([*whole, *(each for each in self._ended if each[0] > last)])
        return [told for _, told in whole]

    def mean(self, name: str) -> float:
        """Return the mean of one of the numbers of the settled episodes, NaN where there are none."""
        values = [told[name] for told in self.settled()]
        return float(np.mean(values)) if values else float("nan")

    def get_state(self) -> tuple[int, list[tuple[int, dict[str, float]]]]:
        """Return all that is known, to be put into a checkpoint."""
        return self._steps, list(self._ended)

    def set_state(self, state: tuple[int, list[tuple[int, dict[str, float]]]]) -> None:
        """Go on from what `get_state` returned."""
        self._steps, self._ended = state[0], deque(state[1])
