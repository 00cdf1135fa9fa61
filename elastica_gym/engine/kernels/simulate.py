"""The library's step: that of the environments, with the features of a Scene and calls to the user's classes.

It is an entry of its own, compiled when first needed, so that the environments start fast.
"""

from math import cos, exp, sin

import numpy as np

from ..jit.compiler import FIRST, ONE, apart, entry, inner
from ..model import BLOCK
from .bodies import orthonormalise_bodies
from .constraints import hold, move
from .contact.pairs import ground_bodies, touch_bodies, touch_rods
from .ends import add_to
from .hooks import call
from .joints import join
from .math.vectors import add, plus, times, to_material, vector
from .rod.damping import decay, decay_bodies, dilating_decay, drag, smooth, smooth_ring
from .rod.flow import resist
from .rod.kinematics import orthonormalise
from .rod.loads import clear, clear_at, dead_force, dead_torque, external, external_at, wave
from .rod.rings import follow, hand_back
from .rod.tension import bend_energy_rates, reciprocate
from .sides import join_sides
from .step import ORTHONORMALISE_EVERY, drift, drift_twice, internal, kick, matrix, rows, settle
from .watch import find_broken

# where there are loads from outside: nowhere, in a few slots, everywhere
UNLOADED, SPARSE, DENSE = 0, 1, 2

# steps between two looks at whether motion is finite: at each, one would take 2 to 6 % of the step
WATCH_EVERY = 8


@inner
def ends(span):
    """Return the first slot of a span and the one after its last."""
    return np.uint64(span[0]), np.uint64(span[1])


@inner
def answer(address, time):
    """Call a hook, if there is one."""
    return call(address, time) if address != 0 else 0  # type: ignore[call-arg]  # the compiler adds the first


@inner
def constrain_values(scene, state, hooks):
    """Constrain positions and directors. Returns whether to stop."""
    time = state.time[0]
    if scene.pins.slot.size + scene.clamps.slot.size > 0:
        hold(scene.pins, scene.clamps, time, state.x[0], state.Q[0], state.body_x[0], state.body_Q[0])
    return answer(hooks.values, time)


@inner
def constrain_rates(scene, state, hooks):
    """Constrain velocities. Returns whether to stop."""
    time = state.time[0]
    if scene.pins.slot.size + scene.clamps.slot.size > 0:
        move(scene.pins, scene.clamps, time, state.v[0], state.Q[0], state.w[0], state.body_v[0], state.body_Q[0],
             state.body_w[0])  # fmt: skip
    return answer(hooks.rates, time)


@apart
def point_forces(loads, time, force, body_force):
    """Add the forces on single nodes and bodies."""
    for j in range(loads.slot.size):
        late = time - loads.ramp_time[j]
        growth = time / loads.ramp_time[j] if late < 0.0 else 1.0
        f = times(growth, vector(loads.growing[j]))
        if late < 0.0:
            f = plus(f, 1.0, vector(loads.before[j]))
        elif loads.angular_frequency[j] != 0.0:
            angle = loads.angular_frequency[j] * late
            f = plus(plus(f, cos(angle), vector(loads.cosine[j])), sin(angle), vector(loads.sine[j]))
        add_to(force, body_force, loads.slot[j], 1.0, f)


@apart
def dead_loads_on_bodies(loads, body_Q, body_force, body_torque):
    """Add what is constant in the lab to bodies."""
    for b in range(body_force.shape[0]):
        add(body_force[b], 1.0, vector(loads.body_force[b]))
        add(body_torque[b], 1.0, to_material(body_Q[b], vector(loads.body_torque[b])))


