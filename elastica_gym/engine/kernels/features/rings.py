"""Closed rods: the image of the first element at the end."""

from ...jit.compiler import inline
from ..rod.rings import follow, hand_back


@inline
def move_images(scene, state):
    """Move the images with their originals."""
    if scene.rings.first.size > 0:
        follow(scene.rings, state.x[0], state.v[0], state.Q[0], state.w[0])


@inline
def apply(model, scene, state, control):
    """Move the net loads on images to their originals."""
    if scene.rings.first.size > 0:
        hand_back(scene.rings, state.force[0], state.torque[0])
