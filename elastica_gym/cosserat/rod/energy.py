"""Energies and centres of mass of rods, from their public attributes."""

import numpy as np

from ...engine.model import Array
from .strain import apply


class RodEnergy:
    """Energies and centres of mass as methods."""

    mass: Array
    position_collection: Array
    velocity_collection: Array
    omega_collection: Array
    mass_second_moment_of_inertia: Array
    dilatation: Array
    kappa: Array
    rest_kappa: Array
    bend_matrix: Array
    rest_voronoi_lengths: Array
    sigma: Array
    rest_sigma: Array
    shear_matrix: Array
    rest_lengths: Array

    def compute_translational_energy(self) -> np.float64:
        """Return the sum of m v^2/2 over nodes [J]."""
        return 0.5 * (self.mass * (self.velocity_collection**2).sum(axis=0)).sum()

    def compute_rotational_energy(self) -> np.float64:
        """Return the sum of w . J w/(2 e) over elements [J]."""
        momentum = apply(self.mass_second_moment_of_inertia, self.omega_collection) / self.dilatation
        return 0.5 * (self.omega_collection * momentum).sum()

    def compute_bending_energy(self) -> np.float64:
        """Return the sum of (kappa - kappa^) . B (kappa - kappa^) D^/2 over Voronoi points [J]."""
        excess = self.kappa - self.rest_kappa
        return 0.5 * (excess * apply(self.bend_matrix, excess) * self.rest_voronoi_lengths).sum()

    def compute_shear_energy(self) -> np.float64:
        """Return the sum of (sigma - sigma^) . S (sigma - sigma^) l^/2 over elements [J]."""
        excess = self.sigma - self.rest_sigma
        return 0.5 * (excess * apply(self.shear_matrix, excess) * self.rest_lengths).sum()

    def compute_velocity_center_of_mass(self) -> Array:
        """Return the velocity of the centre of mass [m/s], (3,)."""
        return (self.mass * self.velocity_collection).sum(axis=1) / self.mass.sum()

    def compute_position_center_of_mass(self) -> Array:
        """Return the centre of mass [m], (3,)."""
        return (self.mass * self.position_collection).sum(axis=1) / self.mass.sum()
