"""The parts of every animal: rods in surroundings, muscles, and sensors."""

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..engine import Model, Rod, State, advance, at_rest
from ..engine.jit.compiler import entry, inline, stage
from ..engine.kernels.contact.law import overlap
from ..engine.kernels.math.vectors import column, plus, times, to_lab, vector
from ..engine.model import Array, Index
from ..engine.surroundings import Cylinder
from .mirror import Mirror
from .muscles import Muscles, couple_matrix
from .observation import AXES, Block, single


class Sensors(NamedTuple):
    """The sensors of an animal: slots of the Model, and scales that make readings of order one."""

    nodes: Index
    """Nodes whose position and velocity are observed, (P,) int64"""
    joints: Index
    """Voronoi points whose curvature, twist and roll are observed, (J,) int64"""
    skin: Index
    """Borders of the patches of elements whose contact is observed, (S + 1,) int64"""
    front: Index
    """First and last node of the part that the heading points to, (2,) int64"""
    rear: Index
    """First and last node of the part that the heading points from, (2,) int64"""
    head: int
    """The node that reaches for targets"""
    crown: int
    """The element whose normal points up while the animal is upright"""
    length: float
    """Body length, the unit of lengths [m]"""
    curvature_scale: float
    """Unit of curvature [1/m]"""
    weight: float
    """Weight of the body; a patch's equal share of it is the unit of contact [N]"""
    fastest: float
    """Speed above which a simulation has diverged, of nodes and objects [m/s]"""


# compared by identity: functions cache results derived from it
@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """An animal in its surroundings. Environments of the same animal share one; do not modify it.

    Attributes
    ----------
    name : str
    rods : tuple of Rod
        Its rods in the pose described.
    cylinders : tuple of Cylinder
        The free objects around it.
    model : Model
    muscles : Muscles
    mirror : Mirror, optional
        The mirror in which it is its own image.
    couples : Array
        Couple in the slots of the Model, for each activation [N m], (A, 3, L).
    sensors : Sensors
    sim_dt : float
        Default time step of the physics [s].
    frame : str
        Definition of forward and right, in words.
    order : str
        The order in which places along the body are numbered, in words.
    settling : float
        Time for the body as described to come to rest on the ground [s].
    """

    name: str
    rods: tuple[Rod, ...]
    cylinders: tuple[Cylinder, ...] = ()
    model: Model
    muscles: Muscles
    mirror: Mirror | None = None
    couples: Array
    sensors: Sensors
    sim_dt: float
    frame: str
    order: str
    settling: float = 0.0

    @property
    def n_activations(self) -> int:
        """Number of activations A, the size of an action."""
        return self.muscles.n_activations

    @property
    def activation_names(self) -> tuple[str, ...]:
        """Name of each activation."""
        return self.muscles.activation_names

    def nodes(self, rod: int) -> slice:
        """Return the slots of the nodes of a rod in the Model."""
        start = int(self.model.first_slot[rod])
        return slice(start, start + self.rods[rod].n_elements + 1)

    def elements(self, rod: int) -> slice:
        """Return the slots of the elements of a rod in the Model."""
        start = int(self.model.first_slot[rod])
        return slice(start, start + self.rods[rod].n_elements)

    @functools.cached_property
    def rest(self) -> State:
        """State of one such animal at rest on the ground; do not modify it."""
        state, control = at_rest(self.model, self.rods, cylinders=self.cylinders)
        advance(self.model, state, control, 0, 1, self.sim_dt, round(self.settling / self.sim_dt))
        for moving in (state.v, state.w, state.body_v, state.body_w, state.time, state.step):
            moving[:] = 0
        return state

    def blocks(self) -> list[Block]:
        """Return the blocks of the observation that `observe` writes, in its order."""
        s, axes = self.sensors, AXES
        nodes, places, patches = s.nodes.size, s.joints.size, s.skin.size - 1

        def each(count: int, parts: Sequence[str]) -> tuple[str, ...]:
            return tuple(f"{k}/{part}" for k in range(count) for part in parts)

        order, share = self.order, f"1/{patches} of the weight"
        numbered, frame = tuple(map(str, range(patches))), ", ".join(axes)
        blocks = [
            Block("position", each(nodes, axes), -1.0, 1.0, "body length",
                  f"position of {nodes} nodes, {order}, relative to the centre of mass: {frame}"),
            Block("velocity", each(nodes, axes), -20.0, 20.0, "body lengths/s", f"their velocity: {frame} of each"),
            Block("curvature", each(places, ("normal", "binormal", "twist")), -10.0, 10.0, f"{s.curvature_scale:g}/m",
                  f"curvature about the normal and binormal, and twist, at {places} places, {order}"),
            Block("roll", each(places, ("normal", "binormal")), -1.0, 1.0, "1",
                  "up component of normal and binormal there: the roll of the body"),
        ]  # fmt: skip
        if self.model.planes.stiffness.size:
            carried = f"normal force of the ground on each of {patches} parts, {order}"
            blocks.append(Block("contact", numbered, 0.0, 50.0, share, carried))
        if self.cylinders:
            blocks.append(Block("touch", numbered, 0.0, 50.0, share, "normal force of objects on each of these"))
        for b in range(len(self.cylinders)):
            thing = f"object/{b}"
            blocks += [
                Block(f"{thing}/position", axes, -4.0, 4.0, "body length", f"object's centre, from the head: {frame}"),
                Block(f"{thing}/axis", axes, -1.0, 1.0, "1", f"its axis, from base to top at the start: {frame}"),
                Block(f"{thing}/velocity", axes, -20.0, 20.0, "body lengths/s", f"its velocity: {frame}"),
                Block(f"{thing}/spin", axes, -50.0, 50.0, "rad/s", f"its angular velocity: about {frame}"),
                single(f"{thing}/gap", -1.0, 4.0, "body length",
                       "gap between its surface and the animal's, negative where they overlap"),
            ]  # fmt: skip
        meaning = "current activation of each muscle, in the order of the actions"
        return [*blocks, Block("activation", self.activation_names, -1.0, 1.0, "1", meaning)]


