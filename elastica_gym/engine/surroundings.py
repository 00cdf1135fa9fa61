"""What acts on rods: planes with anisotropic friction, cylinders, other rods, and travelling waves of muscle couple."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .model import Array
from .rod import require_finite, require_not_negative, require_positive

Vector = tuple[float, float, float]

SURFACE_TOLERANCE = 1e-4, 0.05
"""Default gap below which an element touches a plane: the lesser of a length [m] and a fraction of its radius"""


@dataclass(frozen=True, kw_only=True)
class Plane:
    """A plane with anisotropic Coulomb friction (Gazzola et al. 2018, appendix D).

    Attributes
    ----------
    origin : tuple of float
        A point of the plane [m].
    normal : tuple of float
        Towards the free side; of any length.
    stiffness : float
        Restoring force per penetration [N/m].
    damping : float
        Damping force per velocity along the normal [N s/m].
    kinetic_friction, static_friction : tuple of float
        Coefficients forward (along the tangent), backward and sideways.
    slip_tolerance : float
        Slip velocity up to which friction is static; from twice this on it is kinetic [m/s].
    surface_tolerance : float, optional
        Gap below which an element is in contact [m]; 1e-4 m unless given, but at most a twentieth of its radius.
    """

    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    normal: tuple[float, float, float] = (0.0, 1.0, 0.0)
    stiffness: float = 1.0
    damping: float = 1e-6
    kinetic_friction: tuple[float, float, float] = (0.0, 0.0, 0.0)
    static_friction: tuple[float, float, float] = (0.0, 0.0, 0.0)
    slip_tolerance: float = 1e-8
    surface_tolerance: float | None = None

    def __post_init__(self) -> None:
        require_finite("origin", self.origin, 3)
        require_finite("normal", self.normal, 3)
        require_positive("length of normal", float(np.linalg.norm(self.normal)))
        require_positive("slip_tolerance", self.slip_tolerance)
        for name in ("stiffness", "damping"):
            require_not_negative(name, getattr(self, name))
        if self.surface_tolerance is not None:
            require_not_negative("surface_tolerance", self.surface_tolerance)
        for name in ("kinetic_friction", "static_friction"):
            require_finite(name, getattr(self, name), 3)
            for direction, value in zip(("forward", "backward", "sideways"), getattr(self, name), strict=True):
                require_not_negative(f"{name} {direction}", value)

    @property
    def reach(self) -> tuple[float, float]:
        """Gap below which an element is in contact: the lesser of a length [m] and a fraction of its radius."""
        return SURFACE_TOLERANCE if self.surface_tolerance is None else (self.surface_tolerance, np.inf)


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Normal force and friction between two overlapping round objects.

    The normal force is ``stiffness`` times the overlap plus ``damping`` times the velocity of
    approach, and never pulls. Friction is ``slip_damping`` times the slip velocity, up to ``friction``
    times the normal force (Coulomb's law; Preclik, Popa and Ruede 2011): objects that stick creep at
    the tangential force over ``slip_damping``, which must stay below the lighter mass over the time
    step. Where nodes of rods touch, up to four pairs of elements do: with m the mass of a node and dt
    the time step, ``stiffness`` below m/(2 dt^2) and ``damping`` below m/(4 dt) are stable. Radii are
    those at rest.

    Attributes
    ----------
    stiffness : float
        Restoring force per overlap k [N/m].
    damping : float
        Damping force per velocity of approach nu [N s/m].
    friction : float
        Coefficient of Coulomb friction mu.
    slip_damping : float
        Friction force per slip velocity c, below the Coulomb bound [N s/m].
    """

    stiffness: float
    damping: float = 0.0
    friction: float = 0.0
    slip_damping: float = 0.0

    def __post_init__(self) -> None:
        require_positive("stiffness", self.stiffness)
        for name in ("damping", "friction", "slip_damping"):
            require_not_negative(name, getattr(self, name))


