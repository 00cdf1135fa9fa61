"""One step of the physics, on a page, and the loop over steps and environments."""

from math import exp

import numpy as np

from ..jit.compiler import FIRST, entry, inline
from ..model import Control, Model, State
from .bodies import drift_bodies, kick_bodies, orthonormalise_bodies, weigh_bodies
from .contact.cylinders import cylinders_on_planes, rods_on_cylinders
from .contact.plane import kinetic_friction, normal_response, slip_velocity, static_friction, to_nodes
from .contact.rods import rods_on_rods
from .joints import join
from .layout import end_of, matrix, rows
from .queue import fetch_add
from .rod.curvature import bending, logarithm, relative_rotation
from .rod.dynamics import dynamics
from .rod.kinematics import kinematics, kinematics_twice, orthonormalise
from .rod.loads import balance, external, wave
from .rod.strains import strains, stretch
from .rod.tension import bend_energy_rates, tension

# steps between two corrections of the directors; powers of two make the test cheap
ORTHONORMALISE_EVERY = 1024


@inline
def drift(model, state, i, n, h):
    """Move environment i by a time h at its current velocities."""
    kinematics(FIRST, n, h, rows(state.x[i]), rows(state.v[i]), matrix(state.Q[i]), rows(state.w[i]))
    if model.cylinders.mass.size > 0:
        drift_bodies(h, state.body_x[i], state.body_v[i], state.body_Q[i], state.body_w[i])


@inline
def drift_twice(model, state, i, n, h):
    """Move environment i by a time h, twice."""
    kinematics_twice(FIRST, n, h, rows(state.x[i]), rows(state.v[i]), matrix(state.Q[i]), rows(state.w[i]))
    if model.cylinders.mass.size > 0:
        for _ in range(2):
            drift_bodies(h, state.body_x[i], state.body_v[i], state.body_Q[i], state.body_w[i])


@inline
def internal(model, state, control, i, first, n, dt):
    """Compute the forces and torques of strains, gravity and damping, of the rods from slot ``first`` to n - 1."""
    m, s, c = model, state, control
    x, v, Q, w = rows(s.x[i]), rows(s.v[i]), matrix(s.Q[i]), rows(s.w[i])
    force, torque, kappa = rows(s.force[i]), rows(s.torque[i]), rows(s.kappa[i])
    stress, before, after = rows(s.scratch[i]), rows(s.scratch[i, 3:]), rows(s.scratch[i, 6:])
    inv_length, cosine, lever = s.scratch[i, 9], s.scratch[i, 10], rows(s.scratch[i, 11:])
    rate = 1.0 - exp(-dt / m.activation_time) if m.activation_time > 0.0 else 1.0

    stretch(first, n, x, m.volume_root, s.length[i], inv_length, s.radius[i])
    strains(first, n, x, v, Q, w, inv_length, m.rest_length, m.inv_rest_length, rows(c.rest_sigma[i]), rows(m.shear),
            rows(m.inertia), stress, torque)  # fmt: skip
    relative_rotation(first, n, Q, kappa, cosine)
    logarithm(first, n, m.is_balanced, m.inv_rest_voronoi_length, cosine, kappa, lever)
    bending(first, n, s.length[i], kappa, lever, m.rest_voronoi_length, rows(m.bend), rows(c.rest_kappa[i]),
            m.is_muscular, rate, rows(c.couple[i]), rows(s.couple[i]), before, after)  # fmt: skip
    if m.is_reciprocal:
        joint_rate = s.scratch[i, 14]
        bend_energy_rates(first, n, s.length[i], kappa, rows(c.rest_kappa[i]), m.rest_voronoi_length, rows(m.bend),
                          rows(m.inv_bend), m.is_muscular, rows(s.couple[i]), joint_rate)  # fmt: skip
        tension(first, n, x, Q, w, inv_length, m.rest_length, m.inv_rest_length, rows(c.rest_sigma[i]), rows(m.shear),
                rows(m.inertia), joint_rate, stress)  # fmt: skip
    balance(first, n, stress, before, after, m.mass, m.gravity, m.is_viscous, v, w, s.length[i],
            (m.viscosity[0], m.viscosity[1]), force, torque)  # fmt: skip


