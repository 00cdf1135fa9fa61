"""Products of many small vectors and matrices, for scripts and their compiled functions.

Vectors are columns, (3, n); matrices are stacked along the last axis, (3, 3, n).
"""

from itertools import permutations

import numpy as np
from numba import njit

from ..engine.model import Array


def levi_civita_tensor(dim: int) -> Array:
    """Return the Levi-Civita tensor of ``dim`` indices, with entries 1, -1 or 0."""
    epsilon = np.zeros((dim,) * dim)
    for indices in permutations(range(dim)):
        epsilon[indices] = round(np.linalg.det(np.eye(dim)[list(indices)]))
    return epsilon


@njit(cache=True)
def _batch_matvec(matrix_collection, vector_collection):
    """Return A a, (3, 3, n) and (3, n) to (3, n)."""
    n = vector_collection.shape[1]
    result = np.zeros((3, n))
    for i in range(3):
        for j in range(3):
            for k in range(n):
                result[i, k] += matrix_collection[i, j, k] * vector_collection[j, k]
    return result


@njit(cache=True)
def _batch_matmul(first_matrix_collection, second_matrix_collection):
    """Return A B, (3, 3, n)."""
    n = first_matrix_collection.shape[2]
    result = np.zeros((3, 3, n))
    for i in range(3):
        for j in range(3):
            for m in range(3):
                for k in range(n):
                    result[i, m, k] += first_matrix_collection[i, j, k] * second_matrix_collection[j, m, k]
    return result


@njit(cache=True)
def _batch_cross(first_vector_collection, second_vector_collection):
    """Return a x b, (3, n)."""
    a, b = first_vector_collection, second_vector_collection
    result = np.empty((3, b.shape[1]))
    for k in range(b.shape[1]):
        result[0, k] = a[1, k] * b[2, k] - a[2, k] * b[1, k]
        result[1, k] = a[2, k] * b[0, k] - a[0, k] * b[2, k]
        result[2, k] = a[0, k] * b[1, k] - a[1, k] * b[0, k]
    return result


@njit(cache=True)
def _batch_vec_oneD_vec_cross(first_vector_collection, second_vector):
    """Return a x b for one b, (3, n) and (3,) to (3, n)."""
    a, b = first_vector_collection, second_vector
    result = np.empty((3, a.shape[1]))
    for k in range(a.shape[1]):
        result[0, k] = a[1, k] * b[2] - a[2, k] * b[1]
        result[1, k] = a[2, k] * b[0] - a[0, k] * b[2]
        result[2, k] = a[0, k] * b[1] - a[1, k] * b[0]
    return result


@njit(cache=True)
def _batch_dot(first_vector, second_vector):
    """Return a . b, (3, n) to (n,)."""
    result = np.zeros(first_vector.shape[1])
    for i in range(3):
        for k in range(first_vector.shape[1]):
            result[k] += first_vector[i, k] * second_vector[i, k]
    return result


@njit(cache=True)
def _batch_norm(vector):
    """Return |a|, (3, n) to (n,)."""
    return np.sqrt(_batch_dot(vector, vector))


@njit(cache=True)
def _batch_product_i_k_to_ik(vector1, vector2):
    """Return a_i b_k, (3,) and (n,) to (3, n)."""
    result = np.empty((3, vector2.shape[0]))
    for i in range(3):
        for k in range(vector2.shape[0]):
            result[i, k] = vector1[i] * vector2[k]
    return result


@njit(cache=True)
def _batch_product_i_ik_to_k(vector1, vector2):
    """Return the sum over i of a_i b_ik, (3,) and (3, n) to (n,)."""
    result = np.zeros(vector2.shape[1])
    for i in range(3):
        for k in range(vector2.shape[1]):
            result[k] += vector1[i] * vector2[i, k]
    return result


@njit(cache=True)
def _batch_product_k_ik_to_ik(vector1, vector2):
    """Return a_k b_ik, (n,) and (3, n) to (3, n)."""
    result = np.empty((3, vector2.shape[1]))
    for i in range(3):
        for k in range(vector2.shape[1]):
            result[i, k] = vector1[k] * vector2[i, k]
    return result


@njit(cache=True)
def _batch_vector_sum(vector1, vector2):
    """Return a + b, (3, n)."""
    return vector1 + vector2


@njit(cache=True)
def _batch_matrix_transpose(input_matrix):
    """Return the transpose of each matrix, (3, 3, n)."""
    result = np.empty(input_matrix.shape)
    for i in range(input_matrix.shape[0]):
        for j in range(input_matrix.shape[1]):
            for k in range(input_matrix.shape[2]):
                result[j, i, k] = input_matrix[i, j, k]
    return result
