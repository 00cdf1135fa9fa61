"""A rod on a plane, pushed along its axis, moves only above static friction, and then against kinetic friction.

Coulomb friction as in Gazzola et al. 2018, appendix D.
"""

import numpy as np
from case import Result, show

from elastica_gym.cosserat import (
    AnisotropicFrictionalPlane,
    BaseSystemCollection,
    CosseratRod,
    Forcing,
    GravityForces,
    PositionVerlet,
    UniformForces,
    integrate,
    stable_time_step,
)

LENGTH, RADIUS, MASS = 1.0, 0.025, 1.0
KINETIC, STATIC, G = 0.4, 0.8, 9.81
"""Coefficients of friction, and gravity [m/s^2]"""
DURATION = 0.25
"""Time of the energy measurement [s]"""
AXIS, ACROSS, UP = np.eye(3)


class Simulator(BaseSystemCollection, Forcing):
    """A rod, a plane and loads."""


def resting() -> CosseratRod:
    """Return a rod on the ground along ``AXIS``."""
    return CosseratRod.straight_rod(
        20,
        RADIUS * UP,
        AXIS,
        UP,
        LENGTH,
        RADIUS,
        MASS / (np.pi * RADIUS**2 * LENGTH),
        youngs_modulus=1e6,
        shear_modulus=4e5,
    )


def energies(rod: CosseratRod, *loads: tuple, gravity: np.ndarray = -G * UP) -> tuple[float, float]:
    """Return energies of translation and rotation of a rod under loads, each (class, *arguments) [J]."""
    simulator = Simulator()
    simulator.append(rod)
    for kind, *arguments in loads:
        simulator.add_forcing_to(rod).using(kind, *arguments)
    simulator.add_forcing_to(rod).using(GravityForces, gravity)
    simulator.add_forcing_to(rod).using(
        AnisotropicFrictionalPlane,
        k=10.0,
        nu=1e-4,
        plane_origin=np.zeros(3),
        plane_normal=UP,
        slip_velocity_tol=1e-6,
        static_mu_array=np.full(3, STATIC),
        kinetic_mu_array=np.full(3, KINETIC),
    )
    simulator.finalize()
    # near the threshold, a rod takes some steps of both sticking and slipping
    steps = int(DURATION / (0.02 * stable_time_step(rod)))
    integrate(PositionVerlet(), simulator, DURATION, steps, progress_bar=False)
    return rod.compute_translational_energy(), rod.compute_rotational_energy()


def pushed(force: float) -> float:
    """Return the energy of a rod pushed along its axis [J]."""
    return energies(resting(), (UniformForces, force, AXIS))[0]


def exact(force: np.ndarray) -> np.ndarray:
    """Return the theoretical energy [J]."""
    speed = (force - KINETIC * MASS * G) / MASS * DURATION
    return np.where(force > STATIC * MASS * G, 0.5 * MASS * speed**2, 0.0)


def measure() -> Result:
    """Return the energy over the force: none up to the static threshold, then from the force minus friction."""
    forces, fine = STATIC * MASS * G * np.array([0.2, 0.6, 0.99, 1.01, 1.5, 2.0]), np.linspace(0.0, 16.0, 1000)
    found = np.array([pushed(force) for force in forces])
    return Result(
        "Axial friction",
        "force [N]",
        "energy [J]",
        forces,
        found,
        fine,
        exact(fine),
        float(np.abs(found - exact(forces)).max() / exact(forces).max()),
        1e-3,
    )


if __name__ == "__main__":
    show(measure, "axial_friction")
