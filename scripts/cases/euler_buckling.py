"""The frequency of a cantilever falls with axial compression, and it buckles at pi^2 Y I/(4 L^2) (Euler 1744)."""

import numpy as np
from cantilever_frequency import DENSITY, LENGTH, RADIUS, YOUNG, TipCallBack, frequency
from case import Result, show

from elastica_gym.cosserat import (
    BaseSystemCollection,
    CallBacks,
    Constraints,
    CosseratRod,
    EndpointForces,
    Forcing,
    OneEndFixedBC,
    PositionVerlet,
    integrate,
    stable_time_step,
)

N = 20
FREE = LENGTH * (1.0 - 0.5 / N)
"""Free length, without the held half element [m]"""
THRESHOLD = np.pi**2 * YOUNG * np.pi * RADIUS**4 / 4.0 / (4.0 * FREE**2)
"""Theoretical buckling force [N]"""


class Simulator(BaseSystemCollection, Constraints, Forcing, CallBacks):
    """A rod, a clamp, a force and a callback."""


def swing(force: float) -> float:
    """Return the frequency of the first mode under a force along the axis [Hz]."""
    simulator = Simulator()
    rod = CosseratRod.straight_rod(
        N,
        np.zeros(3),
        np.array([1.0, 0.0, 0.0]),
        np.array([0.0, 1.0, 0.0]),
        LENGTH,
        RADIUS,
        DENSITY,
        youngs_modulus=YOUNG,
        shear_modulus=YOUNG / 3.0,
    )
    s = rod.position_collection[0] / LENGTH
    rod.velocity_collection[1] = 1e-5 * (1.0 - np.cos(0.5 * np.pi * s))
    simulator.append(rod)
    simulator.constrain(rod).using(OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    unloaded = frequency(N)
    simulator.add_forcing_to(rod).using(
        EndpointForces, np.zeros(3), np.array([-force, 0.0, 0.0]), ramp_up_time=0.1 / unloaded
    )
    times: list[float] = []
    tips: list[float] = []
    simulator.collect_diagnostics(rod).using(TipCallBack, 50, times, tips)
    simulator.finalize()
    duration = 5.0 / unloaded
    integrate(PositionVerlet(), simulator, duration, int(duration / (0.7 * stable_time_step(rod))), progress_bar=False)
    t, y = np.array(times), np.array(tips)
    rising = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0) & (t[:-1] > 0.1 / unloaded))
    crossings = t[rising] - y[rising] * (t[rising + 1] - t[rising]) / (y[rising + 1] - y[rising])
    return (crossings.size - 1) / (crossings[-1] - crossings[0])


def measure() -> Result:
    """Return the squared frequency over the force; the rod buckles where it is zero.

    It decreases almost linearly.
    """
    forces = THRESHOLD * np.array([0.0, 0.2, 0.4, 0.6])
    squared = np.array([swing(force) for force in forces]) ** 2
    found = float(np.roots(np.polyfit(forces, squared, 2)).max())
    ends = np.array([0.0, THRESHOLD])
    return Result(
        f"Buckling of a cantilever: {found:.4f} N, theory {THRESHOLD:.4f} N",
        "force [N]",
        "squared frequency [1/s^2]",
        forces,
        squared,
        ends,
        np.array([frequency(N) ** 2, 0.0]),
        abs(found / THRESHOLD - 1.0),
        2e-2,
    )


if __name__ == "__main__":
    show(measure, "euler_buckling")