@dataclass(frozen=True, kw_only=True)
class Joint:
    """A joint between an end of one rod and an end of another (Zhang et al. 2019).

    Attributes
    ----------
    rods : tuple of int
        Numbers of the two rods.
    ends : tuple of int
        The end of each: 0 for its first node and element, -1 for its last.
    stiffness : float
        Force per distance of the two nodes k [N/m].
    damping : float
        Force per relative velocity nu [N s/m].
    turn_stiffness : float
        Torque per angle of relative rotation from the pose described [N m]; 0 for free rotation.
    turn_damping : float
        Torque per relative angular velocity [N m s].

    Raises
    ------
    ValueError
        If an argument is invalid.
    """

    rods: tuple[int, int]
    ends: tuple[int, int]
    stiffness: float
    damping: float = 0.0
    turn_stiffness: float = 0.0
    turn_damping: float = 0.0

    def __post_init__(self) -> None:
        if len(self.rods) != 2 or len(self.ends) != 2 or not set(self.ends) <= {0, -1}:
            raise ValueError(f"rods and ends must be two each, with ends 0 or -1, not {self.rods} and {self.ends}")
        require_positive("stiffness", self.stiffness)
        for name in ("damping", "turn_stiffness", "turn_damping"):
            require_not_negative(name, getattr(self, name))


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """A free rigid cylinder: it has weight, stands, tips, rolls and slides on planes, and rods push it.

    Rods touch it as a capsule with domed ends; planes touch the rims of its flat ends.

    Attributes
    ----------
    start : tuple of float
        Centre of its first end [m].
    direction : tuple of float
        From its first end to its second, d3; of any length.
    normal : tuple of float
        d1, perpendicular to ``direction``; of any length.
    length : float
        [m]
    radius : float
        [m]
    mass : float
        [kg]
    rods : Contact
        Contact with rods.
    ground_stiffness : float
        Restoring force per penetration of a plane at each point of contact [N/m].
    ground_damping : float
        Damping force per velocity along the plane's normal at each point of contact [N s/m].
    ground_friction : float
        Coefficient of Coulomb friction with planes; it sticks without creeping.
    """

    start: Vector
    direction: Vector
    normal: Vector
    length: float
    radius: float
    mass: float
    rods: Contact
    ground_stiffness: float
    ground_damping: float = 0.0
    ground_friction: float = 0.0

    def __post_init__(self) -> None:
        for name in ("start", "direction", "normal"):
            require_finite(name, getattr(self, name), 3)
        for name in ("length", "radius", "mass", "ground_stiffness"):
            require_positive(name, getattr(self, name))
        for name in ("ground_damping", "ground_friction"):
            require_not_negative(name, getattr(self, name))
        for name in ("direction", "normal"):
            require_positive(f"length of {name}", float(np.linalg.norm(getattr(self, name))))
        cosine = float(np.dot(self.normal, self.directors[2]) / np.linalg.norm(self.normal))
        if abs(cosine) > 1e-9:
            raise ValueError(
                f"normal {self.normal} must be perpendicular to direction {self.direction}; "
                f"the cosine between them is {cosine:.3g}"
            )

    @property
    def directors(self) -> Array:
        """Rows d1, d2, d3 in the lab, (3, 3)."""
        d3 = np.asarray(self.direction, dtype=np.float64) / np.linalg.norm(self.direction)
        d1 = np.asarray(self.normal, dtype=np.float64) / np.linalg.norm(self.normal)
        return np.array([d1, np.cross(d3, d1), d3])

    @property
    def centre(self) -> Array:
        """Centre of mass [m], (3,)."""
        return np.asarray(self.start, dtype=np.float64) + 0.5 * self.length * self.directors[2]

    @property
    def inertia(self) -> Array:
        """Diagonal of the moment of inertia J [kg m^2], (3,)."""
        across = self.mass * (3.0 * self.radius**2 + self.length**2) / 12.0
        return np.array([across, across, 0.5 * self.mass * self.radius**2])


@dataclass(frozen=True, kw_only=True)
class Wave:
    """A travelling wave of muscle couple along a rod (Gazzola et al. 2018, section 5.2).

    With s the arc length of an element's end over the total, the couple between two elements is
    min(1, t/ramp) beta(s) sin(2 pi t/period - k s + phase) about ``axis``, taken in reverse order
    along the rod; equal and opposite on the two. beta is a cubic B-spline.

    Attributes
    ----------
    coefficients : tuple of float
        Control coefficients of beta, at least four [N m].
    period : float
        [s]
    wave_number : float
        k, for s from 0 to 1 [rad].
    phase : float
        [rad]
    axis : tuple of float
        Direction of the couple in the lab.
    ramp_time : float
        Time of linear growth to full strength, 0 for none [s].
    rod : int
        Index of the rod.
    """

    coefficients: tuple[float, ...]
    period: float
    wave_number: float
    phase: float = 0.0
    axis: tuple[float, float, float] = (0.0, 1.0, 0.0)
    ramp_time: float = 0.0
    rod: int = 0

    def __post_init__(self) -> None:
        require_positive("period", self.period)
        require_not_negative("ramp_time", self.ramp_time)
        if len(self.coefficients) < 4:
            raise ValueError(f"coefficients must be at least 4 numbers, not {len(self.coefficients)}")
        require_finite("coefficients", self.coefficients, len(self.coefficients))
        require_finite("axis", self.axis, 3)
        require_finite("wave_number", [self.wave_number], 1)
        require_finite("phase", [self.phase], 1)

    def profiles(self, rest_length: Array) -> tuple[Array, Array]:
        """Return the factors of sin and cos of 2 pi t/period in the couple at Voronoi points [N m], (n - 1,) each."""
        s = np.cumsum(rest_length) / np.sum(rest_length)
        return wave_profiles(s, beta_spline(self.coefficients, s), self.wave_number, self.phase)


def beta_spline(coefficients: ArrayLike, s: Array) -> Array:
    """Return the cubic B-spline with control ``coefficients``, at least four, at arc lengths ``s`` from 0 to 1."""
    # imported here: it takes longer than the rest of `import elastica_gym`
    from scipy.interpolate import BSpline

    b = np.asarray(coefficients, dtype=np.float64)
    knots = np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, len(b) - 2), np.ones(3)])
    # rounding in the sum must not leave the spline's domain
    return BSpline(knots, b, 3)(np.clip(s, 0.0, 1.0))


def wave_profiles(s: Array, beta: Array, wave_number: float, phase: float) -> tuple[Array, Array]:
    """Return the factors of sin and cos of omega t in a travelling wave: couples at Voronoi points, (n - 1,) each.

    The couple is beta sin(omega t - k s + phase), taken in reverse order along the rod.
    """
    angle = phase - wave_number * s
    sine, cosine = (beta * f(angle) for f in (np.cos, np.sin))
    return sine[::-1][1:], cosine[::-1][1:]


def net_couple(couple: Array) -> Array:
    """Return the net couples on elements from couples at Voronoi points, (n - 1,) to (n,).

    An element gets the couple of the joint before it, and minus that of the joint after it.
    """
    return -np.diff(couple, prepend=0.0, append=0.0)
