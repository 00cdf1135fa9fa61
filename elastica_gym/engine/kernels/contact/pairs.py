"""Contact by pair, each with its own law: rods on rods, rods on rigid bodies, and rigid bodies on planes."""

import numpy as np

from ...jit.compiler import apart, inline
from ...model import Cylinders, Planes
from ...scene import Law
from .broad_phase import update_neighbour_list
from .cylinders import cylinders_on_planes, rods_on_cylinders
from .rods import contact_of_pair, reaches


@inline
def first_row(contacts, one, two):
    """Return the first row of a pair of rods, ``one`` not after ``two``, and the end of the rows of ``one``."""
    low, end = contacts.row[one], contacts.row[one + 1]
    high = end
    while low < high:
        between = (low + high) // 2
        if contacts.other[between] < two:
            low = between + 1
        else:
            high = between
    return low, end


@inline
def keep_with_law(contacts, n_neighbours, slots):
    """Keep the listed pairs whose rods may touch, each with its first row, and return their number."""
    c, kept = contacts, 0
    for a in range(n_neighbours):
        pair = c.neighbours[a]
        one, two = c.rod_of[pair // slots], c.rod_of[pair % slots]
        p, end = first_row(c, one, two)
        if p < end and c.other[p] == two:
            c.neighbours[kept], c.first[kept] = pair, p
            kept += 1
    return kept


@inline
def contact_by_laws(contacts, p, end, low, high, x, v, Q, w, length, radius, force, torque, touch):
    """Add the forces between two elements by the laws of their rods, in the rows from p to ``end`` - 1."""
    c = contacts
    two = c.rod_of[high]
    while p < end and c.other[p] == two:
        law = Law(c.stiffness[p], c.damping[p], 0.0, 0.0)
        contact_of_pair(law, np.uint64(low), np.uint64(high), x, v, Q, w, length, radius, force, torque, touch)
        p += 1


@apart
def contact_of_rods(
    n, contacts, n_neighbours, neighbour_x, neighbour_reach, scratch, x, v, Q, w, length, radius, force, torque,
):  # fmt: skip
    """Add the forces between elements of rods that overlap, pair by pair in the order of their slots.

    Returns the number of listed pairs; if they do not fit in the list, all pairs are tested.
    """
    c, begin, end, reach, last_far, touch = contacts, scratch[0], scratch[1], scratch[2], scratch[3], scratch[4]
    slots = begin.size
    for k in range(slots):
        touch[k] = 0.0
    # for the longest that the elements can become before the list is rebuilt
    reaches(n, length, radius, 2.0 * c.stray, c.last_other, c.last_clear, reach, last_far)
    n_neighbours, is_new = update_neighbour_list(
        n, c.order, c.neighbours, n_neighbours, neighbour_x, neighbour_reach, c.stray, begin, end, reach, last_far, x
    )
    if is_new and n_neighbours <= c.neighbours.size:
        n_neighbours = keep_with_law(c, n_neighbours, slots)
    reaches(n, length, radius, 0.0, c.last_other, c.last_clear, reach, last_far)
    if n_neighbours <= c.neighbours.size:
        for a in range(n_neighbours):
            low, high, p = c.neighbours[a] // slots, c.neighbours[a] % slots, c.first[a]
            if low <= last_far[high]:
                last = c.row[c.rod_of[low] + 1]
                contact_by_laws(c, p, last, low, high, x, v, Q, w, length, radius, force, torque, touch)
    else:
        for a in range(c.elements.size):
            for b in range(a + 1, c.elements.size):
                low, high = c.elements[a], c.elements[b]
                if low <= last_far[high]:
                    p, last = first_row(c, c.rod_of[low], c.rod_of[high])
                    contact_by_laws(c, p, last, low, high, x, v, Q, w, length, radius, force, torque, touch)
    return n_neighbours


@apart
def contact_with_bodies(contacts, shapes, scratch, x, v, Q, w, length, radius, bodies, force, torque):
    """Add the forces between rods and rigid bodies that overlap."""
    body_x, body_v, body_Q, body_w, body_force, body_torque = bodies
    gap, touch = scratch[0], scratch[1]
    touch[:] = 0.0
    for j in range(contacts.body.size):
        b, c, i, d = contacts.body[j], contacts.body[j] + 1, j, j + 1
        one = Cylinders(
            shapes.length[b:c], shapes.radius[b:c], shapes.mass[b:c], shapes.inertia[b:c], shapes.ground_stiffness[b:c],
            shapes.ground_damping[b:c], shapes.ground_friction[b:c], contacts.stiffness[i:d], contacts.damping[i:d],
            contacts.friction[i:d], contacts.slip_damping[i:d],
        )  # fmt: skip
        body = (body_x[b:c], body_v[b:c], body_Q[b:c], body_w[b:c], body_force[b:c], body_torque[b:c])
        first, last = np.uint64(contacts.span[j, 0]), np.uint64(contacts.span[j, 1])
        rods_on_cylinders(first, last, gap, x, v, Q, w, length, radius, one, body, force, torque, touch)


@apart
def ground_bodies(dt, planes, grounded, friction, shapes, x, v, Q, w, contact, force, torque):
    """Add the loads of planes on rigid bodies, after all other loads."""
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
