"""A ring buckles out of its plane above sqrt(3) B/C turns of twist: Michell's instability (Michell 1889).

A straight rod of bending stiffness B and twist stiffness C is bent to a ring of radius R and twisted before closing.
Its coupled in-plane and out-of-plane mode of n waves has the squared frequencies n^2 (n^2 - 1) x/(rho A R^4), where
(n^2 + 1) x^2 - 2 n^2 B x + (n^2 - 1) B^2 - M^2 = 0, with M = C times the turns of twist, follows from Kirchhoff's
equations without rotational inertia. For n = 2 the lower one is negative, and the ring buckles, above M = sqrt(3) B.
"""

import numpy as np
from case import Result, show

from elastica_gym.cosserat import (
    BaseSystemCollection,
    CallBackBaseClass,
    CallBacks,
    CosseratRod,
    PositionVerlet,
    integrate,
    stable_time_step,
)

N, R, RADIUS, DENSITY, YOUNG, SHEAR = 60, 1.0, 0.01, 1000.0, 1e6, 4e5
AREA = np.pi * RADIUS**2
BENDING, TWISTING = YOUNG * AREA * RADIUS**2 / 4.0, SHEAR * AREA * RADIUS**2 / 2.0
THRESHOLD = np.sqrt(3.0) * BENDING / TWISTING
"""Theoretical turns at buckling"""


class Simulator(BaseSystemCollection, CallBacks):
    """A ring and a callback."""


class ModeCallBack(CallBackBaseClass):
    """Records a ring's deviation from a circle, in the mode of two waves."""

    def __init__(self, every: int, times: list, sizes: list) -> None:
        self.every, self.times, self.sizes = every, times, sizes

    def make_callback(self, system: CosseratRod, time: float, current_step: int) -> None:
        """Append time and the amplitude of the in-plane wave."""
        x, y, _ = system.position_collection
        self.times.append(time)
        self.sizes.append(np.mean((np.hypot(x, y) - R) * np.sin(2.0 * angles())) * 2.0)


def angles() -> np.ndarray:
    """Return the angles of the nodes around the ring [rad], (N,)."""
    return 2.0 * np.pi * np.arange(N) / N


def exact(turns: float) -> float:
    """Return the theoretical lower squared frequency of two waves [1/s^2]."""
    return 12.0 * root(turns) / (DENSITY * AREA * R**4)


def root(turns: float) -> float:
    """Return the lower x for two waves [N m^2]."""
    return (4.0 * BENDING - np.sqrt(BENDING**2 + 5.0 * (TWISTING * turns) ** 2)) / 5.0


def nudge(rod: CosseratRod, turns: float) -> None:
    """Excite the mode: in-plane and out-of-plane waves in the theoretical ratio."""
    phi, out = angles(), TWISTING * turns / (BENDING - root(turns))
    radial, around = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
    rod.velocity_collection[:2] = 1e-5 * (2.0 * np.sin(2.0 * phi) * radial + np.cos(2.0 * phi) * around)
    rod.velocity_collection[2] = 1e-5 * out * np.cos(2.0 * phi)


def squared_frequency(turns: float) -> float:
    """Return the squared frequency of the mode; above the threshold, minus its squared growth rate [1/s^2]."""
    rest_kappa = np.zeros((3, N))
    rest_kappa[2] = -turns / R
    ring = CosseratRod.ring_rod(
        N,
        np.zeros(3),
        np.array([0.0, 1.0, 0.0]),
        np.array([0.0, 0.0, 1.0]),
        2.0 * np.pi * R,
        RADIUS,
        DENSITY,
        youngs_modulus=YOUNG,
        shear_modulus=SHEAR,
    )
    nudge(ring, turns)
    simulator = Simulator()
    simulator.append(ring)
    times: list[float] = []
    sizes: list[float] = []
    simulator.collect_diagnostics(ring).using(ModeCallBack, 20, times, sizes)
    simulator.finalize()
    # set after finalize, which would replace a zero rest curvature by the current one
    ring.rest_kappa[:] = rest_kappa
    duration = 5.0 / np.sqrt(abs(exact(turns)))
    integrate(PositionVerlet(), simulator, duration, int(duration / (0.7 * stable_time_step(ring))), progress_bar=False)
    return from_samples(np.array(times), np.array(sizes))


def from_samples(t: np.ndarray, a: np.ndarray) -> float:
    """Return the squared frequency of a wave, or minus its squared growth rate, from a(t + h) + a(t - h) = 2 c a(t).

    c is the cosine of the frequency times h, or the hyperbolic cosine of the growth rate times h.
    """
    far = t.size // 4
    middle = a[far:-far]
    c = np.dot(a[2 * far :] + a[: -2 * far], middle) / (2.0 * np.dot(middle, middle))
    turned = np.arccos(c) if c < 1.0 else 1j * np.arccosh(c)
    return float(((turned / (t[far] - t[0])) ** 2).real)


def measure() -> Result:
    """Return the squared frequency over the twist; the ring buckles where it is zero."""
    turns, fine = THRESHOLD * np.array([0.0, 0.4, 0.7, 0.9, 1.1, 1.3]), np.linspace(0.0, 1.3 * THRESHOLD, 100)
    squared = np.array([squared_frequency(each) for each in turns])
    found = float(np.interp(0.0, -squared, turns))
    return Result(
        f"Michell's instability: {found:.4f} turns, theory {THRESHOLD:.4f}",
        "twist [turns]",
        "squared frequency [1/s^2]",
        turns,
        squared,
        fine,
        np.array([exact(each) for each in fine]),
        abs(found / THRESHOLD - 1.0),
        5e-3,
    )


if __name__ == "__main__":
    show(measure, "michell")
