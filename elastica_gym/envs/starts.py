"""How an episode starts: the animal somewhat bent, in any direction, slightly in motion."""

import numpy as np

from ..bodies.body import Body
from ..cosserat import State
from ..cosserat.model import Array

BENDS = (2.0, 1.0, 0.5)
"""Standard deviation of the curvature of each sine wave along the body [1/m]"""
SPEED = 0.02
"""Standard deviation of the velocity in each horizontal direction [m/s]"""


def draw_start(rng: np.random.Generator, body: Body, rest: State, state: State, i: int) -> None:
    """Write a new start into environment i: shape, heading and velocity at random, muscles at rest.

    All else, ghosts included, is copied from ``rest``, the State of one body at rest: what diverged leaves no trace.

    Every rod lies flat at its height: in the plane it is bent by three sine waves of random strength
    and phase, and it straightens when let go. The animal's centre of mass is above the origin.
    """
    heading = rng.uniform(-np.pi, np.pi)
    bends = rng.normal(0.0, BENDS)
    phases = rng.uniform(-np.pi, np.pi, len(BENDS))
    velocity = rng.normal(0.0, SPEED, 2)
    for field, resting in zip(state, rest, strict=True):
        field[i] = resting[0]
    for rod, start in zip(body.rods, body.model.first_slot, strict=True):
        n = rod.n_elements
        position, directors = _bent(rod.rest_length, float(rod.position[1, 0]), heading, bends, phases, rod.nodal_mass)
        state.x[i, :, start : start + n + 1] = position
        state.Q[i, :, :, start : start + n] = directors
        state.v[i, 0, start : start + n + 1], state.v[i, 2, start : start + n + 1] = velocity


def _bent(
    rest_length: Array, height: float, heading: float, bends: Array, phases: Array, mass: Array
) -> tuple[Array, Array]:
    """Return the nodes (3, n + 1) and directors (3, 3, n) of a rod bent in the horizontal plane."""
    s = (np.cumsum(rest_length) - 0.5 * rest_length) / rest_length.sum()
    curvature = sum(b * np.sin((j + 1) * np.pi * s + p) for j, (b, p) in enumerate(zip(bends, phases, strict=True)))
    turned = np.cumsum(curvature * rest_length)
    angle = heading + turned - turned.mean()
    zero, one = np.zeros_like(angle), np.ones_like(angle)
    tangent, normal = np.array([np.cos(angle), zero, np.sin(angle)]), np.array([zero, one, zero])
    nodes = np.concatenate([np.zeros((3, 1)), np.cumsum(rest_length * tangent, axis=1)], axis=1)
    nodes -= (nodes * mass).sum(axis=1, keepdims=True) / mass.sum()
    nodes[1] = height
    return nodes, np.array([normal, np.cross(tangent, normal, axis=0), tangent])
