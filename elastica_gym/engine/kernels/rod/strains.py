"""Shear and stretch: lengths, element strains, the internal force they cause, and their torques."""

from ...jit.compiler import ONE, stage
from ..math.roots import TINY, inverse_fourth_root


@stage
def stretch(first, n, x, volume_root, length, inv_length, radius):
    """Compute l, 1/l and r = sqrt(V/(pi l))."""
    for k in range(first, n):
        j = k + ONE
        d0, d1, d2 = x[0][j] - x[0][k], x[1][j] - x[1][k], x[2][j] - x[2][k]
        l_squared = d0 * d0 + d1 * d1 + d2 * d2
        # the nodes of a ghost may coincide
        l_squared = l_squared if l_squared > TINY else TINY
        inv_root = inverse_fourth_root(l_squared)
        inv_l = inv_root * inv_root
        length[k], inv_length[k] = l_squared * inv_l, inv_l
        radius[k] = volume_root[k] * inv_root


@stage
def strains(
    first, n, x, v, Q, w, inv_length, rest_length, inv_rest_length, rest_sigma, S, J, stress, torque,
):  # fmt: skip
    """Compute n = Q^T n_L / e and the element's own torques (Gazzola et al. 2018, eq. 2.20, 2.21).

    The torques are those of shear, (Q t x n_L) l^, and of transport, (J w/e) x w + (J w/e^2) de/dt.
    """
    for k in range(first, n):
        j = k + ONE
        d0, d1, d2 = x[0][j] - x[0][k], x[1][j] - x[1][k], x[2][j] - x[2][k]
        u0, u1, u2 = v[0][j] - v[0][k], v[1][j] - v[1][k], v[2][j] - v[2][k]
        q00, q01, q02 = Q[0][0][k], Q[0][1][k], Q[0][2][k]
        q10, q11, q12 = Q[1][0][k], Q[1][1][k], Q[1][2][k]
        q20, q21, q22 = Q[2][0][k], Q[2][1][k], Q[2][2][k]
        inv_l = inv_length[k]
        inv_e = rest_length[k] * inv_l

        # e Q t = Q dx / l^
        s0 = (q00 * d0 + q01 * d1 + q02 * d2) * inv_rest_length[k]
        s1 = (q10 * d0 + q11 * d1 + q12 * d2) * inv_rest_length[k]
        s2 = (q20 * d0 + q21 * d1 + q22 * d2) * inv_rest_length[k]
        n0 = S[0][k] * (s0 - rest_sigma[0][k]) * inv_e
        n1 = S[1][k] * (s1 - rest_sigma[1][k]) * inv_e
        n2 = S[2][k] * (s2 - 1.0 - rest_sigma[2][k]) * inv_e
        stress[0][k] = q00 * n0 + q10 * n1 + q20 * n2
        stress[1][k] = q01 * n0 + q11 * n1 + q21 * n2
        stress[2][k] = q02 * n0 + q12 * n1 + q22 * n2

        w0, w1, w2 = w[0][k], w[1][k], w[2][k]
        L0, L1, L2 = J[0][k] * w0 * inv_e, J[1][k] * w1 * inv_e, J[2][k] * w2 * inv_e
        rate = (d0 * u0 + d1 * u1 + d2 * u2) * inv_l * inv_l
        torque[0][k] = (s1 * n2 - s2 * n1) * rest_length[k] + (L1 * w2 - L2 * w1) + L0 * rate
        torque[1][k] = (s2 * n0 - s0 * n2) * rest_length[k] + (L2 * w0 - L0 * w2) + L1 * rate
        torque[2][k] = (s0 * n1 - s1 * n0) * rest_length[k] + (L0 * w1 - L1 * w0) + L2 * rate
