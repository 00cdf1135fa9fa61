"""Cylinders on planes, and rods on cylinders.

Rods touch a cylinder as a capsule with domed ends: its axis, swept by a sphere of its radius. Planes
touch the rims of its flat ends.
"""

from math import sqrt

from ...jit.compiler import ONE, apart, inline, stage
from ..math.roots import inverse_sqrt
from ..math.vectors import add, column, cross, dot, norm, plus, times, to_lab, to_material, vector
from .law import axis_velocity, friction_force, load, normal_force, overlap, spin_velocity, twist

# points of contact: three on each rim
POINTS = 6
# maximum Gauss-Seidel passes over the points of contact
SWEEPS = 30
# change of friction in a pass, relative to its bound, below which it has converged
SETTLED = 1e-5


@stage
def clearance(first, n, x, length, radius, body_radius, body_length, centre, axis, gap):
    """Compute a lower bound of the gap between elements and a cylinder, from the elements' bounding spheres."""
    c0, c1, c2 = centre
    a0, a1, a2 = axis
    half = 0.5 * body_length
    for k in range(first, n):
        j = k + ONE
        d0, d1, d2 = 0.5 * (x[0][k] + x[0][j]) - c0, 0.5 * (x[1][k] + x[1][j]) - c1, 0.5 * (x[2][k] + x[2][j]) - c2
        # to the nearest point of the axis
        along = d0 * a0 + d1 * a1 + d2 * a2
        along = along if along < half else half
        along = along if along > -half else -half
        d0, d1, d2 = d0 - along * a0, d1 - along * a1, d2 - along * a2
        squared = d0 * d0 + d1 * d1 + d2 * d2
        reach = 0.5 * length[k] + radius[k] + body_radius
        # a ghost has no cross-section
        gap[k] = squared * inverse_sqrt(squared) - reach if radius[k] > 0.0 else 1.0


@apart
def rods_on_cylinders(first, last, gap, x, v, Q, w, length, radius, cylinders, bodies, force, torque, touch):
    """Add the forces between rod elements, from slot ``first`` to ``last`` - 1, and cylinders where they overlap.

    Both velocities include the spin, and the cylinder gets the torque of the force about its centre.
    Adds the normal forces to ``touch``.
    """
    c = cylinders
    body_x, body_v, body_Q, body_w, body_force, body_torque = bodies
    for b in range(c.mass.size):
        centre, axis, body_radius = vector(body_x[b]), vector(body_Q[b, 2]), c.radius[b]
        start, edge = plus(centre, -0.5 * c.length[b], axis), times(c.length[b], axis)
        velocity, spin = vector(body_v[b]), to_lab(body_Q[b], vector(body_w[b]))
        clearance(first, last, (x[0], x[1], x[2]), length, radius, body_radius, c.length[b], centre, axis, gap)
        for k in range(first, last):
            if gap[k] < 0.0:
                a = column(x, k)
                e = plus(column(x, k + ONE), -1.0, a)
                g, n, s, t = overlap(a, e, radius[k], start, edge, body_radius, False)
                if g > 0.0:
                    arm = times(radius[k] - 0.5 * g, n)
                    body_arm = plus(plus(plus(start, t, edge), 0.5 * g - body_radius, n), -1.0, centre)
                    u = plus(axis_velocity(v, k, s), -1.0, plus(velocity, 1.0, cross(spin, body_arm)))
                    N = normal_force(g, dot(u, n), c.rod_stiffness[b], c.rod_damping[b])
                    u = plus(u, 1.0, spin_velocity(Q, w, k, arm))
                    rub = friction_force(n, u, N, c.rod_friction[b], c.rod_slip_damping[b])
                    f = plus(times(N, n), 1.0, rub)
                    load(force, k, s, times(-1.0, f))
                    twist(torque, Q, k, cross(rub, arm))
                    add(body_force[b], 1.0, f)
                    add(body_torque[b], 1.0, to_material(body_Q[b], cross(body_arm, f)))
                    touch[k] += N


@inline
def rim(Q, length, radius, n, number):
    """Return one of six points, from the centre: on each end's rim, the lowest and those 120 degrees from it.

    It stands on three, lies on two and tips over one.
    """
    axis = vector(Q[2])
    down = plus(times(dot(n, axis), axis), -1.0, n)
    size = norm(down)
    # upright, any direction will do
    down = times(1.0 / size, down) if size > 1e-9 else vector(Q[0])
    side = cross(axis, down)
    third = number % 3
    cosine = 1.0 if third == 0 else -0.5
    sine = 0.0 if third == 0 else (sqrt(0.75) if third == 1 else -sqrt(0.75))
    end = times(0.5 * length if number < 3 else -0.5 * length, axis)
    return plus(plus(end, radius * cosine, down), radius * sine, side)


