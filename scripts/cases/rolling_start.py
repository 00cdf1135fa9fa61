"""A rod thrown sideways onto a plane slips until it rolls, at any coefficient (Gazzola et al. 2018, app. D).

Friction slows translation and speeds up rotation until the rod rolls: v = v0/(1 + J/(m r^2)).
"""

import numpy as np
from axial_friction import ACROSS, MASS, energies, resting
from case import Result, show

SPEED = 1.0
"""Initial speed of the rod [m/s]"""


def thrown(factor: float) -> tuple[float, float]:
    """Return the energies of a rod whose moment of inertia is multiplied by a factor [J]."""
    rod = resting()
    rod.mass_second_moment_of_inertia *= factor
    rod.inv_mass_second_moment_of_inertia /= factor
    rod.velocity_collection[:] = SPEED * ACROSS[:, None]
    return energies(rod)


def exact(factor: np.ndarray) -> np.ndarray:
    """Return the theoretical energies of translation and rotation [J], (n, 2)."""
    speed = SPEED / (1.0 + 0.5 * factor)
    return np.stack([0.5 * MASS * speed**2, 0.25 * MASS * factor * speed**2], axis=-1)


def measure() -> Result:
    """Return the rolling energies over the moment of inertia."""
    factors, fine = np.array([0.25, 0.5, 1.0, 1.5, 2.0]), np.linspace(0.25, 2.0, 100)
    found = np.array([thrown(factor) for factor in factors])
    error = np.abs(found / exact(factors) - 1.0).max()
    return Result(
        "From slipping to rolling",
        "moment of inertia over m r^2/2",
        "energy [J]",
        factors,
        found,
        fine,
        exact(fine),
        float(error),
        1e-3,
        labels=("translation", "rotation"),
    )


if __name__ == "__main__":
    show(measure, "rolling_start")
