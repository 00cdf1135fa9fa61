"""The same scene in PyElastica 1.0.0, built from our own descriptions of rods, planes and waves."""

from collections.abc import Sequence
from typing import Any

import elastica as ea
import numpy as np

from elastica_gym.cosserat import Control, Model, Rod, State, Wave, advance, at_rest, build_model
from elastica_gym.cosserat.model import Array
from elastica_gym.cosserat.surroundings import Plane

from .scenes import disturb, motion

NO_RAMP = 1e-300
"""A ramp as short as PyElastica allows stands for none [s]"""


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
                ramp_up_time=wave.ramp_time or NO_RAMP, direction=np.array(wave.axis), with_spline=True,
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


def both(rod: Rod, dt: float, **loads: Any) -> tuple[Model, State, Control, Twin]:
    """Return a scene of ours, at rest, and its twin."""
    model = build_model([rod], **loads)
    return model, *at_rest(model, [rod]), Twin(rod, dt=dt, **loads)


def distance(model: Model, state: State, twin: Twin) -> float:
    """Return the largest difference of positions [m]."""
    return float(np.abs(motion(model, state)[0] - twin.motion[0]).max())


def worst_step(rod: Rod, dt: float, n_states: int, **loads: Any) -> float:
    """Return how much one step from random states differs.

    For v and w relative to their largest change, for x and Q absolute; the largest of all.
    """
    model, state, control, twin = both(rod, dt, **loads)
    rng = np.random.default_rng(0)
    worst = 0.0
    for number in range(n_states):
        # sliding (in part, where the slip tolerance is large) or sticking
        disturb(rod, model, state, rng, speed=(1.0, 1e-9)[number % 2])
        state.time[0] = time = rng.uniform(0.0, 3.0)
        before = tuple(a.copy() for a in motion(model, state))
        twin.set_state(*before, time)
        advance(model, state, control, 0, 1, dt, 1)
        twin.advance(1)
        for index, (ours, theirs, start) in enumerate(zip(motion(model, state), twin.motion, before, strict=True)):
            scale = np.abs(theirs - start).max() if index in (1, 3) else 1.0
            worst = max(worst, float(np.abs(ours - theirs).max() / scale))
    return worst
