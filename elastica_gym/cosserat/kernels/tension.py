"""The tension that makes the documented loads those of a potential."""

from .compiler import ONE, apart, inner


@inner
def bend_energy_rate(k, length, kappa, rest_kappa, rest_voronoi_length, B):
    """Return 3/4 (kappa - kappa^).B (kappa - kappa^)/E^4 at the joint after element k, 0 if it is a ghost [N]."""
    inv_E = 2.0 * rest_voronoi_length[k] / (length[k] + length[k + ONE])
    squares = 0.0
    for d in range(3):
        bent = kappa[d, k] - rest_kappa[d, k]
        squares += B[d, k] * bent * bent
    return 0.75 * squares * inv_E * inv_E * inv_E * inv_E


@apart
def reciprocate(
    first, last, is_closed, x, Q, w, length, kappa, rest_length, rest_voronoi_length, rest_sigma, rest_kappa, S, B, J,
    force,
):  # fmt: skip
    """Add the tension of the elements from slot ``first`` to last - 1, along each.

    Couples go with 1/E^3, forces with 1/e and spins with J/e. They are the derivatives, by angles and shear, of
    (kappa - kappa^).B (kappa - kappa^) D^/(2 E^3) and (sigma - sigma^).S (sigma - sigma^) l^/(2 e), and of the
    Lagrangian's w.J w/(2 e); this is what is left, the derivative by length.
    """
    before = 0.0
    if is_closed:
        before = bend_energy_rate(last - ONE, length, kappa, rest_kappa, rest_voronoi_length, B)
    for k in range(first, last):
        j = k + ONE
        d0, d1, d2 = x[0, j] - x[0, k], x[1, j] - x[1, k], x[2, j] - x[2, k]
        shear = spin = 0.0
        for i in range(3):
            s = (Q[i, 0, k] * d0 + Q[i, 1, k] * d1 + Q[i, 2, k] * d2) / rest_length[k] - rest_sigma[i, k]
            s -= 1.0 if i == 2 else 0.0
            shear += S[i, k] * s * s
            spin += J[i, k] * w[i, k] * w[i, k]
        e = length[k] / rest_length[k]
        after = bend_energy_rate(k, length, kappa, rest_kappa, rest_voronoi_length, B)
        pull = (0.5 * (spin / rest_length[k] - shear) / (e * e) - before - after) / length[k]
        before = after
        force[0, k] += pull * d0
        force[1, k] += pull * d1
        force[2, k] += pull * d2
        force[0, j] -= pull * d0
        force[1, j] -= pull * d1
        force[2, j] -= pull * d2
