"""Bending and twist: curvature at Voronoi points and the couples it causes."""

from ...jit.compiler import ONE, stage
from ..math.rotations import half_angle


@stage
def relative_rotation(first, n, Q, axis, cosine):
    """Compute the axial vector a of R = Q[k+1] Q[k]^T, and the cosine of its angle."""
    for k in range(first, n):
        j = k + ONE
        p00, p01, p02 = Q[0][0][k], Q[0][1][k], Q[0][2][k]
        p10, p11, p12 = Q[1][0][k], Q[1][1][k], Q[1][2][k]
        p20, p21, p22 = Q[2][0][k], Q[2][1][k], Q[2][2][k]
        q00, q01, q02 = Q[0][0][j], Q[0][1][j], Q[0][2][j]
        q10, q11, q12 = Q[1][0][j], Q[1][1][j], Q[1][2][j]
        q20, q21, q22 = Q[2][0][j], Q[2][1][j], Q[2][2][j]
        R00 = q00 * p00 + q01 * p01 + q02 * p02
        R11 = q10 * p10 + q11 * p11 + q12 * p12
        R22 = q20 * p20 + q21 * p21 + q22 * p22
        axis[0][k] = 0.5 * ((q20 * p10 + q21 * p11 + q22 * p12) - (q10 * p20 + q11 * p21 + q12 * p22))
        axis[1][k] = 0.5 * ((q00 * p20 + q01 * p21 + q02 * p22) - (q20 * p00 + q21 * p01 + q22 * p02))
        axis[2][k] = 0.5 * ((q10 * p00 + q11 * p01 + q12 * p02) - (q00 * p10 + q01 * p11 + q02 * p12))
        cosine[k] = 0.5 * (R00 + R11 + R22) - 0.5


@stage
def logarithm(first, n, is_balanced, inv_rest_voronoi_length, cosine, kappa, lever):
    """Turn the axial vectors a in ``kappa`` into curvatures: Q[k+1] = exp(-D^ [kappa]x) Q[k].

    With theta the angle of the rotation, kappa = -(theta/|a|) a / D^.

    Sets ``lever``, which transfers a couple from the joint to its elements (see `bending`): kappa D^/2,
    or, if balanced, the same with tan(theta/2) in place of theta/2.
    """
    for k in range(first, n):
        a0, a1, a2 = kappa[0][k], kappa[1][k], kappa[2][k]
        ratio, inv_h = half_angle(cosine[k], a0 * a0 + a1 * a1 + a2 * a2)
        scale = -ratio * inv_h * inv_rest_voronoi_length[k]
        kappa[0][k], kappa[1][k], kappa[2][k] = scale * a0, scale * a1, scale * a2
        scale = -0.5 * inv_h * (inv_h if is_balanced else ratio)
        lever[0][k], lever[1][k], lever[2][k] = scale * a0, scale * a1, scale * a2


@stage
def bending(
    first, n, length, kappa, lever, rest_voronoi_length, B, rest_kappa, is_muscular, rate, target, couple,
    before, after,
):  # fmt: skip
    """Compute the couples on the elements before and after each joint, and activate the muscles.

    With half of kappa x tau_L D^/E^3 and with tau_L/E^3 (Gazzola et al. 2018, eq. 2.21), the element before gets
    their sum and the one after their difference. To be opposite in the lab, the two must be rotated into each
    other by the joint's angle theta; they are if tan(theta/2) replaces theta/2, which is |kappa| D^/2.

    The muscle couple, if any, is added to tau_L, so it acts equally and oppositely on the two elements.
    It approaches its target by the fraction ``rate`` per step.
    """
    for k in range(first, n):
        j = k + ONE
        k0, k1, k2 = kappa[0][k], kappa[1][k], kappa[2][k]
        h0, h1, h2 = lever[0][k], lever[1][k], lever[2][k]
        m0 = m1 = m2 = 0.0
        if is_muscular:
            m0 = couple[0][k] + rate * (target[0][k] - couple[0][k])
            m1 = couple[1][k] + rate * (target[1][k] - couple[1][k])
            m2 = couple[2][k] + rate * (target[2][k] - couple[2][k])
            couple[0][k], couple[1][k], couple[2][k] = m0, m1, m2
        inv_E = 2.0 * rest_voronoi_length[k] / (length[k] + length[j])
        inv_E3 = inv_E * inv_E * inv_E
        t0 = (B[0][k] * (k0 - rest_kappa[0][k]) + m0) * inv_E3
        t1 = (B[1][k] * (k1 - rest_kappa[1][k]) + m1) * inv_E3
        t2 = (B[2][k] * (k2 - rest_kappa[2][k]) + m2) * inv_E3
        c0, c1, c2 = h1 * t2 - h2 * t1, h2 * t0 - h0 * t2, h0 * t1 - h1 * t0
        before[0][k], before[1][k], before[2][k] = c0 + t0, c1 + t1, c2 + t2
        after[0][k], after[1][k], after[2][k] = c0 - t0, c1 - t1, c2 - t2
