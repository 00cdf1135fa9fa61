"""Rotations of many frames at once, for scripts and their compiled functions.

A frame is a matrix with directors as rows; multiplying it by exp(-[a]x) turns it by a vector a.
"""

from math import atan2, sin, sqrt

import numpy as np
from numba import njit

from ._linalg import _batch_matmul
from .joint import get_relative_rotation_two_systems as get_relative_rotation_two_systems
from .not_offered import refuse_names


@njit(cache=True)
def _get_rotation_matrix(scale, axis_collection):
    """Return exp(-scale [a]x) for each column a, (3, n) to (3, 3, n)."""
    n = axis_collection.shape[1]
    result = np.zeros((3, 3, n))
    for k in range(n):
        a, b, c = scale * axis_collection[0, k], scale * axis_collection[1, k], scale * axis_collection[2, k]
        angle = sqrt(a * a + b * b + c * c)
        S = sin(angle) / angle if angle > 1e-8 else 1.0
        half = sin(0.5 * angle) / (0.5 * angle) if angle > 1e-8 else 1.0
        C = 0.5 * half * half
        result[0, 0, k] = 1.0 - C * (b * b + c * c)
        result[1, 1, k] = 1.0 - C * (a * a + c * c)
        result[2, 2, k] = 1.0 - C * (a * a + b * b)
        result[0, 1, k], result[1, 0, k] = C * a * b + S * c, C * a * b - S * c
        result[0, 2, k], result[2, 0, k] = C * a * c - S * b, C * a * c + S * b
        result[1, 2, k], result[2, 1, k] = C * b * c + S * a, C * b * c - S * a
    return result


@njit(cache=True)
def _rotate(director_collection, scale, axis_collection):
    """Return exp(-scale [a]x) Q for each frame, (3, 3, n) and (3, n) to (3, 3, n)."""
    return _batch_matmul(_get_rotation_matrix(scale, axis_collection), director_collection)


@njit(cache=True)
def _inv_rotate(director_collection):
    """Return a with Q[k + 1] = exp(-[a]x) Q[k] for neighbouring frames, (3, 3, n + 1) to (3, n)."""
    Q = director_collection
    n = Q.shape[2] - 1
    result = np.empty((3, n))
    for k in range(n):
        R = np.zeros((3, 3))
        for i in range(3):
            for j in range(3):
                for m in range(3):
                    R[i, j] += Q[i, m, k + 1] * Q[j, m, k]
        a, b, c = 0.5 * (R[1, 2] - R[2, 1]), 0.5 * (R[2, 0] - R[0, 2]), 0.5 * (R[0, 1] - R[1, 0])
        size = sqrt(a * a + b * b + c * c)
        angle = atan2(size, 0.5 * (R[0, 0] + R[1, 1] + R[2, 2] - 1.0))
        scale = angle / size if size > 1e-9 else 1.0
        result[0, k], result[1, k], result[2, k] = scale * a, scale * b, scale * c
    return result


@njit(cache=True)
def _skew_symmetrize(vector):
    """Return [a]x for each column, (3, n) to (3, 3, n)."""
    result = np.zeros((3, 3, vector.shape[1]))
    for k in range(vector.shape[1]):
        result[0, 1, k], result[1, 0, k] = -vector[2, k], vector[2, k]
        result[0, 2, k], result[2, 0, k] = vector[1, k], -vector[1, k]
        result[1, 2, k], result[2, 1, k] = -vector[0, k], vector[0, k]
    return result


@njit(cache=True)
def _inv_skew_symmetrize(matrix):
    """Return a for each [a]x, (3, 3, n) to (3, n)."""
    result = np.empty((3, matrix.shape[2]))
    for k in range(matrix.shape[2]):
        result[0, k], result[1, k], result[2, k] = matrix[2, 1, k], matrix[0, 2, k], matrix[1, 0, k]
    return result


__getattr__ = refuse_names(__name__)