@inline
def applied(model, state, control, i, n, time):
    """Add the loads on environment i that do not depend on other loads."""
    m, s, c = model, state, control
    force, torque = rows(s.force[i]), rows(s.torque[i])
    if m.is_loaded:
        external(FIRST, n, rows(c.force[i]), rows(c.torque[i]), force, torque)
    for j in range(m.waves.ramp_time.size):
        waves, ramp = m.waves, m.waves.ramp_time[j]
        strength = time / ramp if time < ramp else 1.0
        wave(FIRST, n, strength, waves.angular_frequency[j] * time, waves.axis[j], waves.sine[j], waves.cosine[j],
             matrix(s.Q[i]), torque)  # fmt: skip
    if m.joints.stiffness.size > 0:
        join(m.joints, s.x[i], s.v[i], s.Q[i], s.w[i], s.force[i], s.torque[i], s.body_x[i], s.body_v[i],
             s.body_Q[i], s.body_w[i], s.body_force[i], s.body_torque[i])  # fmt: skip


@inline
def contacts(model, state, i, n):
    """Add the loads of contact between rods and bodies in environment i, and the weight of bodies."""
    m, s = model, state
    x, v, Q, w, length, radius = s.x[i], s.v[i], s.Q[i], s.w[i], s.length[i], m.contact_radius
    if m.cylinders.mass.size > 0:
        bodies = s.body_x[i], s.body_v[i], s.body_Q[i], s.body_w[i], s.body_force[i], s.body_torque[i]
        weigh_bodies(m.cylinders.mass, m.gravity, s.body_force[i], s.body_torque[i])
        s.body_touch[i, :] = 0.0
        rods_on_cylinders(FIRST, n, s.scratch[i, 0], x, v, Q, w, length, radius, m.cylinders, bodies, s.force[i],
                          s.torque[i], s.body_touch[i])  # fmt: skip
    if m.rod_contact.is_on:
        begin, end, reach, last_far = s.scratch[i, 0], s.scratch[i, 1], s.scratch[i, 2], s.scratch[i, 3]
        s.rod_touch[i, :] = 0.0
        s.n_neighbours[i] = rods_on_rods(
            n, m.rod_contact, s.order[i], s.neighbours[i], s.n_neighbours[i], rows(s.neighbour_x[i]),
            s.neighbour_reach[i], begin, end, reach, last_far, x, v, Q, w, length, radius, s.force[i], s.torque[i],
            s.rod_touch[i],
        )  # fmt: skip


@inline
def plane_contact(model, state, planes, j, i, first, n):
    """Add the response and friction of plane j to the rods from slot ``first`` to n - 1 of environment i."""
    m, s, p, normal = model, state, planes, planes.normal[j]
    x, v, Q, w = rows(s.x[i]), rows(s.v[i]), matrix(s.Q[i]), rows(s.w[i])
    force, torque, radius = rows(s.force[i]), rows(s.torque[i]), s.radius[i]
    push, axial, axial_material = rows(s.scratch[i]), rows(s.scratch[i, 3:]), rows(s.scratch[i, 6:])
    static_axial, static_rolling, response = s.scratch[i, 9], s.scratch[i, 10], s.scratch[i, 11]
    carried = s.scratch[i, 12]
    slip_axial, slip_rolling, damping = s.scratch[i, 13], s.scratch[i, 14], s.scratch[i, 15]
    share, weight = (m.share[0], m.share[1]), (m.weight[0], m.weight[1])

    normal_response(
        first, n, normal, p.origin[j], p.stiffness[j], p.damping[j], p.surface_tolerance[j, 0],
        p.surface_tolerance[j, 1], x, radius, share, force, response, damping, carried, axial,
    )  # fmt: skip
    slip_velocity(
        first, n, normal, v, Q, w, radius, weight, damping, axial, axial_material, slip_axial, slip_rolling, response,
    )  # fmt: skip
    n_sticking = kinetic_friction(
        first, n, normal, p.slip_tolerance[j], p.kinetic_friction[j], p.static_friction[j], slip_axial, slip_rolling,
        response, carried, radius, axial, axial_material, push, static_axial, static_rolling, torque, s.normal_force[i],
    )  # fmt: skip
    to_nodes(first, n, push, force)
    if n_sticking > 0:
        static_friction(
            first, n, normal, p.static_friction[j], radius, share, force, axial, axial_material, static_axial,
            static_rolling, push, torque,
        )  # fmt: skip
        to_nodes(first, n, push, force)


