"""Parts of Model and State as kernels take them: rows of arrays, and spans of slots."""

import numpy as np

from ..jit.compiler import inline
from ..model import BLOCK


@inline
def rows(a):
    """Return the three rows of a (3, L) array, which the stages take separately."""
    return a[0], a[1], a[2]


@inline
def matrix(a):
    """Return the nine rows of a (3, 3, L) array."""
    return rows(a[0]), rows(a[1]), rows(a[2])


@inline
def span_of(span):
    """Return the first slot of a span and the one after its last."""
    return np.uint64(span[0]), np.uint64(span[1])


@inline
def end_of(model):
    """Return the number of slots that stages work on: those of all rods, up to the end of a block."""
    return np.uint64(-(-(model.first_slot[-1] + model.n_elements[-1] + 1) // BLOCK) * BLOCK)
