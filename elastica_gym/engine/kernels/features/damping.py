"""Damping of velocities at the end of a step: by factors, and by filters along rods."""

from math import exp

from ...jit.compiler import FIRST, inline
from ..layout import end_of, rows
from ..rod.damping import decay, decay_bodies, dilating_decay, smooth, smooth_ring


@inline
def prepare(scene, state, dt):
    """Compute the factors that do not change between steps."""
    for k in range(scene.decay.node_rate.size):
        scene.decay.node_factor[k] = exp(-scene.decay.node_rate[k] * dt)
        scene.decay.element_factor[k] = exp(-scene.decay.element_rate[k] * dt)
        state.decay[0, k] = 1.0


@inline
def apply(model, scene, state, dt):
    """Damp velocities over a time step."""
    n, d, v, w = end_of(model), scene.decay, rows(state.v[0]), rows(state.w[0])
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
