"""A slender rod pulled through a viscous fluid: the speed at which drag balances the force, lengthwise and across."""

import numpy as np
from case import Result, show

from elastica_gym.cosserat import (
    BaseSystemCollection,
    CosseratRod,
    Forcing,
    PositionVerlet,
    SlenderBodyTheory,
    UniformForces,
    integrate,
)

LENGTH, RADIUS, VISCOSITY, FORCE = 1.0, 0.01, 1.0, 0.05


class Simulator(BaseSystemCollection, Forcing):
    """A rod, a force and a fluid."""


def speed(angle: float) -> float:
    """Return the final speed along the force of a rod at an angle to it [m/s]."""
    simulator = Simulator()
    direction = np.array([np.cos(angle), np.sin(angle), 0.0])
    rod = CosseratRod.straight_rod(
        20,
        np.zeros(3),
        direction,
        np.array([0.0, 0.0, 1.0]),
        LENGTH,
        RADIUS,
        1000.0,
        youngs_modulus=1e7,
        shear_modulus=4e6,
    )
    simulator.append(rod)
    simulator.add_forcing_to(rod).using(UniformForces, FORCE, np.array([1.0, 0.0, 0.0]))
    simulator.add_forcing_to(rod).using(SlenderBodyTheory, VISCOSITY)
    simulator.finalize()
    integrate(PositionVerlet(), simulator, 2.0, 20_000, progress_bar=False)
    return float(rod.compute_velocity_center_of_mass()[0])


def exact(angle: np.ndarray) -> np.ndarray:
    """Return the speed by slender-body theory: lengthwise drag is half of that across [m/s]."""
    across = 4.0 * np.pi * VISCOSITY * LENGTH / np.log(LENGTH / RADIUS)
    return FORCE / across * (1.0 + np.cos(angle) ** 2)


def measure() -> Result:
    """Return the speed over the angle between rod and force."""
    angles, fine = np.linspace(0.0, 0.5 * np.pi, 4), np.linspace(0.0, 0.5 * np.pi, 100)
    found = np.array([speed(angle) for angle in angles])
    error = float(np.abs(found / exact(angles) - 1.0).max())
    return Result(
        "Sedimentation of a slender body",
        "angle to the force [rad]",
        "speed along the force [m/s]",
        angles,
        found,
        fine,
        exact(fine),
        error,
        1e-3,
    )


if __name__ == "__main__":
    show(measure, "sedimentation")
