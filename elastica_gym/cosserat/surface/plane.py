"""A plane for contact."""

import numpy as np
from numpy.typing import ArrayLike

from ...engine.rod import three
from .surface_base import SurfaceBase

UNIT = 1e-12
"""Deviation of a normal's length from 1 up to which it is not normalised"""


class Plane(SurfaceBase):
    """A fixed plane.

    Parameters
    ----------
    plane_origin : array_like
        A point on it [m], (3,); changes to an array between runs or callbacks take effect.
    plane_normal : array_like
        Towards the free side, of any length, (3,). Changes to an array of unit length take effect too.

    Attributes
    ----------
    origin : Array
        (3, 1)
    normal : Array
        Of unit length, (3,).
    """

    def __init__(self, plane_origin: ArrayLike, plane_normal: ArrayLike) -> None:
        self.origin = three("plane_origin", plane_origin).reshape(3, 1)
        normal = three("plane_normal", plane_normal)
        size = float(np.linalg.norm(normal))
        if size == 0.0:
            raise ValueError("plane_normal must not be zero")
        self.normal = normal if abs(size - 1.0) < UNIT else normal / size
