"""Rods that run side by side, held together where their surfaces touch."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...joint import ConnectionBase
from ...model import Array


def get_connection_vector_straight_straight_rod(
    rod_one: Any, rod_two: Any, rod_one_idx: tuple[int, int], rod_two_idx: tuple[int, int]
) -> tuple[Array, Array, Array]:
    """Return where elements of two rods face each other, as they are now.

    Parameters
    ----------
    rod_one, rod_two : CosseratRod
    rod_one_idx, rod_two_idx : tuple of int
        First and last + 1 of the m elements of each.

    Returns
    -------
    tuple of Array
        Unit vectors from each element of one to that of two, (3, m), and the reverse, (3, m), each in the material
        frame of where it begins; and how far their surfaces are apart [m], (m,).
    """
    one, two = slice(*rod_one_idx), slice(*rod_two_idx)
    between = _middles(rod_two)[:, two] - _middles(rod_one)[:, one]
    distance = np.linalg.norm(between, axis=0)
    between /= distance
    return (np.einsum("ijk,jk->ik", rod_one.director_collection[..., one], between),
            np.einsum("ijk,jk->ik", rod_two.director_collection[..., two], -between),
            distance - rod_one.radius[one] - rod_two.radius[two])  # fmt: skip


class SurfaceJointSideBySide(ConnectionBase):
    """A spring between points of the surfaces of two rods, a damper between their elements, and repulsion.

    Parameters
    ----------
    k : float or array_like
        Force per distance of the points [N/m]; one for all or one for each of the m pairs of elements.
    nu : float or array_like
        Force per relative velocity of the elements [N s/m].
    k_repulsive : float or array_like
        Force per overlap to the power of 3/2 [N/m^(3/2)].
    rod_one_direction_vec_in_material_frame, rod_two_direction_vec_in_material_frame : array_like
        Unit vectors to the other rod, (3, m) or, of one pair, (3,).
    offset_btw_rods : float or array_like
        How far the surfaces are apart at rest [m]; half of it grows with the radius of each rod.
    """

    def __init__(
        self, k: ArrayLike, nu: ArrayLike, k_repulsive: ArrayLike, rod_one_direction_vec_in_material_frame: ArrayLike,
        rod_two_direction_vec_in_material_frame: ArrayLike, offset_btw_rods: ArrayLike, **kwargs: Any,
    ) -> None:  # fmt: skip
        self.k, self.nu, self.k_repulsive = (np.array(each, dtype=np.float64) for each in (k, nu, k_repulsive))
        self.offset_btw_rods = np.array(offset_btw_rods, dtype=np.float64)
        self.rod_one_direction_vec_in_material_frame = _columns(rod_one_direction_vec_in_material_frame)
        self.rod_two_direction_vec_in_material_frame = _columns(rod_two_direction_vec_in_material_frame)
        self.spring_force = self.rod_one_rd2 = self.rod_two_rd2 = np.zeros((3, 1))

    def apply_forces(
        self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0
    ) -> None:
        """Pull the points together, damp, and part what overlaps; half of each force to each node."""
        i, j = np.atleast_1d(index_one), np.atleast_1d(index_two)
        radius_one, self.rod_one_rd2 = self._arm(system_one, i, self.rod_one_direction_vec_in_material_frame)
        radius_two, self.rod_two_rd2 = self._arm(system_two, j, self.rod_two_direction_vec_in_material_frame)
        between = _middles(system_two)[:, j] - _middles(system_one)[:, i]
        # rounded, as the original does, so that rods at rest stay at rest
        self.spring_force = self.k * np.round(between + self.rod_two_rd2 - self.rod_one_rd2, 12)
        distance = np.linalg.norm(between, axis=0)
        overlap = np.maximum(-np.round(distance - radius_one - radius_two, 12), 0.0)
        rate = _middle_velocities(system_two)[:, j] - _middle_velocities(system_one)[:, i]
        force = self.spring_force + self.nu * rate - self.k_repulsive * overlap**1.5 * between / distance
        for system, index, sign in ((system_one, i, 0.5), (system_two, j, -0.5)):
            for node in (index, index + 1):
                np.add.at(system.external_forces, (slice(None), node), sign * force)

    def apply_torques(
        self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0
    ) -> None:
        """Add the torques of the springs about the elements' centres."""
        for system, index, arm, sign in ((system_one, index_one, self.rod_one_rd2, 1.0),
                                         (system_two, index_two, self.rod_two_rd2, -1.0)):  # fmt: skip
            i = np.atleast_1d(index)
            torque = np.cross(arm, sign * self.spring_force, axis=0)
            torque = np.einsum("ijk,jk->ik", system.director_collection[..., i], torque)
            np.add.at(system.external_torques, (slice(None), i), torque)

    def _arm(self, system: Any, index: Array, direction: Array) -> tuple[Array, Array]:
        """Return how far each rod reaches [m], (m,), and the way from its axis to there in the lab [m], (3, m)."""
        reach = system.radius[index] + 0.5 * self.offset_btw_rods / np.sqrt(system.dilatation[index])
        return reach, reach * np.einsum("jik,jk->ik", system.director_collection[..., index], direction)


def _middles(rod: Any) -> Array:
    """Return the centres of elements [m], (3, n)."""
    return 0.5 * (rod.position_collection[:, 1:] + rod.position_collection[:, :-1])


def _middle_velocities(rod: Any) -> Array:
    """Return the velocities of the centres of elements [m/s], (3, n)."""
    return 0.5 * (rod.velocity_collection[:, 1:] + rod.velocity_collection[:, :-1])


def _columns(vectors: ArrayLike) -> Array:
    values = np.array(vectors, dtype=np.float64)
    return values[:, None] if values.ndim == 1 else values
