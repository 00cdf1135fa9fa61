"""A released cantilever oscillates at the frequency of its first mode, 1.8751^2/(2 pi) sqrt(Y I/(rho A L^4))."""

import numpy as np
from case import Result, show

from elastica_gym.cosserat import (
    BaseSystemCollection,
    CallBackBaseClass,
    CallBacks,
    Constraints,
    CosseratRod,
    OneEndFixedBC,
    PositionVerlet,
    integrate,
    stable_time_step,
)

LENGTH, RADIUS, DENSITY, YOUNG = 1.0, 0.01, 1000.0, 1e6
MODE = 1.8751040687119611


class Simulator(BaseSystemCollection, Constraints, CallBacks):
    """A rod, a clamp and a callback."""


class TipCallBack(CallBackBaseClass):
    """Records the distance of the last node from the axis."""

    def __init__(self, every: int, times: list, tips: list) -> None:
        self.every, self.times, self.tips = every, times, tips

    def make_callback(self, system: CosseratRod, time: float, current_step: int) -> None:
        """Append time and distance."""
        self.times.append(time)
        self.tips.append(system.position_collection[1, -1])


def frequency(n: int) -> float:
    """Return the theoretical frequency of a rod whose first half element is held [Hz]."""
    free = LENGTH * (1.0 - 0.5 / n)
    return MODE**2 / (2.0 * np.pi) * np.sqrt(YOUNG * RADIUS**2 / (4.0 * DENSITY)) / free**2


def measure() -> Result:
    """Return the end's deflection over time; theory is a sine at the first mode's frequency."""
    n = 40
    simulator = Simulator()
    rod = CosseratRod.straight_rod(
        n,
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
    ratio = (np.cosh(MODE) + np.cos(MODE)) / (np.sinh(MODE) + np.sin(MODE))
    shape = np.cosh(MODE * s) - np.cos(MODE * s) - ratio * (np.sinh(MODE * s) - np.sin(MODE * s))
    rod.velocity_collection[1] = 1e-3 * shape
    simulator.append(rod)
    simulator.constrain(rod).using(OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    times: list[float] = []
    tips: list[float] = []
    simulator.collect_diagnostics(rod).using(TipCallBack, 200, times, tips)
    simulator.finalize()
    expected = frequency(n)
    duration = 3.0 / expected
    integrate(PositionVerlet(), simulator, duration, int(duration / (0.7 * stable_time_step(rod))), progress_bar=False)

    t, y = np.array(times), np.array(tips)
    rising = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0))
    crossings = t[rising] - y[rising] * (t[rising + 1] - t[rising]) / (y[rising + 1] - y[rising])
    found = (crossings.size - 1) / (crossings[-1] - crossings[0])
    fine = np.linspace(0.0, duration, 300)
    return Result(
        f"First mode of a cantilever: {found:.4f} Hz, theory {expected:.4f} Hz",
        "time [s]",
        "deflection of the end [m]",
        t,
        y,
        fine,
        y.max() * np.sin(2.0 * np.pi * expected * fine),
        abs(found / expected - 1.0),
        1e-2,
    )


if __name__ == "__main__":
    show(measure, "cantilever_frequency")