@inner
def external_loads(model, scene, state, control, hooks, n):
    """Collect in Control what acts on rods from outside, but the planes. Returns whether to stop."""
    time, Q, loads = state.time[0], state.Q[0], scene.dead_loads
    force, torque = control.force[0], control.torque[0]
    if scene.point_loads.slot.size > 0:
        point_forces(scene.point_loads, time, force, state.body_force[0])
    if model.cylinders.mass.size > 0:
        dead_loads_on_bodies(loads, state.body_Q[0], state.body_force[0], state.body_torque[0])
    if loads.has_force:
        dead_force(FIRST, n, rows(loads.force), rows(force))
    if loads.has_torque:
        dead_torque(FIRST, n, rows(loads.torque), matrix(Q), rows(torque))
    waves = scene.waves
    for j in range(waves.ramp_time.size):
        k, m = ends(scene.wave_span[j])
        strength = time / waves.ramp_time[j] if time < waves.ramp_time[j] else 1.0
        wave(k, m, strength, waves.angular_frequency[j] * time, waves.axis[j], waves.sine[j], waves.cosine[j],
             matrix(Q), rows(torque))  # fmt: skip
    for j in range(scene.flows.viscosity.size):
        resist(scene.flows.span[j, 0], scene.flows.span[j, 1], scene.flows.viscosity[j], state.x[0], state.v[0],
               model.weight, state.length[0], state.radius[0], force)  # fmt: skip
    for j in range(scene.tensions.is_closed.size):
        first, last = ends(scene.tensions.span[j])
        bend_energy_rates(
            first, last, state.length[0], rows(state.kappa[0]), rows(control.rest_kappa[0]), model.rest_voronoi_length,
            rows(model.bend), rows(model.inv_bend), model.is_muscular, rows(state.couple[0]), state.scratch[0, 0],
        )  # fmt: skip
        reciprocate(
            first, last, scene.tensions.is_closed[j], rows(state.x[0]), matrix(Q), rows(state.w[0]), state.length[0],
            model.rest_length, model.inv_rest_length, rows(control.rest_sigma[0]), rows(model.shear),
            rows(model.inertia), state.scratch[0, 0], force,
        )  # fmt: skip
    if scene.joints.stiffness.size > 0:
        join(scene.joints, state.x[0], state.v[0], Q, state.w[0], force, torque, state.body_x[0], state.body_v[0],
             state.body_Q[0], state.body_w[0], state.body_force[0], state.body_torque[0])  # fmt: skip
    s = state
    if scene.sides.stiffness.size > 0:
        join_sides(scene.sides, s.x[0], s.v[0], Q, s.length[0], model.rest_length, s.radius[0], force, torque)
    if scene.body_contacts.body.size > 0:
        bodies = s.body_x[0], s.body_v[0], s.body_Q[0], s.body_w[0], s.body_force[0], s.body_torque[0]
        touch_bodies(scene.body_contacts, model.cylinders, s.scratch[0], s.x[0], s.v[0], Q, s.w[0], s.length[0],
                     model.contact_radius, bodies, force, torque)  # fmt: skip
    if scene.rod_contacts.stiffness.size > 0:
        s.n_pairs[0] = touch_rods(
            n, scene.rod_contacts, s.n_pairs[0], rows(s.listed_x[0]), s.listed_reach[0], s.scratch[0], s.x[0], s.v[0],
            Q, s.w[0], s.length[0], model.contact_radius, force, torque,
        )  # fmt: skip
    return answer(hooks.loads, time)


@inner
def clear_loads(scene, state, control, n, loading):
    """Set the loads from outside to zero."""
    if loading == DENSE:
        clear(FIRST, n, rows(control.force[0]), rows(control.torque[0]))
    else:
        clear_at(scene.touched, control.force[0], control.torque[0])
    state.body_force[0, :, :] = 0.0
    state.body_torque[0, :, :] = 0.0


@inner
def add_loads(scene, state, control, n, loading):
    """Add the loads from outside to the net loads."""
    if loading == DENSE:
        external(FIRST, n, rows(control.force[0]), rows(control.torque[0]), rows(state.force[0]), rows(state.torque[0]))
    else:
        external_at(scene.touched, control.force[0], control.torque[0], state.force[0], state.torque[0])


@inner
def ground(model, scene, state):
    """Add the response and friction of each plane to the rods that it acts on, after all other loads."""
    state.normal_force[0, :] = 0.0
    for j in range(scene.planes.stiffness.size):
        first, n = ends(scene.plane_span[j])
        # the first node reads a push from before
        for d in range(3):
            state.scratch[0, d, first - ONE] = 0.0
        settle(model, state, scene.planes, j, 0, first, n)


@inner
def damp(model, scene, state, hooks, n, dt):
    """Damp velocities over a time step. Returns whether to stop."""
    d, v, w = scene.decay, rows(state.v[0]), rows(state.w[0])
    if d.is_on:
        decay(FIRST, n, d.node_factor, d.element_factor, v, w)
    if d.is_dilating:
        dilating_decay(FIRST, n, dt, rows(d.dilating_rate), state.length[0], model.inv_rest_length, w)
    if d.is_on_bodies:
        decay_bodies(dt, d.body_rate, d.body_turn_rate, state.body_v[0], state.body_w[0])
    for j in range(scene.filters.order.size):
        first, last, order = scene.filters.span[j, 0], scene.filters.span[j, 1], scene.filters.order[j]
        for i in range(3):
            if scene.filters.is_closed[j]:
                smooth_ring(first, last, order, state.v[0, i], state.scratch[0, 0])
                smooth_ring(first, last, order, state.w[0, i], state.scratch[0, 0])
            else:
                smooth(first, last, order, state.v[0, i], state.scratch[0, 0])
                smooth(first, last - 1, order, state.w[0, i], state.scratch[0, 0])
    return answer(hooks.damping, state.time[0])


@inner
def prepare(scene, state, dt):
    """Compute the factors that do not change between steps."""
    for k in range(scene.decay.node_rate.size):
        scene.decay.node_factor[k] = exp(-scene.decay.node_rate[k] * dt)
        scene.decay.element_factor[k] = exp(-scene.decay.element_rate[k] * dt)
        state.decay[0, k] = 1.0


