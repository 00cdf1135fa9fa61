"""The continuum snake crawls as fast as in PyElastica 0.2.2 (Gazzola et al. 2018, section 5.2; Zhang et al. 2021).

A wave of muscle couples, on ground with twice the forward friction sideways and one and a half times it backward.
"""

import numpy as np
from case import Result, show

from elastica_gym.cosserat import (
    AnisotropicFrictionalPlane,
    BaseSystemCollection,
    CallBackBaseClass,
    CallBacks,
    CosseratRod,
    Forcing,
    GravityForces,
    MuscleTorques,
    PositionVerlet,
    integrate,
)

LENGTH, RADIUS, PERIOD, G, FROUDE = 0.35, 0.011 * 0.35, 2.0, 9.80665, 0.1
WAVE = (3.4e-3, 3.3e-3, 4.2e-3, 2.6e-3, 3.6e-3, 3.5e-3)
"""Control coefficients of the couple along the snake [N m]"""
START, DURATION, TIME_STEP = 2.0 * PERIOD, 11.0 * PERIOD, 8e-6
"""Start and end of the speed measurement, and time step [s]"""
SPEED = 0.50179 / (DURATION - START)
"""Speed in PyElastica 0.2.2 with this time step: 0.50179 m from 4 s to 22 s [m/s]"""


class Simulator(BaseSystemCollection, Forcing, CallBacks):
    """A snake, the ground and a callback."""


class WayCallBack(CallBackBaseClass):
    """Records the position of the centre of mass."""

    def __init__(self, every: int, times: list, places: list) -> None:
        self.every, self.times, self.places = every, times, places

    def make_callback(self, system: CosseratRod, time: float, current_step: int) -> None:
        """Append time and position."""
        self.times.append(time)
        self.places.append(system.compute_position_center_of_mass())


def crawl() -> tuple[np.ndarray, np.ndarray]:
    """Return times [s], (m,), and positions of the centre of mass [m], (m, 3)."""
    up, young = np.array([0.0, 1.0, 0.0]), 1e6
    snake = CosseratRod.straight_rod(
        50,
        np.zeros(3),
        np.array([0.0, 0.0, 1.0]),
        up,
        LENGTH,
        RADIUS,
        1000.0,
        nu=1e-4,
        youngs_modulus=young,
        shear_modulus=young / 1.5,
    )
    simulator = Simulator()
    simulator.append(snake)
    simulator.add_forcing_to(snake).using(GravityForces, -G * up)
    simulator.add_forcing_to(snake).using(
        MuscleTorques,
        base_length=LENGTH,
        b_coeff=WAVE,
        period=PERIOD,
        wave_number=2.0 * np.pi,
        phase_shift=0.0,
        rest_lengths=snake.rest_lengths,
        ramp_up_time=PERIOD,
        direction=up,
        with_spline=True,
    )
    forward = LENGTH / (PERIOD**2 * G * FROUDE)
    simulator.add_forcing_to(snake).using(
        AnisotropicFrictionalPlane,
        k=1.0,
        nu=1e-6,
        plane_origin=-RADIUS * up,
        plane_normal=up,
        slip_velocity_tol=1e-8,
        static_mu_array=np.zeros(3),
        kinetic_mu_array=forward * np.array([1.0, 1.5, 2.0]),
    )
    times: list[float] = []
    places: list[np.ndarray] = []
    simulator.collect_diagnostics(snake).using(WayCallBack, 12_500, times, places)
    simulator.finalize()
    integrate(PositionVerlet(), simulator, DURATION, round(DURATION / TIME_STEP))
    return np.array(times), np.array(places)


def measure() -> Result:
    """Return the distance since ``START``, next to PyElastica's."""
    times, places = crawl()
    first = int(np.searchsorted(times, START - 0.5 * TIME_STEP))
    way = np.linalg.norm(places[first:] - places[first], axis=1)
    ends = np.array([START, DURATION])
    error = float(abs(way[-1] / (ends[1] - ends[0]) / SPEED - 1.0))
    return Result(
        "The continuum snake",
        "time [s]",
        "way [m]",
        times[first:],
        way,
        ends,
        SPEED * (ends - START),
        error,
        1e-2,
        reference="PyElastica 0.2.2",
    )


if __name__ == "__main__":
    show(measure, "snake")
