"""Contact between systems."""

from collections.abc import Sequence
from typing import Any

from numpy.typing import ArrayLike

from ..engine import surroundings
from ..engine.rod import as_number, three
from .by_hand import act
from .interaction import _triple, friction_of
from .lowering import SceneBuilder
from .rigidbody import Cylinder, Sphere
from .rod.rod_base import RodBase
from .surface.plane import Plane


def common_check_systems_identity(system_one: Any, system_two: Any) -> None:
    """Raise TypeError if two systems are the same."""
    if system_one is system_two:
        raise TypeError("the two systems are the same; this contact is between different systems")


def common_check_systems_different(system_one: Any, system_two: Any) -> None:
    """Raise TypeError unless two systems are the same."""
    if system_one is not system_two:
        raise TypeError("the two systems are different; this contact is of a system with itself")


def common_check_systems_validity(system: Any, allowed_system: Sequence[type]) -> None:
    """Raise TypeError unless a system is of an allowed type."""
    if not isinstance(system, tuple(allowed_system)):
        names = " or ".join(each.__name__ for each in allowed_system)
        raise TypeError(f"a system must be a {names}, not a {type(system).__name__}")


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

    @property
    def _allowed_system_one(self) -> list[type]:
        """Types of the first system; subclasses override it (name in 1.0)."""
        return list(self.allowed_systems_one)

    @property
    def _allowed_system_two(self) -> list[type]:
        """Types of the second system; subclasses override it (name in 1.0)."""
        return list(self.allowed_systems_two)

    def _check_systems_validity(self, system_one: Any, system_two: Any) -> None:
        """Raise TypeError unless this contact applies to the systems; subclasses override it (name in 1.0)."""
        for which, system, allowed in (
            ("first", system_one, self._allowed_system_one),
            ("second", system_two, self._allowed_system_two),
        ):
            if not isinstance(system, tuple(allowed)):
                names = " or ".join(each.__name__ for each in allowed)
                raise TypeError(
                    f"the {which} system of {type(self).__name__} must be a {names}, not a {type(system).__name__}"
                )

    def require_systems(self, system_one: Any, system_two: Any) -> None:
        """Raise TypeError unless this contact applies to the systems."""
        self._check_systems_validity(system_one, system_two)


class _Compiled(NoContact):
    """Contact whose only implementation is the compiled one."""

    IS_COMPILED = True

    def apply_contact(self, system_one: Any, system_two: Any, time: float = 0.0) -> None:
        """Add forces and torques, as the compiled step does."""
        self.require_systems(system_one, system_two)
        act(self.lower, system_one, system_two)


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
        self.k, self.nu = as_number("k", k), as_number("nu", nu)


class RodRodContact(_Press):
    """Contact of two rods, without friction. It conserves energy if ``nu`` is 0, and never pulls.

    With m the mass of a node and dt the time step, it is stable for ``k`` below m/(2 dt^2) and ``nu`` below m/(4 dt).

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
            raise ValueError("RodRodContact is between two rods; use RodSelfContact for a rod with itself")
        builder.add_rod_contact(system_one, system_two, stiffness=self.k, damping=self.nu)


class RodSelfContact(_Press):
    """Contact of a rod with itself, between elements that are more than 0.4 circumferences apart along the rod.

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
            raise ValueError("RodSelfContact is of a rod with itself; give the rod twice, or use RodRodContact")
        builder.add_rod_contact(system_one, system_one, stiffness=self.k, damping=self.nu)


class _RodOnBody(_Compiled):
    """Contact of a rod with a rigid body.

    Parameters
    ----------
    k : float
        Restoring force per overlap [N/m].
    nu : float
        Damping force per velocity of approach [N s/m].
    velocity_damping_coefficient : float
        Friction force per slip velocity, below the Coulomb bound [N s/m].
    friction_coefficient : float
        mu
    """

    allowed_systems_one = (RodBase,)

    def __init__(
        self, k: float, nu: float, velocity_damping_coefficient: float = 0.0, friction_coefficient: float = 0.0
    ) -> None:
        self.k, self.nu = as_number("k", k), as_number("nu", nu)
        self.velocity_damping_coefficient = as_number("velocity_damping_coefficient", velocity_damping_coefficient)
        self.friction_coefficient = as_number("friction_coefficient", friction_coefficient)

    def lower(self, builder: SceneBuilder, system_one: Any, system_two: Any) -> None:
        """Write a pair."""
        builder.add_body_contact(
            system_one,
            system_two,
            stiffness=self.k,
            damping=self.nu,
            friction=self.friction_coefficient,
            slip_damping=self.velocity_damping_coefficient,
        )


