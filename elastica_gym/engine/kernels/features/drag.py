"""Drag on nodes and elements, proportional to velocity."""

from ...jit.compiler import FIRST, inline
from ..layout import end_of, rows
from ..rod.damping import drag


@inline
def apply(model, scene, state, control):
    """Add it to the net loads."""
    if scene.drag.is_on:
        drag(FIRST, end_of(model), rows(state.v[0]), rows(state.w[0]), scene.drag.force, scene.drag.torque,
             rows(state.force[0]), rows(state.torque[0]))  # fmt: skip
