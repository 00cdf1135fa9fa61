"""Contact between systems."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import surroundings
from .interaction import SURFACE_TOLERANCE, _triple
from .lowering import SceneBuilder
from .rod.rod_base import RodBase
from .surface.plane import Plane


class NoContact:
    """Base class of contact; write your own by overriding `apply_contact`.

    It is called once in each step (in each stage of PEFRL), after the systems have moved, and adds to
    their ``external_forces`` [N], lab frame, and ``external_torques`` [N m], material frame.
    """

    allowed_systems_one: tuple[type, ...] = (object,)
    allowed_systems_two: tuple[type, ...] = (object,)

    def apply_contact(self, system_one: Any, system_two: Any, time: float = 0.0) -> None:
        """Add forces and torques."""

    def require_systems(self, system_one: Any, system_two: Any) -> None:
        """Raise TypeError unless these can touch in this way."""
        for which, system, allowed in (("first", system_one, self.allowed_systems_one),
                                       ("second", system_two, self.allowed_systems_two)):  # fmt: skip
            if not isinstance(system, allowed):
                names = " or ".join(each.__name__ for each in allowed)
                raise TypeError(f"the {which} system of {type(self).__name__} must be a {names}, "
                                f"not a {type(system).__name__}")  # fmt: skip


class _RodOnPlane(NoContact):
    """What answers to the net force, and so exists in the compiled step alone."""

    allowed_systems_one = (RodBase,)
    allowed_systems_two = (Plane,)

    def apply_contact(self, system_one: Any, system_two: Any, time: float = 0.0) -> None:
        """Refuse: a plane answers to the net force, which is not known before all other loads are."""
        raise NotImplementedError(
            f"{type(self).__name__} acts after all other loads, inside the step; it cannot be called by a subclass"
        )

    def _friction(self) -> dict[str, Any]:
        return {}

    k: float
    nu: float

    def lower(self, builder: SceneBuilder, system_one: Any, system_two: Any) -> None:
        """Write a plane."""
        builder.add_plane(system_one, surroundings.Plane(
            origin=_triple(system_two.origin), normal=_triple(system_two.normal), stiffness=self.k, damping=self.nu,
            surface_tolerance=SURFACE_TOLERANCE, **self._friction(),
        ))  # fmt: skip


class RodPlaneContact(_RodOnPlane):
    """A rod on a plane without friction.

    Parameters
    ----------
    k : float
        Restoring force per penetration [N/m].
    nu : float
        Damping force per velocity along the normal [N s/m].
    """

    def __init__(self, k: float, nu: float) -> None:
        self.k, self.nu = float(k), float(nu)


class RodPlaneContactWithAnisotropicFriction(_RodOnPlane):
    """A rod on a plane with anisotropic Coulomb friction (Gazzola et al. 2018, appendix D).

    Parameters
    ----------
    k, nu : float
        As for `RodPlaneContact`.
    slip_velocity_tol : float
        Slip velocity up to which friction is static; from twice of it on it is kinetic [m/s].
    static_mu_array, kinetic_mu_array : array_like
        Coefficients forward (along the tangent), backward and sideways, (3,).
    """

    def __init__(
        self, k: float, nu: float, slip_velocity_tol: float, static_mu_array: ArrayLike, kinetic_mu_array: ArrayLike
    ) -> None:
        self.k, self.nu, self.slip_velocity_tol = float(k), float(nu), float(slip_velocity_tol)
        self.static_mu_array, self.kinetic_mu_array = np.array(static_mu_array), np.array(kinetic_mu_array)

    def _friction(self) -> dict[str, Any]:
        return {"slip_tolerance": self.slip_velocity_tol, "static_friction": _triple(self.static_mu_array),
                "kinetic_friction": _triple(self.kinetic_mu_array)}  # fmt: skip
