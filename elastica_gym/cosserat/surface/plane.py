"""A plane, for systems to touch."""

import numpy as np
from numpy.typing import ArrayLike

from ...engine.rod import three
from .surface_base import SurfaceBase

UNIT = 1e-12
"""How far the length of a normal may be from 1 for it to be taken as it is"""


class Plane(SurfaceBase):
    """A plane that does not move by itself.

    Parameters
    ----------
    plane_origin : array_like
        A point of it [m], (3,); an array is followed if it changes between runs or callbacks.
    plane_normal : array_like
        Towards the free side; of any length, (3,). An array of unit length is followed too.

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
