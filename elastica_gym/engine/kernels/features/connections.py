"""Joints of nodes and elements, and of rods side by side."""

from ...jit.compiler import inline
from ..joints import join
from ..sides import join_sides


@inline
def apply(model, scene, state, control):
    """Add their loads to the external loads."""
    s, force, torque = state, control.force[0], control.torque[0]
    if scene.joints.stiffness.size > 0:
        join(scene.joints, s.x[0], s.v[0], s.Q[0], s.w[0], force, torque, s.body_x[0], s.body_v[0], s.body_Q[0],
             s.body_w[0], s.body_force[0], s.body_torque[0])  # fmt: skip
    if scene.sides.stiffness.size > 0:
        join_sides(scene.sides, s.x[0], s.v[0], s.Q[0], s.length[0], model.rest_length, s.radius[0], force, torque)
