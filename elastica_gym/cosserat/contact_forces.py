"""Contact between systems."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import surroundings
from .interaction import SURFACE_TOLERANCE, _triple
from .lowering import SceneBuilder
from .rigidbody import Cylinder, Sphere
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

    def lower(self, builder: SceneBuilder, system_one: Any, system_two: Any) -> None:
        """Write no rows."""

    def require_systems(self, system_one: Any, system_two: Any) -> None:
        """Raise TypeError unless these can touch in this way."""
        for which, system, allowed in (("first", system_one, self.allowed_systems_one),
                                       ("second", system_two, self.allowed_systems_two)):  # fmt: skip
            if not isinstance(system, allowed):
                names = " or ".join(each.__name__ for each in allowed)
                raise TypeError(f"the {which} system of {type(self).__name__} must be a {names}, "
                                f"not a {type(system).__name__}")  # fmt: skip


class _Compiled(NoContact):
    """Contact that exists in the compiled step alone."""

    IS_COMPILED = True

    def apply_contact(self, system_one: Any, system_two: Any, time: float = 0.0) -> None:
        """Refuse: there is no other implementation than the compiled one."""
        raise NotImplementedError(
            f"{type(self).__name__} acts inside the compiled step; it cannot be called by a subclass"
        )


class _Press(_Compiled):
    """Contact with a spring and a damper along the normal.

    Parameters
    ----------
    k : float
        Restoring force per overlap [N/m].
    nu : float
        Damping force per velocity of approach [N s/m].
    """

    def __init__(self, k: float, nu: float) -> None:
        self.k, self.nu = float(k), float(nu)


class RodRodContact(_Press):
    """Two rods that touch, without friction. It keeps energy where ``nu`` is 0, and never pulls.

    With m the mass of a node and dt the time step, ``k`` below m/(2 dt^2) and ``nu`` below m/(4 dt) are stable.

    Parameters
    ----------
    k : float
        Restoring force per overlap [N/m].
    nu : float
        Damping force per velocity of approach [N s/m].
    """

    allowed_systems_one = allowed_systems_two = (RodBase,)

    def lower(self, builder: SceneBuilder, system_one: Any, system_two: Any) -> None:
        """Write a pair."""
        if system_one is system_two:
            raise ValueError("RodRodContact is between two rods; a rod touches itself by RodSelfContact")
        builder.add_rod_contact(system_one, system_two, stiffness=self.k, damping=self.nu)


class RodSelfContact(_Press):
    """A rod that touches itself, where two elements are more than 0.4 of a turn of its surface apart along it.

    Parameters
    ----------
    k : float
        Restoring force per overlap [N/m].
    nu : float
        Damping force per velocity of approach [N s/m].
    """

    allowed_systems_one = allowed_systems_two = (RodBase,)

    def lower(self, builder: SceneBuilder, system_one: Any, system_two: Any) -> None:
        """Write a pair."""
        if system_one is not system_two:
            raise ValueError("RodSelfContact is of a rod with itself; give it twice, or use RodRodContact")
        builder.add_rod_contact(system_one, system_one, stiffness=self.k, damping=self.nu)


class _RodOnBody(_Compiled):
    """A rod that touches a rigid body.

    Parameters
    ----------
    k : float
        Restoring force per overlap [N/m].
    nu : float
        Damping force per velocity of approach [N s/m].
    velocity_damping_coefficient : float
        Force of friction per slip, below the Coulomb bound [N s/m].
    friction_coefficient : float
        mu
    """

    allowed_systems_one = (RodBase,)

    def __init__(
        self, k: float, nu: float, velocity_damping_coefficient: float = 0.0, friction_coefficient: float = 0.0
    ) -> None:
        self.k, self.nu = float(k), float(nu)
        self.velocity_damping_coefficient = float(velocity_damping_coefficient)
        self.friction_coefficient = float(friction_coefficient)

    def lower(self, builder: SceneBuilder, system_one: Any, system_two: Any) -> None:
        """Write a pair."""
        builder.add_body_contact(
            system_one, system_two, stiffness=self.k, damping=self.nu, friction=self.friction_coefficient,
            slip_damping=self.velocity_damping_coefficient,
        )  # fmt: skip


class RodCylinderContact(_RodOnBody):
    """A rod and a cylinder, which is a capsule to it, with Coulomb friction. It never pulls."""

    allowed_systems_two = (Cylinder,)


class RodSphereContact(_RodOnBody):
    """A rod and a sphere, with Coulomb friction. It never pulls."""

    allowed_systems_two = (Sphere,)


class CylinderPlaneContact(_Press):
    """A cylinder on a plane, which touches it at the rims of its flat ends. It never pulls.

    Parameters
    ----------
    k : float
        Restoring force per penetration at each point of contact [N/m].
    nu : float
        Damping force per velocity along the normal at each point of contact [N s/m].
    friction_coefficient : float
        mu
    """

    allowed_systems_one = (Cylinder,)
    allowed_systems_two = (Plane,)

    def __init__(self, k: float, nu: float, friction_coefficient: float = 0.0) -> None:
        super().__init__(k, nu)
        self.friction_coefficient = float(friction_coefficient)

    def lower(self, builder: SceneBuilder, system_one: Any, system_two: Any) -> None:
        """Write a plane."""
        plane = surroundings.Plane(origin=_triple(system_two.origin), normal=_triple(system_two.normal),
                                   stiffness=self.k, damping=self.nu)  # fmt: skip
        builder.add_body_plane(system_one, plane, self.friction_coefficient)


class _RodOnPlane(_Compiled):
    """A rod on a plane, which answers to the net force on it."""

    allowed_systems_one = (RodBase,)
    allowed_systems_two = (Plane,)

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
