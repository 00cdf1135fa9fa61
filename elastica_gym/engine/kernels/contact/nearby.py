"""Which elements are near each other, found in a time that grows with their number alone.

Space is cut into cells so wide that whatever may touch an element is in its own cell or in one of the 26
around it. Cells are kept in buckets by a hash of their place (Teschner et al. 2003), elements in each in
ascending order.
"""

from math import floor

import numpy as np

from ...jit.compiler import apart, inline
from ..math.vectors import dot, plus
from .law import middle


@inline
def bucket_of(i, j, k, n_buckets):
    """Return the bucket of a cell; their number is a power of two."""
    return ((i * 73856093) ^ (j * 19349663) ^ (k * 83492791)) & (n_buckets - 1)


@inline
def cell_of(centre, width, number):
    """Return the cell of a place. What is not a number is nowhere near the others, wherever it is put."""
    c0, c1, c2 = centre
    if abs(c0) + abs(c1) + abs(c2) < 1e15 * width:
        return np.int64(floor(c0 / width)), np.int64(floor(c1 / width)), np.int64(floor(c2 / width))
    return number, number, number


@apart
def fill(elements, x, width, cell, bucket, member):
    """Sort elements, by their place in ``elements``, into cells of a width."""
    n_buckets = bucket.size - 1
    bucket[:] = 0
    for a in range(elements.size):
        i, j, k = cell_of(middle(x, np.uint64(elements[a])), width, a)
        cell[a, 0], cell[a, 1], cell[a, 2] = i, j, k
        bucket[bucket_of(i, j, k, n_buckets)] += 1
    total = 0
    for b in range(n_buckets):
        total += bucket[b]
        bucket[b] = total
    bucket[n_buckets] = total
    # each bucket is filled from its end, so the last element goes first
    for a in range(elements.size - 1, -1, -1):
        b = bucket_of(cell[a, 0], cell[a, 1], cell[a, 2], n_buckets)
        bucket[b] -= 1
        member[bucket[b]] = a


@inline
def gather(a, elements, x, reach, margin, cell, bucket, member, near):
    """Put into ``near`` the elements after ``a`` whose balls, larger by a margin, overlap its, and return how many.

    In ascending order, so that what is computed from them does not depend on the cells.
    """
    count = 0
    at_a, reach_a = middle(x, np.uint64(elements[a])), reach[elements[a]] + 2.0 * margin
    for step in range(27):
        i, j, k = cell[a, 0] + step // 9 - 1, cell[a, 1] + step // 3 % 3 - 1, cell[a, 2] + step % 3 - 1
        place = bucket_of(i, j, k, bucket.size - 1)
        for m in range(bucket[place], bucket[place + 1]):
            b = member[m]
            if b > a and cell[b, 0] == i and cell[b, 1] == j and cell[b, 2] == k:
                between = plus(middle(x, np.uint64(elements[b])), -1.0, at_a)
                furthest = reach_a + reach[elements[b]]
                if dot(between, between) < furthest * furthest:
                    free = count
                    while free > 0 and near[free - 1] > b:
                        near[free] = near[free - 1]
                        free -= 1
                    near[free] = b
                    count += 1
    return count
