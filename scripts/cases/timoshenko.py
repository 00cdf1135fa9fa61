"""A cantilever with a transverse end force bends and shears (Gazzola et al. 2018, section 3.4.3).

The error falls with the square of the number of elements, from 5 to 200.
"""

import numpy as np
from case import Result, show

from elastica_gym.cosserat import (
    AnalyticalLinearDamper,
    BaseSystemCollection,
    Constraints,
    CosseratRod,
    Damping,
    EndpointForces,
    Forcing,
    OneEndFixedBC,
    PositionVerlet,
    integrate,
    stable_time_step,
)

LENGTH, RADIUS, DENSITY, YOUNG, SHEAR, FORCE = 3.0, 0.25, 500.0, 1e6, 1e4, -0.1
SIZES = (5, 10, 20, 50, 100, 200)
REST = 20.0
"""Time for damping to bring the rod to rest [s]"""


class Simulator(BaseSystemCollection, Constraints, Forcing, Damping):
    """A rod, a clamp, a force and a damper."""


def deflection(n: int) -> float:
    """Return the end deflection at rest of a rod of n elements [m]."""
    simulator = Simulator()
    rod = CosseratRod.straight_rod(
        n,
        np.zeros(3),
        np.array([0.0, 0.0, 1.0]),
        np.array([0.0, 1.0, 0.0]),
        LENGTH,
        RADIUS,
        DENSITY,
        youngs_modulus=YOUNG,
        shear_modulus=SHEAR,
    )
    simulator.append(rod)
    simulator.constrain(rod).using(OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    simulator.add_forcing_to(rod).using(EndpointForces, np.zeros(3), np.array([FORCE, 0.0, 0.0]))
    simulator.dampen(rod).using(AnalyticalLinearDamper, uniform_damping_constant=3.0)
    simulator.finalize()
    steps = int(REST / (0.5 * stable_time_step(rod)))
    integrate(PositionVerlet(), simulator, REST, steps, progress_bar=False)
    return float(rod.position_collection[0, -1])


def exact(n: int) -> float:
    """Return the deflection of a rod with a clamped first element by Timoshenko's theory [m].

    The first element does not rotate, so bending starts half an element into the second.
    """
    area = np.pi * RADIUS**2
    bending = YOUNG * area**2 / (4.0 * np.pi)
    free = LENGTH * (1.0 - 0.5 / n)
    return FORCE * LENGTH / (27.0 / 28.0 * SHEAR * area) + FORCE * free**3 / (3.0 * bending)


def measure() -> Result:
    """Return the relative error over the number of elements; theory is second order."""
    sizes = np.array(SIZES)
    found = np.array([deflection(n) for n in SIZES])
    errors = np.abs(found / np.array([exact(n) for n in SIZES]) - 1.0)
    order = -np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    return Result(
        f"Timoshenko's beam: order {order:.2f}",
        "elements",
        "relative error",
        sizes,
        errors,
        sizes,
        errors[0] * (sizes[0] / sizes) ** 2.0,
        abs(order - 2.0),
        0.1,
        scale="log",
    )


if __name__ == "__main__":
    show(measure, "timoshenko")
