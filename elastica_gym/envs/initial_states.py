"""Initial states of episodes: the animal slightly bent, with any heading, slightly in motion; its object at some place.

Each function writes an initial state into environment i and returns the muscles' activations in it, or None if they
are at rest.
"""

import functools
from collections.abc import Callable

import numpy as np

from ..bodies.body import Body, activate
from ..engine import State, advance, at_rest
from ..engine.model import Array

BENDS = (0.7, 0.35, 0.175)
"""Standard deviation of the curvature of each sine wave along the body, where it is thinnest, in 1/body length"""
SPEED = 0.02
"""Standard deviation of the velocity in each horizontal direction [m/s]"""
CLEAR = 0.02
"""Least distance between the animal's surface and an object at the start [m]"""
ARC = 0.4
"""Distance of the object from the head on the arc [m]"""
RING = (0.4, 0.8)
"""Its least and largest distance anywhere [m]"""
NEARBY = (0.2, 0.4)
"""Its least and largest distance where the animal hardly needs to crawl [m]"""
IN_THE_BEND = ((0.224, 0.22), (0.255, 0.2), (0.291, 0.1))
"""Places where an arm can grab it by bending at full strength: distance from the head [m], and angle to the right of
straight ahead, for the second arm, or of straight behind, for the first [rad]"""
GRABBING = 0.8
"""Time in which the arm is bent to full strength [s]"""
HOLDING = 2.0
"""Time after which it holds the object, at rest [s]"""


def bent(rng: np.random.Generator, body: Body, state: State, i: int) -> None:
    """Write a random shape, heading and velocity, with muscles at rest.

    The heading is uniform. The animal is bent sideways by couples of three sine waves of random phase, for which the
    curvature of its thinnest part has standard deviations of 0.7, 0.35 and 0.175 per body length; it straightens when
    released. Its horizontal velocity has a standard deviation of 0.02 m/s in each direction. Its centre of mass is
    above the origin.
    """
    # all else, ghosts included, is copied from the body at rest, so a divergence leaves no trace; the animal is one rod
    heading = rng.uniform(-np.pi, np.pi)
    bends = rng.normal(0.0, BENDS)
    phases = rng.uniform(-np.pi, np.pi, len(BENDS))
    velocity = rng.normal(0.0, SPEED, 2)
    for field, resting in zip(state, body.rest, strict=True):
        field[i] = resting[0]
    (rod,) = body.rods
    s = (np.cumsum(rod.rest_length) - 0.5 * rod.rest_length) / rod.rest_length.sum()
    waves = sum(b * np.sin((j + 1) * np.pi * s + p) for j, (b, p) in enumerate(zip(bends, phases, strict=True)))
    yields = (rod.radius.min() / rod.radius) ** 4
    turned = np.cumsum(waves * yields * rod.rest_length) / body.sensors.length
    nodes, elements = body.nodes(0), body.elements(0)
    _turn(heading + turned - turned.mean(), rod.nodal_mass, state.x[i, :, nodes], state.Q[i, :, :, elements])
    state.v[i, 0, nodes], state.v[i, 2, nodes] = velocity


def _turn(angle: Array, mass: Array, nodes: Array, directors: Array) -> None:
    """Rotate each element of a rod by an angle about the vertical, from x to z, and reconnect them, in place."""
    cosine, sine = np.cos(angle), np.sin(angle)

    def turned(x: Array, z: Array) -> tuple[Array, Array]:
        return x * cosine - z * sine, x * sine + z * cosine

    directors[:, 0], directors[:, 2] = turned(directors[:, 0], directors[:, 2])
    steps = turned(*np.diff(nodes[[0, 2]], axis=1))
    for row, step in zip((nodes[0], nodes[2]), steps, strict=True):
        row[0], row[1:] = 0.0, np.cumsum(step)
        row -= (row * mass).sum() / mass.sum()


def with_object_on_the_arc(rng: np.random.Generator, body: Body, state: State, i: int) -> None:
    """Write a bent animal with the object at 0.4 m from the head, between straight ahead and straight to the right.

    The angle is uniform, redrawn if the object would overlap the animal.
    """
    bent(rng, body, state, i)
    while not _place(body, state, i, ARC, rng.uniform(0.0, 0.5 * np.pi)):
        pass


def with_object_anywhere(rng: np.random.Generator, body: Body, state: State, i: int) -> None:
    """Write a bent animal with the object at 0.4 to 0.8 m from the head, in any direction; both are uniform."""
    bent(rng, body, state, i)
    while not _place(body, state, i, rng.uniform(*RING), rng.uniform(-np.pi, np.pi)):
        pass


def with_object_to_the_right(rng: np.random.Generator, body: Body, state: State, i: int) -> None:
    """Write a bent animal with the object at 0.4 m straight to the right of the head, the far end of the arc.

    The state is redrawn if the object would overlap the animal.
    """
    bent(rng, body, state, i)
    while not _place(body, state, i, ARC, 0.5 * np.pi):
        bent(rng, body, state, i)


