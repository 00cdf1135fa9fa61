"""What every animal has: rods in surroundings, muscles, and senses."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..cosserat import Model, Rod
from ..cosserat.kernels.compiler import entry, inline
from ..cosserat.model import Array, Index
from ..muscles import Muscles

FASTEST = 10.0
"""Speed of a node above which a simulation has diverged [m/s]: no muscle moves one half as fast"""


class Senses(NamedTuple):
    """Where an animal feels itself: slots of the Model, and scales that make readings of order one."""

    nodes: Index
    """Nodes whose position and velocity it feels, (P,) int64"""
    joints: Index
    """Voronoi points whose curvature and twist it feels, and how the section there has rolled, (J,) int64"""
    skin: Index
    """Borders of the patches of elements whose contact it feels, (S + 1,) int64"""
    front: Index
    """First and last node of the part that the heading points to, (2,) int64"""
    rear: Index
    """First and last node of the part that the heading points from, (2,) int64"""
    head: int
    """The node that reaches for targets"""
    length: float
    """Body length, the unit of lengths [m]"""
    curvature_scale: float
    """Unit of curvature [1/m]"""
    weight: float
    """Weight of the body: with the patches' share of it, the unit of contact [N]"""


# compared by identity: its functions cache what they derive from it
@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """An animal in its surroundings. Environments of the same animal share one; it is not to be changed.

    Attributes
    ----------
    name : str
    rods : tuple of Rod
        Its rods where they were described.
    model : Model
    muscles : Muscles
    arms : tuple of str
        Names of the two arms.
    couples : Array
        Couple in the slots of the Model by activation [N m], (42, 3, L).
    senses : Senses
    sim_dt : float
        Time step of the physics unless another is asked for [s].
    """

    name: str
    rods: tuple[Rod, ...]
    model: Model
    muscles: Muscles
    arms: tuple[str, str]
    couples: Array
    senses: Senses
    sim_dt: float

    @property
    def n_readings(self) -> int:
        """How many numbers `feel` writes for one environment."""
        s = self.senses
        return 6 * s.nodes.size + 5 * s.joints.size + s.skin.size - 1

    def reading_names(self) -> tuple[str, ...]:
        """Return the name of each number that `feel` writes."""
        s, axes = self.senses, ("forward", "up", "right")
        return (
            *(f"position/{p}/{axis}" for p in range(s.nodes.size) for axis in axes),
            *(f"velocity/{p}/{axis}" for p in range(s.nodes.size) for axis in axes),
            *(f"curvature/{j}/{axis}" for j in range(s.joints.size) for axis in ("normal", "binormal", "twist")),
            *(f"roll/{j}/{axis}" for j in range(s.joints.size) for axis in ("normal", "binormal")),
            *(f"contact/{c}" for c in range(s.skin.size - 1)),
        )


class Pose(NamedTuple):
    """Where each of B animals is, and whether its simulation is sound."""

    centre: Array
    """Centre of mass [m], (B, 3)"""
    velocity: Array
    """Velocity of the centre of mass [m/s], (B, 3)"""
    heading: Array
    """Horizontal unit vector from the rear to the front part, as (x, z), (B, 2)"""
    head: Array
    """Position of the head [m], (B, 3)"""
    sound: Index
    """1 where all is finite and below `FASTEST`, else 0, (B,) int64"""

    def only(self, envs: slice) -> "Pose":
        """Return views of some environments."""
        return Pose(self.centre[envs], self.velocity[envs], self.heading[envs], self.head[envs], self.sound[envs])


def make_pose(n_envs: int) -> Pose:
    """Allocate a Pose."""
    return Pose(np.zeros((n_envs, 3)), np.zeros((n_envs, 3)), np.zeros((n_envs, 2)), np.zeros((n_envs, 3)),
                np.ones(n_envs, dtype=np.int64))  # fmt: skip


@entry
def activate(couples, activations, out):
    """Write the couples that activations (B, 42) command into ``out`` (B, 3, L), environment by environment."""
    for i in range(activations.shape[0]):
        out[i] = 0.0
        for a in range(activations.shape[1]):
            level = activations[i, a]
            for c in range(3):
                for k in range(out.shape[2]):
                    out[i, c, k] += level * couples[a, c, k]


@inline
def _mean(row, ends):
    total = 0.0
    for k in range(ends[0], ends[1] + 1):
        total += row[k]
    return total / (ends[1] + 1 - ends[0])


@entry
def feel(model, state, senses, pose, readings):
    """Compute the pose and the readings (B, R) of every environment, in the frame of its heading.

    Readings, with the heading's forward, up and right axes: positions of nodes from the centre of
    mass in body lengths, their velocities in body lengths a second, curvature and twist in
    ``curvature_scale``, the up component of normal and binormal there, and the force with which the ground
    carries each patch of skin, over the weight of an equal share of the body. In a loop over environments
    rather than in NumPy, whose sums may round differently with the size of the batch.
    """
    n_nodes, n_joints, n_skin = senses.nodes.size, senses.joints.size, senses.skin.size - 1
    inv_length = 1.0 / senses.length
    for i in range(state.x.shape[0]):
        x, v = state.x[i], state.v[i]
        total, sound = 0.0, True
        for c in range(3):
            pose.centre[i, c] = 0.0
            pose.velocity[i, c] = 0.0
        for k in range(model.mass.size):
            m = model.mass[k]
            total += m
            for c in range(3):
                pose.centre[i, c] += m * x[c, k]
                pose.velocity[i, c] += m * v[c, k]
                # false for what is not a number, too
                sound = sound and abs(v[c, k]) < FASTEST and abs(x[c, k]) < 1e6 and abs(state.w[i, c, k]) < 1e9
        for c in range(3):
            pose.centre[i, c] /= total
            pose.velocity[i, c] /= total
            pose.head[i, c] = x[c, senses.head]
        pose.sound[i] = 1 if sound else 0

        hx = _mean(x[0], senses.front) - _mean(x[0], senses.rear)
        hz = _mean(x[2], senses.front) - _mean(x[2], senses.rear)
        size = (hx * hx + hz * hz) ** 0.5
        hx, hz = (hx / size, hz / size) if size > 1e-9 else (1.0, 0.0)
        pose.heading[i, 0], pose.heading[i, 1] = hx, hz

        row, at = readings[i], 0
        for p in range(n_nodes):
            k = senses.nodes[p]
            dx, dz = x[0, k] - pose.centre[i, 0], x[2, k] - pose.centre[i, 2]
            row[at] = (dx * hx + dz * hz) * inv_length
            row[at + 1] = (x[1, k] - pose.centre[i, 1]) * inv_length
            row[at + 2] = (dz * hx - dx * hz) * inv_length
            row[at + 3 * n_nodes] = (v[0, k] * hx + v[2, k] * hz) * inv_length
            row[at + 3 * n_nodes + 1] = v[1, k] * inv_length
            row[at + 3 * n_nodes + 2] = (v[2, k] * hx - v[0, k] * hz) * inv_length
            at += 3
        at = 6 * n_nodes
        for j in range(n_joints):
            for c in range(3):
                row[at] = state.kappa[i, c, senses.joints[j]] / senses.curvature_scale
                at += 1
        for j in range(n_joints):
            for c in range(2):
                row[at] = state.Q[i, c, 1, senses.joints[j]]
                at += 1
        for s in range(n_skin):
            carried = 0.0
            for k in range(senses.skin[s], senses.skin[s + 1]):
                carried += state.normal_force[i, k]
            row[at] = carried * n_skin / senses.weight
            at += 1
