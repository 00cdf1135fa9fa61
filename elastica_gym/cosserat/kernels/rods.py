"""Rods on rods, and on themselves.

The broad phase sweeps along the axis of the widest extent: elements sorted by where their balls
begin are compared only with those that begin before they end. The order is total (ties by slot), so
that which pairs are met, and in which order, does not depend on what was sorted before; and as it
is nearly right already, sorting by insertion takes a time that grows with the number of elements.
"""

from math import pi

import numpy as np

from ..model import NEAR
from .compiler import FIRST, ONE, apart, inner, stage
from .contact import load, middle, overlap, press, surface_velocity
from .vectors import column, dot, plus, times


@inner
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
def extents(n, along, length, radius, last_other, last_clear, begin, end, last_far):
    """Compute where the balls about elements begin and end, and the last slot before each that may touch it."""
    for k in range(FIRST, n):
        reach = 0.5 * length[k] + radius[k]
        centre = 0.5 * (along[k] + along[k + ONE])
        begin[k], end[k] = centre - reach, centre + reach
        # a ghost has neither length nor section
        far = (k - ONE) - NEAR * pi * radius[k] / (length[k] if length[k] > 0.0 else 1.0)
        far = far if far < last_clear[k] else last_clear[k]
        last_far[k] = far if far > last_other[k] else last_other[k]


@inner
def sort(order, begin):
    """Sort the slots in ``order`` by ``begin``, then by number."""
    for a in range(1, order.size):
        k = order[a]
        key = begin[k]
        b = a - 1
        while b >= 0 and (begin[order[b]] > key or (begin[order[b]] == key and order[b] > k)):
            order[b + 1] = order[b]
            b -= 1
        order[b + 1] = k


@apart
def rods_on_rods(n, contact, order, begin, end, last_far, x, v, Q, w, length, radius, force, torque, touch):
    """Add the forces between elements of rods that overlap: of two rods, or of one far enough from each other.

    Half of the force on an element goes to each of its nodes; both get the torque of the force about
    their centre. Adds the normal forces to ``touch``. Returns how many pairs the sweep has met.
    """
    extents(n, x[widest(x, order)], length, radius, contact.last_other, contact.last_clear, begin, end, last_far)
    sort(order, begin)
    n_met = 0
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
            if not low > last_far[high]:
                meet(contact, np.uint64(low), np.uint64(high), x, v, Q, w, length, radius, force, torque, touch)
    return n_met


@inner
def meet(contact, j, k, x, v, Q, w, length, radius, force, torque, touch):
    """Add the forces between elements j and k, if they overlap."""
    at_j, at_k = middle(x, j), middle(x, k)
    between = plus(at_k, -1.0, at_j)
    reach = radius[j] + radius[k] + 0.5 * (length[j] + length[k])
    if dot(between, between) < reach * reach:
        a, b = column(x, j), column(x, k)
        e, f = plus(column(x, j + ONE), -1.0, a), plus(column(x, k + ONE), -1.0, b)
        g, normal, point = overlap(a, e, radius[j], b, f, radius[k])
        if g > 0.0:
            arm_j, arm_k = plus(point, -1.0, at_j), plus(point, -1.0, at_k)
            u = plus(surface_velocity(v, Q, w, j, arm_j), -1.0, surface_velocity(v, Q, w, k, arm_k))
            push, N = press(g, normal, u, contact.stiffness, contact.damping, contact.friction, contact.slip_damping)
            load(force, torque, Q, j, times(-1.0, push), arm_j)
            load(force, torque, Q, k, push, arm_k)
            touch[j] += N
            touch[k] += N
