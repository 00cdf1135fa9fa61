"""Rods on rods, and on themselves."""

from math import pi

import numpy as np

from ...jit.compiler import FIRST, ONE, apart, inline, stage
from ...model import NEAR
from ..math.vectors import column, cross, dot, plus, times
from .broad_phase import update_neighbour_list
from .law import axis_velocity, friction_force, load, middle, normal_force, overlap, spin_velocity, twist


@stage
def reaches(n, length, radius, stretch, last_other, last_clear, reach, last_far):
    """Compute the radius of each element's bounding sphere, and the last slot before it that may touch it.

    The slot is that of an element longer by ``stretch``.
    """
    for k in range(FIRST, n):
        reach[k] = 0.5 * length[k] + radius[k]
        # a ghost has neither length nor cross-section
        far = (k - ONE) - NEAR * pi * radius[k] / (length[k] + stretch if length[k] > 0.0 else 1.0)
        far = far if far < last_clear[k] else last_clear[k]
        last_far[k] = far if far > last_other[k] else last_other[k]


@apart
def rods_on_rods(
    n, contact, order, neighbours, n_neighbours, neighbour_x, neighbour_reach, begin, end, reach, last_far, x, v, Q, w,
    length, radius, force, torque, touch,
):  # fmt: skip
    """Add the forces between overlapping elements, of two rods or far enough apart along one.

    Adds the normal forces to ``touch``, and returns the number of neighbouring pairs.
    """
    slots = begin.size
    reaches(n, length, radius, 0.0, contact.last_other, contact.last_clear, reach, last_far)
    n_neighbours, _ = update_neighbour_list(
        n,
        order,
        neighbours,
        n_neighbours,
        neighbour_x,
        neighbour_reach,
        contact.stray,
        begin,
        end,
        reach,
        contact.last_clear,
        x,
    )
    if n_neighbours <= neighbours.size:
        for a in range(n_neighbours):
            low, high = neighbours[a] // slots, neighbours[a] % slots
            if low <= last_far[high]:
                contact_of_pair(
                    contact, np.uint64(low), np.uint64(high), x, v, Q, w, length, radius, force, torque, touch
                )
    else:
        # they do not fit in the list: test all pairs, in the same order
        for low in range(slots - 1):
            for high in range(low + 1, slots - 1):
                if low <= last_far[high] and radius[low] > 0.0 and radius[high] > 0.0:
                    contact_of_pair(
                        contact, np.uint64(low), np.uint64(high), x, v, Q, w, length, radius, force, torque, touch
                    )
    return n_neighbours


@inline
def contact_of_pair(contact, j, k, x, v, Q, w, length, radius, force, torque, touch):
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
                friction = friction_force(n, u, N, contact.friction, contact.slip_damping)
                push = plus(push, 1.0, friction)
                twist(torque, Q, j, cross(friction, arm_j))
                twist(torque, Q, k, cross(arm_k, friction))
            load(force, j, s, times(-1.0, push))
            load(force, k, t, push)
            touch[j] += N
            touch[k] += N
