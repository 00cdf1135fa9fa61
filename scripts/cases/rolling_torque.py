"""A rod on a plane under an axial torque rolls up to 3/2 mu_s m g r, then slips (Gazzola et al. 2018, app. D)."""

import numpy as np
from axial_friction import AXIS, DURATION, KINETIC, MASS, RADIUS, STATIC, G, energies, resting
from case import Result, show

from elastica_gym.cosserat import UniformTorques

INERTIA = 0.5 * MASS * RADIUS**2
THRESHOLD = 1.5 * STATIC * MASS * G * RADIUS
"""Theoretical torque above which the rod slips [N m]"""


def exact(torque: np.ndarray) -> np.ndarray:
    """Return the theoretical energies of translation and rotation [J], (n, 2)."""
    friction = np.where(torque > THRESHOLD, KINETIC * MASS * G, torque / (1.5 * RADIUS))
    speed, spin = friction / MASS * DURATION, (torque - friction * RADIUS) / INERTIA * DURATION
    return np.stack([0.5 * MASS * speed**2, 0.5 * INERTIA * spin**2], axis=-1)


def measure() -> Result:
    """Return energies over the torque: rolling, then slipping."""
    torques = THRESHOLD * np.array([0.2, 0.6, 0.99, 1.01, 1.2, 1.5])
    fine = np.linspace(0.0, 1.5 * THRESHOLD, 1000)
    found = np.array([energies(resting(), (UniformTorques, torque, AXIS)) for torque in torques])
    error = np.abs(found / exact(torques) - 1.0).max()
    return Result(
        "Rolling by a torque",
        "torque [N m]",
        "energy [J]",
        torques,
        found,
        fine,
        exact(fine),
        float(error),
        1e-3,
        labels=("translation", "rotation"),
    )


if __name__ == "__main__":
    show(measure, "rolling_torque")