@inline
def ground(model, state, i, n, dt):
    """Add the response and friction of the planes to environment i, after all other loads."""
    m, s, p = model, state, model.planes
    s.normal_force[i, :] = 0.0
    for j in range(p.stiffness.size):
        plane_contact(m, s, p, j, i, FIRST, n)
    if m.cylinders.mass.size > 0:
        cylinders_on_planes(dt, m.cylinders, p, s.body_x[i], s.body_v[i], s.body_Q[i], s.body_w[i], s.body_contact[i],
                            s.body_force[i], s.body_torque[i])  # fmt: skip


@inline
def kick(model, state, i, n, dt):
    """Change the velocities of environment i by its net loads over a time dt, and damp them."""
    m, s = model, state
    dynamics(FIRST, n, dt, rows(s.force[i]), rows(s.torque[i]), s.length[i], m.inv_rest_length, m.inv_mass,
             rows(m.inv_inertia), s.decay[i], rows(s.v[i]), rows(s.w[i]))  # fmt: skip
    if m.cylinders.mass.size > 0:
        kick_bodies(dt, m.cylinders.mass, m.cylinders.inertia, s.body_force[i], s.body_torque[i], s.body_v[i],
                    s.body_w[i])  # fmt: skip


@entry
def advance_queue(model, state, control, order, queue, dt, n_substeps, mine):
    """Advance the environments in ``order`` from ``queue[0]`` on, as `advance` does, shared among threads.

    A thread that finishes an environment takes the next: CPUs of a shared machine are not equally fast. Returns how
    many this thread has advanced, and writes their numbers into ``mine``.
    """
    n_mine = 0
    n = end_of(model)
    place: int = fetch_add(queue)  # type: ignore[call-arg] # the context is Numba's to give
    while place < order.size:
        i = order[place]
        for k in range(model.mass.size):
            state.decay[i, k] = exp(-model.damping_rate[k] * dt)
        start = state.time[i]

        drift(model, state, i, n, 0.5 * dt if n_substeps > 0 else 0.0)
        for step in range(n_substeps):
            internal(model, state, control, i, FIRST, n, dt)
            applied(model, state, control, i, n, start + (step + 0.5) * dt)
            contacts(model, state, i, n)
            ground(model, state, i, n, dt)
            kick(model, state, i, n, dt)
            drift(model, state, i, n, dt if step < n_substeps - 1 else 0.5 * dt)
            if (state.step[i] + step + 1) % ORTHONORMALISE_EVERY == 0:
                orthonormalise(FIRST, n, matrix(state.Q[i]))
                orthonormalise_bodies(state.body_Q[i])
        # once per call: these share cache lines with values that other threads read
        state.step[i] += n_substeps
        state.time[i] = start + n_substeps * dt
        mine[n_mine] = i
        n_mine += 1
        place = fetch_add(queue)
    return n_mine


def advance(model: Model, state: State, control: Control, first: int, last: int, dt: float, n_substeps: int) -> None:
    """Advance environments first to last - 1 by n_substeps of position Verlet: half drift, kick, half drift.

    The half drifts of consecutive steps are one, within a call.
    """
    envs = np.arange(first, last)
    advance_queue(model, state, control, envs, np.zeros(1, dtype=np.int64), dt, n_substeps, np.empty_like(envs))
