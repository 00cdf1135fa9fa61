"""Contact of single pairs, each with its own law: rods on rods, on rigid bodies, and these on planes."""

from math import pi

import numpy as np

from ...jit.compiler import apart, inline
from ...model import NEAR, Cylinders, Planes
from ...scene import Law
from .cylinders import cylinders_on_planes, rods_on_cylinders
from .nearby import fill, gather
from .rods import meet, strayed


@inline
def width_of_cells(elements, reach, margin):
    """Return how wide cells must be for neighbours of an element to be in those around its own."""
    widest = 0.0
    for a in range(elements.size):
        here = reach[elements[a]]
        widest = here if here > widest else widest
    return 2.0 * (widest + margin)


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
def list_pairs(contacts, x, length, radius, reach, margin):
    """List the elements that may touch, by slot, with the row of their rods. Returns how many there are.

    No more of them are listed than there is room for.
    """
    c, n_pairs = contacts, 0
    for a in range(c.elements.size):
        low = c.elements[a]
        for i in range(gather(a, c.elements, x, reach, margin, c.cell, c.bucket, c.member, c.near)):
            high = c.elements[c.near[i]]
            one, two = c.rod_of[low], c.rod_of[high]
            # as long as the element can become until it has strayed
            if one != two or not is_close(low, high, radius[high], length[high] + 2.0 * c.stray):
                p, end = first_row(c, one, two)
                while p < end and c.other[p] == two:
                    if n_pairs < c.pairs.shape[0]:
                        c.pairs[n_pairs, 0], c.pairs[n_pairs, 1], c.pairs[n_pairs, 2] = low, high, p
                    n_pairs += 1
                    p += 1
    return n_pairs


@inline
def is_close(low, high, radius, length):
    """Return whether two elements of a rod are too near along it to touch."""
    return high - low - 1 < NEAR * pi * radius / length


@inline
def press_pair(contacts, p, low, high, x, v, Q, w, length, radius, force, torque, touch):
    """Add the forces between two elements by the law of row p, unless they are neighbours."""
    c = contacts
    if c.rod_of[low] != c.rod_of[high] or not is_close(low, high, radius[high], length[high]):
        law = Law(c.stiffness[p], c.damping[p], 0.0, 0.0)
        meet(law, np.uint64(low), np.uint64(high), x, v, Q, w, length, radius, force, torque, touch)


@apart
def touch_rods(n, contacts, n_pairs, listed_x, listed_reach, scratch, x, v, Q, w, length, radius, force, torque):
    """Add the forces between elements of rods that overlap, pair by pair in the order of their slots.

    Pairs that may touch are listed, with a margin, and the list serves until an element has used up its share
    of it, as in `rods.rods_on_rods`. Returns how many there are; where there is no room for so many, they are
    found anew each time.
    """
    c, reach, touch = contacts, scratch[0], scratch[1]
    margin = 2.0 * c.stray
    for k in range(reach.size):
        reach[k], touch[k] = 0.5 * length[k] + radius[k], 0.0
    is_new = n_pairs < 0 or strayed(n, (x[0], x[1], x[2]), reach, listed_x, listed_reach, c.stray) > 0
    if is_new or n_pairs > c.pairs.shape[0]:
        fill(c.elements, x, width_of_cells(c.elements, reach, margin), c.cell, c.bucket, c.member)
    if is_new:
        n_pairs = list_pairs(c, x, length, radius, reach, margin)
        for k in range(reach.size):
            listed_x[0][k], listed_x[1][k], listed_x[2][k] = x[0, k], x[1, k], x[2, k]
            listed_reach[k] = reach[k]
    if n_pairs <= c.pairs.shape[0]:
        for a in range(n_pairs):
            press_pair(c, c.pairs[a, 2], c.pairs[a, 0], c.pairs[a, 1], x, v, Q, w, length, radius, force, torque, touch)
    else:
        for a in range(c.elements.size):
            for i in range(gather(a, c.elements, x, reach, 0.0, c.cell, c.bucket, c.member, c.near)):
                low, high = c.elements[a], c.elements[c.near[i]]
                p, end = first_row(c, c.rod_of[low], c.rod_of[high])
                while p < end and c.other[p] == c.rod_of[high]:
                    press_pair(c, p, low, high, x, v, Q, w, length, radius, force, torque, touch)
                    p += 1
    return n_pairs


@apart
def touch_bodies(contacts, shapes, scratch, x, v, Q, w, length, radius, bodies, force, torque):
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