class RodCylinderContact(_RodOnBody):
    """Contact of a rod and a cylinder, treated as a capsule, with Coulomb friction. It never pulls."""

    allowed_systems_two = (Cylinder,)


class RodSphereContact(_RodOnBody):
    """Contact of a rod and a sphere, with Coulomb friction. It never pulls."""

    allowed_systems_two = (Sphere,)


class CylinderPlaneContact(_Press):
    """Contact of a cylinder with a plane, at the rims of its flat ends. It never pulls.

    Parameters
    ----------
    k : float
        Restoring force per penetration at each point of contact [N/m].
    nu : float
        Damping force per velocity along the normal at each point of contact [N s/m].
    friction_coefficient : float
        mu; no friction when called by hand before the first run, since static friction needs the time step.
    """

    allowed_systems_one = (Cylinder,)
    allowed_systems_two = (Plane,)

    def __init__(self, k: float, nu: float, friction_coefficient: float = 0.0) -> None:
        super().__init__(k, nu)
        self.friction_coefficient = as_number("friction_coefficient", friction_coefficient)

    def lower(self, builder: SceneBuilder, system_one: Any, system_two: Any) -> None:
        """Write a plane."""
        plane = surroundings.Plane(
            origin=_triple(system_two.origin), normal=_triple(system_two.normal), stiffness=self.k, damping=self.nu
        )
        builder.add_body_plane(system_one, plane, self.friction_coefficient)


class _RodOnPlane(_Compiled):
    """Contact of a rod with a plane, which balances the net force on the rod."""

    allowed_systems_one = (RodBase,)
    allowed_systems_two = (Plane,)

    def _friction(self) -> dict[str, Any]:
        return {}

    k: float
    nu: float
    surface_tol: float | None

    def lower(self, builder: SceneBuilder, system_one: Any, system_two: Any) -> None:
        """Write a plane."""
        builder.add_plane(
            system_one,
            surroundings.Plane(
                origin=_triple(system_two.origin),
                normal=_triple(system_two.normal),
                stiffness=self.k,
                damping=self.nu,
                surface_tolerance=self.surface_tol,
                **self._friction(),
            ),
        )


class RodPlaneContact(_RodOnPlane):
    """Contact of a rod with a plane, without friction.

    Parameters
    ----------
    k : float
        Restoring force per penetration [N/m].
    nu : float
        Damping force per velocity along the normal [N s/m].
    surface_tol : float, optional
        Gap below which an element is in contact [m]; 1e-4 m unless given, but at most a twentieth of its radius.
    """

    def __init__(self, k: float, nu: float, surface_tol: float | None = None) -> None:
        self.k, self.nu, self.surface_tol = as_number("k", k), as_number("nu", nu), surface_tol


class RodPlaneContactWithAnisotropicFriction(_RodOnPlane):
    """Contact of a rod with a plane, with anisotropic Coulomb friction (Gazzola et al. 2018, appendix D).

    Parameters
    ----------
    k, nu, surface_tol : float
        As for `RodPlaneContact`.
    slip_velocity_tol : float
        Slip velocity up to which friction is static; above twice this it is kinetic [m/s].
    static_mu_array, kinetic_mu_array : array_like
        Coefficients forward (along the tangent), backward and sideways, (3,).
    """

    def __init__(
        self,
        k: float,
        nu: float,
        slip_velocity_tol: float,
        static_mu_array: ArrayLike,
        kinetic_mu_array: ArrayLike,
        surface_tol: float | None = None,
    ) -> None:
        self.k, self.nu, self.surface_tol = as_number("k", k), as_number("nu", nu), surface_tol
        self.slip_velocity_tol = as_number("slip_velocity_tol", slip_velocity_tol)
        self.static_mu_array = three("static_mu_array", static_mu_array).copy()
        self.kinetic_mu_array = three("kinetic_mu_array", kinetic_mu_array).copy()

    def _friction(self) -> dict[str, Any]:
        return friction_of(self)
