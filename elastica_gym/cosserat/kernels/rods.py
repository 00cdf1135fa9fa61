"""Rods on rods, and on themselves.

The broad phase sweeps along the axis of the widest extent: elements sorted by where their spheres
begin are compared only with those that begin before they end. The order is total (ties by slot), so
that which pairs are met, and in which order, does not depend on what was sorted before; and as it
is nearly right already, sorting by insertion takes a time that grows with the number of elements.
"""

from math import pi

from .compiler import apart, inner
from .contact import closest, press
from .roots import TINY
from .vectors import add_column, column, cross, dot, norm, plus, times, to_lab_at, to_material_at

# of half a turn of the rod about its own surface: neighbours nearer than that cannot touch
NEAR = 0.8


@inner
def widest(x, order):
    """Return the axis, 0 to 2, along which the elements spread furthest."""
    best, axis = -1.0, 0
    for c in range(3):
        low = high = x[c, order[0]]
        for a in range(order.size):
            k = order[a]
            low = x[c, k] if x[c, k] < low else low
            high = x[c, k] if x[c, k] > high else high
        if high - low > best:
            best, axis = high - low, c
    return axis


@inner
def sort(order, begin):
    """Sort the slots in ``order`` by ``begin``, then by number."""
    for a in range(1, order.size):
        k = order[a]
        b = a - 1
        while b >= 0 and (begin[order[b]] > begin[k] or (begin[order[b]] == begin[k] and order[b] > k)):
            order[b + 1] = order[b]
            b -= 1
        order[b + 1] = k


@apart
def rods_on_rods(contact, order, begin, end, x, v, Q, w, length, radius, force, torque):
    """Add the forces between elements of rods that overlap: of two rods, or of one far enough from each other.

    Half of the force on an element goes to each of its nodes; friction turns both about their axes.
    """
    axis = widest(x, order)
    for a in range(order.size):
        k = order[a]
        middle, reach = 0.5 * (x[axis, k] + x[axis, k + 1]), 0.5 * length[k] + radius[k]
        begin[k], end[k] = middle - reach, middle + reach
    sort(order, begin)
    for a in range(order.size):
        j = order[a]
        for b in range(a + 1, order.size):
            k = order[b]
            # false for what is not a number, too
            if not begin[k] <= end[j]:
                break
            low, high = (j, k) if j < k else (k, j)
            one, two = contact.rod_of[low], contact.rod_of[high]
            near = high - low - 1 < NEAR * pi * radius[high] / length[high]
            if contact.may_touch[one, two] and not (near and one == two):
                meet(contact, low, high, x, v, Q, w, length, radius, force, torque)


@inner
def meet(contact, j, k, x, v, Q, w, length, radius, force, torque):
    """Add the forces between elements j and k, if they overlap."""
    a, b = column(x, j), column(x, k)
    e, f = plus(column(x, j + 1), -1.0, a), plus(column(x, k + 1), -1.0, b)
    r1, r2 = radius[j], radius[k]
    between = plus(plus(b, 0.5, f), -1.0, plus(a, 0.5, e))
    reach = r1 + r2 + 0.5 * (length[j] + length[k])
    if dot(between, between) < reach * reach:
        p, q = closest(a, e, b, f)
        towards = plus(plus(b, q, f), -1.0, plus(a, p, e))
        d = norm(towards)
        # axes that cross have no direction to part in
        if r1 + r2 > d and d * d > TINY:
            n = times(1.0 / d, towards)
            arm1, arm2 = times(r1, n), times(-r2, n)
            u = times(0.5, plus(column(v, j), 1.0, column(v, j + 1)))
            u = plus(u, 1.0, cross(to_lab_at(Q, j, column(w, j)), arm1))
            u = plus(plus(u, -0.5, column(v, k)), -0.5, column(v, k + 1))
            u = plus(u, -1.0, cross(to_lab_at(Q, k, column(w, k)), arm2))
            push = press(r1 + r2 - d, n, u, contact.stiffness, contact.damping, contact.friction, contact.slip_damping)
            add_column(force, j, -0.5, push)
            add_column(force, j + 1, -0.5, push)
            add_column(force, k, 0.5, push)
            add_column(force, k + 1, 0.5, push)
            add_column(torque, j, -1.0, to_material_at(Q, j, cross(arm1, push)))
            add_column(torque, k, 1.0, to_material_at(Q, k, cross(arm2, push)))
