"""A rigid cylinder."""

import numpy as np
from numpy.typing import ArrayLike

from ..rod.cosserat_rod import _unit, _vector
from ..rod.description import require_positive
from .rigid_body import RigidBodyBase


class Cylinder(RigidBodyBase):
    """A rigid cylinder of even density. To rods it is a capsule, to planes its ends are flat.

    Parameters
    ----------
    start : array_like
        Centre of its first end [m], (3,).
    direction : array_like
        From its first end to its second, d3; of any length, (3,).
    normal : array_like
        d1, perpendicular to ``direction``; of any length, (3,).
    base_length, base_radius : float
        [m]
    density : float
        [kg/m^3]
    """

    def __init__(
        self, start: ArrayLike, direction: ArrayLike, normal: ArrayLike, base_length: float, base_radius: float,
        density: float,
    ) -> None:  # fmt: skip
        for name, value in (("base_length", base_length), ("base_radius", base_radius), ("density", density)):
            require_positive(name, value)
        d3, d1 = _unit("direction", direction), _unit("normal", normal)
        if abs(float(d1 @ d3)) > 1e-8:
            raise ValueError(f"normal must be perpendicular to direction; the cosine between them is {d1 @ d3:.3g}")
        self.length, self.radius, self.density = (np.float64(each) for each in (base_length, base_radius, density))
        self.volume = np.pi * self.radius**2 * self.length
        self.mass = self.density * self.volume
        across = self.mass * (3.0 * self.radius**2 + self.length**2) / 12.0
        inertia = np.array([across, across, 0.5 * self.mass * self.radius**2])
        centre = _vector("start", start) + 0.5 * self.length * d3
        self._set_up(centre, np.array([d1, np.cross(d3, d1), d3]), inertia)
