"""Stages of a step as functions of arrays, as in PyElastica's rod, which write their results in place.

For scripts that import them from `rod.cosserat_rod`; all for open rods of n elements. This library's step is
compiled as a whole, and the rod's attributes are computed by `strain`.
"""

import numpy as np
from numpy.typing import NDArray

from ...engine.model import Array
from .._calculus import difference_kernel_for_block_structure, quadrature_kernel_for_block_structure
from . import strain


def _get_z_vector() -> Array:
    """Return the unit vector along z, (3, 1)."""
    return np.array([[0.0], [0.0], [1.0]])


def _compute_geometry_from_state(
    position_collection: Array, volume: Array, lengths: Array, tangents: Array, radius: Array
) -> None:
    """Write lengths, tangents and radii of elements."""
    edges = np.diff(position_collection, axis=1)
    lengths[:] = np.linalg.norm(edges, axis=0)
    tangents[:] = edges / lengths
    radius[:] = np.sqrt(volume / (np.pi * lengths))


def _compute_all_dilatations(
    position_collection: Array,
    volume: Array,
    lengths: Array,
    tangents: Array,
    radius: Array,
    dilatation: Array,
    rest_lengths: Array,
    rest_voronoi_lengths: Array,
    voronoi_dilatation: Array,
) -> None:
    """Write the results of `_compute_geometry_from_state`, and the dilatations of elements and Voronoi lengths."""
    _compute_geometry_from_state(position_collection, volume, lengths, tangents, radius)
    dilatation[:] = lengths / rest_lengths
    voronoi_dilatation[:] = 0.5 * (lengths[1:] + lengths[:-1]) / rest_voronoi_lengths


def _compute_dilatation_rate(
    position_collection: Array, velocity_collection: Array, lengths: Array, rest_lengths: Array, dilatation_rate: Array
) -> None:
    """Write the rates of the elements' dilatations [1/s]."""
    edges, rates = np.diff(position_collection, axis=1), np.diff(velocity_collection, axis=1)
    dilatation_rate[:] = (edges * rates).sum(axis=0) / (lengths * rest_lengths)


def _compute_shear_stretch_strains(
    position_collection: Array,
    volume: Array,
    lengths: Array,
    tangents: Array,
    radius: Array,
    rest_lengths: Array,
    rest_voronoi_lengths: Array,
    dilatation: Array,
    voronoi_dilatation: Array,
    director_collection: Array,
    sigma: Array,
) -> None:
    """Write the results of `_compute_all_dilatations`, and sigma."""
    _compute_all_dilatations(
        position_collection,
        volume,
        lengths,
        tangents,
        radius,
        dilatation,
        rest_lengths,
        rest_voronoi_lengths,
        voronoi_dilatation,
    )
    sigma[:] = strain.shear(director_collection, np.diff(position_collection, axis=1), rest_lengths)


def _compute_internal_shear_stretch_stresses_from_model(
    position_collection: Array,
    volume: Array,
    lengths: Array,
    tangents: Array,
    radius: Array,
    rest_lengths: Array,
    rest_voronoi_lengths: Array,
    dilatation: Array,
    voronoi_dilatation: Array,
    director_collection: Array,
    sigma: Array,
    rest_sigma: Array,
    shear_matrix: Array,
    internal_stress: Array,
) -> None:
    """Write the results of `_compute_shear_stretch_strains`, and the stress S (sigma - sigma^)."""
    _compute_shear_stretch_strains(
        position_collection,
        volume,
        lengths,
        tangents,
        radius,
        rest_lengths,
        rest_voronoi_lengths,
        dilatation,
        voronoi_dilatation,
        director_collection,
        sigma,
    )
    internal_stress[:] = strain.apply(shear_matrix, sigma - rest_sigma)


def _compute_bending_twist_strains(director_collection: Array, rest_voronoi_lengths: Array, kappa: Array) -> None:
    """Write kappa [1/m]."""
    kappa[:] = strain.curvature(director_collection, rest_voronoi_lengths, False)


def _compute_internal_bending_twist_stresses_from_model(
    director_collection: Array,
    rest_voronoi_lengths: Array,
    internal_couple: Array,
    bend_matrix: Array,
    kappa: Array,
    rest_kappa: Array,
) -> None:
    """Write kappa and the couple B (kappa - kappa^)."""
    _compute_bending_twist_strains(director_collection, rest_voronoi_lengths, kappa)
    internal_couple[:] = strain.apply(bend_matrix, kappa - rest_kappa)


