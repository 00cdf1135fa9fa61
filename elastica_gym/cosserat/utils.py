"""Small things that scripts import from here."""

from math import isqrt
from typing import Literal

__all__ = ["MaxDimension", "Tolerance", "isqrt"]


class MaxDimension:
    """The dimension of space."""

    @staticmethod
    def value() -> Literal[3]:
        """Return 3."""
        return 3


class Tolerance:
    """Below which differences do not count."""

    @staticmethod
    def atol() -> float:
        """Return the absolute tolerance."""
        return 1e-14

    @staticmethod
    def rtol() -> float:
        """Return the relative tolerance."""
        return 1e-5
