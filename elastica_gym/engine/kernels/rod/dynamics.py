"""Kick: velocities change with the loads, and are damped."""

from ...jit.compiler import stage


@stage
def dynamics(first, n, dt, force, torque, length, inv_rest_length, inv_mass, inv_inertia, decay, v, w):
    """Advance v by dt F/m and w by dt e J^-1 T, then multiply both by exp(-c dt)."""
    for k in range(first, n):
        b = dt * inv_mass[k]
        v[0][k] = (v[0][k] + b * force[0][k]) * decay[k]
        v[1][k] = (v[1][k] + b * force[1][k]) * decay[k]
        v[2][k] = (v[2][k] + b * force[2][k]) * decay[k]
        c = dt * length[k] * inv_rest_length[k]
        w[0][k] = (w[0][k] + c * inv_inertia[0][k] * torque[0][k]) * decay[k]
        w[1][k] = (w[1][k] + c * inv_inertia[1][k] * torque[1][k]) * decay[k]
        w[2][k] = (w[2][k] + c * inv_inertia[2][k] * torque[2][k]) * decay[k]
