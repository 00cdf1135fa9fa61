"""The tension that makes the documented internal loads derive from a potential.

Couples scale with 1/E^3, forces with 1/e and spins with J/e. They are the derivatives, by angles and shear, of
tau_L.B^-1 tau_L D^/(2 E^3), tau_L = B (kappa - kappa^), and (sigma - sigma^).S (sigma - sigma^) l^/(2 e), and of the
Lagrangian's w.J w/(2 e); the tension is the missing derivative, by length. A muscle couple is part of tau_L, as if it
shifted kappa^: with the tension of the passive part alone, an arm that muscles hold bent flutters.
"""

from ...jit.compiler import ONE, apart, inline, stage


@inline
def bend_energy_rate(k, length, kappa, rest_kappa, rest_voronoi_length, B, inv_B, is_muscular, couple):
    """Return 3/4 tau_L.B^-1 tau_L/E^4 at the joint after element k, 0 if it is a ghost [N]."""
    inv_E = 2.0 * rest_voronoi_length[k] / (length[k] + length[k + ONE])
    t0, t1, t2 = (couple[0][k], couple[1][k], couple[2][k]) if is_muscular else (0.0, 0.0, 0.0)
    t0 += B[0][k] * (kappa[0][k] - rest_kappa[0][k])
    t1 += B[1][k] * (kappa[1][k] - rest_kappa[1][k])
    t2 += B[2][k] * (kappa[2][k] - rest_kappa[2][k])
    squares = inv_B[0][k] * t0 * t0 + inv_B[1][k] * t1 * t1 + inv_B[2][k] * t2 * t2
    return 0.75 * squares * inv_E * inv_E * inv_E * inv_E


@inline
def pull(k, x, Q, w, inv_l, rest_length, inv_rest_length, rest_sigma, S, J, before, after):
    """Return the tension of element k as a vector from its first node to its second, with the rates of its joints."""
    j = k + ONE
    d0, d1, d2 = x[0][j] - x[0][k], x[1][j] - x[1][k], x[2][j] - x[2][k]
    inv_rest = inv_rest_length[k]
    s0 = (Q[0][0][k] * d0 + Q[0][1][k] * d1 + Q[0][2][k] * d2) * inv_rest - rest_sigma[0][k]
    s1 = (Q[1][0][k] * d0 + Q[1][1][k] * d1 + Q[1][2][k] * d2) * inv_rest - rest_sigma[1][k]
    s2 = (Q[2][0][k] * d0 + Q[2][1][k] * d1 + Q[2][2][k] * d2) * inv_rest - rest_sigma[2][k] - 1.0
    shear = S[0][k] * s0 * s0 + S[1][k] * s1 * s1 + S[2][k] * s2 * s2
    spin = J[0][k] * w[0][k] * w[0][k] + J[1][k] * w[1][k] * w[1][k] + J[2][k] * w[2][k] * w[2][k]
    inv_e = rest_length[k] * inv_l
    tension = (0.5 * (spin * inv_rest - shear) * inv_e * inv_e - before - after) * inv_l
    return tension * d0, tension * d1, tension * d2


@stage
def bend_energy_rates(
    first, n, length, kappa, rest_kappa, rest_voronoi_length, B, inv_B, is_muscular, couple, rate
):  # fmt: skip
    """Compute the rate at which the energy of each joint falls with its length."""
    for k in range(first, n):
        rate[k] = bend_energy_rate(k, length, kappa, rest_kappa, rest_voronoi_length, B, inv_B, is_muscular, couple)


@stage
def tension(first, n, x, Q, w, inv_length, rest_length, inv_rest_length, rest_sigma, S, J, rate, stress):
    """Add the tension of each element to its stress."""
    for k in range(first, n):
        inv_l, before, after = inv_length[k], rate[k - ONE], rate[k]
        p0, p1, p2 = pull(k, x, Q, w, inv_l, rest_length, inv_rest_length, rest_sigma, S, J, before, after)
        stress[0][k] += p0
        stress[1][k] += p1
        stress[2][k] += p2


@apart
def reciprocate(
    first, last, is_closed, x, Q, w, length, rest_length, inv_rest_length, rest_sigma, S, J, rate, force,
):  # fmt: skip
    """Add the tension of the elements of a rod from slot ``first`` to last - 1 to the forces on its nodes."""
    before = 0.0
    if is_closed:
        before = rate[last - ONE]
    for k in range(first, last):
        after = rate[k]
        p = pull(k, x, Q, w, 1.0 / length[k], rest_length, inv_rest_length, rest_sigma, S, J, before, after)
        before = after
        for d in range(3):
            force[d, k] += p[d]
            force[d, k + ONE] -= p[d]
