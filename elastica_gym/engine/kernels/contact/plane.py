"""A plane that rods lie on: its response, and anisotropic friction (Gazzola et al. 2018, appendix D).

Forces act on elements, at the point of contact; half goes to each node. The plane responds to the
net force, so it comes after every other load. n is the plane's normal, a the in-plane unit tangent
of the element, b = a x n its rolling direction, N the normal force that carries it.
"""

from ...jit.compiler import ONE, inline, stage
from ..math.roots import inverse_sqrt


@inline
def static_fraction(speed, inv_tolerance):
    """Return the static fraction of friction: 1 up to the slip tolerance, falling to 0 at twice that."""
    excess = abs(speed) * inv_tolerance - 1.0
    excess = excess if excess > 0.0 else 0.0
    excess = excess if excess < 1.0 else 1.0
    return 1.0 - excess


@inline
def friction_coefficient(direction, forward, backward):
    """Return the coefficient of friction for motion or a push along +t, along -t, or neither."""
    moving = backward if direction < 0.0 else 0.5 * (forward + backward)
    return forward if direction > 0.0 else moving


@stage
def normal_response(
    first, n, normal, origin, k_plane, nu_plane, surface_tol, surface_part, x, radius, share,
    force, response, damping, carried, axial,
):  # fmt: skip
    """Compute the plane's response to push and penetration, its damping, N, and a."""
    n0, n1, n2 = normal[0], normal[1], normal[2]
    height = n0 * origin[0] + n1 * origin[1] + n2 * origin[2]
    for k in range(first, n):
        j = k + ONE
        s0, s1 = share[0][k], share[1][k]
        d0, d1, d2 = x[0][j] - x[0][k], x[1][j] - x[1][k], x[2][j] - x[2][k]
        dn = n0 * d0 + n1 * d1 + n2 * d2
        fn = (
            n0 * (s0 * force[0][k] + s1 * force[0][j])
            + n1 * (s0 * force[1][k] + s1 * force[1][j])
            + n2 * (s0 * force[2][k] + s1 * force[2][j])
        )

        r = radius[k]
        gap = n0 * x[0][k] + n1 * x[1][k] + n2 * x[2][k] + 0.5 * dn - height - r
        near = surface_part * r
        near = near if near < surface_tol else surface_tol
        touching = 1.0 if gap <= near else 0.0
        # a ghost has no cross-section
        touching = touching if r > 0.0 else 0.0
        N = -fn if fn < 0.0 else 0.0
        N *= touching
        depth = gap if gap < 0.0 else 0.0
        response[k], damping[k], carried[k] = N - touching * k_plane * depth, touching * nu_plane, N

        a0, a1, a2 = d0 - dn * n0, d1 - dn * n1, d2 - dn * n2
        inv_a = inverse_sqrt(a0 * a0 + a1 * a1 + a2 * a2)
        axial[0][k], axial[1][k], axial[2][k] = a0 * inv_a, a1 * inv_a, a2 * inv_a


@stage
def slip_velocity(
    first, n, normal, v, Q, w, radius, weight, damping, axial, axial_material, slip_axial, slip_rolling, response,
):  # fmt: skip
    """Compute the velocity of the element's lowest point along a and b, and a in the material frame.

    The point moves with the element and with its spin, W x (-r n) . b = -r W . a. Also damps the
    element's velocity along n, in the response.
    """
    n0, n1, n2 = normal[0], normal[1], normal[2]
    for k in range(first, n):
        j = k + ONE
        p0, p1 = weight[0][k], weight[1][k]
        u0, u1, u2 = p0 * v[0][k] + p1 * v[0][j], p0 * v[1][k] + p1 * v[1][j], p0 * v[2][k] + p1 * v[2][j]
        a0, a1, a2 = axial[0][k], axial[1][k], axial[2][k]
        b0, b1, b2 = a1 * n2 - a2 * n1, a2 * n0 - a0 * n2, a0 * n1 - a1 * n0
        m0 = Q[0][0][k] * a0 + Q[0][1][k] * a1 + Q[0][2][k] * a2
        m1 = Q[1][0][k] * a0 + Q[1][1][k] * a1 + Q[1][2][k] * a2
        m2 = Q[2][0][k] * a0 + Q[2][1][k] * a1 + Q[2][2][k] * a2
        response[k] -= damping[k] * (u0 * n0 + u1 * n1 + u2 * n2)
        slip_axial[k] = u0 * a0 + u1 * a1 + u2 * a2
        slip_rolling[k] = u0 * b0 + u1 * b1 + u2 * b2 - radius[k] * (w[0][k] * m0 + w[1][k] * m1 + w[2][k] * m2)
        axial_material[0][k], axial_material[1][k], axial_material[2][k] = m0, m1, m2