def _compute_internal_forces(
    position_collection: Array,
    volume: Array,
    lengths: Array,
    tangents: Array,
    radius: Array,
    rest_lengths: Array,
    rest_voronoi_lengths: Array,
    dilatation: Array,
    voronoi_dilatation: Array,
    director_collection: Array,
    sigma: Array,
    rest_sigma: Array,
    shear_matrix: Array,
    internal_stress: Array,
    internal_forces: Array,
    ghost_elems_idx: NDArray[np.int32],
) -> None:
    """Write the results of `_compute_internal_shear_stretch_stresses_from_model`, and the forces on nodes [N]."""
    _compute_internal_shear_stretch_stresses_from_model(
        position_collection,
        volume,
        lengths,
        tangents,
        radius,
        rest_lengths,
        rest_voronoi_lengths,
        dilatation,
        voronoi_dilatation,
        director_collection,
        sigma,
        rest_sigma,
        shear_matrix,
        internal_stress,
    )
    stress = strain.apply_transposed(director_collection, internal_stress / dilatation)
    internal_forces[:] = difference_kernel_for_block_structure(stress, ghost_elems_idx)


def _compute_internal_torques(
    position_collection: Array,
    velocity_collection: Array,
    tangents: Array,
    lengths: Array,
    rest_lengths: Array,
    director_collection: Array,
    rest_voronoi_lengths: Array,
    bend_matrix: Array,
    rest_kappa: Array,
    kappa: Array,
    voronoi_dilatation: Array,
    mass_second_moment_of_inertia: Array,
    omega_collection: Array,
    internal_stress: Array,
    internal_couple: Array,
    dilatation: Array,
    dilatation_rate: Array,
    internal_torques: Array,
    ghost_voronoi_idx: NDArray[np.int32],
) -> None:
    """Write kappa, couples, dilatation rates and the torques on elements [N m], material frame."""
    _compute_internal_bending_twist_stresses_from_model(
        director_collection, rest_voronoi_lengths, internal_couple, bend_matrix, kappa, rest_kappa
    )
    _compute_dilatation_rate(position_collection, velocity_collection, lengths, rest_lengths, dilatation_rate)
    weight = 1.0 / voronoi_dilatation**3
    bending = difference_kernel_for_block_structure(internal_couple * weight, ghost_voronoi_idx)
    moments = np.cross(kappa, internal_couple, axis=0) * rest_voronoi_lengths * weight
    bending += quadrature_kernel_for_block_structure(moments, ghost_voronoi_idx)
    shearing = np.cross(strain.apply(director_collection, tangents), internal_stress, axis=0) * rest_lengths
    momentum = strain.apply(mass_second_moment_of_inertia, omega_collection) / dilatation
    internal_torques[:] = bending + shearing + np.cross(momentum, omega_collection, axis=0)
    internal_torques += momentum * dilatation_rate / dilatation


def _update_accelerations(
    acceleration_collection: Array,
    internal_forces: Array,
    external_forces: Array,
    mass: Array,
    alpha_collection: Array,
    inv_mass_second_moment_of_inertia: Array,
    internal_torques: Array,
    external_torques: Array,
    dilatation: Array,
) -> None:
    """Write the accelerations of nodes [m/s^2] and elements [rad/s^2]."""
    acceleration_collection[:] = (internal_forces + external_forces) / mass
    torques = internal_torques + external_torques
    alpha_collection[:] = strain.apply(inv_mass_second_moment_of_inertia, torques) * dilatation


def _zeroed_out_external_forces_and_torques(external_forces: Array, external_torques: Array) -> None:
    """Clear loads."""
    external_forces[:] = 0.0
    external_torques[:] = 0.0


def _compute_damping_forces(
    damping_forces: Array,
    velocity_collection: Array,
    dissipation_constant_for_forces: Array,
    lengths: Array,
    ghost_elems_idx: NDArray[np.int32],
) -> None:
    """Write the damping of nodes in 0.2.x [N]."""
    velocity = 0.5 * (velocity_collection[:, 1:] + velocity_collection[:, :-1])
    force = dissipation_constant_for_forces * lengths * velocity
    damping_forces[:] = quadrature_kernel_for_block_structure(force, ghost_elems_idx)


def _compute_damping_torques(
    damping_torques: Array, omega_collection: Array, dissipation_constant_for_torques: Array, lengths: Array
) -> None:
    """Write the damping of elements in 0.2.x [N m]."""
    damping_torques[:] = dissipation_constant_for_torques * omega_collection * lengths
