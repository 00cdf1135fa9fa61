"""Differences and averages along a rod, for scripts and their compiled functions."""

import numpy as np
from numba import njit

from .not_offered import refuse_names


@njit(cache=True)
def position_difference_kernel(vector):
    """Return a[k + 1] - a[k], (3, n + 1) to (3, n)."""
    return vector[:, 1:] - vector[:, :-1]


@njit(cache=True)
def position_average(vector):
    """Return (a[k + 1] + a[k])/2, (n + 1,) to (n,)."""
    return 0.5 * (vector[1:] + vector[:-1])


@njit(cache=True)
def quadrature_kernel(array_collection):
    """Return (a[k] + a[k - 1])/2 with zeros beyond the ends, (3, n) to (3, n + 1)."""
    rows, n = array_collection.shape
    result = np.zeros((rows, n + 1))
    for i in range(rows):
        for k in range(n):
            half = 0.5 * array_collection[i, k]
            result[i, k] += half
            result[i, k + 1] += half
    return result


@njit(cache=True)
def difference_kernel(array_collection):
    """Return a[k] - a[k - 1] with zeros beyond the ends, (3, n) to (3, n + 1)."""
    rows, n = array_collection.shape
    result = np.zeros((rows, n + 1))
    for i in range(rows):
        for k in range(n):
            result[i, k] += array_collection[i, k]
            result[i, k + 1] -= array_collection[i, k]
    return result


@njit(cache=True)
def _reset(array_collection, ghost_idx):
    for k in ghost_idx:
        array_collection[:, k] = 0.0


@njit(cache=True)
def quadrature_kernel_for_block_structure(array_collection, ghost_idx):
    """Set the columns at ``ghost_idx`` to zero, in place, and return `quadrature_kernel`."""
    _reset(array_collection, ghost_idx)
    return quadrature_kernel(array_collection)


@njit(cache=True)
def difference_kernel_for_block_structure(array_collection, ghost_idx):
    """Set the columns at ``ghost_idx`` to zero, in place, and return `difference_kernel`."""
    _reset(array_collection, ghost_idx)
    return difference_kernel(array_collection)


@njit(cache=True)
def _clip_array(input_array, vmin, vmax):
    """Clip an array in place to a range, and return it, (n,)."""
    for k in range(input_array.shape[0]):
        input_array[k] = min(max(input_array[k], vmin), vmax)
    return input_array


@njit(cache=True)
def _isnan_check(array):
    """Return whether any entry is NaN."""
    return bool(np.isnan(array).any())


# names in 1.0
_difference, _average = position_difference_kernel, position_average
_trapezoidal, _two_point_difference = quadrature_kernel, difference_kernel
_trapezoidal_for_block_structure = quadrature_kernel_for_block_structure
_two_point_difference_for_block_structure = difference_kernel_for_block_structure


__getattr__ = refuse_names(__name__)
