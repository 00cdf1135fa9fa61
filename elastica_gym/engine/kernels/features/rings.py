"""Closed rods: the image of the first element at the end."""

from ...jit.compiler import inline
from ..rod.rings import follow, hand_back


@inline
def move_images(scene, state):
    """Move the images with the elements that they are of."""
    if scene.rings.first.size > 0:
        follow(scene.rings, state.x[0], state.v[0], state.Q[0], state.w[0])


@inline
def apply(model, scene, state, control):
    """Hand the net loads on images back to the elements that they are of."""
    if scene.rings.first.size > 0:
        hand_back(scene.rings, state.force[0], state.torque[0])
