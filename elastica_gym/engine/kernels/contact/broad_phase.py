"""The broad phase: which elements may touch each other.

Pairs are listed with a margin, and the list is valid until an element has used up its share of the margin. It
is built by a sweep along the axis of the widest extent: elements, sorted by where their bounding spheres begin,
are compared only with those that begin before they end; as they are nearly sorted already, insertion sort takes
a time proportional to the number of elements. Pairs are processed in the order of their slots, so that results
do not depend on when the list was built.
"""

import numpy as np

from ...jit.compiler import FIRST, ONE, inline, stage
from ..math.vectors import dot, plus
from .law import middle


@inline
def widest(x, order):
    """Return the axis, 0 to 2, along which the elements have the widest extent."""
    best, axis = -1.0, 0
    for c in range(3):
        row = x[c]
        low = high = row[order[0]]
        for a in range(order.size):
            here = row[order[a]]
            low = here if here < low else low
            high = here if here > high else high
        if high - low > best:
            best, axis = high - low, c
    return axis


@stage
def count_displaced(n, x, reach, neighbour_x, neighbour_reach, limit):
    """Count the nodes that moved, and the spheres that grew, by more than ``limit`` since the list was built."""
    count = 0
    for k in range(FIRST, n):
        d0, d1, d2 = (
            x[0][k] - neighbour_x[0][k],
            x[1][k] - neighbour_x[1][k],
            x[2][k] - neighbour_x[2][k],
        )
        # also false for NaN
        here = 1 if d0 * d0 + d1 * d1 + d2 * d2 <= limit * limit else 0
        alike = 1 if reach[k] - neighbour_reach[k] <= limit else 0
        count += 1 - here * alike
    return count


@stage
def extents(n, along, reach, margin, begin, end):
    """Compute where the bounding spheres, enlarged by a margin, begin and end along an axis."""
    for k in range(FIRST, n):
        centre = 0.5 * (along[k] + along[k + ONE])
        begin[k], end[k] = centre - (reach[k] + margin), centre + (reach[k] + margin)


@inline
def sort(order, key):
    """Sort the slots in ``order`` by their ``key``, then by number."""
    for a in range(1, order.size):
        k = order[a]
        b = a - 1
        while b >= 0 and (key[order[b]] > key[k] or (key[order[b]] == key[k] and order[b] > k)):
            order[b + 1] = order[b]
            b -= 1
        order[b + 1] = k


@inline
def sort_pairs(neighbours, n_neighbours):
    """Sort the first pairs, by insertion over shrinking gaps (Shell 1959)."""
    gap = n_neighbours // 2
    while gap > 0:
        for a in range(gap, n_neighbours):
            pair = neighbours[a]
            b = a - gap
            while b >= 0 and neighbours[b] > pair:
                neighbours[b + gap] = neighbours[b]
                b -= gap
            neighbours[b + gap] = pair
        gap //= 2


@inline
def build_neighbour_list(order, begin, end, x, reach, last_clear, margin, neighbours):
    """List the pairs of elements whose bounding spheres, enlarged by a margin, overlap.

    Omits pairs whose lower slot is beyond the last one that may touch the higher. Returns the number of pairs, also
    of those that do not fit in the list, and the number that the sweep compared.
    """
    sort(order, begin)
    n_neighbours = n_met = 0
    slots = begin.size
    for a in range(order.size):
        j = order[a]
        until = end[j]
        for b in range(a + 1, order.size):
            k = order[b]
            # also false for NaN
            if not begin[k] <= until:
                break
            n_met += 1
            low, high = (j, k) if j < k else (k, j)
            if low <= last_clear[high]:
                between = plus(middle(x, np.uint64(high)), -1.0, middle(x, np.uint64(low)))
                furthest = reach[low] + reach[high] + 2.0 * margin
                if dot(between, between) < furthest * furthest:
                    if n_neighbours < neighbours.size:
                        neighbours[n_neighbours] = low * slots + high
                    n_neighbours += 1
    if n_neighbours <= neighbours.size:
        sort_pairs(neighbours, n_neighbours)
    return n_neighbours, n_met


@inline
def update_neighbour_list(
    n, order, neighbours, n_neighbours, neighbour_x, neighbour_reach, stray, begin, end, reach, last_clear, x,
):  # fmt: skip
    """Rebuild the neighbour list if an element may have used up its margin.

    Returns the number of pairs, and whether the list is new.
    """
    is_new = n_neighbours < 0 or count_displaced(n, (x[0], x[1], x[2]), reach, neighbour_x, neighbour_reach, stray) > 0
    if is_new:
        margin = 2.0 * stray
        extents(n, x[widest(x, order)], reach, margin, begin, end)
        n_neighbours, _ = build_neighbour_list(order, begin, end, x, reach, last_clear, margin, neighbours)
        for k in range(begin.size):
            neighbour_x[0][k], neighbour_x[1][k], neighbour_x[2][k] = x[0, k], x[1, k], x[2, k]
            neighbour_reach[k] = reach[k]
    return n_neighbours, is_new
