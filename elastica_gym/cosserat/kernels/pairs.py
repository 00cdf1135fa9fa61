"""Contact of single pairs, each with its own law: rods on rods, on rigid bodies, and these on planes."""

from math import pi

import numpy as np

from ..model import NEAR, Cylinders, Planes
from ..scene import Law
from .compiler import apart
from .cylinders import cylinders_on_planes, rods_on_cylinders
from .rods import extents, meet, sort, widest


@apart
def touch_rods(n, contacts, scratch, x, v, Q, w, length, radius, force, torque):
    """Add the forces between elements of rods that overlap, by a sweep for each group of rods with the same law.

    As in `rods.rods_on_rods`, neighbours along a rod do not touch; pairs are not kept between steps.
    """
    begin, end, reach, touch = scratch[0], scratch[1], scratch[2], scratch[3]
    for k in range(reach.size):
        reach[k], touch[k] = 0.5 * length[k] + radius[k], 0.0
    for g in range(contacts.stiffness.size):
        law = Law(contacts.stiffness[g], contacts.damping[g], 0.0, 0.0)
        order = contacts.order[contacts.span[g, 0] : contacts.span[g, 1]]
        extents(n, x[widest(x, order)], reach, 0.0, begin, end)
        sort(order, begin)
        for a in range(order.size):
            j = order[a]
            for b in range(a + 1, order.size):
                k = order[b]
                # false for what is not a number, too
                if not begin[k] <= end[j]:
                    break
                low, high = (j, k) if j < k else (k, j)
                one, two = contacts.rod_of[low], contacts.rod_of[high]
                is_near = one == two and high - low - 1 < NEAR * pi * radius[high] / length[high]
                if contacts.may_touch[g, one, two] and not is_near:
                    meet(law, np.uint64(low), np.uint64(high), x, v, Q, w, length, radius, force, torque, touch)


@apart
def touch_bodies(n, contacts, shapes, scratch, x, v, Q, w, length, radius, bodies, force, torque):
    """Add the forces between rods and rigid bodies that overlap."""
    body_x, body_v, body_Q, body_w, body_force, body_torque = bodies
    gap, masked, touch = scratch[0], scratch[1], scratch[2]
    touch[:] = 0.0
    for j in range(contacts.body.size):
        b, c, i, d = contacts.body[j], contacts.body[j] + 1, j, j + 1
        # elements without section touch nothing
        masked[:] = 0.0
        for k in range(contacts.span[j, 0], contacts.span[j, 1]):
            masked[k] = radius[k]
        one = Cylinders(
            shapes.length[b:c], shapes.radius[b:c], shapes.mass[b:c], shapes.inertia[b:c], shapes.ground_stiffness[b:c],
            shapes.ground_damping[b:c], shapes.ground_friction[b:c], contacts.stiffness[i:d], contacts.damping[i:d],
            contacts.friction[i:d], contacts.slip_damping[i:d],
        )  # fmt: skip
        body = (body_x[b:c], body_v[b:c], body_Q[b:c], body_w[b:c], body_force[b:c], body_torque[b:c])
        rods_on_cylinders(n, gap, x, v, Q, w, length, masked, one, body, force, torque, touch)


@apart
def ground_bodies(dt, planes, grounded, friction, shapes, x, v, Q, w, contact, force, torque):
    """Add what planes do to rigid bodies, after all other loads."""
    for j in range(grounded.size):
        b, c, i, d = grounded[j], grounded[j] + 1, j, j + 1
        one = Cylinders(
            shapes.length[b:c], shapes.radius[b:c], shapes.mass[b:c], shapes.inertia[b:c], planes.stiffness[i:d],
            planes.damping[i:d], friction[i:d], shapes.rod_stiffness[b:c], shapes.rod_damping[b:c],
            shapes.rod_friction[b:c], shapes.rod_slip_damping[b:c],
        )  # fmt: skip
        plane = Planes(
            planes.origin[i:d], planes.normal[i:d], planes.stiffness[i:d], planes.damping[i:d],
            planes.surface_tolerance[i:d], planes.slip_tolerance[i:d], planes.kinetic_friction[i:d],
            planes.static_friction[i:d],
        )  # fmt: skip
        cylinders_on_planes(dt, one, plane, x[b:c], v[b:c], Q[b:c], w[b:c], contact[b:c], force[b:c], torque[b:c])
