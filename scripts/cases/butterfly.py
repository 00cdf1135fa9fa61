"""A rod straight at rest, released with a kink in its middle, flaps like two wings and conserves energy.

The radius of the published rod is a third of its element length and it stretches by a tenth; the documented model does
not conserve its energy at any time step. Its couples scale with 1/E^3 of the dilatation at a joint, its forces with 1/e
and its spin with J/e, without the tension that these changes require. The load `ReciprocalTension` adds it. A slender
rod hardly stretches, and the documented model conserves its energy.
"""

import numpy as np
from case import Result, show

from elastica_gym.cosserat import (
    BaseSystemCollection,
    CallBackBaseClass,
    CallBacks,
    CosseratRod,
    Forcing,
    PositionVerlet,
    ReciprocalTension,
    integrate,
    stable_time_step,
)

N, LENGTH, DENSITY, YOUNG = 4, 3.0, 5000.0, 1e4
PUBLISHED, SLENDER = 0.25, 0.025
"""Radii [m]"""
DURATION = 5.0
"""Duration for a radius of 1 m; inversely proportional to the radius [s]"""


class Simulator(BaseSystemCollection, Forcing, CallBacks):
    """A rod, optional tension and a callback."""


class EnergyCallBack(CallBackBaseClass):
    """Records energies of translation, rotation, shear and bending: documented ones, or those of the potential."""

    def __init__(self, every: int, is_reciprocal: bool, times: list, energies: list) -> None:
        self.every, self.is_reciprocal, self.times, self.energies = every, is_reciprocal, times, energies

    def make_callback(self, system: CosseratRod, time: float, current_step: int) -> None:
        """Append time and energies."""
        elastic = system.compute_shear_energy(), system.compute_bending_energy()
        if self.is_reciprocal:
            shear = np.einsum("ik,ijk,jk->k", system.sigma, system.shear_matrix, system.sigma)
            bend = np.einsum("ik,ijk,jk->k", system.kappa, system.bend_matrix, system.kappa)
            elastic = (
                0.5 * (shear * system.rest_lengths / system.dilatation).sum(),
                0.5 * (bend * system.rest_voronoi_lengths / system.voronoi_dilatation**3).sum(),
            )
        self.times.append(time)
        self.energies.append((system.compute_translational_energy(), system.compute_rotational_energy(), *elastic))


def fly(radius: float, part: float = 0.2, is_reciprocal: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Return times [s], (m,), and energies [J], (m, 4), of a flight with a fraction of the stable step."""
    half = np.arange(N + 1.0) - N // 2
    nodes = LENGTH / N / np.sqrt(2.0) * np.array([N // 2 - abs(half), 0.0 * half, half + N // 2])
    rod = CosseratRod.straight_rod(
        N,
        np.zeros(3),
        np.array([0.0, 0.0, 1.0]),
        np.array([0.0, 1.0, 0.0]),
        LENGTH,
        radius,
        DENSITY,
        youngs_modulus=YOUNG,
        poisson_ratio=0.5,
        position=nodes,
    )
    simulator = Simulator()
    simulator.append(rod)
    if is_reciprocal:
        simulator.add_forcing_to(rod).using(ReciprocalTension)
    steps = int(DURATION / radius / (part * stable_time_step(rod)))
    times: list[float] = []
    energies: list[tuple] = []
    simulator.collect_diagnostics(rod).using(EnergyCallBack, steps // 100, is_reciprocal, times, energies)
    simulator.finalize()
    integrate(PositionVerlet(), simulator, DURATION / radius, steps, progress_bar=False)
    return np.array(times), np.array(energies)


def drift(energies: np.ndarray) -> float:
    """Return the largest relative change of the total energy."""
    whole = energies.sum(axis=1)
    return float(np.abs(whole / whole[0] - 1.0).max())


def measure() -> Result:
    """Return energies of a slender rod over time; in theory their sum is constant."""
    times, energies = fly(SLENDER)
    sums = np.stack([energies[:, :2].sum(axis=1), energies[:, 2:].sum(axis=1), energies.sum(axis=1)], axis=1)
    return Result(
        "Butterfly",
        "time [s]",
        "energy [J]",
        times,
        sums,
        times[[0, -1]],
        sums[[0, 0], 2],
        drift(energies),
        1e-3,
        labels=("kinetic", "elastic", "both"),
    )


if __name__ == "__main__":
    show(measure, "butterfly")