def couples_of(muscles: Muscles, rods: Sequence[Rod], model: Model) -> Array:
    """Return the couple in the slots of a model of these rods, for each activation [N m], (A, 3, L)."""
    couples = np.zeros((muscles.n_activations, 3, model.mass.size))
    for number, (rod, start) in enumerate(zip(rods, model.first_slot.tolist(), strict=True)):
        couples[:, :, start : start + rod.n_elements - 1] = couple_matrix(muscles, rod, number)
    return couples


class Pose(NamedTuple):
    """The pose of each of B animals, and whether its simulation is sound."""

    centre: Array
    """Centre of mass [m], (B, 3)"""
    heading: Array
    """Horizontal unit vector from the rear to the front part, as (x, z), (B, 2)"""
    head: Array
    """Position of the head [m], (B, 3)"""
    upright: Array
    """Up component of the crown's normal, (B,)"""
    objects: Array
    """Centres of mass of the free objects [m], (B, C, 3)"""
    gaps: Array
    """Least distance of each object's surface from the animal's, negative where they overlap [m], (B, C)"""
    sound: Index
    """1 if all is finite and speeds are below the sensors' ``fastest``, else 0, (B,) int64"""

    def only(self, envs: slice) -> "Pose":
        """Return views of some environments."""
        return Pose._make(field[envs] for field in self)


def make_pose(n_envs: int, n_objects: int) -> Pose:
    """Allocate a Pose."""
    return Pose(
        centre=np.zeros((n_envs, 3)),
        heading=np.zeros((n_envs, 2)),
        head=np.zeros((n_envs, 3)),
        upright=np.zeros(n_envs),
        objects=np.zeros((n_envs, n_objects, 3)),
        gaps=np.zeros((n_envs, n_objects)),
        sound=np.ones(n_envs, dtype=np.int64),
    )


