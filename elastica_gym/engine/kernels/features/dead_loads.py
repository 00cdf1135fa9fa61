"""Loads that are constant in the lab, on rods and bodies."""

from ...jit.compiler import FIRST, apart, inline
from ..layout import end_of, matrix, rows
from ..math.vectors import add, to_material, vector
from ..rod.loads import dead_force, dead_torque


@inline
def apply(model, scene, state, control):
    """Add them to the external loads."""
    loads, n = scene.dead_loads, end_of(model)
    if model.cylinders.mass.size > 0:
        _apply_to_bodies(loads, state.body_Q[0], state.body_force[0], state.body_torque[0])
    if loads.has_force:
        dead_force(FIRST, n, rows(loads.force), rows(control.force[0]))
    if loads.has_torque:
        dead_torque(FIRST, n, rows(loads.torque), matrix(state.Q[0]), rows(control.torque[0]))


@apart
def _apply_to_bodies(loads, body_Q, body_force, body_torque):
    for b in range(body_force.shape[0]):
        add(body_force[b], 1.0, vector(loads.body_force[b]))
        add(body_torque[b], 1.0, to_material(body_Q[b], vector(loads.body_torque[b])))
