"""A rod rolls down an incline up to a slope of 3 mu_s, and slips on a steeper one (Gazzola et al. 2018, app. D)."""

import numpy as np
from axial_friction import ACROSS, DURATION, KINETIC, MASS, RADIUS, STATIC, UP, G, energies, resting
from case import Result, show

THRESHOLD = np.arctan(3.0 * STATIC)
"""Theoretical angle above which the rod slips [rad]"""


def exact(angle: np.ndarray) -> np.ndarray:
    """Return the theoretical energies of translation and rotation [J], (n, 2)."""
    pull, inertia = MASS * G * np.sin(angle), 0.5 * MASS * RADIUS**2
    friction = np.where(angle > THRESHOLD, KINETIC * MASS * G * np.cos(angle), pull / 3.0)
    speed, spin = (pull - friction) / MASS * DURATION, friction * RADIUS / inertia * DURATION
    return np.stack([0.5 * MASS * speed**2, 0.5 * inertia * spin**2], axis=-1)


def measure() -> Result:
    """Return energies over the angle: rolling, then slipping."""
    angles, fine = np.array([0.1, 0.4, 0.8, 0.99, 1.01, 1.2]) * THRESHOLD, np.linspace(0.0, 1.2 * THRESHOLD, 1000)
    found = np.array(
        [energies(resting(), gravity=G * (np.sin(angle) * ACROSS - np.cos(angle) * UP)) for angle in angles]
    )
    error = np.abs(found / exact(angles) - 1.0).max()
    return Result(
        "Rolling down an incline",
        "angle [rad]",
        "energy [J]",
        angles,
        found,
        fine,
        exact(fine),
        float(error),
        1e-3,
        labels=("translation", "rotation"),
    )


if __name__ == "__main__":
    show(measure, "rolling_incline")
