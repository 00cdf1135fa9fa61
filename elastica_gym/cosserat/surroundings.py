"""What rods meet: planes with anisotropic friction, and travelling waves of muscle couple."""

from dataclasses import dataclass

import numpy as np

from .model import Array
from .rod import require_finite, require_not_negative, require_positive


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
        Slip velocity up to which friction is static; from twice of it on it is kinetic [m/s].
    surface_tolerance : float
        Gap below which an element is in contact [m].
    """

    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    normal: tuple[float, float, float] = (0.0, 1.0, 0.0)
    stiffness: float = 1.0
    damping: float = 1e-6
    kinetic_friction: tuple[float, float, float] = (0.0, 0.0, 0.0)
    static_friction: tuple[float, float, float] = (0.0, 0.0, 0.0)
    slip_tolerance: float = 1e-8
    surface_tolerance: float = 1e-4

    def __post_init__(self) -> None:
        require_finite("origin", self.origin, 3)
        require_finite("normal", self.normal, 3)
        require_positive("length of normal", float(np.linalg.norm(self.normal)))
        require_positive("slip_tolerance", self.slip_tolerance)
        for name in ("stiffness", "damping", "surface_tolerance"):
            require_not_negative(name, getattr(self, name))
        for name in ("kinetic_friction", "static_friction"):
            require_finite(name, getattr(self, name), 3)
            for direction, value in zip(("forward", "backward", "sideways"), getattr(self, name), strict=True):
                require_not_negative(f"{name} {direction}", value)


@dataclass(frozen=True, kw_only=True)
class Wave:
    """A travelling wave of muscle couple along a rod (Gazzola et al. 2018, section 5.2).

    With s the arc length of an element's end over the whole, the couple between two elements is
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
        """Return what multiplies sin and cos of 2 pi t/period: the couple at Voronoi points [N m], (n - 1,) each."""
        # imported here: it takes longer than all else that `import elastica_gym` does
        from scipy.interpolate import BSpline

        s = np.cumsum(rest_length) / np.sum(rest_length)
        b = np.asarray(self.coefficients, dtype=np.float64)
        knots = np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, len(b) - 2), np.ones(3)])
        # rounding in the sum must not leave the spline's domain
        beta = BSpline(knots, b, 3)(np.clip(s, 0.0, 1.0))
        angle = self.phase - self.wave_number * s
        sine, cosine = (beta * f(angle) for f in (np.cos, np.sin))
        return sine[::-1][1:], cosine[::-1][1:]
