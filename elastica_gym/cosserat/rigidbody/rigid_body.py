"""Base class of rigid bodies."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ...engine.model import Array
from ...engine.surroundings import Contact
from ..rod.cosserat_rod import Field

NOWHERE = Contact(stiffness=1.0)


@dataclass(frozen=True)
class LoweredBody:
    """A rigid body under the names of `surroundings.Cylinder`; a sphere is a cylinder of zero length.

    Contact is declared per pair here, so the per-body contact parameters of environments are left out.
    """

    length: float
    radius: float
    mass: float
    inertia: Array
    centre: Array
    directors: Array
    rods: Contact = NOWHERE
    ground_stiffness: float = 0.0
    ground_damping: float = 0.0
    ground_friction: float = 0.0


class RigidBodyBase:
    """Base class of rigid bodies, which have one node and one element, at their centre of mass.

    From ``finalize`` on, the arrays are views of the simulation's memory; mass and inertia are read there.

    Attributes
    ----------
    position_collection, velocity_collection : Array
        Of the centre of mass [m], [m/s], lab frame, (3, 1).
    director_collection : Array
        Rows d1, d2, d3 in the lab, (3, 3, 1).
    omega_collection : Array
        Angular velocity [rad/s], material frame, (3, 1).
    external_forces, external_torques : Array
        Forces on the centre [N], lab frame, and torques about it [N m], material frame, (3, 1).
    mass_second_moment_of_inertia : Array
        [kg m^2], diagonal, (3, 3, 1).
    inv_mass_second_moment_of_inertia : Array
        Its inverse, (3, 3, 1), computed when read.
    acceleration_collection, alpha_collection : Array
        Accelerations from the loads of the last kick [m/s^2], [rad/s^2], (3, 1), computed when read.
    mass, volume, density : np.float64 or Array
        [kg], [m^3], [kg/m^3]; from ``finalize`` on, read-only arrays of shape (1,).
    length, radius : np.float64
        [m]
    """

    REQUISITE_MODULES: ClassVar[list[type]] = []
    n_elems = n_nodes = 1
    ring_rod_flag = False
    _time_step = 0.0
    """Time step of the run, needed by friction on planes called by hand [s]"""

    position_collection = Field()
    velocity_collection = Field()
    director_collection = Field()
    omega_collection = Field()
    external_forces = Field()
    external_torques = Field()
    mass_second_moment_of_inertia = Field()

    density: Any
    volume: Any
    length: np.float64
    radius: np.float64
    mass: Any

    def _set_up(self, position: Array, directors: Array, inertia: Array) -> None:
        self._fields: dict[str, Array] = {
            name: np.zeros((3, 1))
            for name in ("velocity_collection", "omega_collection", "external_forces", "external_torques")
        }
        # warm start of friction with planes; part of a saved state
        self._fields["plane_contact"] = np.zeros((6, 7))
        self._fields["position_collection"] = np.array(position, dtype=np.float64).reshape(3, 1)
        self._fields["director_collection"] = directors.reshape(3, 3, 1)
        self._fields["mass_second_moment_of_inertia"] = np.diag(inertia)[:, :, None]

    @property
    def inv_mass_second_moment_of_inertia(self) -> Array:  # noqa: D102
        return np.linalg.inv(self.mass_second_moment_of_inertia[..., 0])[:, :, None]

    @property
    def acceleration_collection(self) -> Array:  # noqa: D102
        return self.external_forces / self.mass

    @property
    def alpha_collection(self) -> Array:  # noqa: D102
        J, w = self.mass_second_moment_of_inertia[..., 0], self.omega_collection
        turn = np.cross(J @ w, w, axis=0) + self.external_torques
        return np.linalg.solve(J, turn)

    def compute_position_center_of_mass(self) -> Array:
        """Return the centre of mass [m], (3,)."""
        return self.position_collection[..., 0].copy()

    def compute_translational_energy(self) -> Any:
        """Return m v^2/2 [J]; like the mass, an array of shape (1,) from ``finalize`` on."""
        return 0.5 * self.mass * (self.velocity_collection**2).sum()

    def compute_rotational_energy(self) -> np.float64:
        """Return w . J w/2 [J]."""
        w = self.omega_collection[:, 0]
        return 0.5 * (w @ self.mass_second_moment_of_inertia[..., 0] @ w)

    def compute_internal_forces_and_torques(self, time: float) -> None:
        """Do nothing: a rigid body has no internal loads."""

    def update_accelerations(self, time: float, dt: float) -> None:
        """Do nothing: the accelerations are computed from the loads when read."""

    def zeroed_out_external_forces_and_torques(self, time: float) -> None:
        """Clear the loads."""
        self.external_forces[:] = 0.0
        self.external_torques[:] = 0.0

    def _lowered(self) -> LoweredBody:
        """Return the attributes that a Model needs.

        Raises
        ------
        ValueError
            If the inertia is not diagonal.
        """
        J = self.mass_second_moment_of_inertia[..., 0]
        if np.count_nonzero(J) > np.count_nonzero(np.diag(J)):
            raise ValueError("mass_second_moment_of_inertia must be diagonal")
        return LoweredBody(
            length=self._axis_length,
            radius=self.radius,
            mass=float(np.squeeze(self.mass)),
            inertia=np.diag(J).copy(),
            centre=self.position_collection[:, 0],
            directors=self.director_collection[..., 0],
        )

    @property
    def _axis_length(self) -> float:
        """Length from end to end, without caps."""
        return self.length

    def _move(self, memory: dict[str, Array]) -> None:
        """Copy fields to other memory and use it from now on."""
        for name, target in memory.items():
            target[...] = self._fields[name]
        self._fields = {**self._fields, **memory}
        for name in ("mass", "volume", "density"):
            setattr(self, name, _constant(getattr(self, name)))


def _constant(value: Any) -> Array:
    """Return a number as a read-only array of shape (1,)."""
    array = np.array(value, dtype=np.float64).reshape(1)
    array.flags.writeable = False
    return array