@stage
def _command(activations, couples, out):
    """Write the couples commanded by activations (A,) into ``out`` (3, L): a third of these act in each direction."""
    slots, third = np.uint64(out.shape[1]), activations.size // 3
    for c in range(3):
        for k in range(slots):
            out[c, k] = 0.0
        for a in range(c * third, (c + 1) * third):
            level = activations[a]
            for k in range(slots):
                out[c, k] += level * couples[a, c, k]


@entry
def activate(couples, activations, out):
    """Write the couples commanded by activations (B, A) into ``out`` (B, 3, L), environment by environment."""
    for i in range(activations.shape[0]):
        _command(activations[i], couples, out[i])


@inline
def _mean(row, ends):
    total = 0.0
    for k in range(ends[0], ends[1] + 1):
        total += row[k]
    return total / (ends[1] + 1 - ends[0])


@inline
def _write(row, at, scale, hx, hz, a):
    """Write the forward, up and right component of a vector, scaled."""
    row[at] = scale * (a[0] * hx + a[2] * hz)
    row[at + 1] = scale * a[1]
    row[at + 2] = scale * (a[2] * hx - a[0] * hz)


@inline
def _gap(x, radius, slots, centre, axis, length, thickness):
    """Return the least distance between the surfaces of elements and of a cylinder."""
    start, edge = plus(centre, -0.5 * length, axis), times(length, axis)
    least = 1e9
    for k in range(slots):
        # a ghost has no cross-section
        if radius[k] > 0.0:
            first = column(x, k)
            way = plus(column(x, k + 1), -1.0, first)
            depth, _, _, _ = overlap(first, way, radius[k], start, edge, thickness, False)
            least = -depth if -depth < least else least
    return least


@inline
def _patches(row, at, force, skin, scale):
    """Write the sum of a force over the elements of each patch of skin, scaled."""
    for s in range(skin.size - 1):
        total = 0.0
        for k in range(skin[s], skin[s + 1]):
            total += force[k]
        row[at + s] = scale * total


@inline
def _observe_object(model, state, i, b, pose, row, at, inv_length):
    """Compute the pose of an object, and write its readings."""
    hx, hz = pose.heading[i, 0], pose.heading[i, 1]
    place, axis = vector(state.body_x[i, b]), vector(state.body_Q[i, b, 2])
    length, radius = model.cylinders.length[b], model.cylinders.radius[b]
    gap = _gap(state.x[i], model.contact_radius, model.mass.size - 1, place, axis, length, radius)
    for c in range(3):
        pose.objects[i, b, c] = place[c]
    pose.gaps[i, b] = gap
    _write(row, at, inv_length, hx, hz, plus(place, -1.0, vector(pose.head[i])))
    _write(row, at + 3, 1.0, hx, hz, axis)
    _write(row, at + 6, inv_length, hx, hz, vector(state.body_v[i, b]))
    _write(row, at + 9, 1.0, hx, hz, to_lab(state.body_Q[i, b], vector(state.body_w[i, b])))
    row[at + 12] = gap * inv_length


@inline
def _is_sound(model, state, sensors, i):
    """Return whether all is finite in environment i, and speeds are below the sensors' ``fastest``."""
    x, v, w, fastest = state.x[i], state.v[i], state.w[i], sensors.fastest
    sound = True
    for c in range(3):
        for k in range(model.mass.size):
            # also false for NaN
            sound &= (abs(v[c, k]) < fastest) & (abs(x[c, k]) < 1e6) & (abs(w[c, k]) < 1e9)
        for b in range(model.cylinders.mass.size):
            sound &= (abs(state.body_v[i, b, c]) < fastest) & (abs(state.body_w[i, b, c]) < 1e9)
    return sound


