"""A slender body in a viscous fluid (Gazzola et al. 2018, eq. 4.13)."""

from math import log, pi

from ...jit.compiler import apart


@apart
def resist(first, last, mu, x, v, weight, length, radius, force):
    """Add -4 pi mu l / ln(L/r) (I - t t^T/2) v on the elements from first to last - 1, half to each node."""
    total = 0.0
    for k in range(first, last):
        total += length[k]
    for k in range(first, last):
        inv_l = 1.0 / length[k]
        p, q = weight[0, k], weight[1, k]
        t0, t1, t2 = x[0, k + 1] - x[0, k], x[1, k + 1] - x[1, k], x[2, k + 1] - x[2, k]
        u0, u1, u2 = p * v[0, k] + q * v[0, k + 1], p * v[1, k] + q * v[1, k + 1], p * v[2, k] + q * v[2, k + 1]
        along = 0.5 * (t0 * u0 + t1 * u1 + t2 * u2) * inv_l * inv_l
        half = -2.0 * pi * mu * length[k] / log(total / radius[k])
        f0, f1, f2 = half * (u0 - along * t0), half * (u1 - along * t1), half * (u2 - along * t2)
        force[0, k] += f0
        force[1, k] += f1
        force[2, k] += f2
        force[0, k + 1] += f0
        force[1, k + 1] += f1
        force[2, k + 1] += f2
