"""Small functions that scripts import from PyElastica's `utils`."""

from collections.abc import Iterable, Iterator
from itertools import islice
from math import isqrt
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np

from ..engine.model import Array

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

T = TypeVar("T")

__all__ = ["MaxDimension", "Tolerance", "extend_instance", "grouper", "isqrt", "perm_parity"]


class MaxDimension:
    """The dimension of space."""

    @staticmethod
    def value() -> Literal[3]:
        """Return 3."""
        return 3


class Tolerance:
    """Tolerances below which differences are ignored."""

    @staticmethod
    def atol() -> float:
        """Return the absolute tolerance."""
        return float(np.finfo(np.float64).eps * 1e4)

    @staticmethod
    def rtol() -> float:
        """Return the relative tolerance."""
        return float(np.finfo(np.float64).eps * 1e11)


def perm_parity(lst: list[int]) -> int:
    """Return 1 if a permutation of 0, 1, ... is even, -1 if it is odd, and sort it in place."""
    parity = 1
    for place in range(len(lst)):
        # each swap puts one number in its place
        while (number := lst[place]) != place:
            lst[place], lst[number] = lst[number], number
            parity = -parity
    return parity


def grouper(iterable: Iterable[T], n: int) -> Iterator[tuple[T, ...]]:
    """Yield the elements of an iterable in tuples of n; the last may be shorter."""
    rest = iter(iterable)
    while group := tuple(islice(rest, n)):
        yield group


def extend_instance(obj: Any, cls: type) -> None:
    """Add ``cls`` as the first base class of one object."""
    kind = type(obj)
    obj.__class__ = type(kind.__name__, (cls, kind), {})


def _bspline(t_coeff: Array, l_centerline: float = 1.0) -> "tuple[BSpline, Array, Array]":
    """Return a cubic spline along a rod, its control points and coefficients.

    Parameters
    ----------
    t_coeff : Array
        Control coefficients, the first and last at the ends, (n,) with n at least 4.
    l_centerline : float
        Length of the rod [m].
    """
    return __bspline_impl__(l_centerline * np.linspace(0.0, 1.0, t_coeff.shape[0] - 2), t_coeff, 3)


def __bspline_impl__(  # noqa: N807
    x_pts: Array, t_c: Array, degree: int
) -> "tuple[BSpline, Array, Array]":
    """Return a spline with given knots, the outer ones repeated, and the knots and coefficients."""
    # imported here: this import is slow
    from scipy.interpolate import BSpline

    knots = np.concatenate([np.full(degree, x_pts[0]), x_pts, np.full(degree, x_pts[-1])])
    return BSpline(knots, t_c, degree, extrapolate=False), x_pts, t_c
