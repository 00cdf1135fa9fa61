"""External loads on rods and rigid bodies."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..engine.model import Array
from ..engine.rod import as_number, as_numbers, require_not_negative, require_positive, three
from ..engine.surroundings import beta_spline, net_couple, wave_profiles
from .lowering import SceneBuilder


class NoForces:
    """Base class of loads; write your own by overriding one or both methods.

    They are called once per step (per stage of PEFRL), after the drift, and add to
    ``system.external_forces`` [N], lab frame, and ``system.external_torques`` [N m], material frame.
    """

    def apply_forces(self, system: Any, time: float = 0.0) -> None:
        """Add forces at the stage's time [s]."""

    def apply_torques(self, system: Any, time: float = 0.0) -> None:
        """Add torques at the stage's time [s]."""

    def lower(self, builder: SceneBuilder, system: Any) -> None:
        """Write no rows."""


class GravityForces(NoForces):
    """Weight.

    Parameters
    ----------
    acc_gravity : array_like
        Acceleration [m/s^2], (3,).
    """

    def __init__(self, acc_gravity: ArrayLike = (0.0, -9.80665, 0.0)) -> None:
        # a copy, unlike in other loads, as in 1.0.0
        self.acc_gravity = three("acc_gravity", acc_gravity).copy()

    def apply_forces(self, system: Any, time: float = 0.0) -> None:
        """Add m g to each node."""
        self.compute_gravity_forces(self.acc_gravity, system.mass, system.external_forces)

    @staticmethod
    def compute_gravity_forces(acc_gravity: Array, mass: Array, external_forces: Array) -> None:
        """Add m g to forces, (3, n + 1)."""
        external_forces += acc_gravity[:, None] * mass

    def lower(self, builder: SceneBuilder, system: Any) -> None:
        """Write constant forces."""
        builder.add_dead_force(system, self.acc_gravity[:, None] * system.mass)


class EndpointForces(NoForces):
    """Forces on the first and last node, growing linearly until ``ramp_up_time``.

    Parameters
    ----------
    start_force, end_force : array_like
        [N], (3,); changes to arrays between runs or callbacks take effect.
    ramp_up_time : float
        [s]; 0 for full force from the start.
    """

    def __init__(self, start_force: ArrayLike, end_force: ArrayLike, ramp_up_time: float = 0.0) -> None:
        self.start_force, self.end_force = three("start_force", start_force), three("end_force", end_force)
        require_not_negative("ramp_up_time", ramp_up_time)
        self.ramp_up_time = float(ramp_up_time)

    def apply_forces(self, system: Any, time: float = 0.0) -> None:
        """Add the forces at the ends."""
        self.compute_end_point_forces(system.external_forces, self.start_force, self.end_force, time, self.ramp_up_time)

    @staticmethod
    def compute_end_point_forces(
        external_forces: Array, start_force: Array, end_force: Array, time: float, ramp_up_time: float
    ) -> None:
        """Add the forces at the ends to forces, (3, n + 1)."""
        growth = min(1.0, time / ramp_up_time) if ramp_up_time > 0.0 else 1.0
        external_forces[..., 0] += growth * start_force
        external_forces[..., -1] += growth * end_force

    def lower(self, builder: SceneBuilder, system: Any) -> None:
        """Write a row for each end."""
        for index, force in ((0, self.start_force), (-1, self.end_force)):
            if force.any():
                builder.add_point_load(system, index, ramp_time=self.ramp_up_time, growing=force)


class EndpointForcesSinusoidal(NoForces):
    """Forces on the ends that rotate in the plane across a tangent, once in 4 s.

    Until ``ramp_up_time`` each is -2 times its magnitude along the normal; afterwards, with T the
    time since, cos(pi T/2) along normal x tangent and sin(pi T/2) along the normal.

    Parameters
    ----------
    start_force_mag, end_force_mag : float
        [N]
    ramp_up_time : float
        [s]
    tangent_direction, normal_direction : array_like
        Unit vectors, (3,).
    """

    def __init__(
        self,
        start_force_mag: float,
        end_force_mag: float,
        ramp_up_time: float = 0.0,
        tangent_direction: ArrayLike = (0.0, 0.0, 1.0),
        normal_direction: ArrayLike = (0.0, 1.0, 0.0),
    ) -> None:
        require_not_negative("ramp_up_time", ramp_up_time)
        self.start_force_mag = as_number("start_force_mag", start_force_mag)
        self.end_force_mag = as_number("end_force_mag", end_force_mag)
        self.ramp_up_time = float(ramp_up_time)
        self.normal_direction = three("normal_direction", normal_direction)
        self.roll_direction = np.cross(self.normal_direction, three("tangent_direction", tangent_direction))

    def apply_forces(self, system: Any, time: float = 0.0) -> None:
        """Add the forces at the ends."""
        late = 0.5 * np.pi * (time - self.ramp_up_time)
        turning = np.cos(late) * self.roll_direction + np.sin(late) * self.normal_direction
        direction = -2.0 * self.normal_direction if late < 0.0 else turning
        system.external_forces[..., 0] += self.start_force_mag * direction
        system.external_forces[..., -1] += self.end_force_mag * direction

    def lower(self, builder: SceneBuilder, system: Any) -> None:
        """Write a row for each end."""
        for index, size in ((0, self.start_force_mag), (-1, self.end_force_mag)):
            builder.add_point_load(
                system,
                index,
                ramp_time=self.ramp_up_time,
                before=-2.0 * size * self.normal_direction,
                cosine=size * self.roll_direction,
                sine=size * self.normal_direction,
                angular_frequency=0.5 * np.pi,
            )


