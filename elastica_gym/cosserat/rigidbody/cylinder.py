"""A rigid cylinder."""

import warnings

import numpy as np
from numpy.typing import ArrayLike

from ...engine.model import Array
from ...engine.rod import require_positive
from ..not_offered import refuse_names
from ..rod.cosserat_rod import TOLERANCE, _unit, _vector
from .rigid_body import RigidBodyBase


class Cylinder(RigidBodyBase):
    """A rigid cylinder of uniform density. In contact with rods it is a capsule; with planes its ends are flat.

    Parameters
    ----------
    start : array_like
        Centre of its first end [m], (3,).
    direction : array_like
        From its first end to its second, d3, of any length, (3,).
    normal : array_like
        Along d1, of any length, (3,). If it is not perpendicular to ``direction``, its perpendicular part
        is used, or any perpendicular if it is parallel, with a warning.
    base_length, base_radius : float
        [m]
    density : float
        [kg/m^3]
    """

    def __init__(
        self,
        start: ArrayLike,
        direction: ArrayLike,
        normal: ArrayLike,
        base_length: float,
        base_radius: float,
        density: float,
    ) -> None:
        for name, value in (("base_length", base_length), ("base_radius", base_radius), ("density", density)):
            require_positive(name, value)
        d3 = _unit("direction", direction)
        d1 = _perpendicular(_unit("normal", normal), d3)
        self.length, self.radius, self.density = (np.float64(each) for each in (base_length, base_radius, density))
        self.volume = np.pi * self.radius**2 * self.length
        self.mass = self.density * self.volume
        across = self.mass * (3.0 * self.radius**2 + self.length**2) / 12.0
        inertia = np.array([across, across, 0.5 * self.mass * self.radius**2])
        centre = _vector("start", start) + 0.5 * self.length * d3
        self._set_up(centre, np.array([d1, np.cross(d3, d1), d3]), inertia)


def _perpendicular(normal: Array, axis: Array) -> Array:
    """Return the unit vector perpendicular to an axis and nearest to a normal; warn if they differ."""
    cosine = float(normal @ axis)
    if abs(cosine) <= TOLERANCE:
        return normal
    across = normal - cosine * axis
    is_parallel = float(np.linalg.norm(across)) <= TOLERANCE
    if is_parallel:
        across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    taken = "another perpendicular is used" if is_parallel else "its perpendicular part is used"
    warnings.warn(
        f"normal is not perpendicular to direction, the cosine between them is {cosine:.3g}: {taken}",
        UserWarning,
        stacklevel=3,
    )
    return across / np.linalg.norm(across)


__getattr__ = refuse_names(__name__)
