"""Rods side by side, joined at their surfaces."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ....engine.model import Array
from ...by_hand import act_joint
from ...joint import ConnectionBase, End
from ...lowering import SceneBuilder
from ...not_offered import refuse_methods


def get_connection_vector_straight_straight_rod(
    rod_one: Any, rod_two: Any, rod_one_idx: tuple[int, int], rod_two_idx: tuple[int, int]
) -> tuple[Array, Array, Array]:
    """Return the directions and gaps between facing elements of two rods in their current state.

    Parameters
    ----------
    rod_one, rod_two : CosseratRod
    rod_one_idx, rod_two_idx : tuple of int
        First and last + 1 of the m elements on each rod.

    Returns
    -------
    tuple of Array
        Unit vectors from each element of rod one to that of rod two, (3, m), and the reverse, (3, m), each in the
        material frame of its starting element; and the gaps between their surfaces [m], (m,).
    """
    one, two = slice(*rod_one_idx), slice(*rod_two_idx)
    between = _middles(rod_two)[:, two] - _middles(rod_one)[:, one]
    distance = np.linalg.norm(between, axis=0)
    between /= distance
    return (
        np.einsum("ijk,jk->ik", rod_one.director_collection[..., one], between),
        np.einsum("ijk,jk->ik", rod_two.director_collection[..., two], -between),
        distance - rod_one.radius[one] - rod_two.radius[two],
    )


@refuse_methods
class SurfaceJointSideBySide(ConnectionBase):
    """A spring between surface points of two rods, a damper between their elements, and repulsion.

    Parameters
    ----------
    k : float or array_like
        Force per distance of the points [N/m]; one for all or one per pair of elements, (m,).
    nu : float or array_like
        Force per relative velocity of the elements [N s/m].
    k_repulsive : float or array_like
        Force per overlap to the power of 3/2 [N/m^(3/2)].
    rod_one_direction_vec_in_material_frame, rod_two_direction_vec_in_material_frame : array_like
        Unit vectors to the other rod, (3, m) or, for one pair, (3,).
    offset_btw_rods : float or array_like
        Gap between the surfaces at rest [m]; half of it scales with the radius of each rod.
    """

    IS_COMPILED = True

    def __init__(
        self,
        k: ArrayLike,
        nu: ArrayLike,
        k_repulsive: ArrayLike,
        rod_one_direction_vec_in_material_frame: ArrayLike,
        rod_two_direction_vec_in_material_frame: ArrayLike,
        offset_btw_rods: ArrayLike,
        **kwargs: Any,
    ) -> None:
        towards = [
            np.array(each, dtype=np.float64).reshape(3, -1)
            for each in (rod_one_direction_vec_in_material_frame, rod_two_direction_vec_in_material_frame)
        ]
        self.towards = np.stack(towards).transpose(2, 0, 1)
        self.laws = [
            np.broadcast_to(np.ravel(np.asarray(each, dtype=np.float64)), len(self.towards))
            for each in (k, nu, k_repulsive, offset_btw_rods)
        ]
        self._n_lowered = 0

    def apply_forces(self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0) -> None:
        """Add forces and torques, as the compiled step does."""
        act_joint(self, system_one, index_one, system_two, index_two)

    def apply_torques(
        self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0
    ) -> None:
        """Do nothing: torques are added with the forces."""

    def lower(self, builder: SceneBuilder, ends: End) -> None:
        """Write the next pair."""
        pair = self._n_lowered % len(self.towards)
        k, nu, repulsion, offset = (float(each[pair]) for each in self.laws)
        builder.add_side(ends, stiffness=k, damping=nu, repulsion=repulsion, towards=self.towards[pair], offset=offset)
        self._n_lowered += 1


def _middles(rod: Any) -> Array:
    """Return the centres of elements [m], (3, n)."""
    return 0.5 * (rod.position_collection[:, 1:] + rod.position_collection[:, :-1])
