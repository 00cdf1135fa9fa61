"""Drift: positions and directors move with their velocities."""

from ...jit.compiler import inline, stage
from ..math.fused import multiply_add
from ..math.rotations import sine_over_angle, versine_over_angle_squared


@inline
def rotation(a0, a1, a2):
    """Return exp(-[a]x) = I - A [a]x + B [a]x^2, with A = sin|a|/|a| and B = (1 - cos|a|)/|a|^2."""
    s = a0 * a0 + a1 * a1 + a2 * a2
    A = sine_over_angle(s)
    B = versine_over_angle_squared(s)
    A0, A1, A2 = A * a0, A * a1, A * a2
    B0, B1, B2 = B * a0, B * a1, B * a2
    return (
        (1.0 - B1 * a1 - B2 * a2, B0 * a1 + A2, B0 * a2 - A1),
        (B0 * a1 - A2, 1.0 - B0 * a0 - B2 * a2, B1 * a2 + A0),
        (B0 * a2 + A1, B1 * a2 - A0, 1.0 - B0 * a0 - B1 * a1),
    )


@inline
def turn(R, q):
    """Return a column of the directors, rotated by R; the order of the sums determines results to the last bit."""
    return (
        multiply_add(R[0][2], q[2], multiply_add(R[0][1], q[1], R[0][0] * q[0])),
        multiply_add(R[1][2], q[2], multiply_add(R[1][0], q[0], R[1][1] * q[1])),
        multiply_add(R[2][2], q[2], multiply_add(R[2][0], q[0], R[2][1] * q[1])),
    )


@stage
def kinematics(first, n, h, x, v, Q, w):
    """Advance x by h v, and Q by the rotation exp(-h [w]x), over a time h (Gazzola et al. 2018, eq. 4.4)."""
    for k in range(first, n):
        x[0][k] = multiply_add(h, v[0][k], x[0][k])
        x[1][k] = multiply_add(h, v[1][k], x[1][k])
        x[2][k] = multiply_add(h, v[2][k], x[2][k])
        R = rotation(h * w[0][k], h * w[1][k], h * w[2][k])
        Q[0][0][k], Q[1][0][k], Q[2][0][k] = turn(R, (Q[0][0][k], Q[1][0][k], Q[2][0][k]))
        Q[0][1][k], Q[1][1][k], Q[2][1][k] = turn(R, (Q[0][1][k], Q[1][1][k], Q[2][1][k]))
        Q[0][2][k], Q[1][2][k], Q[2][2][k] = turn(R, (Q[0][2][k], Q[1][2][k], Q[2][2][k]))


@stage
def kinematics_twice(first, n, h, x, v, Q, w):
    """Apply `kinematics` twice, equal to the last bit, in little more time than once."""
    for k in range(first, n):
        x[0][k] = multiply_add(h, v[0][k], multiply_add(h, v[0][k], x[0][k]))
        x[1][k] = multiply_add(h, v[1][k], multiply_add(h, v[1][k], x[1][k]))
        x[2][k] = multiply_add(h, v[2][k], multiply_add(h, v[2][k], x[2][k]))
        R = rotation(h * w[0][k], h * w[1][k], h * w[2][k])
        Q[0][0][k], Q[1][0][k], Q[2][0][k] = turn(R, turn(R, (Q[0][0][k], Q[1][0][k], Q[2][0][k])))
        Q[0][1][k], Q[1][1][k], Q[2][1][k] = turn(R, turn(R, (Q[0][1][k], Q[1][1][k], Q[2][1][k])))
        Q[0][2][k], Q[1][2][k], Q[2][2][k] = turn(R, turn(R, (Q[0][2][k], Q[1][2][k], Q[2][2][k])))


@stage
def orthonormalise(first, n, Q):
    """Remove rounding errors from the directors: one Newton step Q <- (3 I - Q Q^T) Q / 2 to the nearest rotation."""
    for k in range(first, n):
        q00, q01, q02 = Q[0][0][k], Q[0][1][k], Q[0][2][k]
        q10, q11, q12 = Q[1][0][k], Q[1][1][k], Q[1][2][k]
        q20, q21, q22 = Q[2][0][k], Q[2][1][k], Q[2][2][k]
        g00 = 1.5 - 0.5 * (q00 * q00 + q01 * q01 + q02 * q02)
        g11 = 1.5 - 0.5 * (q10 * q10 + q11 * q11 + q12 * q12)
        g22 = 1.5 - 0.5 * (q20 * q20 + q21 * q21 + q22 * q22)
        g01 = -0.5 * (q00 * q10 + q01 * q11 + q02 * q12)
        g02 = -0.5 * (q00 * q20 + q01 * q21 + q02 * q22)
        g12 = -0.5 * (q10 * q20 + q11 * q21 + q12 * q22)
        Q[0][0][k] = g00 * q00 + g01 * q10 + g02 * q20
        Q[0][1][k] = g00 * q01 + g01 * q11 + g02 * q21
        Q[0][2][k] = g00 * q02 + g01 * q12 + g02 * q22
        Q[1][0][k] = g01 * q00 + g11 * q10 + g12 * q20
        Q[1][1][k] = g01 * q01 + g11 * q11 + g12 * q21
        Q[1][2][k] = g01 * q02 + g11 * q12 + g12 * q22
        Q[2][0][k] = g02 * q00 + g12 * q10 + g22 * q20
        Q[2][1][k] = g02 * q01 + g12 * q11 + g22 * q21
        Q[2][2][k] = g02 * q02 + g12 * q12 + g22 * q22
