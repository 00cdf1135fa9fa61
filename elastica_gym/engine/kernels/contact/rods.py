"""Rods on rods, and on themselves.

Pairs of elements that may touch are listed, with a margin, and the list serves until one of them has
used up its share of it. To list them, a sweep along the axis of the widest extent: elements sorted by
where their balls begin are compared only with those that begin before they end; as the order is
nearly right already, sorting by insertion takes a time that grows with the number of elements. Pairs
are taken in the order of their slots, so that results do not depend on when they were listed.
"""

from math import pi

import numpy as np

from ...jit.compiler import FIRST, ONE, apart, inline, stage
from ...model import NEAR
from ..math.vectors import column, cross, dot, plus, times
from .law import axis_velocity, friction_force, load, middle, normal_force, overlap, spin_velocity, twist


@inline
def widest(x, order):
    """Return the axis, 0 to 2, along which the elements spread furthest."""
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
def reaches(n, length, radius, last_other, last_clear, reach, last_far):
    """Compute the radius of the ball about each element, and the last slot before it that may touch it."""
    for k in range(FIRST, n):
        reach[k] = 0.5 * length[k] + radius[k]
        # a ghost has neither length nor section
        far = (k - ONE) - NEAR * pi * radius[k] / (length[k] if length[k] > 0.0 else 1.0)
        far = far if far < last_clear[k] else last_clear[k]
        last_far[k] = far if far > last_other[k] else last_other[k]


@stage
def strayed(n, x, reach, listed_x, listed_reach, limit):
    """Count the nodes that have moved, and the balls that have grown, by more than ``limit`` since they were listed."""
    count = 0
    for k in range(FIRST, n):
        d0, d1, d2 = x[0][k] - listed_x[0][k], x[1][k] - listed_x[1][k], x[2][k] - listed_x[2][k]
        # false for what is not a number, too
        here = 1 if d0 * d0 + d1 * d1 + d2 * d2 <= limit * limit else 0
        alike = 1 if reach[k] - listed_reach[k] <= limit else 0
        count += 1 - here * alike
    return count


@stage
def extents(n, along, reach, margin, begin, end):
    """Compute where the balls, larger by a margin, begin and end along an axis."""
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
def sort_pairs(pairs, n_pairs):
    """Sort the first pairs, by insertion over shrinking gaps (Shell 1959)."""
    gap = n_pairs // 2
    while gap > 0:
        for a in range(gap, n_pairs):
            pair = pairs[a]
            b = a - gap
            while b >= 0 and pairs[b] > pair:
                pairs[b + gap] = pairs[b]
                b -= gap
            pairs[b + gap] = pair
        gap //= 2


@inline
def list_pairs(contact, order, begin, end, x, reach, margin, pairs):
    """List the pairs of elements whose balls, larger by a margin, overlap and that are not neighbours.

    Returns how many there are, of which as many are listed as there is room for, and how many the sweep has met.
    """
    sort(order, begin)
    n_pairs = n_met = 0
    slots = begin.size
    for a in range(order.size):
        j = order[a]
        until = end[j]
        for b in range(a + 1, order.size):
            k = order[b]
            # false for what is not a number, too
            if not begin[k] <= until:
                break
            n_met += 1
            low, high = (j, k) if j < k else (k, j)
            if low <= contact.last_clear[high]:
                between = plus(middle(x, np.uint64(high)), -1.0, middle(x, np.uint64(low)))
                furthest = reach[low] + reach[high] + 2.0 * margin
                if dot(between, between) < furthest * furthest:
                    if n_pairs < pairs.size:
                        pairs[n_pairs] = low * slots + high
                    n_pairs += 1
    if n_pairs <= pairs.size:
        sort_pairs(pairs, n_pairs)
    return n_pairs, n_met


@apart
def rods_on_rods(
    n, contact, order, pairs, n_pairs, listed_x, listed_reach, begin, end, reach, last_far, x, v, Q, w, length, radius,
    force, torque, touch,
):  # fmt: skip
    """Add the forces between elements of rods that overlap: of two rods, or of one far enough from each other.

    Adds the normal forces to ``touch``. Takes the pairs that are listed, lists them anew
    if an element may have come nearer than the list allows for, and returns how many there are.
    """
    margin, slots = 2.0 * contact.stray, begin.size
    reaches(n, length, radius, contact.last_other, contact.last_clear, reach, last_far)
    if n_pairs < 0 or strayed(n, (x[0], x[1], x[2]), reach, listed_x, listed_reach, contact.stray) > 0:
        extents(n, x[widest(x, order)], reach, margin, begin, end)
        n_pairs, _ = list_pairs(contact, order, begin, end, x, reach, margin, pairs)
        for k in range(slots):
            listed_x[0][k], listed_x[1][k], listed_x[2][k] = x[0, k], x[1, k], x[2, k]
            listed_reach[k] = reach[k]
    if n_pairs <= pairs.size:
        for a in range(n_pairs):
            low, high = pairs[a] // slots, pairs[a] % slots
            if low <= last_far[high]:
                meet(contact, np.uint64(low), np.uint64(high), x, v, Q, w, length, radius, force, torque, touch)
    else:
        # no room for so many: all of them, in the same order
        for low in range(slots - 1):
            for high in range(low + 1, slots - 1):
                if low <= last_far[high] and radius[low] > 0.0 and radius[high] > 0.0:
                    meet(contact, np.uint64(low), np.uint64(high), x, v, Q, w, length, radius, force, torque, touch)
    return n_pairs


@inline
def meet(contact, j, k, x, v, Q, w, length, radius, force, torque, touch):
    """Add the forces between elements j and k, if they overlap."""
    at_j, at_k = middle(x, j), middle(x, k)
    between = plus(at_k, -1.0, at_j)
    reach = radius[j] + radius[k] + 0.5 * (length[j] + length[k])
    if dot(between, between) < reach * reach:
        a, b = column(x, j), column(x, k)
        e, f = plus(column(x, j + ONE), -1.0, a), plus(column(x, k + ONE), -1.0, b)
        g, n, s, t = overlap(a, e, radius[j], b, f, radius[k], True)
        if g > 0.0:
            u = plus(axis_velocity(v, j, s), -1.0, axis_velocity(v, k, t))
            N = normal_force(g, dot(u, n), contact.stiffness, contact.damping)
            push = times(N, n)
            if contact.friction > 0.0:
                arm_j, arm_k = times(radius[j] - 0.5 * g, n), times(0.5 * g - radius[k], n)
                u = plus(u, 1.0, plus(spin_velocity(Q, w, j, arm_j), -1.0, spin_velocity(Q, w, k, arm_k)))
                rub = friction_force(n, u, N, contact.friction, contact.slip_damping)
                push = plus(push, 1.0, rub)
                twist(torque, Q, j, cross(rub, arm_j))
                twist(torque, Q, k, cross(arm_k, rub))
            load(force, j, s, times(-1.0, push))
            load(force, k, t, push)
            touch[j] += N
            touch[k] += N
