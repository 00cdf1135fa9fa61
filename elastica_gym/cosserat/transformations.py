"""Rotations and skew matrices with shape checks."""

import numpy as np
from numpy.typing import ArrayLike

from ..engine.model import Array
from ._rotations import _inv_skew_symmetrize, _rotate, _skew_symmetrize


def format_vector_shape(vector_collection: ArrayLike) -> Array:
    """Return vectors as columns, (3, n), from (3,), (3, n) or, unless n is 3, (n, 3)."""
    vectors = np.asarray(vector_collection, dtype=np.float64)
    if vectors.shape == (3,):
        return vectors[:, None]
    if vectors.ndim == 2 and 3 in vectors.shape:
        return np.ascontiguousarray(vectors if vectors.shape[0] == 3 else vectors.T)
    raise ValueError(f"vectors must have shape (3,), (3, n) or (n, 3), not {vectors.shape}")


def format_matrix_shape(matrix_collection: ArrayLike) -> Array:
    """Return stacked matrices, (3, 3, n), from (9,), (3, 3), (9, n), (n, 9), (3, 3, n) or (n, 3, 3).

    An ambiguous shape is read as the first of these that fits. The axes of (n, 3, 3) are reversed, so each
    matrix is transposed, as in PyElastica.
    """
    matrices = np.asarray(matrix_collection, dtype=np.float64)
    shape = matrices.shape
    if shape in ((9,), (3, 3)):
        return matrices.reshape(3, 3, 1)
    if matrices.ndim == 2 and 9 in shape:
        return np.ascontiguousarray(matrices if shape[0] == 9 else matrices.T).reshape(3, 3, -1)
    if matrices.ndim == 3 and shape[:2] == (3, 3):
        return matrices
    if matrices.ndim == 3 and shape[1:] == (3, 3):
        return np.ascontiguousarray(matrices.T)
    raise ValueError(f"matrices must have shape (9,), (3, 3), (9, n), (n, 9), (3, 3, n) or (n, 3, 3), not {shape}")


def skew_symmetrize(vector: ArrayLike) -> Array:
    """Return [a]x for each vector, (3, 3, n)."""
    return _skew_symmetrize(format_vector_shape(vector))


def inv_skew_symmetrize(matrix_collection: ArrayLike) -> Array:
    """Return a for each matrix [a]x, (3, n).

    Raises
    ------
    ValueError
        If a matrix is not skew-symmetric.
    """
    matrices = format_matrix_shape(matrix_collection)
    if not np.allclose(matrices, -np.einsum("ijk->jik", matrices)):
        raise ValueError("matrix_collection must be skew-symmetric")
    return _inv_skew_symmetrize(matrices)


def rotate(matrix: ArrayLike, scale: float | Array, axis: ArrayLike) -> Array:
    """Return frames turned by ``scale`` times ``axis``: exp(-scale [a]x) Q, (3, 3, n).

    Parameters
    ----------
    matrix : array_like
        One frame, (9,) or (3, 3), or many, (3, 3, n) or another shape of `format_matrix_shape`.
    scale : float or Array
        One for all, or one each, (n,) [rad].
    axis : array_like
        One for all, (3,), or one each, (3, n).
    """
    frames, axes = format_matrix_shape(matrix), format_vector_shape(axis)
    n = max(frames.shape[2], axes.shape[1], np.size(scale))
    frames = np.ascontiguousarray(np.broadcast_to(frames, (3, 3, n)))
    return _rotate(frames, 1.0, np.broadcast_to(axes, (3, n)) * scale)
