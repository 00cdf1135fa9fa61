"""Joints between any points fixed to rods and rigid bodies."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ....engine.model import Array
from ....engine.rod import as_number
from ...joint import ConnectionBase, FixedJoint


def compute_position_of_point(system: Any, point: ArrayLike, index: int) -> Array:
    """Return the position of a point fixed to a node and its element, or to a body [m], (3,).

    Parameters
    ----------
    system : CosseratRod or RigidBodyBase
    point : array_like
        Offset from the node or the body's centre, in the material frame [m], (3,).
    index : int
        Index of the node and its element.
    """
    return system.position_collection[..., index] + system.director_collection[..., index].T @ np.asarray(point)


def compute_velocity_of_point(system: Any, point: ArrayLike, index: int) -> Array:
    """Return the velocity of such a point [m/s], (3,)."""
    turning = np.cross(system.omega_collection[..., index], np.asarray(point))
    return system.velocity_collection[..., index] + system.director_collection[..., index].T @ turning


class GenericSystemTypeFreeJoint(ConnectionBase):
    """A ball joint between two points: a spring and a damper.

    Parameters
    ----------
    k : float
        Force per distance [N/m].
    nu : float
        Force per relative velocity [N s/m].
    point_system_one, point_system_two : array_like, optional
        The points, as offsets from the node or the body's centre, in the material frame [m], (3,); default zero.
    """

    def __init__(
        self,
        k: float,
        nu: float,
        point_system_one: ArrayLike | None = None,
        point_system_two: ArrayLike | None = None,
        **kwargs: Any,
    ) -> None:
        self.k, self.nu = as_number("k", k), as_number("nu", nu)
        self.point_system_one, self.point_system_two = (
            np.zeros(3) if point is None else np.asarray(point) for point in (point_system_one, point_system_two)
        )

    def apply_forces(self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0) -> None:
        """Add k (x2 - x1) + nu (v2 - v1) to one, its opposite to two, and the resulting torques."""
        ends = (system_one, self.point_system_one, index_one), (system_two, self.point_system_two, index_two)
        x1, x2 = (compute_position_of_point(*end) for end in ends)
        v1, v2 = (compute_velocity_of_point(*end) for end in ends)
        force = self.k * (x2 - x1) + self.nu * (v2 - v1)
        for (system, point, index), push in zip(ends, (force, -force), strict=True):
            system.external_forces[..., index] += push
            system.external_torques[..., index] += np.cross(point, system.director_collection[..., index] @ push)

    def apply_torques(
        self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0
    ) -> None:
        """Do nothing: the joint rotates freely."""


class GenericSystemTypeFixedJoint(GenericSystemTypeFreeJoint):
    """A joint between two points that also holds the relative rotation of two systems.

    Parameters
    ----------
    k, nu, point_system_one, point_system_two
        As for `GenericSystemTypeFreeJoint`.
    kt, nut, rest_rotation_matrix
        As for `FixedJoint`.
    """

    def __init__(
        self,
        k: float,
        nu: float,
        kt: float,
        nut: float = 0.0,
        point_system_one: ArrayLike | None = None,
        point_system_two: ArrayLike | None = None,
        rest_rotation_matrix: ArrayLike | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(k, nu, point_system_one, point_system_two)
        self.turn = FixedJoint(k, nu, kt, nut, rest_rotation_matrix)

    def apply_torques(
        self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0
    ) -> None:
        """Add the torque of a `FixedJoint` to two, and its opposite to one."""
        self.turn.apply_torques(system_one, index_one, system_two, index_two, time)