@inline
def _locate(model, state, sensors, i, pose):
    """Compute the pose of the animal in environment i."""
    x, total, moment = state.x[i], 0.0, (0.0, 0.0, 0.0)
    for k in range(model.mass.size):
        total += model.mass[k]
        moment = plus(moment, model.mass[k], column(x, k))
    for c in range(3):
        pose.centre[i, c] = moment[c] / total
        pose.head[i, c] = x[c, sensors.head]
    pose.upright[i] = state.Q[i, 0, 1, sensors.crown]
    hx = _mean(x[0], sensors.front) - _mean(x[0], sensors.rear)
    hz = _mean(x[2], sensors.front) - _mean(x[2], sensors.rear)
    size = (hx * hx + hz * hz) ** 0.5
    pose.heading[i, 0], pose.heading[i, 1] = (hx / size, hz / size) if size > 1e-9 else (1.0, 0.0)


@inline
def _read(model, state, levels, sensors, i, pose, row):
    """Write the readings of environment i, whose pose has been computed, and return their number."""
    n_nodes, n_joints, n_skin = sensors.nodes.size, sensors.joints.size, sensors.skin.size - 1
    inv_length, at = 1.0 / sensors.length, 0
    hx, hz, centre = pose.heading[i, 0], pose.heading[i, 1], vector(pose.centre[i])
    for p in range(n_nodes):
        k = sensors.nodes[p]
        _write(row, at, inv_length, hx, hz, plus(column(state.x[i], k), -1.0, centre))
        _write(row, at + 3 * n_nodes, inv_length, hx, hz, column(state.v[i], k))
        at += 3
    at = 6 * n_nodes
    for j in range(n_joints):
        for c in range(3):
            row[at] = state.kappa[i, c, sensors.joints[j]] / sensors.curvature_scale
            at += 1
    for j in range(n_joints):
        for c in range(2):
            row[at] = state.Q[i, c, 1, sensors.joints[j]]
            at += 1
    if model.planes.stiffness.size > 0:
        _patches(row, at, state.normal_force[i], sensors.skin, n_skin / sensors.weight)
        at += n_skin
    bodies = model.cylinders
    if bodies.mass.size > 0:
        _patches(row, at, state.body_touch[i], sensors.skin, n_skin / sensors.weight)
        at += n_skin
    for b in range(bodies.mass.size):
        _observe_object(model, state, i, b, pose, row, at, inv_length)
        at += 13
    for a in range(levels.shape[1]):
        row[at + a] = levels[i, a]
    return at + levels.shape[1]


@entry
def observe(model, state, levels, sensors, pose, low, high, readings, envs):
    """Compute the pose and the readings (B, R or more) of some environments (E,), in the frame of their headings.

    Readings are clipped to their minimum and maximum values (R or more,). Where the simulation has diverged, pose and
    readings are left unchanged.

    Readings, with the heading's forward, up and right axes: positions of nodes relative to the centre of
    mass in body lengths, their velocities in body lengths per second, curvature and twist in
    ``curvature_scale``, the up component of normal and binormal there, and the normal force of the ground on each
    patch of skin, over the weight of an equal share of the body. With objects, also their force on each
    patch, likewise; and for each object its centre relative to the head in body lengths, axis, velocity in
    body lengths per second, angular velocity in rad/s, and the gap to the animal's surface in body lengths.
    Last, the muscles' current activations, ``levels`` (B, A). Computed in a loop over environments rather
    than in NumPy, whose sums may round differently with the size of the batch.
    """
    for e in range(envs.size):
        i = envs[e]
        pose.sound[i] = 1 if _is_sound(model, state, sensors, i) else 0
        if pose.sound[i] == 1:
            _locate(model, state, sensors, i, pose)
            row = readings[i]
            for at in range(_read(model, state, levels, sensors, i, pose, row)):
                row[at] = low[at] if row[at] < low[at] else high[at] if row[at] > high[at] else row[at]
