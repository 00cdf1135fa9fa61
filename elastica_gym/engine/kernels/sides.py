"""Elements of rods that run side by side, joined where their surfaces face each other (Zhang et al. 2019)."""

from math import sqrt

import numpy as np

from ..jit.compiler import ONE, apart, inline
from .contact.law import middle, twist
from .math.vectors import add_column, cross, dot, plus, times, to_lab_at, vector

# distances are rounded to this fraction of a metre, so that rods at rest stay at rest
PARTS = 1e12


@inline
def rounded(a):
    """Return a distance, rounded [m]."""
    return np.rint(PARTS * a) / PARTS


@inline
def reach(k, offset, length, rest_length, radius):
    """Return the distance from its axis at which an element is joined: half the offset scales with its radius [m]."""
    return radius[k] + 0.5 * offset * sqrt(rest_length[k] / length[k])


@inline
def load(force, torque, Q, k, f, arm):
    """Add a force f on element k, ``arm`` from its centre: half of it to each node, and the torque to the element."""
    add_column(force, k, 0.5, f)
    add_column(force, k + ONE, 0.5, f)
    twist(torque, Q, k, cross(arm, f))


@apart
def join_sides(sides, x, v, Q, length, rest_length, radius, force, torque):
    """Add springs between points of two surfaces, and dampers and repulsion between the elements."""
    for j in range(sides.stiffness.size):
        one, two = np.uint64(sides.element[j, 0]), np.uint64(sides.element[j, 1])
        r1 = reach(one, sides.offset[j], length, rest_length, radius)
        r2 = reach(two, sides.offset[j], length, rest_length, radius)
        arm_one = times(r1, to_lab_at(Q, one, vector(sides.towards[j, 0])))
        arm_two = times(r2, to_lab_at(Q, two, vector(sides.towards[j, 1])))
        between = plus(middle(x, two), -1.0, middle(x, one))
        gap = plus(plus(between, 1.0, arm_two), -1.0, arm_one)
        pull = times(sides.stiffness[j], (rounded(gap[0]), rounded(gap[1]), rounded(gap[2])))
        rest = times(sides.damping[j], plus(middle(v, two), -1.0, middle(v, one)))
        distance = sqrt(dot(between, between))
        depth = -rounded(distance - r1 - r2)
        if depth > 0.0:
            rest = plus(rest, -sides.repulsion[j] * depth * sqrt(depth) / distance, between)
        # dampers and repulsion act on the centres
        load(force, torque, Q, one, pull, arm_one)
        load(force, torque, Q, two, times(-1.0, pull), arm_two)
        load(force, torque, Q, one, rest, (0.0, 0.0, 0.0))
        load(force, torque, Q, two, times(-1.0, rest), (0.0, 0.0, 0.0))
