"""Strains, internal loads and energies from a rod's motion and material.

The arrays are those of one rod, closed or open. *Between* neighbours means between elements k and
k + 1; a closed rod (a ring) also has the pair of its last and first element.
"""

import numpy as np

from ...engine.model import Array


def between(values: Array, is_ring: bool) -> tuple[Array, Array]:
    """Return the first and the second of each pair of neighbours along the last axis."""
    return (values, np.roll(values, -1, axis=-1)) if is_ring else (values[..., :-1], values[..., 1:])


def difference(values: Array, is_ring: bool) -> Array:
    """Return a[k] - a[k - 1], with zeros beyond the ends of an open rod, which gives one value more."""
    if is_ring:
        return values - np.roll(values, 1, axis=-1)
    return np.diff(values, prepend=0.0, append=0.0)


def quadrature(values: Array, is_ring: bool) -> Array:
    """Return (a[k] + a[k - 1])/2, with zeros beyond the ends of an open rod, which gives one value more."""
    if is_ring:
        return 0.5 * (values + np.roll(values, 1, axis=-1))
    halves = np.zeros((*values.shape[:-1], values.shape[-1] + 1))
    halves[..., :-1] += 0.5 * values
    halves[..., 1:] += 0.5 * values
    return halves


def apply(matrices: Array, vectors: Array) -> Array:
    """Return matrix times vector for each element, (3, 3, n) and (3, n)."""
    return np.einsum("ijk,jk->ik", matrices, vectors)


def apply_transposed(matrices: Array, vectors: Array) -> Array:
    """Return transposed matrix times vector for each element, (3, 3, n) and (3, n)."""
    return np.einsum("jik,jk->ik", matrices, vectors)


def curvature(directors: Array, rest_voronoi_lengths: Array, is_ring: bool) -> Array:
    """Return kappa with Q[k+1] = exp(-D^ [kappa]x) Q[k] between neighbours [1/m]."""
    first, second = between(directors, is_ring)
    R = np.einsum("ijk,ljk->ilk", second, first)
    axis = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    size = np.linalg.norm(axis, axis=0)
    angle = np.arctan2(size, 0.5 * (np.trace(R) - 1.0))
    ratio = np.divide(angle, size, out=np.ones_like(size), where=size > 1e-9)
    return -ratio * axis / rest_voronoi_lengths


def shear(directors: Array, edges: Array, rest_lengths: Array) -> Array:
    """Return sigma = e Q t - d3, (3, n)."""
    sigma = apply(directors, edges / rest_lengths)
    sigma[2] -= 1.0
    return sigma


def internal_torques(
    *,
    directors: Array,
    omega: Array,
    edges: Array,
    edge_rates: Array,
    rest_lengths: Array,
    stress: Array,
    kappa: Array,
    couple: Array,
    voronoi_dilatation: Array,
    rest_voronoi_lengths: Array,
    inertia: Array,
    is_ring: bool,
) -> Array:
    """Return T of Gazzola et al. 2018, eq. 2.21, on elements [N m], material frame, (3, n)."""
    weight = 1.0 / voronoi_dilatation**3
    bending = difference(couple * weight, is_ring)
    bending += quadrature(np.cross(kappa, couple, axis=0) * rest_voronoi_lengths * weight, is_ring)
    shearing = np.cross(apply(directors, edges / np.linalg.norm(edges, axis=0)), stress, axis=0) * rest_lengths
    lengths = np.linalg.norm(edges, axis=0)
    momentum = apply(inertia, omega) * rest_lengths / lengths
    stretch_rate = (edges * edge_rates).sum(axis=0) / lengths**2
    return bending + shearing + np.cross(momentum, omega, axis=0) + momentum * stretch_rate
