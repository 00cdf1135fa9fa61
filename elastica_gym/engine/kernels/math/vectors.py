"""Vectors of three components, for physics computed one body or one contact at a time.

Vectors are tuples of three numbers; Q holds directors as rows, so that Q a is a in the material frame.
"""

from math import sqrt

from ...jit.compiler import inline


@inline
def vector(row):
    """Return the three numbers of an array as a tuple."""
    return row[0], row[1], row[2]


@inline
def column(rows, k):
    """Return the vector in slot k of a (3, L) array."""
    return rows[0, k], rows[1, k], rows[2, k]


@inline
def dot(a, b):
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inline
def norm(a):
    """Return the length of a."""
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@inline
def cross(a, b):
    """Return a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inline
def times(s, a):
    """Return s a."""
    return s * a[0], s * a[1], s * a[2]


@inline
def plus(a, s, b):
    """Return a + s b."""
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@inline
def to_material(Q, a):
    """Return Q a for directors Q, (3, 3)."""
    return (
        Q[0, 0] * a[0] + Q[0, 1] * a[1] + Q[0, 2] * a[2],
        Q[1, 0] * a[0] + Q[1, 1] * a[1] + Q[1, 2] * a[2],
        Q[2, 0] * a[0] + Q[2, 1] * a[1] + Q[2, 2] * a[2],
    )


@inline
def to_lab(Q, a):
    """Return Q^T a for directors Q, (3, 3)."""
    return (
        Q[0, 0] * a[0] + Q[1, 0] * a[1] + Q[2, 0] * a[2],
        Q[0, 1] * a[0] + Q[1, 1] * a[1] + Q[2, 1] * a[2],
        Q[0, 2] * a[0] + Q[1, 2] * a[1] + Q[2, 2] * a[2],
    )


@inline
def to_material_at(Q, k, a):
    """Return Q a for the directors in slot k of a (3, 3, L) array."""
    return (
        Q[0, 0, k] * a[0] + Q[0, 1, k] * a[1] + Q[0, 2, k] * a[2],
        Q[1, 0, k] * a[0] + Q[1, 1, k] * a[1] + Q[1, 2, k] * a[2],
        Q[2, 0, k] * a[0] + Q[2, 1, k] * a[1] + Q[2, 2, k] * a[2],
    )


@inline
def to_lab_at(Q, k, a):
    """Return Q^T a for the directors in slot k of a (3, 3, L) array."""
    return (
        Q[0, 0, k] * a[0] + Q[1, 0, k] * a[1] + Q[2, 0, k] * a[2],
        Q[0, 1, k] * a[0] + Q[1, 1, k] * a[1] + Q[2, 1, k] * a[2],
        Q[0, 2, k] * a[0] + Q[1, 2, k] * a[1] + Q[2, 2, k] * a[2],
    )


@inline
def add(row, s, a):
    """Add s a to an array of three numbers."""
    row[0] += s * a[0]
    row[1] += s * a[1]
    row[2] += s * a[2]


@inline
def add_column(rows, k, s, a):
    """Add s a to slot k of a (3, L) array."""
    rows[0, k] += s * a[0]
    rows[1, k] += s * a[1]
    rows[2, k] += s * a[2]
