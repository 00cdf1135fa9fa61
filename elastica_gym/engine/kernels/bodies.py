"""Rigid bodies: drift and kick of their six degrees of freedom, and their weight.

Arrays are one environment's: x, v, force (C, 3) in the lab, Q (C, 3, 3), w, torque (C, 3) in the
material frame, J (C, 3) the diagonal of the moment of inertia.
"""

from ..jit.compiler import apart
from .math.rotations import sine_over_angle, versine_over_angle_squared
from .math.vectors import add, cross, dot, plus, times, vector


@apart
def drift_bodies(h, x, v, Q, w):
    """Advance x by h v, and Q by the rotation exp(-h [w]x), over a time h."""
    for b in range(x.shape[0]):
        add(x[b], h, vector(v[b]))
        a = times(h, vector(w[b]))
        s = dot(a, a)
        A, B = sine_over_angle(s), versine_over_angle_squared(s)
        for c in range(3):
            # exp(-[a]x) q = q - A a x q + B a x (a x q), for each column q of Q
            q = Q[b, 0, c], Q[b, 1, c], Q[b, 2, c]
            aq = cross(a, q)
            q = plus(plus(q, -A, aq), B, cross(a, aq))
            Q[b, 0, c], Q[b, 1, c], Q[b, 2, c] = q


@apart
def weigh_bodies(mass, gravity, force, torque):
    """Set the force on each body to its weight, and the torque to zero."""
    for b in range(mass.size):
        for c in range(3):
            force[b, c] = mass[b] * gravity[c]
            torque[b, c] = 0.0


@apart
def kick_bodies(dt, mass, J, force, torque, v, w):
    """Advance v by dt F/m and w by dt J^-1 ((J w) x w + T)."""
    for b in range(mass.size):
        add(v[b], dt / mass[b], vector(force[b]))
        spin = vector(w[b])
        momentum = J[b, 0] * spin[0], J[b, 1] * spin[1], J[b, 2] * spin[2]
        turn = plus(vector(torque[b]), 1.0, cross(momentum, spin))
        for c in range(3):
            w[b, c] += dt * turn[c] / J[b, c]


@apart
def orthonormalise_bodies(Q):
    """Remove rounding errors from the directors: one Newton step Q <- (3 I - Q Q^T) Q / 2 to the nearest rotation."""
    for b in range(Q.shape[0]):
        q0, q1, q2 = vector(Q[b, 0]), vector(Q[b, 1]), vector(Q[b, 2])
        g01, g02, g12 = -0.5 * dot(q0, q1), -0.5 * dot(q0, q2), -0.5 * dot(q1, q2)
        p0 = plus(plus(times(1.5 - 0.5 * dot(q0, q0), q0), g01, q1), g02, q2)
        p1 = plus(plus(times(1.5 - 0.5 * dot(q1, q1), q1), g01, q0), g12, q2)
        p2 = plus(plus(times(1.5 - 0.5 * dot(q2, q2), q2), g02, q0), g12, q1)
        for c in range(3):
            Q[b, 0, c], Q[b, 1, c], Q[b, 2, c] = p0[c], p1[c], p2[c]
