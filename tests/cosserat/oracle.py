"""The same scene in PyElastica 1.0.0, built from our own descriptions of rods, planes and waves."""

from collections.abc import Sequence

import elastica as ea
import numpy as np

from elastica_gym.cosserat import Plane, Rod, Wave
from elastica_gym.cosserat.model import Array

REST = 1e300
"""A ramp as short as PyElastica allows stands for none"""


class _Simulator(ea.BaseSystemCollection, ea.Forcing, ea.Damping, ea.Contact):
    """Only what the scenes need: every feature more would cost PyElastica time."""


class Twin:
    """A rod and its surroundings in PyElastica, which steps as ours does.

    Parameters
    ----------
    rod : Rod
        Without viscosity, which PyElastica 1.0.0 defines differently.
    dt : float
        [s]
    planes, waves, gravity
        As for `build_model`.
    """

    def __init__(
        self, rod: Rod, *, dt: float, planes: Sequence[Plane] = (), waves: Sequence[Wave] = (),
        gravity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> None:  # fmt: skip
        simulator = _Simulator()
        self.rod = _rod(rod)
        simulator.append(self.rod)
        if any(gravity):
            simulator.add_forcing_to(self.rod).using(ea.GravityForces, acc_gravity=np.array(gravity))
        for wave in waves:
            simulator.add_forcing_to(self.rod).using(
                ea.MuscleTorques, base_length=1.0, b_coeff=np.array(wave.coefficients), period=wave.period,
                wave_number=wave.wave_number, phase_shift=wave.phase, rest_lengths=rod.rest_length,
                ramp_up_time=wave.ramp_time or 1.0 / REST, direction=np.array(wave.axis), with_spline=True,
            )  # fmt: skip
        for plane in planes:
            ground = ea.Plane(np.array(plane.origin), plane.normal / np.linalg.norm(plane.normal))
            simulator.append(ground)
            simulator.detect_contact_between(self.rod, ground).using(
                ea.RodPlaneContactWithAnisotropicFriction, k=plane.stiffness, nu=plane.damping,
                slip_velocity_tol=plane.slip_tolerance, static_mu_array=np.array(plane.static_friction),
                kinetic_mu_array=np.array(plane.kinetic_friction),
            )  # fmt: skip
        if rod.damping_rate > 0.0:
            simulator.dampen(self.rod).using(
                ea.AnalyticalLinearDamper, uniform_damping_constant=rod.damping_rate, time_step=dt
            )
        simulator.finalize()
        self._simulator, self._stepper, self.dt, self.time = simulator, ea.PositionVerlet(), np.float64(dt), 0.0

    def advance(self, n_steps: int) -> None:
        """Take steps of position Verlet."""
        step, simulator, dt, time = self._stepper.step, self._simulator, self.dt, self.time
        for _ in range(n_steps):
            time = step(simulator, time, dt)
        self.time = time

    def set_state(self, x: Array, v: Array, Q: Array, w: Array, time: float) -> None:
        """Set positions, velocities, directors, angular velocities and time."""
        rod = self.rod
        rod.position_collection[:], rod.velocity_collection[:] = x, v
        rod.director_collection[:], rod.omega_collection[:] = Q, w
        self.time = time

    @property
    def motion(self) -> tuple[Array, Array, Array, Array]:
        """Positions, velocities, directors and angular velocities."""
        rod = self.rod
        return rod.position_collection, rod.velocity_collection, rod.director_collection, rod.omega_collection


def _rod(rod: Rod) -> ea.CosseratRod:
    first, last = rod.position[:, 0], rod.position[:, -1]
    length = float(np.linalg.norm(last - first))
    return ea.CosseratRod.straight_rod(
        rod.n_elements, first.copy(), (last - first) / length, rod.directors[0, :, 0].copy(), length, rod.radius.copy(),
        rod.density, youngs_modulus=rod.youngs_modulus, shear_modulus=rod.shear_modulus, position=rod.position.copy(),
        directors=rod.directors.copy(), rest_kappa=rod.rest_kappa.copy(), rest_sigma=rod.rest_sigma.copy(),
    )  # fmt: skip
