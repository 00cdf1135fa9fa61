"""Joints between rods and rigid bodies (Zhang et al. 2019)."""

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..engine.model import Array
from ..engine.rod import as_number, three
from .contact_forces import NoContact, RodCylinderContact, RodRodContact, RodSelfContact, RodSphereContact
from .contact_utils import (  # noqa: F401
    _aabbs_not_intersecting,
    _clip,
    _dot_product,
    _find_min_dist,
    _norm,
    _out_of_bounds,
    _prune_using_aabbs_rod_cylinder,
    _prune_using_aabbs_rod_rod,
)
from .lowering import SceneBuilder
from .not_offered import refuse_names
from .rigidbody import Sphere
from .rod.rod_base import RodBase

End = tuple[Any, int, Any, int]


class ConnectionBase(ABC):
    """Base class of connections between two systems; write your own by overriding both methods.

    They are called once per step (per stage of PEFRL), after the drift, and add to
    their ``external_forces`` [N], lab frame, and ``external_torques`` [N m], material frame.
    """

    @abstractmethod
    def apply_forces(self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0) -> None:
        """Add forces at the connected nodes."""

    @abstractmethod
    def apply_torques(
        self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0
    ) -> None:
        """Add torques at the connected elements."""


class FreeJoint(ConnectionBase):
    """A ball joint: a spring and a damper between two nodes.

    Parameters
    ----------
    k : float
        Force per distance [N/m].
    nu : float
        Force per relative velocity [N s/m].
    """

    def __init__(self, k: float, nu: float) -> None:
        self.k, self.nu = as_number("k", k), as_number("nu", nu)

    def apply_forces(self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0) -> None:
        """Add k (x2 - x1) + nu (v2 - v1) to one, and its opposite to two."""
        x, v = (
            getattr(system_two, name)[..., index_two] - getattr(system_one, name)[..., index_one]
            for name in ("position_collection", "velocity_collection")
        )
        force = self.k * x + self.nu * v
        system_one.external_forces[..., index_one] += force
        system_two.external_forces[..., index_two] -= force

    def apply_torques(
        self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0
    ) -> None:
        """Do nothing: the joint rotates freely."""

    def lower(self, builder: SceneBuilder, ends: End) -> None:
        """Write a joint."""
        builder.add_joint(ends, stiffness=self.k, damping=self.nu)


BallJoint = SphericalJoint = FreeJoint


class HingeJoint(FreeJoint):
    """A joint that keeps the tangent of system two in a plane, by the torque -kt (d3 . h)(d3 x h).

    Parameters
    ----------
    k, nu : float
        As for `FreeJoint`.
    kt : float
        Torque per sine of the angle out of the plane [N m].
    normal_direction : array_like
        h, the normal of the plane, fixed in the lab, of any length, (3,).
    """

    def __init__(self, k: float, nu: float, kt: float, normal_direction: ArrayLike) -> None:
        super().__init__(k, nu)
        normal = three("normal_direction", normal_direction)
        if not normal.any():
            raise ValueError("normal_direction must not be zero")
        self.kt, self.normal_direction = as_number("kt", kt), normal / np.linalg.norm(normal)

    def apply_torques(
        self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0
    ) -> None:
        """Add the torque to system two, and its opposite to system one."""
        d3, h = system_two.director_collection[2, :, index_two], self.normal_direction
        _twist(system_one, index_one, system_two, index_two, -self.kt * np.dot(d3, h) * np.cross(d3, h))

    def lower(self, builder: SceneBuilder, ends: End) -> None:
        """Write a joint."""
        builder.add_joint(ends, stiffness=self.k, damping=self.nu, hinge_stiffness=self.kt, axis=self.normal_direction)


