"""Constraints of single nodes, elements and bodies."""

from ...jit.compiler import inline
from ..constraints import hold, move


@inline
def apply_to_values(scene, state):
    """Constrain positions and directors."""
    if scene.pins.slot.size + scene.clamps.slot.size > 0:
        hold(scene.pins, scene.clamps, state.time[0], state.x[0], state.Q[0], state.body_x[0], state.body_Q[0])


@inline
def apply_to_rates(scene, state):
    """Constrain velocities."""
    if scene.pins.slot.size + scene.clamps.slot.size > 0:
        move(scene.pins, scene.clamps, state.time[0], state.v[0], state.Q[0], state.w[0], state.body_v[0],
             state.body_Q[0], state.body_w[0])  # fmt: skip
