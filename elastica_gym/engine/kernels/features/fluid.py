"""The resistance of a viscous fluid to slender bodies."""

from ...jit.compiler import inline
from ..rod.flow import resist


@inline
def apply(model, scene, state, control):
    """Add it to the external loads."""
    for j in range(scene.flows.viscosity.size):
        resist(scene.flows.span[j, 0], scene.flows.span[j, 1], scene.flows.viscosity[j], state.x[0], state.v[0],
               model.weight, state.length[0], state.radius[0], control.force[0])  # fmt: skip
