"""A ring with too much twist does not stay flat: Michell's instability, at sqrt(3) B/C turns (Michell 1889).

A straight rod of stiffness B of bending and C of twist is bent to a ring of radius R, and twisted before it is closed.
Its mode of n waves, in and out of the plane at once, has the squared frequencies n^2 (n^2 - 1) x/(rho A R^4), where
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
"""Turns of buckling in theory"""


class Simulator(BaseSystemCollection, CallBacks):
    """A ring, and a look at it."""


class ModeCallBack(CallBackBaseClass):
    """Notes how far a ring is out of its circle, in two waves around it."""

    def __init__(self, every: int, times: list, sizes: list) -> None:
        self.every, self.times, self.sizes = every, times, sizes

    def make_callback(self, system: CosseratRod, time: float, current_step: int) -> None:
        """Append time and the size of the wave in the plane."""
        x, y, _ = system.position_collection
        self.times.append(time)
        self.sizes.append(np.mean((np.hypot(x, y) - R) * np.sin(2.0 * angles())) * 2.0)


def angles() -> np.ndarray:
    """Return where the nodes are around the ring [rad], (N,)."""
    return 2.0 * np.pi * np.arange(N) / N


def exact(turns: float) -> float:
    """Return the lower squared frequency of two waves by theory [1/s^2]."""
    return 12.0 * root(turns) / (DENSITY * AREA * R**4)


def root(turns: float) -> float:
    """Return x for two waves, the lower [N m^2]."""
    return (4.0 * BENDING - np.sqrt(BENDING**2 + 5.0 * (TWISTING * turns) ** 2)) / 5.0


def nudge(rod: CosseratRod, turns: float) -> None:
    """Start the mode: waves in the plane and waves out of it, at the ratio of theory."""
    phi, out = angles(), TWISTING * turns / (BENDING - root(turns))
    radial, around = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
    rod.velocity_collection[:2] = 1e-5 * (2.0 * np.sin(2.0 * phi) * radial + np.cos(2.0 * phi) * around)
    rod.velocity_collection[2] = 1e-5 * out * np.cos(2.0 * phi)


def squared_frequency(turns: float) -> float:
    """Return the squared frequency of the mode; above the threshold, minus its squared rate of growth [1/s^2]."""
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
    # here, since finalize takes a ring without any for one at rest as it is
    ring.rest_kappa[:] = rest_kappa
    duration = 5.0 / np.sqrt(abs(exact(turns)))
    integrate(PositionVerlet(), simulator, duration, int(duration / (0.7 * stable_time_step(ring))), progress_bar=False)
    return from_samples(np.array(times), np.array(sizes))


def from_samples(t: np.ndarray, a: np.ndarray) -> float:
    """Return the squared frequency of a wave or, less than zero, of its growth, from a(t + h) + a(t - h) = 2 c a(t).

    c is the cosine of the frequency times h, or the hyperbolic cosine of the rate of growth times h.
    """
    far = t.size // 4
    middle = a[far:-far]
    c = np.dot(a[2 * far :] + a[: -2 * far], middle) / (2.0 * np.dot(middle, middle))
    turned = np.arccos(c) if c < 1.0 else 1j * np.arccosh(c)
    return float(((turned / (t[far] - t[0])) ** 2).real)


def measure() -> Result:
    """Return the squared frequency over the twist; where it meets zero, the ring buckles."""
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