def _place(body: Body, state: State, i: int, away: float, angle: float, clear: float = CLEAR) -> bool:
    """Place the first object at a distance from the head and an angle to the right [m, rad], if there is room."""
    x, sensors = state.x[i], body.sensors
    forward = np.array(
        [
            x[c, sensors.front[0] : sensors.front[1] + 1].mean() - x[c, sensors.rear[0] : sensors.rear[1] + 1].mean()
            for c in (0, 2)
        ]
    )
    forward /= np.linalg.norm(forward)
    cosine, sine = away * np.cos(angle), away * np.sin(angle)
    way = cosine * forward[0] - sine * forward[1], sine * forward[0] + cosine * forward[1]
    place = x[[0, 2], sensors.head] + way
    if _clearance(body, x, place) <= clear:
        return False
    state.body_x[i, 0, [0, 2]] = place
    return True


def _clearance(body: Body, x: Array, place: Array) -> float:
    """Return the horizontal distance between the surfaces of the animal and of the upright object at a place [m]."""
    (rod,) = body.rods
    nodes = x[[0, 2], body.nodes(0)]
    middles = 0.5 * (nodes[:, 1:] + nodes[:, :-1])
    away = np.linalg.norm(middles - place[:, None], axis=0) - 0.5 * rod.rest_length - rod.radius
    return float(away.min()) - body.cylinders[0].radius


def with_object_nearby(rng: np.random.Generator, body: Body, state: State, i: int) -> None:
    """Write a bent animal with the object at 0.2 to 0.4 m from the head, in any direction; both are uniform."""
    bent(rng, body, state, i)
    while not _place(body, state, i, rng.uniform(*NEARBY), rng.uniform(-np.pi, np.pi)):
        pass


def with_object_held(rng: np.random.Generator, body: Body, state: State, i: int) -> Array:
    """Write an animal with either arm holding the object, and return the activations that hold it.

    It is one of six such states, rotated to a random heading and slightly in motion.
    """
    held, levels = holding(body)
    chosen, heading, velocity = rng.integers(len(levels)), rng.uniform(-np.pi, np.pi), rng.normal(0.0, SPEED, 2)
    for field, kept in zip(state, held, strict=True):
        field[i] = kept[chosen]
    nodes = body.nodes(0)
    _rotate(heading, state, i, nodes)
    state.v[i, 0, nodes], state.v[i, 2, nodes] = velocity
    state.body_v[i, 0, [0, 2]] = velocity
    return levels[chosen]


def _rotate(angle: float, state: State, i: int, nodes: slice) -> None:
    """Rotate the animal and its objects about the vertical through the origin, from x to z, in place."""
    cosine, sine = np.cos(angle), np.sin(angle)
    contact = state.body_contact[i]
    # vector components are on the first axis
    for vectors in (
        state.x[i, :, nodes],
        state.Q[i, :, :, nodes].transpose(1, 0, 2),
        state.body_x[i].T,
        state.body_Q[i].transpose(2, 0, 1),
        contact[..., 1:4].transpose(2, 0, 1),
        contact[..., 4:7].transpose(2, 0, 1),
    ):
        x, z = vectors[0].copy(), vectors[2].copy()
        vectors[0], vectors[2] = x * cosine - z * sine, x * sine + z * cosine


@functools.lru_cache(maxsize=1)
def holding(body: Body) -> tuple[State, Array]:
    """Return states at rest in which an arm holds the object, and the activations that hold it, (6, 42).

    The object is placed in the bend of each arm, which is then bent at full strength; after two seconds, the arm wraps
    the object by more than 200 degrees (`tests/envs/test_senses.py`). Do not modify the result.
    """
    arms = list(body.muscles.arms)
    places = [(away, angle) if arm else (away, np.pi - angle) for arm in range(2) for away, angle in IN_THE_BEND]
    state, control = at_rest(body.model, body.rods, len(places), cylinders=body.cylinders)
    levels = np.zeros((len(places), body.n_activations))
    for i, (away, angle) in enumerate(places):
        for field, resting in zip(state, body.rest, strict=True):
            field[i] = resting[0]
        if not _place(body, state, i, away, angle, clear=0.0):
            raise ValueError(f"an object {away} m from the head, {angle:.2f} rad to its right, overlaps the animal")
        levels[i, body.muscles.columns("normal", arms[i // len(IN_THE_BEND)])] = 1.0
    n_parts = 16
    for part in range(n_parts):
        activate(body.couples, levels * (part + 1) / n_parts, control.couple)
        advance(body.model, state, control, 0, len(places), body.sim_dt, round(GRABBING / n_parts / body.sim_dt))
    advance(body.model, state, control, 0, len(places), body.sim_dt, round((HOLDING - GRABBING) / body.sim_dt))
    for moving in (state.v, state.w, state.body_v, state.body_w, state.time, state.step):
        moving[:] = 0
    return state, levels


WITH_OBJECT: dict[str, Callable[[np.random.Generator, Body, State, int], Array | None]] = {
    "arc": with_object_on_the_arc,
    "anywhere": with_object_anywhere,
    "default": with_object_to_the_right,
}
"""By name of the ``spread``; the default is that of the 2020 hackathon"""
