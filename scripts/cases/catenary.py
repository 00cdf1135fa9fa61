"""A slender rod that hangs from its ends comes to rest in a catenary (Leibniz, Huygens, 1691).

y = a cosh(x/a), with a from length and span. The remaining bending stiffness causes a deviation where the catenary is
most curved: a rod twice as thick deviates three times as much.
"""

import numpy as np
from case import Result, show
from scipy.optimize import brentq

from elastica_gym.cosserat import (
    AnalyticalLinearDamper,
    BaseSystemCollection,
    Constraints,
    CosseratRod,
    Damping,
    FixedConstraint,
    Forcing,
    GravityForces,
    PositionVerlet,
    integrate,
    stable_time_step,
)

LENGTH, SPAN, DENSITY, YOUNG, G = 1.0, 0.6, 1000.0, 1e7, 9.81
REST = 10.0
"""Time for damping to bring the rod to rest [s]"""


class Simulator(BaseSystemCollection, Constraints, Forcing, Damping):
    """A rod, two supports, gravity and a damper."""


def hung(n: int, radius: float) -> np.ndarray:
    """Return the nodes at rest of a rod that hangs from its ends and started as a V [m], (2, n + 1)."""
    along = np.linspace(-0.5, 0.5, n + 1)
    depth = np.sqrt(LENGTH**2 - SPAN**2)
    nodes = np.array([SPAN * along, depth * (np.abs(along) - 0.5), 0.0 * along])
    rod = CosseratRod.straight_rod(
        n,
        nodes[:, 0],
        np.array([1.0, 0.0, 0.0]),
        np.array([0.0, 0.0, 1.0]),
        LENGTH,
        radius,
        DENSITY,
        youngs_modulus=YOUNG,
        shear_modulus=YOUNG / 3.0,
        position=nodes,
    )
    simulator = Simulator()
    simulator.append(rod)
    simulator.constrain(rod).using(FixedConstraint, constrained_position_idx=(0, -1))
    simulator.add_forcing_to(rod).using(GravityForces, np.array([0.0, -G, 0.0]))
    simulator.dampen(rod).using(AnalyticalLinearDamper, uniform_damping_constant=4.0)
    simulator.finalize()
    integrate(PositionVerlet(), simulator, REST, int(REST / (0.7 * stable_time_step(rod))), progress_bar=False)
    return rod.position_collection[:2].copy()


def exact(x: np.ndarray) -> np.ndarray:
    """Return the height of a catenary between the supports [m]."""
    a = brentq(lambda a: 2.0 * a * np.sinh(0.5 * SPAN / a) - LENGTH, 0.05, 10.0)
    return a * (np.cosh(x / a) - np.cosh(0.5 * SPAN / a))


def measure() -> Result:
    """Return the height over position, and its deviation from a catenary relative to the sag."""
    (x, y), fine = hung(50, 5e-4), np.linspace(-0.5 * SPAN, 0.5 * SPAN, 200)
    error = float(np.abs(y - exact(x)).max() / -exact(np.zeros(1))[0])
    return Result("Catenary", "x [m]", "y [m]", x, y, fine, exact(fine), error, 3e-3)


if __name__ == "__main__":
    show(measure, "catenary")
