"""Internal and external loads on nodes and elements."""

from math import cos, sin

from ...jit.compiler import ONE, inline, stage


@stage
def balance(
    first, n, stress, before, after, mass, gravity, is_viscous, v, w, length, nu, force, torque,
):  # fmt: skip
    """Sum the internal loads and gravity (Gazzola et al. 2018, eq. 2.20, 2.21), and the documented damping.

    A node gets the difference of n between its elements; an element gets, in addition to its own torques,
    ``before`` of the joint after it and ``after`` of the joint before it. The damping, if any, is nu l times
    the mean nodal velocity, half of it on each of an element's nodes, and nu_torque l w.
    """
    g0, g1, g2 = gravity[0], gravity[1], gravity[2]
    for k in range(first, n):
        i, j = k - ONE, k + ONE
        f0 = stress[0][k] - stress[0][i] + mass[k] * g0
        f1 = stress[1][k] - stress[1][i] + mass[k] * g1
        f2 = stress[2][k] - stress[2][i] + mass[k] * g2
        t0 = torque[0][k] + (before[0][k] + after[0][i])
        t1 = torque[1][k] + (before[1][k] + after[1][i])
        t2 = torque[2][k] + (before[2][k] + after[2][i])
        if is_viscous:
            # a ghost's nu is zero
            a, b = 0.25 * nu[0][i] * length[i], 0.25 * nu[0][k] * length[k]
            f0 -= a * (v[0][i] + v[0][k]) + b * (v[0][k] + v[0][j])
            f1 -= a * (v[1][i] + v[1][k]) + b * (v[1][k] + v[1][j])
            f2 -= a * (v[2][i] + v[2][k]) + b * (v[2][k] + v[2][j])
            c = nu[1][k] * length[k]
            t0 -= c * w[0][k]
            t1 -= c * w[1][k]
            t2 -= c * w[2][k]
        force[0][k], force[1][k], force[2][k] = f0, f1, f2
        torque[0][k], torque[1][k], torque[2][k] = t0, t1, t2


@stage
def external(first, n, applied_force, applied_torque, force, torque):
    """Add the external loads in Control."""
    for k in range(first, n):
        force[0][k] += applied_force[0][k]
        force[1][k] += applied_force[1][k]
        force[2][k] += applied_force[2][k]
        torque[0][k] += applied_torque[0][k]
        torque[1][k] += applied_torque[1][k]
        torque[2][k] += applied_torque[2][k]


@stage
def clear(first, n, force, torque):
    """Set loads to zero."""
    for k in range(first, n):
        force[0][k] = force[1][k] = force[2][k] = 0.0
        torque[0][k] = torque[1][k] = torque[2][k] = 0.0


@inline
def clear_at(slots, force, torque):
    """Set loads in some slots to zero."""
    for j in range(slots.size):
        for d in range(3):
            force[d, slots[j]] = torque[d, slots[j]] = 0.0


@inline
def external_at(slots, applied_force, applied_torque, force, torque):
    """Add the external loads in Control, in some slots."""
    for j in range(slots.size):
        k = slots[j]
        for d in range(3):
            force[d, k] += applied_force[d, k]
            torque[d, k] += applied_torque[d, k]


@stage
def dead_force(first, n, load, force):
    """Add forces that are constant in the lab."""
    for k in range(first, n):
        force[0][k] += load[0][k]
        force[1][k] += load[1][k]
        force[2][k] += load[2][k]


@stage
def dead_torque(first, n, load, Q, torque):
    """Add torques that are constant in the lab."""
    for k in range(first, n):
        t0, t1, t2 = load[0][k], load[1][k], load[2][k]
        torque[0][k] += Q[0][0][k] * t0 + Q[0][1][k] * t1 + Q[0][2][k] * t2
        torque[1][k] += Q[1][0][k] * t0 + Q[1][1][k] * t1 + Q[1][2][k] * t2
        torque[2][k] += Q[2][0][k] * t0 + Q[2][1][k] * t1 + Q[2][2][k] * t2


@stage
def wave(first, n, strength, phase, axis, sine, cosine, Q, torque):
    """Add a travelling wave of muscle couple at the angle ``phase`` = omega t (Gazzola et al. 2018, sec. 5.2)."""
    S, C = strength * sin(phase), strength * cos(phase)
    a0, a1, a2 = axis[0], axis[1], axis[2]
    for k in range(first, n):
        m = S * sine[k] + C * cosine[k]
        torque[0][k] += m * (Q[0][0][k] * a0 + Q[0][1][k] * a1 + Q[0][2][k] * a2)
        torque[1][k] += m * (Q[1][0][k] * a0 + Q[1][1][k] * a1 + Q[1][2][k] * a2)
        torque[2][k] += m * (Q[2][0][k] * a0 + Q[2][1][k] * a1 + Q[2][2][k] * a2)