@apart
def cylinders_on_planes(dt, cylinders, planes, x, v, directors, w, contact, force, torque):
    """Add the response of the planes and Coulomb friction at the rims' points of contact; after every other load.

    The response is k times the depth plus nu times the approach of each point, never adhesive. ``contact``
    is set to N, friction and the point from the centre, all in the lab, (C, 6, 7); its old friction is the
    initial guess for the new.
    """
    c, p = cylinders, planes
    for b in range(c.mass.size):
        Q, J = directors[b], c.inertia[b]
        velocity, spin = vector(v[b]), to_lab(Q, vector(w[b]))
        for j in range(p.stiffness.size):
            n = vector(p.normal[j])
            height = dot(plus(vector(x[b]), -1.0, vector(p.origin[j])), n)
            touching = False
            for number in range(POINTS):
                arm = rim(Q, c.length[b], c.radius[b], n, number)
                depth = -height - dot(arm, n)
                N = c.ground_stiffness[b] * depth - c.ground_damping[b] * dot(plus(velocity, 1.0, cross(spin, arm)), n)
                N = N if N > 0.0 and depth > 0.0 else 0.0
                touching = touching or N > 0.0
                point = contact[b, number]
                # friction that stops slip within a step of zero duration is undefined
                last = vector(point[1:]) if dt > 0.0 else (0.0, 0.0, 0.0)
                point[0] = N
                point[1], point[2], point[3] = within(c.ground_friction[b] * N, plus(last, -dot(last, n), n))
                point[4], point[5], point[6] = arm
                add(force[b], N, n)
                add(torque[b], N, to_material(Q, cross(arm, n)))
            if touching and c.ground_friction[b] > 0.0 and dt > 0.0:
                momentum = J[0] * w[b, 0], J[1] * w[b, 1], J[2] * w[b, 2]
                turn = plus(vector(torque[b]), 1.0, cross(momentum, vector(w[b])))
                ahead = plus(velocity, dt / c.mass[b], vector(force[b]))
                spin_ahead = plus(spin, dt, to_lab(Q, (turn[0] / J[0], turn[1] / J[1], turn[2] / J[2])))
                rub(dt, contact[b], c.ground_friction[b], n, vector(Q[2]), c.mass[b], J, ahead, spin_ahead)
                for number in range(POINTS):
                    point = contact[b, number]
                    friction = vector(point[1:])
                    add(force[b], 1.0, friction)
                    add(torque[b], 1.0, to_material(Q, cross(vector(point[4:]), friction)))


@inline
def within(most, a):
    """Return a, shortened to the length ``most`` if it is longer."""
    size = norm(a)
    return times(most / size, a) if size > most else a


@inline
def turned(axis, J, a):
    """Return the angular acceleration that a torque a causes, both in the lab."""
    return plus(times(1.0 / J[0], a), (1.0 / J[2] - 1.0 / J[0]) * dot(axis, a), axis)


@inline
def rub(dt, contact, mu, n, axis, mass, J, ahead, spin):
    """Compute the friction that stops the slip of the points of contact within this step, up to mu N.

    So a cylinder rests on a slope without creeping. ``ahead`` and ``spin`` are its velocities after a
    step without friction. Projected Gauss-Seidel over the points of contact.
    """
    for number in range(POINTS):
        friction = vector(contact[number, 1:])
        ahead = plus(ahead, dt / mass, friction)
        spin = plus(spin, dt, turned(axis, J, cross(vector(contact[number, 4:]), friction)))
    for _ in range(SWEEPS):
        is_settled = True
        for number in range(POINTS):
            point = contact[number]
            most = mu * point[0]
            if most > 0.0:
                arm = vector(point[4:])
                u = plus(ahead, 1.0, cross(spin, arm))
                u = plus(u, -dot(u, n), n)
                speed = norm(u)
                if speed > 0.0:
                    # change of slip per unit of force against it
                    lever = times(1.0 / speed, cross(arm, u))
                    yields = 1.0 / mass + dot(lever, turned(axis, J, lever))
                    old = vector(point[1:])
                    new = within(most, plus(old, -1.0 / (dt * yields), u))
                    change = plus(new, -1.0, old)
                    point[1], point[2], point[3] = new
                    ahead = plus(ahead, dt / mass, change)
                    spin = plus(spin, dt, turned(axis, J, cross(arm, change)))
                    is_settled = is_settled and norm(change) < SETTLED * most
        if is_settled:
            break
