"""Drag during a step, and damping of velocities at its end."""

from math import exp

from ...jit.compiler import apart, stage


@stage
def drag(first, n, v, w, node_drag, element_drag, force, torque):
    """Add forces and torques against velocities."""
    for k in range(first, n):
        a, b = node_drag[k], element_drag[k]
        force[0][k] -= a * v[0][k]
        force[1][k] -= a * v[1][k]
        force[2][k] -= a * v[2][k]
        torque[0][k] -= b * w[0][k]
        torque[1][k] -= b * w[1][k]
        torque[2][k] -= b * w[2][k]


@stage
def decay(first, n, node_factor, element_factor, v, w):
    """Multiply velocities by factors."""
    for k in range(first, n):
        a, b = node_factor[k], element_factor[k]
        v[0][k] *= a
        v[1][k] *= a
        v[2][k] *= a
        w[0][k] *= b
        w[1][k] *= b
        w[2][k] *= b


@stage
def dilating_decay(first, n, dt, rate, length, inv_rest_length, w):
    """Multiply angular velocities by exp(-rate e dt)."""
    for k in range(first, n):
        h = -dt * length[k] * inv_rest_length[k]
        w[0][k] *= exp(h * rate[0][k])
        w[1][k] *= exp(h * rate[1][k])
        w[2][k] *= exp(h * rate[2][k])


@apart
def decay_bodies(dt, rate, turn_rate, v, w):
    """Multiply velocities of bodies by exp(-rate dt), and each component of their angular velocities by its own."""
    for b in range(rate.size):
        for d in range(3):
            v[b, d] *= exp(-rate[b] * dt)
            w[b, d] *= exp(-turn_rate[b, d] * dt)


@apart
def smooth(first, last, order, rate, term):
    """Filter the shortest waves out of one row of velocities, from slot first to last - 1.

    Subtracts (-Laplacian/4)^order of them; both ends are unchanged.
    """
    for k in range(first, last):
        term[k] = rate[k]
    for _ in range(order):
        before = term[first]
        for k in range(first + 1, last - 1):
            here = term[k]
            term[k] = 0.25 * (2.0 * here - before - term[k + 1])
            before = here
        term[first] = term[last - 1] = 0.0
    for k in range(first, last):
        rate[k] -= term[k]


@apart
def smooth_ring(first, last, order, rate, term):
    """Filter the shortest waves out of one row of velocities of a closed rod, as `smooth` does, but without ends."""
    for k in range(first, last):
        term[k] = rate[k]
    for _ in range(order):
        before, start = term[last - 1], term[first]
        for k in range(first, last):
            here, after = term[k], term[k + 1] if k < last - 1 else start
            term[k] = 0.25 * (2.0 * here - before - after)
            before = here
    for k in range(first, last):
        rate[k] -= term[k]
