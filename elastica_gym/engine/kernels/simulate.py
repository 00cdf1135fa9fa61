"""The library's step: that of the environments, with the features of a Scene and calls to the user's classes.

It is a separate entry, compiled when first needed, so that the environments start fast.
"""

from ..jit.compiler import FIRST, entry, inline
from .bodies import orthonormalise_bodies
from .features import (
    connections,
    constraints,
    contact,
    damping,
    dead_loads,
    drag,
    fluid,
    muscle_waves,
    planes,
    point_loads,
    reciprocal_tension,
    rings,
)
from .hooks import call
from .layout import end_of, matrix, rows, span_of
from .rod.kinematics import orthonormalise
from .rod.loads import clear, clear_at, external, external_at
from .step import ORTHONORMALISE_EVERY, drift, drift_twice, internal, kick
from .watch import find_broken

# where external loads act: nowhere, in a few slots, everywhere
UNLOADED, SPARSE, DENSE = 0, 1, 2

# steps between checks that motion is finite: one at each step would take 2 to 6 % of the time
WATCH_EVERY = 8


@inline
def answer(address, time):
    """Call a hook, if there is one. Returns whether to stop, as 0 or 1."""
    return call(address, time) if address != 0 else 0  # type: ignore[call-arg]  # the compiler adds the first


@inline
def external_loads(model, scene, state, control):
    """Collect in Control the external loads on rods, except those of planes."""
    point_loads.apply(model, scene, state, control)
    dead_loads.apply(model, scene, state, control)
    muscle_waves.apply(model, scene, state, control)
    fluid.apply(model, scene, state, control)
    reciprocal_tension.apply(model, scene, state, control)
    connections.apply(model, scene, state, control)
    contact.apply(model, scene, state, control)


@inline
def clear_loads(model, scene, state, control, loading):
    """Set the external loads to zero."""
    if loading == DENSE:
        clear(FIRST, end_of(model), rows(control.force[0]), rows(control.torque[0]))
    else:
        clear_at(scene.touched, control.force[0], control.torque[0])
    state.body_force[0, :, :] = 0.0
    state.body_torque[0, :, :] = 0.0


@inline
def add_loads(model, scene, state, control, loading):
    """Add the external loads to the net loads."""
    s, force, torque = state, control.force[0], control.torque[0]
    if loading == DENSE:
        external(FIRST, end_of(model), rows(force), rows(torque), rows(s.force[0]), rows(s.torque[0]))
    else:
        external_at(scene.touched, force, torque, s.force[0], s.torque[0])


@inline
def watch(state, n, broken):
    """Record the step and the place of the first non-finite motion found, and the last step known to be finite."""
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
    time: results do not depend, to the last bit, on where a run is split. External loads are cleared between stages,
    but neither before the first nor after the last, so that loads set by the caller act once, and callbacks can read
    them. ``loading`` is one of UNLOADED, SPARSE (only in the slots ``scene.touched``) and DENSE. ``broken`` is set to
    the step after which non-finite motion is found, its place, and the last step known to be finite.
    """
    n = end_of(model)
    damping.prepare(scene, state, dt)
    n_kicks = scheme.kicks.size
    # held positions do not change: without a hook, a step's last drift and the next one's first share one pass
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
            if not is_ahead:
                constraints.apply_to_values(scene, state)
                if answer(hooks.values, state.time[0]) != 0:
                    return 1
            if is_last:
                break

            rings.move_images(scene, state)
            for b in range(scene.blocks.shape[0]):
                first, end = span_of(scene.blocks[b])
                internal(model, state, control, 0, first, end, dt)
            if loading != UNLOADED:
                if step + stage > 0:
                    clear_loads(model, scene, state, control, loading)
                external_loads(model, scene, state, control)
                if answer(hooks.loads, state.time[0]) != 0:
                    return 1
                add_loads(model, scene, state, control, loading)
            drag.apply(model, scene, state, control)
            rings.apply(model, scene, state, control)
            planes.apply(model, scene, state, control)
            planes.apply_to_bodies(model, scene, state, scheme.kicks[stage] * dt)
            kick(model, state, 0, n, scheme.kicks[stage] * dt)
            constraints.apply_to_rates(scene, state)
            if answer(hooks.rates, state.time[0]) != 0:
                return 1
            if stage == n_kicks - 1:
                damping.apply(model, scene, state, dt)
                if answer(hooks.damping, state.time[0]) != 0:
                    return 1
                if step == n_steps - 1 or (state.step[0] + 1) % WATCH_EVERY == 0:
                    watch(state, n, broken)
    return 0


@entry
def load(model, scene, state, control, hooks, dt, is_last):
    """Compute the loads of a scene without a step: first all but its planes', then, if ``is_last``, its planes'.

    Loads are added to those in Control, then all to the net loads in State, to which the planes respond. ``dt`` is the
    time step that friction of bodies on planes needs, 0 for none.
    """
    if is_last:
        planes.apply(model, scene, state, control)
        planes.apply_to_bodies(model, scene, state, dt)
    else:
        internal(model, state, control, 0, FIRST, end_of(model), 0.0)
        external_loads(model, scene, state, control)
        answer(hooks.loads, state.time[0])
        add_loads(model, scene, state, control, DENSE)
