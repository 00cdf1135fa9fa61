"""A plane, for systems to touch."""

import numpy as np
from numpy.typing import ArrayLike

from .surface_base import SurfaceBase


class Plane(SurfaceBase):
    """A plane that does not move.

    Parameters
    ----------
    plane_origin : array_like
        A point of it [m], (3,).
    plane_normal : array_like
        Towards the free side; of any length, (3,).

    Attributes
    ----------
    origin : Array
        (3, 1)
    normal : Array
        Of unit length, (3,).
    """

    def __init__(self, plane_origin: ArrayLike, plane_normal: ArrayLike) -> None:
        self.origin = np.array(plane_origin, dtype=np.float64).reshape(3, 1)
        normal = np.array(plane_normal, dtype=np.float64).reshape(3)
        size = float(np.linalg.norm(normal))
        if not (np.isfinite(size) and size > 0.0):
            raise ValueError(f"plane_normal must be finite and not zero, not {normal.tolist()}")
        self.normal = normal / size
