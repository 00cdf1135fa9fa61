"""Cylinders on planes, and rods on cylinders.

Rods meet a cylinder as a capsule: its axis from end to end, swept by a sphere of its radius, so that
its ends are domes to them. Planes meet it as it is, at the rims of its flat ends.
"""

from math import sqrt

from .compiler import FIRST, ONE, apart, inner
from .contact import closest, press
from .roots import TINY
from .vectors import (
    add,
    add_column,
    column,
    cross,
    dot,
    norm,
    plus,
    times,
    to_lab,
    to_lab_at,
    to_material,
    to_material_at,
    vector,
)

# points of contact: three on either rim
POINTS = 6
# passes over the points of contact, each of which sees what the others have changed
SWEEPS = 30


@apart
def rods_on_cylinders(
    n, x, v, Q, w, length, radius, cylinders, body_x, body_v, body_Q, body_w, force, torque, body_force, body_torque,
):  # fmt: skip
    """Add the forces between all rods and all cylinders where they overlap."""
    c = cylinders
    for b in range(c.mass.size):
        rod_on_cylinder(
            FIRST, n, x, v, Q, w, length, radius, c.length[b], c.radius[b], c.rod_stiffness[b], c.rod_damping[b],
            c.rod_friction[b], c.rod_slip_damping[b], body_x[b], body_v[b], body_Q[b], body_w[b], force, torque,
            body_force[b], body_torque[b],
        )  # fmt: skip


@inner
def rod_on_cylinder(
    first, last, x, v, Q, w, length, radius, length2, r2, stiffness, damping, friction, slip_damping, body_x, body_v,
    body_Q, body_w, force, torque, body_force, body_torque,
):  # fmt: skip
    """Add the forces between elements from slot first to last - 1 and a cylinder, action and reaction.

    Half of the force on an element goes to each of its nodes, and its slip is that of their mean
    velocity. Both slips include the spin of the surface, and both bodies get the torque of the
    force about where it is: the element about its axis, the cylinder about its centre.
    """
    centre, axis = vector(body_x), vector(body_Q[2])
    start, edge = plus(centre, -0.5 * length2, axis), times(length2, axis)
    velocity, spin = vector(body_v), to_lab(body_Q, vector(body_w))
    for k in range(first, last):
        r1, j = radius[k], k + ONE
        here, there = column(x, k), column(x, j)
        # what is further from the cylinder's middle than half of both lengths and both radii touches nothing
        between = plus(times(0.5, plus(here, 1.0, there)), -1.0, centre)
        reach = 0.5 * (length[k] + length2) + r1 + r2
        # (a ghost has no section)
        if dot(between, between) < reach * reach and r1 > 0.0:
            e = plus(there, -1.0, here)
            p, q = closest(here, e, start, edge)
            on_axis = plus(start, q, edge)
            towards = plus(on_axis, -1.0, plus(here, p, e))
            d = norm(towards)
            # axes that cross have no direction to part in
            if r1 + r2 > d and d * d > TINY:
                normal = times(1.0 / d, towards)
                arm1, arm2 = times(r1, normal), plus(plus(on_axis, -r2, normal), -1.0, centre)
                u = times(0.5, plus(column(v, k), 1.0, column(v, j)))
                u = plus(u, 1.0, cross(to_lab_at(Q, k, column(w, k)), arm1))
                u = plus(u, -1.0, plus(velocity, 1.0, cross(spin, arm2)))
                f = press(r1 + r2 - d, normal, u, stiffness, damping, friction, slip_damping)
                add_column(force, k, -0.5, f)
                add_column(force, j, -0.5, f)
                add_column(torque, k, -1.0, to_material_at(Q, k, cross(arm1, f)))
                add(body_force, 1.0, f)
                add(body_torque, 1.0, to_material(body_Q, cross(arm2, f)))


