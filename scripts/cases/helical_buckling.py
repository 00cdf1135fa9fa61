"""A twisted rod whose ends approach each other buckles into a helix in its middle (Gazzola et al. 2018, section 3.4.1).

The angle between tangent and axis is that of a localised solution of Kirchhoff's equations (Neukirch, van der
Heijden and Thompson 2002, eqs. 12-15). The published rod, but with larger inertia, lower shear stiffness and more
damping, which do not matter at rest.
"""

import numpy as np
from case import Result, show
from scipy.optimize import fsolve

from elastica_gym.cosserat import (
    BaseSystemCollection,
    Constraints,
    CosseratRod,
    HelicalBucklingBC,
    PositionVerlet,
    integrate,
    stable_time_step,
)

LENGTH, RADIUS, SLACK, TURNS = 100.0, 0.7, 3.0, 27.0
BENDING, TWISTING, SHEAR = 1.345, 0.789, 1e4
"""Stiffness of bending and of twist [N m^2], and of shear and stretch [N]"""
TWISTING_TIME, REST = 200.0, 1500.0
"""Time until which the ends move, and time at which the rod is at rest [s]"""


class Simulator(BaseSystemCollection, Constraints):
    """A rod with twisted and displaced ends."""


def slopes(n: int) -> np.ndarray:
    """Return the angles between the elements of a rod at rest and its axis [rad], (n,)."""
    rod = CosseratRod.straight_rod(
        n,
        np.zeros(3),
        np.array([0.0, 0.0, 1.0]),
        np.array([0.0, 1.0, 0.0]),
        LENGTH,
        RADIUS,
        1.0 / (np.pi * RADIUS**2),
        nu=0.02,
        youngs_modulus=1e6,
    )
    rod.shear_matrix = np.repeat(SHEAR * np.eye(3)[:, :, None], n, axis=2)
    rod.bend_matrix = np.repeat(np.diag([BENDING, BENDING, TWISTING])[:, :, None], n - 1, axis=2)
    # perturbation, so that it buckles in the middle rather than where rounding decides
    rod.velocity_collection[1] = 1e-3 / np.cosh((rod.position_collection[2] - 0.5 * LENGTH) / 5.0)
    simulator = Simulator()
    simulator.append(rod)
    simulator.constrain(rod).using(
        HelicalBucklingBC,
        constrained_position_idx=(0, -1),
        constrained_director_idx=(0, -1),
        twisting_time=TWISTING_TIME,
        slack=SLACK,
        number_of_rotations=TURNS,
    )
    simulator.finalize()
    integrate(PositionVerlet(), simulator, REST, int(REST / (0.9 * stable_time_step(rod))))
    return np.arccos(rod.tangents[2])


def free_length(n: int) -> float:
    """Return the free length: half an element at each end is held [m]."""
    return LENGTH * (1.0 - 1.0 / n)


def load(n: int) -> tuple[float, float]:
    """Return the theoretical moment M L/B and tension T L^2/B at the ends (eqs. 14 and 15)."""
    slack, angle, ratio = SLACK / free_length(n), 2.0 * np.pi * TURNS, TWISTING / BENDING

    def misfit(unknown: np.ndarray) -> list[float]:
        moment, tension = unknown
        return [
            4.0 * np.sqrt((1.0 - moment**2 / (4.0 * tension)) / tension) - slack,
            moment / ratio + 4.0 * np.arccos(moment / (2.0 * np.sqrt(tension))) - angle,
        ]

    moment, tension = fsolve(misfit, [0.58 * angle, 0.1 * angle**2])
    return float(moment), float(tension)


def exact(n: int, z: np.ndarray) -> np.ndarray:
    """Return the theoretical slopes [rad] at positions along the rod [m] (eqs. 12 and 13)."""
    moment, tension = load(n)
    steepest = 2.0 - moment**2 / (2.0 * tension)
    s = z / free_length(n) - 0.5 * LENGTH / free_length(n)
    return np.arccos(1.0 - steepest / np.cosh(np.sqrt(tension - 0.25 * moment**2) * s) ** 2)


def centres(n: int) -> np.ndarray:
    """Return the positions of elements along the rod at rest [m], (n,)."""
    return LENGTH * (np.arange(n) + 0.5) / n


def error(n: int, found: np.ndarray) -> float:
    """Return the root mean square deviation from theory, relative to that of theory."""
    expected = exact(n, centres(n))
    return float(np.linalg.norm(found - expected) / np.linalg.norm(expected))


def measure() -> Result:
    """Return slopes along the rod; theory is the envelope of a localised helix."""
    n = 200
    found, fine = slopes(n), np.linspace(0.0, LENGTH, 1000)
    return Result(
        "Helical buckling",
        "position along the rod [m]",
        "angle to the axis [rad]",
        centres(n),
        found,
        fine,
        exact(n, fine),
        error(n, found),
        4e-2,
    )


if __name__ == "__main__":
    show(measure, "helical_buckling")
