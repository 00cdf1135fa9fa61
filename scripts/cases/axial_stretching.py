"""A rod pulled at its end oscillates along its axis and comes to rest where tension balances the force."""

import numpy as np
from case import Result, show

from elastica_gym.cosserat import (
    BaseSystemCollection,
    CallBackBaseClass,
    CallBacks,
    Constraints,
    CosseratRod,
    EndpointForces,
    Forcing,
    OneEndFixedBC,
    PositionVerlet,
    integrate,
)

LENGTH, RADIUS, MODULUS, FORCE = 1.0, 0.025, 1e4, 1.0


class Simulator(BaseSystemCollection, Constraints, Forcing, CallBacks):
    """A rod, a clamp, a force and a callback."""


class TipCallBack(CallBackBaseClass):
    """Records the position of the last node."""

    def __init__(self, every: int, times: list, tips: list) -> None:
        self.every, self.times, self.tips = every, times, tips

    def make_callback(self, system: CosseratRod, time: float, current_step: int) -> None:
        """Append time and position."""
        self.times.append(time)
        self.tips.append(system.position_collection[0, -1])


def measure() -> Result:
    """Return the end's displacement over time; theory is its rest position."""
    simulator = Simulator()
    rod = CosseratRod.straight_rod(
        19,
        np.zeros(3),
        np.array([1.0, 0.0, 0.0]),
        np.array([0.0, 1.0, 0.0]),
        LENGTH,
        RADIUS,
        1000.0,
        nu=2.0,
        # nothing rotates: torque damping of this size would be unstable at this step
        nu_for_torques=0.0,
        youngs_modulus=MODULUS,
    )
    simulator.append(rod)
    simulator.constrain(rod).using(OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    simulator.add_forcing_to(rod).using(EndpointForces, np.zeros(3), np.array([FORCE, 0.0, 0.0]), ramp_up_time=1e-2)
    times: list[float] = []
    tips: list[float] = []
    simulator.collect_diagnostics(rod).using(TipCallBack, 400, times, tips)
    simulator.finalize()
    integrate(PositionVerlet(), simulator, 20.0, 40_000, progress_bar=False)

    area = np.pi * RADIUS**2
    exact = FORCE * LENGTH / (area * MODULUS - FORCE)
    way = np.array(tips) - LENGTH
    return Result(
        "Axial stretching",
        "time [s]",
        "displacement of the end [m]",
        np.array(times),
        way,
        np.array([0.0, 20.0]),
        np.full(2, exact),
        abs(way[-1] / exact - 1.0),
        1e-3,
    )


if __name__ == "__main__":
    show(measure, "axial_stretching")
