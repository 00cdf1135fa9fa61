"""Places of a node or element of a rod, or of a rigid body, by one number.

A number from 0 on is a slot of the rods' arrays, -1 - b stands for body b.
"""

from ..jit.compiler import inline
from .math.vectors import add, add_column, column, to_lab, to_lab_at, to_material, to_material_at, vector


@inline
def vector_of(rods, bodies, k):
    """Return a vector of a node, element or body."""
    return column(rods, k) if k >= 0 else vector(bodies[-1 - k])


@inline
def add_to(rods, bodies, k, s, a):
    """Add s a to a vector of a node, element or body."""
    if k >= 0:
        add_column(rods, k, s, a)
    else:
        add(bodies[-1 - k], s, a)


@inline
def set_to(rods, bodies, k, d, value):
    """Set component d of a vector of a node, element or body."""
    if k >= 0:
        rods[d, k] = value
    else:
        bodies[-1 - k, d] = value


@inline
def lab_of(Q, body_Q, k, a):
    """Return Q^T a of an element or body."""
    return to_lab_at(Q, k, a) if k >= 0 else to_lab(body_Q[-1 - k], a)


@inline
def material_of(Q, body_Q, k, a):
    """Return Q a of an element or body."""
    return to_material_at(Q, k, a) if k >= 0 else to_material(body_Q[-1 - k], a)


@inline
def director_of(Q, body_Q, k, i):
    """Return director i of an element or body."""
    return (Q[i, 0, k], Q[i, 1, k], Q[i, 2, k]) if k >= 0 else vector(body_Q[-1 - k, i])