class UniformForces(NoForces):
    """A force spread evenly over a system.

    Parameters
    ----------
    force : float
        Total [N].
    direction : array_like
        Unit vector, (3,).
    """

    def __init__(self, force: float, direction: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        self.force = as_number("force", force) * three("direction", direction)[:, None]

    def apply_forces(self, system: Any, time: float = 0.0) -> None:
        """Add an equal share to each element, half on each node."""
        system.external_forces += self.force * _shares(system)

    def lower(self, builder: SceneBuilder, system: Any) -> None:
        """Write constant forces."""
        builder.add_dead_force(system, self.force * _shares(system))


class UniformTorques(NoForces):
    """A torque spread evenly over a system, constant in the lab.

    Parameters
    ----------
    torque : float
        Total [N m].
    direction : array_like
        Unit vector, (3,).
    """

    def __init__(self, torque: float, direction: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        self.torque = as_number("torque", torque) * three("direction", direction)

    def apply_torques(self, system: Any, time: float = 0.0) -> None:
        """Add an equal share to each element."""
        system.external_torques += np.einsum("ijk,j->ik", system.director_collection, self.torque / system.n_elems)

    def lower(self, builder: SceneBuilder, system: Any) -> None:
        """Write constant torques."""
        builder.add_dead_torque(system, self.torque[:, None] / system.n_elems)


class ReciprocalTension(NoForces):
    """Optional tension that makes a rod's internal loads conservative; the documented model lacks it.

    In the documented model, couples scale with 1/E^3 of the dilatation at a joint, forces with 1/e and spins with J/e,
    but no tension opposes the stretch that changes them. Thick rods that stretch and bend therefore gain or lose
    energy, and stiff ones may flutter. With it, a free rod conserves the sum of its kinetic energy, of
    sum (kappa - kappa^).B (kappa - kappa^) D^/(2 E^3) and of sum (sigma - sigma^).S (sigma - sigma^) l^/(2 e).
    """

    def apply_forces(self, system: Any, time: float = 0.0) -> None:
        """Pull the nodes of each element together."""
        s, k, w = system.sigma - system.rest_sigma, system.kappa - system.rest_kappa, system.omega_collection
        shear, bend, spin = (
            np.einsum("ik,ijk,jk->k", a, matrix, a)
            for a, matrix in (
                (s, system.shear_matrix),
                (k, system.bend_matrix),
                (w, system.mass_second_moment_of_inertia),
            )
        )
        bend *= 0.75 / system.voronoi_dilatation**4
        # joints are between elements; the last joint of a ring is the one before its first element
        around = bend + np.roll(bend, 1) if system.ring_rod_flag else np.append(bend, 0.0) + np.append(0.0, bend)
        tension = 0.5 * (spin / system.rest_lengths - shear) / system.dilatation**2 - around
        force = tension * system.tangents
        if system.ring_rod_flag:
            system.external_forces += force - np.roll(force, 1, axis=1)
        else:
            system.external_forces[:, :-1] += force
            system.external_forces[:, 1:] -= force

    def lower(self, builder: SceneBuilder, system: Any) -> None:
        """Write a rod."""
        builder.add_tension(system)


class MuscleTorques(NoForces):
    """A travelling wave of muscle couples along a rod (Gazzola et al. 2018, section 5.2).

    With s the relative arc length of an element's end, the couple between two elements is
    min(1, t/ramp) beta(s) sin(2 pi t/period - k s + phase) along ``direction``, taken in reverse order
    along the rod; equal and opposite on the two.

    Parameters
    ----------
    base_length : float
        Length of the rod [m]; unused, since s is divided by the sum of ``rest_lengths``.
    b_coeff : array_like
        Control coefficients of beta, a cubic B-spline, at least four [N m].
    period : float
        [s]
    wave_number : float
        k, for s from 0 to 1 [rad].
    phase_shift : float
        [rad]
    direction : array_like
        Direction of the couple in the lab, (3,); changes to an array between runs or callbacks take effect.
    rest_lengths : array_like
        Rest lengths of the rod's elements [m], (n,).
    ramp_up_time : float
        Duration of the linear ramp to full strength, 0 for none [s].
    with_spline : bool
        Whether beta is the spline or 1 N m throughout.
    """

    def __init__(
        self,
        base_length: float,
        b_coeff: ArrayLike,
        period: float,
        wave_number: float,
        phase_shift: float,
        direction: ArrayLike,
        rest_lengths: ArrayLike,
        ramp_up_time: float = 0.0,
        with_spline: bool = False,
    ) -> None:
        require_positive("period", period)
        require_not_negative("ramp_up_time", ramp_up_time)
        lengths, coefficients = as_numbers("rest_lengths", rest_lengths), np.atleast_1d(as_numbers("b_coeff", b_coeff))
        if with_spline and coefficients.size < 4:
            raise ValueError(f"b_coeff must be at least 4 numbers, not {coefficients.size}")
        self.direction = three("direction", direction)
        self.angular_frequency = 2.0 * np.pi / period
        self.wave_number = as_number("wave_number", wave_number)
        self.phase_shift = as_number("phase_shift", phase_shift)
        self.ramp_up_time = float(ramp_up_time)
        self.s = np.cumsum(lengths) / np.sum(lengths)
        self.my_spline = beta_spline(coefficients, self.s) if with_spline else np.ones_like(self.s)

    def profiles(self) -> tuple[Array, Array]:
        """Return the amplitudes of sin and cos of 2 pi t/period: couples between elements [N m], (n - 1,)."""
        return wave_profiles(self.s, self.my_spline, self.wave_number, self.phase_shift)

    def apply_torques(self, system: Any, time: float = 0.0) -> None:
        """Add each couple to the element after it, and its opposite to the one before."""
        self.compute_muscle_torques(
            time,
            self.my_spline,
            self.s,
            self.angular_frequency,
            self.wave_number,
            self.phase_shift,
            self.ramp_up_time,
            self.direction,
            system.director_collection,
            system.external_torques,
        )

    @staticmethod
    def compute_muscle_torques(
        time: float,
        my_spline: Array,
        s: Array,
        angular_frequency: float,
        wave_number: float,
        phase_shift: float,
        ramp_up_time: float,
        direction: Array,
        director_collection: Array,
        external_torques: Array,
    ) -> None:
        """Add each couple to the torque, (3, n), of the element after it, and its opposite to the one before."""
        growth = min(1.0, time / ramp_up_time) if ramp_up_time > 0.0 else 1.0
        sine, cosine = wave_profiles(s, my_spline, wave_number, phase_shift)
        angle = angular_frequency * time
        couple = net_couple(growth * (np.sin(angle) * sine + np.cos(angle) * cosine))
        external_torques += np.einsum("ijk,j->ik", director_collection, direction) * couple

    def lower(self, builder: SceneBuilder, system: Any) -> None:
        """Write a wave."""
        if self.s.size != system.n_elems:
            raise ValueError(f"rest_lengths must be {system.n_elems} numbers, one for each element, not {self.s.size}")
        sine, cosine = self.profiles()
        builder.add_wave(
            system,
            axis=self.direction,
            angular_frequency=self.angular_frequency,
            ramp_time=self.ramp_up_time,
            sine=sine,
            cosine=cosine,
        )


def inplace_addition(external_force_or_torque: Array, force_or_torque: Array) -> None:
    """Add loads to a system's loads, (3, n)."""
    external_force_or_torque += force_or_torque


def inplace_subtraction(external_force_or_torque: Array, force_or_torque: Array) -> None:
    """Subtract loads from a system's loads, (3, n)."""
    external_force_or_torque -= force_or_torque


# spelling before 1.0
inplace_substraction = inplace_subtraction


def _shares(system: Any) -> Array:
    """Return the share of a uniform force on each node."""
    shares = np.full(system.n_nodes, 1.0 / system.n_elems)
    if system.n_nodes == system.n_elems + 1:
        shares[0] = shares[-1] = 0.5 / system.n_elems
    return shares