@stage
def kinetic_friction(
    first, n, normal, slip_tol, mu, mu_static, slip_axial, slip_rolling, response, carried, radius, axial,
    axial_material, push, static_axial, static_rolling, torque, normal_force,
):  # fmt: skip
    """Compute kinetic friction, opposite to the slip, with the torque of its rolling part.

    Sets ``push`` to the force on the element, response included, and ``static_axial`` and ``static_rolling`` to the
    bound of static friction, s mu N (without mu along a, where it depends on the push); adds N to ``normal_force``.
    Returns the number of elements that stick at least in part.
    """
    n0, n1, n2 = normal[0], normal[1], normal[2]
    forward, backward, sideways, static_sideways = mu[0], mu[1], mu[2], mu_static[2]
    may_hold = mu_static[0] + mu_static[1] + mu_static[2]
    inv_slip_tol = 1.0 / slip_tol
    n_sticking = 0
    for k in range(first, n):
        va, vb, N = slip_axial[k], slip_rolling[k], carried[k]
        inv_speed = inverse_sqrt(va * va + vb * vb)
        sa, sb = static_fraction(va, inv_slip_tol), static_fraction(vb, inv_slip_tol)
        fa = -(1.0 - sa) * friction_coefficient(va, forward, backward) * N * va * inv_speed
        fb = -(1.0 - sb) * sideways * N * vb * inv_speed

        a0, a1, a2 = axial[0][k], axial[1][k], axial[2][k]
        b0, b1, b2 = a1 * n2 - a2 * n1, a2 * n0 - a0 * n2, a0 * n1 - a1 * n0
        push[0][k] = response[k] * n0 + fa * a0 + fb * b0
        push[1][k] = response[k] * n1 + fa * a1 + fb * b1
        push[2][k] = response[k] * n2 + fa * a2 + fb * b2
        arm = radius[k] * fb
        torque[0][k] -= arm * axial_material[0][k]
        torque[1][k] -= arm * axial_material[1][k]
        torque[2][k] -= arm * axial_material[2][k]

        static_axial[k], static_rolling[k] = sa * N, sb * static_sideways * N
        normal_force[k] += N
        n_sticking += 1 if (sa + sb) * N * may_hold > 0.0 else 0
    return n_sticking


@stage
def static_friction(
    first, n, normal, mu_static, radius, share, force, axial, axial_material, static_axial, static_rolling,
    push, torque,
):  # fmt: skip
    """Compute static friction from the net forces, which include the response and kinetic friction.

    Along a it cancels the push, along b it makes the element roll without slip, both up to s mu N.
    """
    n0, n1, n2 = normal[0], normal[1], normal[2]
    forward, backward = mu_static[0], mu_static[1]
    for k in range(first, n):
        j = k + ONE
        f0 = share[0][k] * force[0][k] + share[1][k] * force[0][j]
        f1 = share[0][k] * force[1][k] + share[1][k] * force[1][j]
        f2 = share[0][k] * force[2][k] + share[1][k] * force[2][j]
        a0, a1, a2 = axial[0][k], axial[1][k], axial[2][k]
        b0, b1, b2 = a1 * n2 - a2 * n1, a2 * n0 - a0 * n2, a0 * n1 - a1 * n0
        m0, m1, m2 = axial_material[0][k], axial_material[1][k], axial_material[2][k]
        r = radius[k]

        fa = f0 * a0 + f1 * a1 + f2 * a2
        most = static_axial[k] * friction_coefficient(fa, forward, backward)
        fa = fa if fa < most else most
        fa = fa if fa > -most else -most

        fb = f0 * b0 + f1 * b1 + f2 * b2
        twist = torque[0][k] * m0 + torque[1][k] * m1 + torque[2][k] * m2
        # a ghost has neither a radius nor static friction
        fb = (fb - 2.0 * twist / (r if r > 0.0 else 1.0)) * (1.0 / 3.0)
        most = static_rolling[k]
        fb = fb if fb < most else most
        fb = fb if fb > -most else -most

        push[0][k] = -fa * a0 - fb * b0
        push[1][k] = -fa * a1 - fb * b1
        push[2][k] = -fa * a2 - fb * b2
        torque[0][k] += r * fb * m0
        torque[1][k] += r * fb * m1
        torque[2][k] += r * fb * m2


@stage
def to_nodes(first, n, push, force):
    """Give half of each element's force to each of its nodes."""
    for k in range(first, n):
        i = k - ONE
        force[0][k] += 0.5 * (push[0][i] + push[0][k])
        force[1][k] += 0.5 * (push[1][i] + push[1][k])
        force[2][k] += 0.5 * (push[2][i] + push[2][k])
