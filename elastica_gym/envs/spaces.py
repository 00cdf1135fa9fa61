"""Spaces whose numbers have names."""

from typing import Any

from gymnasium.spaces import Box
from numpy.typing import NDArray

from ..bodies.mirror import Mirror


class NamedBox(Box):
    """The observations or the actions of an animal, whose numbers have names.

    Otherwise a `gymnasium.spaces.Box`, and equal to one with the same bounds.

    Parameters
    ----------
    low, high : NDArray
        Least and largest values, (d,) float32.
    names : tuple of str
        Names of the d numbers.
    mirror : Mirror or None
        In which the animal is its own image; ``mirror.image(names)`` returns how the numbers transform.
    duration : float
        Simulated time of an episode [s], of which ``time_left`` is a fraction.
    """

    def __init__(
        self, low: NDArray[Any], high: NDArray[Any], *, names: tuple[str, ...], mirror: Mirror | None, duration: float
    ) -> None:
        super().__init__(low, high, dtype=low.dtype)
        self.names, self.mirror, self.duration = names, mirror, duration
