"""Surroundings of rods: planes and a viscous fluid."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..engine import surroundings
from ..engine.model import Array
from ..engine.rod import as_number, require_not_negative, three
from .by_hand import act
from .contact_utils import (
    _elements_to_nodes_inplace,
    _find_slipping_elements,
    _node_to_element_mass_or_force,
    _node_to_element_position,
    _node_to_element_velocity,
)
from .external_forces import NoForces
from .lowering import SceneBuilder
from .not_offered import refuse_methods, refuse_names


@refuse_methods
class InteractionPlane(NoForces):
    """A plane without friction: balances the force pressing on it, and resists penetration and approach.

    Parameters
    ----------
    k : float
        Restoring force per penetration [N/m].
    nu : float
        Damping force per velocity along the normal [N s/m].
    plane_origin, plane_normal : array_like
        A point on it [m], and its normal towards the free side, of any length; (3,) or (3, 1). Changes to arrays
        between runs or callbacks take effect.
    surface_tol : float, optional
        Gap below which an element is in contact [m]; 1e-4 m unless given, but at most a twentieth of its radius.
    """

    IS_COMPILED = True

    def __init__(
        self, k: float, nu: float, plane_origin: ArrayLike, plane_normal: ArrayLike, surface_tol: float | None = None
    ) -> None:
        self.k, self.nu, self.surface_tol = as_number("k", k), as_number("nu", nu), surface_tol
        self.plane_origin, self.plane_normal = three("plane_origin", plane_origin), three("plane_normal", plane_normal)
        # raises if an argument is invalid
        self.plane  # noqa: B018

    @property
    def plane(self) -> surroundings.Plane:
        """The plane as the compiled step reads it."""
        return surroundings.Plane(
            stiffness=self.k,
            damping=self.nu,
            origin=_triple(self.plane_origin),
            normal=_triple(self.plane_normal),
            surface_tolerance=self.surface_tol,
            **self._friction(),
        )

    def _friction(self) -> dict[str, Any]:
        return {}

    def apply_forces(self, system: Any, time: float = 0.0) -> None:
        """Add the plane's response to all previous loads, and its friction."""
        act(self.lower, system)

    def lower(self, builder: SceneBuilder, system: Any) -> None:
        """Write a plane."""
        builder.add_plane(system, self.plane)


class InteractionPlaneRigidBody(InteractionPlane):
    """A plane without friction for cylinders and spheres; another name of `CylinderPlaneContact`.

    Parameters
    ----------
    k, nu, plane_origin, plane_normal
        As for `InteractionPlane`.
    """

    def lower(self, builder: SceneBuilder, system: Any) -> None:
        """Write a plane."""
        builder.add_body_plane(system, self.plane, 0.0)


class AnisotropicFrictionalPlane(InteractionPlane):
    """A plane with anisotropic Coulomb friction (Gazzola et al. 2018, appendix D).

    Parameters
    ----------
    k, nu, plane_origin, plane_normal, surface_tol
        As for `InteractionPlane`.
    slip_velocity_tol : float
        Slip velocity up to which friction is static; above twice this it is kinetic [m/s].
    static_mu_array, kinetic_mu_array : array_like
        Coefficients forward (along the tangent), backward and sideways, (3,).
    """

    def __init__(
        self,
        k: float,
        nu: float,
        plane_origin: ArrayLike,
        plane_normal: ArrayLike,
        slip_velocity_tol: float,
        static_mu_array: ArrayLike,
        kinetic_mu_array: ArrayLike,
        surface_tol: float | None = None,
    ) -> None:
        self.slip_velocity_tol = as_number("slip_velocity_tol", slip_velocity_tol)
        self.static_mu_array = three("static_mu_array", static_mu_array).copy()
        self.kinetic_mu_array = three("kinetic_mu_array", kinetic_mu_array).copy()
        super().__init__(k, nu, plane_origin, plane_normal, surface_tol)

    def _friction(self) -> dict[str, Any]:
        return friction_of(self)


class SlenderBodyTheory(NoForces):
    """Drag of a viscous fluid on a slender rod (Gazzola et al. 2018, eq. 4.13).

    Parameters
    ----------
    dynamic_viscosity : float
        mu [Pa s].
    """

    def __init__(self, dynamic_viscosity: float) -> None:
        require_not_negative("dynamic_viscosity", dynamic_viscosity)
        self.dynamic_viscosity = float(dynamic_viscosity)

    def apply_forces(self, system: Any, time: float = 0.0) -> None:
        """Add -4 pi mu l/ln(L/r) (I - t t^T/2) v on each element, half to each node."""
        force = slender_body_forces(
            system.tangents,
            system.velocity_collection,
            self.dynamic_viscosity,
            system.lengths,
            system.radius,
            system.mass,
        )
        elements_to_nodes_inplace(force, system.external_forces)

    def lower(self, builder: SceneBuilder, system: Any) -> None:
        """Write a fluid."""
        if system.ring_rod_flag:
            raise NotImplementedError("SlenderBodyTheory acts on open rods; this one is a ring")
        builder.add_flow(system, self.dynamic_viscosity)


def friction_of(law: Any) -> dict[str, Any]:
    """Translate anisotropic friction from PyElastica's names to those of `surroundings.Plane`."""
    return {
        "slip_tolerance": law.slip_velocity_tol,
        "static_friction": _triple(law.static_mu_array),
        "kinetic_friction": _triple(law.kinetic_mu_array),
    }


def slender_body_forces(
    tangents: Array, velocity_collection: Array, dynamic_viscosity: float, lengths: Array, radius: Array, mass: Array
) -> Array:
    """Return the drag on each element (Gazzola et al. 2018, eq. 4.13) [N], (3, n)."""
    velocity = _node_to_element_velocity(mass, velocity_collection)
    size = -4.0 * np.pi * dynamic_viscosity * lengths / np.log(lengths.sum() / radius)
    return size * (velocity - 0.5 * tangents * (tangents * velocity).sum(axis=0))


def sum_over_elements(input: Array) -> np.float64:
    """Return the sum over elements, (n,)."""
    return input.sum()


# names in 0.2.x
elements_to_nodes_inplace = _elements_to_nodes_inplace
find_slipping_elements = _find_slipping_elements
node_to_element_pos_or_vel = _node_to_element_position
nodes_to_elements = _node_to_element_mass_or_force


def _triple(value: ArrayLike) -> tuple[float, float, float]:
    a, b, c = np.ravel(np.asarray(value, dtype=np.float64)).tolist()
    return a, b, c


__getattr__ = refuse_names(__name__)
