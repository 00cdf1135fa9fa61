"""Measure the time per step over the number of rods: 20 elements each, joined in pairs and stacked.

``python scripts/many_rods.py`` prints a table and writes the curve to docs/images/many_rods.png.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from elastica_gym.progress import track

ROOT = Path(__file__).resolve().parents[1]
PICTURE = ROOT / "docs" / "images" / "many_rods.png"
COUNTS = (10, 20, 50, 100, 200, 500, 1000)
N_ELEMENTS, LENGTH, RADIUS = 20, 0.2, 0.005
IN_A_ROW = 2
"""Rods joined end to end per row: half as many joints as rods, and nearly as many contacts"""
OVERLAP = 2e-4
"""Overlap of neighbouring rows [m]"""
TILT = 0.05
"""Slope of the rods, alternately up and down, so that neighbours in a row and in a column cross [rad]"""
DT = 1e-5
N_STEPS, REPEATS = 200, 5
"""Steps per measurement, equal for all since touching rods separate; and measurements, of which the best counts"""


def rows(lib: Any, n_rods: int, contact: type | None = None) -> tuple[Any, list[Any]]:
    """Declare a stack of rows of rods, joined end to end within a row, each crossing one of the next row.

    Parameters
    ----------
    lib : module
        ``elastica_gym.cosserat`` or ``elastica``.
    n_rods : int
        Number of rods.
    contact : type, optional
        Contact class; default ``RodRodContact`` of the library.

    Returns
    -------
    tuple
        The simulator, not finalized, and the rods.
    """

    class Simulator(lib.BaseSystemCollection, lib.Constraints, lib.Forcing, lib.Connections, lib.Damping, lib.Contact):
        pass

    simulator, rods = Simulator(), []
    for number in range(n_rods):
        row, place = divmod(number, IN_A_ROW)
        slope = TILT * (-1) ** (row + place)
        direction = np.array([np.cos(slope), np.sin(slope), 0.0])
        middle = np.array([(place + 0.5) * LENGTH * np.cos(slope), 0.0, row * (2.0 * RADIUS - OVERLAP)])
        rod = lib.CosseratRod.straight_rod(
            N_ELEMENTS,
            middle - 0.5 * LENGTH * direction,
            direction,
            np.array([0.0, 0.0, 1.0]),
            LENGTH,
            RADIUS,
            1000.0,
            youngs_modulus=1e6,
            shear_modulus=4e5,
        )
        simulator.append(rod)
        simulator.add_forcing_to(rod).using(lib.GravityForces, acc_gravity=np.array([0.0, -9.81, 0.0]))
        simulator.dampen(rod).using(lib.AnalyticalLinearDamper, uniform_damping_constant=1.0, time_step=DT)
        if place > 0:
            rest = rods[-1].director_collection[..., -1] @ rod.director_collection[..., 0].T
            simulator.connect(rods[-1], rod, -1, 0).using(
                lib.FixedJoint, k=1e3, nu=0.01, kt=0.1, rest_rotation_matrix=rest
            )
        if row > 0:
            detected = simulator.detect_contact_between(rods[number - IN_A_ROW], rod)
            detected.using(contact or lib.RodRodContact, k=100.0, nu=0.01)
        rods.append(rod)
    return simulator, rods


def shake(rods: Sequence[Any], speed: float = 0.02) -> None:
    """Set random node velocities of a given magnitude [m/s]."""
    rng = np.random.default_rng(0)
    for rod in rods:
        rod.velocity_collection[:] = speed * rng.standard_normal(rod.velocity_collection.shape)


def measure(n_rods: int) -> tuple[float, float]:
    """Return the CPU times of declaring and finalizing, and of a step, the best of several [s]."""
    sys.path.insert(0, str(ROOT))
    import elastica_gym.cosserat as lib

    start = time.process_time()
    simulator, rods = rows(lib, n_rods)
    simulator.finalize()
    assembly = time.process_time() - start
    shake(rods)
    steps = []
    for _ in range(REPEATS):
        start = time.process_time()
        lib.integrate(lib.PositionVerlet(), simulator, N_STEPS * DT, N_STEPS, progress_bar=False)
        steps.append((time.process_time() - start) / N_STEPS)
    return assembly, min(steps)


def draw(counts: Sequence[int], times: np.ndarray, path: Path) -> None:
    """Draw the times [s], (counts, 2), next to linear scaling with the number of rods."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.6), layout="constrained")
    for each, column, title, unit, scale in (
        (axes[0], times[:, 1], "A step", "ms", 1e3),
        (axes[1], times[:, 0], "Declaring and finalizing", "s", 1.0),
    ):
        each.loglog(counts, scale * column, "o-", markersize=4, label="measured")
        proportional = scale * np.median(column / counts) * np.array(counts)
        each.loglog(counts, proportional, color="black", linewidth=1.0, linestyle="--", label="proportional")
        each.set(title=title, xlabel="rods of 20 elements, joined and touching", ylabel=f"CPU time [{unit}]")
        each.legend(frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)


def main() -> None:
    """Measure, print and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rods", type=int, nargs="+", default=COUNTS, help="numbers of rods")
    parser.add_argument("--out", type=Path, default=PICTURE, help=f"file of the picture (default: {PICTURE})")
    arguments = parser.parse_args()
    if min(arguments.rods) < 2:
        parser.error("--rods must be at least 2")
    # compile and load caches before measuring
    measure(4)
    times = np.array([measure(n) for n in track(arguments.rods, "measuring")])
    for n, (assembly, step) in zip(arguments.rods, times, strict=True):
        print(
            f"{n:6d} rods: {1e6 * step:9.1f} us per step, {1e6 * step / n:.2f} us per rod; "
            f"{assembly:.2f} s to declare and finalize, {1e3 * assembly / n:.2f} ms per rod"
        )
    draw(arguments.rods, times, arguments.out)
    print(f"the curve is in {arguments.out}")


if __name__ == "__main__":
    main()
