"""Closed rods: the image of the first element, at the end, follows it and passes its loads to it."""

from ...jit.compiler import apart


@apart
def follow(rings, x, v, Q, w):
    """Copy the motion of the first two nodes and the first element to their images."""
    for j in range(rings.first.size):
        k = rings.first[j]
        m = k + rings.n_elements[j]
        for d in range(3):
            x[d, m], x[d, m + 1] = x[d, k], x[d, k + 1]
            v[d, m], v[d, m + 1] = v[d, k], v[d, k + 1]
            w[d, m] = w[d, k]
            for c in range(3):
                Q[d, c, m] = Q[d, c, k]


@apart
def hand_back(rings, force, torque):
    """Move the loads on the images to the first node and element."""
    for j in range(rings.first.size):
        k = rings.first[j]
        m = k + rings.n_elements[j]
        for d in range(3):
            force[d, k] += force[d, m]
            torque[d, k] += torque[d, m]
            force[d, m] = torque[d, m] = 0.0
