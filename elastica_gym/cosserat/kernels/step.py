"""One step of the physics, on a page, and the loop over steps and environments."""

from math import exp

import numpy as np

from ..model import BLOCK
from .compiler import entry, inline
from .curvature import curvature
from .dynamics import dynamics
from .kinematics import kinematics, orthonormalise
from .loads import balance, external, viscosity, wave
from .plane import slip, stick, to_nodes
from .strains import strains

# steps between two corrections of the directors; powers of two make the test cheap
ORTHONORMALISE_EVERY = 1024


@inline
def rows(a):
    """Return the three rows of a (3, L) array, which the stages take apart."""
    return a[0], a[1], a[2]


@inline
def matrix(a):
    """Return the nine rows of a (3, 3, L) array."""
    return rows(a[0]), rows(a[1]), rows(a[2])


@inline
def drift(model, state, i, n, h):
    """Move environment i by a time h at its present velocities."""
    kinematics(n, h, rows(state.x[i]), rows(state.v[i]), matrix(state.Q[i]), rows(state.w[i]))


@inline
def evaluate(model, state, control, i, n, time, dt):
    """Compute the net force and torque on environment i, in its present configuration."""
    m, s, c = model, state, control
    x, v, Q, w = rows(s.x[i]), rows(s.v[i]), matrix(s.Q[i]), rows(s.w[i])
    force, torque = rows(s.force[i]), rows(s.torque[i])

    # internal loads
    strains(n, x, v, Q, w, m.rest_length, m.inv_rest_length, m.section, rows(c.rest_sigma[i]), rows(m.shear),
            rows(m.inertia), s.length[i], s.radius[i], rows(s.sigma[i]), rows(s.stress[i]), torque)  # fmt: skip
    rate = 1.0 - exp(-dt / m.activation_time) if m.activation_time > 0.0 else 1.0
    curvature(n, Q, s.length[i], m.rest_voronoi_length, m.inv_rest_voronoi_length, rows(m.bend),
              rows(c.rest_kappa[i]), rate, rows(c.couple[i]),
              rows(s.couple[i]), rows(s.kappa[i]), rows(s.moment[i]), rows(s.transport[i]))  # fmt: skip
    balance(n, rows(s.stress[i]), rows(s.moment[i]), rows(s.transport[i]), m.mass, m.gravity,
            force, torque)  # fmt: skip
    if m.is_loaded:
        external(n, rows(c.force[i]), rows(c.torque[i]), force, torque)
    if m.is_viscous:
        viscosity(n, v, w, s.length[i], (m.viscosity[0], m.viscosity[1]), force, torque)

    # travelling waves of muscle couple
    for j in range(m.waves.ramp_time.size):
        ramp = m.waves.ramp_time[j]
        strength = time / ramp if time < ramp else 1.0
        wave(n, strength, m.waves.angular_frequency[j] * time, m.waves.axis[j], m.waves.sine[j],
             m.waves.cosine[j], Q, torque)  # fmt: skip

    # planes, which answer to all of the above
    s.normal_force[i, :] = 0.0
    push, axial, axial_material = rows(s.contact[i]), rows(s.contact[i, 3:]), rows(s.contact[i, 6:])
    hold, hold_rolling = s.contact[i, 9], s.contact[i, 10]
    share, weight = (m.share[0], m.share[1]), (m.weight[0], m.weight[1])
    for j in range(m.planes.stiffness.size):
        p = m.planes
        n_sticking = slip(
            n, p.normal[j], p.origin[j], p.stiffness[j], p.damping[j], p.surface_tolerance[j], p.slip_tolerance[j],
            p.kinetic_friction[j], p.static_friction[j],
            x, v, Q, w, s.radius[i], share, weight, force, torque,
            push, axial, axial_material, hold, hold_rolling, s.normal_force[i])  # fmt: skip
        to_nodes(n, push, force)
        if n_sticking > 0:
            stick(n, p.normal[j], p.static_friction[j], s.radius[i], share, force,
                  axial, axial_material, hold, hold_rolling, push, torque)  # fmt: skip
            to_nodes(n, push, force)


@inline
def kick(model, state, i, n, dt):
    """Change the velocities of environment i by its net loads over a time dt, and damp them."""
    m, s = model, state
    dynamics(n, dt, rows(s.force[i]), rows(s.torque[i]), s.length[i], m.inv_rest_length, m.inv_mass,
             rows(m.inv_inertia), s.decay[i], rows(s.v[i]), rows(s.w[i]))  # fmt: skip


@entry
def advance(model, state, control, first, last, dt, n_substeps):
    """Advance environments first to last - 1 by n_substeps of position Verlet: half drift, kick, half drift.

    The half drifts of consecutive steps are one, within a call.
    """
    n = np.uint64(BLOCK * (model.mass.size // BLOCK - 1))
    for i in range(first, last):
        for k in range(model.mass.size):
            state.decay[i, k] = exp(-model.damping_rate[k] * dt)
        start = state.time[i]

        drift(model, state, i, n, 0.5 * dt)
        for step in range(n_substeps):
            evaluate(model, state, control, i, n, start + (step + 0.5) * dt, dt)
            kick(model, state, i, n, dt)
            drift(model, state, i, n, dt if step < n_substeps - 1 else 0.5 * dt)
            state.step[i] += 1
            if state.step[i] % ORTHONORMALISE_EVERY == 0:
                orthonormalise(n, matrix(state.Q[i]))
        state.time[i] = start + n_substeps * dt