class FixedJoint(FreeJoint):
    """A joint that holds the relative rotation of two elements, including twist.

    Parameters
    ----------
    k, nu : float
        As for `FreeJoint`.
    kt : float
        Torque per angle [N m].
    nut : float
        Torque per relative angular velocity [N m s].
    rest_rotation_matrix : Array, optional
        C with Q1 = C Q2 at rest, (3, 3); default identity. Changes between runs or callbacks take effect.
    """

    def __init__(
        self, k: float, nu: float, kt: float, nut: float = 0.0, rest_rotation_matrix: ArrayLike | None = None
    ) -> None:
        super().__init__(k, nu)
        rest = np.eye(3) if rest_rotation_matrix is None else np.asarray(rest_rotation_matrix)
        if rest.shape != (3, 3) or np.abs(rest @ rest.T - np.eye(3)).max() > 1e-8:
            raise ValueError(f"rest_rotation_matrix must be a rotation of shape (3, 3), not {rest.tolist()}")
        self.kt, self.nut, self.rest_rotation_matrix = as_number("kt", kt), as_number("nut", nut), rest

    def apply_torques(
        self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0
    ) -> None:
        """Add kt Q2^T vee log(Q2 Q1^T C) - nut (Q2^T w2 - Q1^T w1) to two, and its opposite to one."""
        from scipy.spatial.transform import Rotation

        Q1, Q2 = system_one.director_collection[..., index_one], system_two.director_collection[..., index_two]
        w1, w2 = Q1.T @ system_one.omega_collection[..., index_one], Q2.T @ system_two.omega_collection[..., index_two]
        angle = Rotation.from_matrix(Q2 @ Q1.T @ self.rest_rotation_matrix).as_rotvec()
        _twist(system_one, index_one, system_two, index_two, self.kt * (Q2.T @ angle) - self.nut * (w2 - w1))

    def lower(self, builder: SceneBuilder, ends: End) -> None:
        """Write a joint."""
        builder.add_joint(
            ends,
            stiffness=self.k,
            damping=self.nu,
            turn_stiffness=self.kt,
            turn_damping=self.nut,
            rest_rotation=self.rest_rotation_matrix,
        )


class _ContactAsJoint(FreeJoint):
    """Contact under its names of 0.2.x, declared by ``connect`` without indices."""

    IS_COMPILED = True

    def apply_forces(self, system_one: Any, index_one: Any, system_two: Any, index_two: Any, time: float = 0.0) -> None:
        """Add forces and torques, as the compiled step does."""
        self.contact_with(system_two).apply_contact(system_one, system_two, time)

    def contact_with(self, system_two: Any) -> NoContact:
        """Return the contact with a second system."""
        raise NotImplementedError

    def lower(self, builder: SceneBuilder, ends: End) -> None:
        """Write a pair."""
        one, _, two, _ = ends
        contact = self.contact_with(two)
        contact.require_systems(one, two)
        contact.lower(builder, one, two)


class ExternalContact(_ContactAsJoint):
    """Contact of a rod with another or with a rigid body: `RodRodContact`, `RodCylinderContact`, `RodSphereContact`.

    Parameters
    ----------
    k, nu, velocity_damping_coefficient, friction_coefficient : float
        As for `RodCylinderContact`; between rods there is no friction.
    """

    def __init__(
        self, k: float, nu: float, velocity_damping_coefficient: float = 0.0, friction_coefficient: float = 0.0
    ) -> None:
        super().__init__(k, nu)
        self._friction = (velocity_damping_coefficient, friction_coefficient)

    def contact_with(self, system_two: Any) -> NoContact:
        """Return the contact with a second system, chosen by its type."""
        if isinstance(system_two, RodBase):
            return RodRodContact(self.k, self.nu)
        kind = RodSphereContact if isinstance(system_two, Sphere) else RodCylinderContact
        return kind(self.k, self.nu, *self._friction)


class SelfContact(_ContactAsJoint):
    """Contact of a rod with itself: `RodSelfContact`.

    Parameters
    ----------
    k, nu : float
        As for `RodSelfContact`.
    """

    def contact_with(self, system_two: Any) -> NoContact:
        """Return the contact of a rod with itself."""
        return RodSelfContact(self.k, self.nu)


def get_relative_rotation_two_systems(system_one: Any, index_one: int, system_two: Any, index_two: int) -> Array:
    """Return Q1 Q2^T, the ``rest_rotation_matrix`` that keeps the current relative rotation, (3, 3)."""
    return system_one.director_collection[..., index_one] @ system_two.director_collection[..., index_two].T


def _twist(system_one: Any, index_one: Any, system_two: Any, index_two: Any, torque: Array) -> None:
    """Add a torque in the lab frame to system two, and its opposite to system one."""
    system_one.external_torques[..., index_one] -= system_one.director_collection[..., index_one] @ torque
    system_two.external_torques[..., index_two] += system_two.director_collection[..., index_two] @ torque


# names in 0.2.x
_prune_using_aabbs_rod_rigid_body = _prune_using_aabbs_rod_cylinder

__getattr__ = refuse_names(__name__)