@inner
def rim(Q, length, radius, n, number):
    """Return one of six points, from the centre: on each end's rim the lowest one and those 120 degrees from it.

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


@inner
def turned(Q, J, a):
    """Return Q^T J^-1 Q a, the angular acceleration that a torque a causes, both in the lab."""
    t = to_material(Q, a)
    return to_lab(Q, (t[0] / J[0], t[1] / J[1], t[2] / J[2]))


@apart
def cylinders_on_planes(dt, cylinders, planes, x, v, directors, w, contact, force, torque):
    """Add what all planes do to all cylinders. Comes after every other load."""
    c, p = cylinders, planes
    for b in range(c.mass.size):
        for j in range(p.stiffness.size):
            cylinder_on_plane(
                dt, vector(p.normal[j]), vector(p.origin[j]), c.ground_stiffness[b], c.ground_damping[b],
                c.ground_friction[b], c.length[b], c.radius[b], c.mass[b], c.inertia[b], x[b], v[b], directors[b], w[b],
                contact[b], force[b], torque[b],
            )  # fmt: skip


@inner
def cylinder_on_plane(
    dt, n, origin, stiffness, damping, friction, length, radius, mass, J, x, v, Q, w, contact, force, torque,
):  # fmt: skip
    """Add the response of a plane and Coulomb friction at the points of contact of a cylinder's rims.

    The response is k times the depth and nu times the approach of each point, never adhesive. Friction
    is what brings the slip to zero by the end of the step, as far as mu N allows, so a cylinder rests
    on a slope without creeping; found by passes over the points, each with what the others do
    (projected Gauss-Seidel).
    """
    velocity, spin = vector(v), to_lab(Q, vector(w))
    height = dot(plus(vector(x), -1.0, origin), n)
    touching = False
    for number in range(POINTS):
        arm = rim(Q, length, radius, n, number)
        depth = -height - dot(arm, n)
        N = stiffness * depth - damping * dot(plus(velocity, 1.0, cross(spin, arm)), n)
        N = N if N > 0.0 and depth > 0.0 else 0.0
        touching = touching or N > 0.0
        contact[number, 0] = N
        for a in range(1, 4):
            contact[number, a] = 0.0
        add(force, N, n)
        add(torque, N, to_material(Q, cross(arm, n)))
    # (a step of no duration stops nothing)
    if touching and friction > 0.0 and dt > 0.0:
        rub(contact, friction, n, Q, length, radius, mass, J, velocity, vector(w), force, torque, dt)


@inner
def rub(contact, mu, n, Q, length, radius, mass, J, velocity, w, force, torque, dt):
    """Add friction at the points of contact; ``contact`` holds their N and the force of friction found, (6, 4)."""
    transport = cross((J[0] * w[0], J[1] * w[1], J[2] * w[2]), w)
    for _ in range(SWEEPS):
        for number in range(POINTS):
            most = mu * contact[number, 0]
            if most > 0.0:
                arm = rim(Q, length, radius, n, number)
                # the slip at the end of this step, as things stand
                ahead = plus(velocity, dt / mass, vector(force))
                turn = plus(vector(torque), 1.0, transport)
                spin = to_lab(Q, (w[0] + dt * turn[0] / J[0], w[1] + dt * turn[1] / J[1], w[2] + dt * turn[2] / J[2]))
                u = plus(ahead, 1.0, cross(spin, arm))
                u = plus(u, -dot(u, n), n)
                speed = norm(u)
                if speed > 0.0:
                    # how far a unit of force against the slip changes it
                    t = times(1.0 / speed, u)
                    yields = 1.0 / mass + dot(cross(turned(Q, J, cross(arm, t)), arm), t)
                    old = contact[number, 1], contact[number, 2], contact[number, 3]
                    new = plus(old, -1.0 / (dt * yields), u)
                    size = norm(new)
                    new = times(most / size, new) if size > most else new
                    change = plus(new, -1.0, old)
                    contact[number, 1], contact[number, 2], contact[number, 3] = new
                    add(force, 1.0, change)
                    add(torque, 1.0, to_material(Q, cross(arm, change)))