@inner
def watch(state, n, broken):
    """Note the step and the place of the first motion that is found not to be finite, and the last step when it was."""
    if broken[0] == 0:
        place = find_broken(FIRST, n, state.v[0], state.w[0], state.body_v[0], state.body_w[0])
        if place != 0:
            broken[0], broken[1] = state.step[0] + 1, place
        else:
            broken[2] = state.step[0] + 1


@entry
def simulate(model, scene, state, control, hooks, scheme, dt, n_steps, loading, broken):
    """Take steps of a symplectic scheme. Returns 0, or 1 if a hook asked to stop in the middle of a step.

    Unlike `advance`, it does not merge the last drift of a step with the first of the next into one of twice the
    time: what comes out does not depend, to the last bit, on where a run is cut. External loads are cleared between
    stages, but neither before the first nor after the last, so that those set from outside act once, and callbacks
    see them. ``loading`` is one of UNLOADED, SPARSE (only where ``scene.touched`` says) and DENSE. ``broken`` gets the
    number of the step after which motion is found not to be finite, the place, and the last step known to be sound.
    """
    n = np.uint64(-(-(model.first_slot[-1] + model.n_elements[-1] + 1) // BLOCK) * BLOCK)
    prepare(scene, state, dt)
    n_kicks = scheme.kicks.size
    # what is held is held where it was: unless somebody looks in, a step's last drift and the next one's first are one
    is_paired = scheme.drifts[0] == scheme.drifts[n_kicks] and hooks.values == 0
    is_ahead = False
    for step in range(n_steps):
        for stage in range(n_kicks + 1):
            is_last = stage == n_kicks
            is_due = is_last and (state.step[0] + 1) % ORTHONORMALISE_EVERY == 0
            if is_last and is_paired and not is_due and step < n_steps - 1:
                drift_twice(model, state, 0, n, scheme.drifts[stage] * dt)
                is_ahead = True
            elif is_ahead:
                is_ahead = False
            else:
                drift(model, state, 0, n, scheme.drifts[stage] * dt)
            state.time[0] += scheme.drifts[stage] * dt
            if is_last:
                state.step[0] += 1
            if is_due:
                orthonormalise(FIRST, n, matrix(state.Q[0]))
                orthonormalise_bodies(state.body_Q[0])
            if not is_ahead and constrain_values(scene, state, hooks) != 0:
                return 1
            if is_last:
                break
            if scene.rings.first.size > 0:
                follow(scene.rings, state.x[0], state.v[0], state.Q[0], state.w[0])
            for b in range(scene.blocks.shape[0]):
                first, end = ends(scene.blocks[b])
                internal(model, state, control, 0, first, end, dt)
            if loading != UNLOADED:
                if step + stage > 0:
                    clear_loads(scene, state, control, n, loading)
                if external_loads(model, scene, state, control, hooks, n) != 0:
                    return 1
                add_loads(scene, state, control, n, loading)
            if scene.drag.is_on:
                drag(FIRST, n, rows(state.v[0]), rows(state.w[0]), scene.drag.force, scene.drag.torque,
                     rows(state.force[0]), rows(state.torque[0]))  # fmt: skip
            if scene.rings.first.size > 0:
                hand_back(scene.rings, state.force[0], state.torque[0])
            if scene.planes.stiffness.size > 0:
                ground(model, scene, state)
            if scene.grounded.size > 0:
                ground_bodies(
                    scheme.kicks[stage] * dt, scene.body_planes, scene.grounded, scene.ground_friction, model.cylinders,
                    state.body_x[0], state.body_v[0], state.body_Q[0], state.body_w[0], state.body_contact[0],
                    state.body_force[0], state.body_torque[0],
                )  # fmt: skip
            kick(model, state, 0, n, scheme.kicks[stage] * dt)
            if constrain_rates(scene, state, hooks) != 0:
                return 1
            if stage == n_kicks - 1:
                if damp(model, scene, state, hooks, n, dt) != 0:
                    return 1
                if step == n_steps - 1 or (state.step[0] + 1) % WATCH_EVERY == 0:
                    watch(state, n, broken)
    return 0


@entry
def load(model, scene, state, control, hooks, dt, is_last):
    """Collect what a scene does to systems as they are, without a step: its loads or, then, the answer of its planes.

    Loads are added to those in Control, then all to the net loads in State, which the planes answer to. ``dt`` is the
    time step that friction of bodies on planes needs, 0 for none.
    """
    n = np.uint64(-(-(model.first_slot[-1] + model.n_elements[-1] + 1) // BLOCK) * BLOCK)
    if is_last:
        ground(model, scene, state)
        ground_bodies(dt, scene.body_planes, scene.grounded, scene.ground_friction, model.cylinders, state.body_x[0],
                      state.body_v[0], state.body_Q[0], state.body_w[0], state.body_contact[0], state.body_force[0],
                      state.body_torque[0])  # fmt: skip
    else:
        internal(model, state, control, 0, FIRST, n, 0.0)
        external_loads(model, scene, state, control, hooks, n)
        add_loads(scene, state, control, n, DENSE)
