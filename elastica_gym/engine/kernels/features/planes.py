"""Planes: their response to the net loads on rods and rigid bodies, and friction."""

from ...jit.compiler import ONE, inline
from ..contact.pairs import ground_bodies
from ..layout import span_of
from ..step import plane_contact


@inline
def apply(model, scene, state, control):
    """Add the response and friction of each plane to the rods that it acts on, after all other loads."""
    if scene.planes.stiffness.size > 0:
        state.normal_force[0, :] = 0.0
    for j in range(scene.planes.stiffness.size):
        first, n = span_of(scene.plane_span[j])
        # the first node reads the push in the slot before
        for d in range(3):
            state.scratch[0, d, first - ONE] = 0.0
        plane_contact(model, state, scene.planes, j, 0, first, n)


@inline
def apply_to_bodies(model, scene, state, dt):
    """Add the response and friction of planes to bodies, over a time step dt."""
    s = state
    if scene.grounded.size > 0:
        ground_bodies(
            dt, scene.body_planes, scene.grounded, scene.ground_friction, model.cylinders, s.body_x[0], s.body_v[0],
            s.body_Q[0], s.body_w[0], s.body_contact[0], s.body_force[0], s.body_torque[0],
        )  # fmt: skip
