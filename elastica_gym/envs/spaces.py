"""Spaces that say what their numbers are."""

from typing import Any

from gymnasium.spaces import Box
from numpy.typing import NDArray

from ..bodies.mirror import Mirror


class NamedBox(Box):
    """The observations or the actions of an animal, whose numbers have names.

    A `gymnasium.spaces.Box` in all else, and equal to one of the same bounds.

    Parameters
    ----------
    low, high : NDArray
        Least and largest values, (d,) float32.
    names : tuple of str
        What the d numbers are.
    mirror : Mirror or None
        In which the animal is its own image; ``mirror.image(names)`` says what its numbers become there.
    duration : float
        Simulated time of an episode [s], which ``time_left`` is a part of.
    """

    def __init__(
        self, low: NDArray[Any], high: NDArray[Any], *, names: tuple[str, ...], mirror: Mirror | None, duration: float
    ) -> None:
        super().__init__(low, high, dtype=low.dtype)
        self.names, self.mirror, self.duration = names, mirror, duration
