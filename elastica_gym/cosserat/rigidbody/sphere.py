"""A rigid sphere."""

import numpy as np
from numpy.typing import ArrayLike

from ...engine.rod import require_positive
from ..rod.cosserat_rod import _vector
from .rigid_body import RigidBodyBase


class Sphere(RigidBodyBase):
    """A rigid sphere of uniform density.

    Parameters
    ----------
    center : array_like
        [m], (3,)
    base_radius : float
        [m]
    density : float
        [kg/m^3]
    """

    def __init__(self, center: ArrayLike, base_radius: float, density: float) -> None:
        require_positive("base_radius", base_radius)
        require_positive("density", density)
        self.radius, self.density = np.float64(base_radius), np.float64(density)
        self.length = 2.0 * self.radius
        self.volume = 4.0 / 3.0 * np.pi * self.radius**3
        self.mass = self.density * self.volume
        directors = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        self._set_up(_vector("center", center), directors, np.full(3, 0.4 * self.mass * self.radius**2))

    @property
    def _axis_length(self) -> float:
        return 0.0
