"""The same scene in PyElastica 1.0.0, built from our descriptions of rods, planes, waves and cylinders.

Contact listed as different in docs/differences.md is corrected by default, by a pairwise implementation.
"""

import itertools
from collections.abc import Sequence
from typing import Any

import elastica as ea
import numpy as np
from elastica._contact_functions import _calculate_contact_forces_cylinder_plane

from elastica_gym.engine import Control, Model, Rod, State, Wave, advance, at_rest, build_model
from elastica_gym.engine.kernels.contact.law import CENTRING
from elastica_gym.engine.model import Array
from elastica_gym.engine.surroundings import Contact, Cylinder, Plane

from .scenes import disturb, disturb_body, motion

NO_RAMP = 1e-300
"""Shortest ramp that PyElastica allows, used for none [s]"""


class _Simulator(ea.BaseSystemCollection, ea.Forcing, ea.Damping, ea.Contact):
    """Only the features that the scenes need: each one costs PyElastica time."""


class Twin:
    """Rods and their surroundings in PyElastica, with the same steps as ours.

    Parameters
    ----------
    rods : sequence of Rod
        Without viscosity, which PyElastica 1.0.0 defines differently.
    dt : float
        [s]
    planes, waves, gravity, cylinders, rod_contact
        As for `build_model`.
    corrected : bool
        Whether contact and the inertia of cylinders are corrected to ours.
    """

    def __init__(
        self,
        rods: Sequence[Rod],
        *,
        dt: float,
        planes: Sequence[Plane] = (),
        waves: Sequence[Wave] = (),
        gravity: tuple[float, float, float] = (0.0, 0.0, 0.0),
        cylinders: Sequence[Cylinder] = (),
        rod_contact: Contact | None = None,
        corrected: bool = True,
    ) -> None:
        self._simulator = simulator = _Simulator()
        self.rods, self.bodies = [_rod(rod) for rod in rods], [_body(each, corrected) for each in cylinders]
        for system in (*self.rods, *self.bodies):
            simulator.append(system)
            if any(gravity):
                simulator.add_forcing_to(system).using(ea.GravityForces, acc_gravity=np.array(gravity))
        for wave in waves:
            simulator.add_forcing_to(self.rods[wave.rod]).using(
                ea.MuscleTorques,
                base_length=1.0,
                b_coeff=np.array(wave.coefficients),
                period=wave.period,
                wave_number=wave.wave_number,
                phase_shift=wave.phase,
                rest_lengths=rods[wave.rod].rest_length,
                ramp_up_time=wave.ramp_time or NO_RAMP,
                direction=np.array(wave.axis),
                with_spline=True,
            )
        self._add_contacts(cylinders, rod_contact, corrected)
        for plane in planes:
            self._add_plane(plane, cylinders, corrected)
        for system, rod in zip(self.rods, rods, strict=True):
            if rod.damping_rate > 0.0:
                simulator.dampen(system).using(
                    ea.AnalyticalLinearDamper, uniform_damping_constant=rod.damping_rate, time_step=dt
                )
        simulator.finalize()
        self._stepper, self.dt, self.time = ea.PositionVerlet(), np.float64(dt), 0.0

    def _add_contacts(self, cylinders: Sequence[Cylinder], rod_contact: Contact | None, corrected: bool) -> None:
        detect = self._simulator.detect_contact_between
        for body, cylinder in zip(self.bodies, cylinders, strict=True):
            on_body = CylinderContact if corrected else ea.RodCylinderContact
            for rod in self.rods:
                detect(rod, body).using(on_body, **_law(cylinder.rods, friction=True))
        if rod_contact is not None:
            law = _law(rod_contact, friction=False)
            for a, rod in enumerate(self.rods):
                detect(rod, rod).using(SelfContact if corrected else ea.RodSelfContact, **law)
                for other in self.rods[a + 1 :]:
                    detect(rod, other).using(PairContact if corrected else ea.RodRodContact, **law)

    def _add_plane(self, plane: Plane, cylinders: Sequence[Cylinder], corrected: bool) -> None:
        ground = ea.Plane(np.array(plane.origin), plane.normal / np.linalg.norm(plane.normal))
        self._simulator.append(ground)
        for rod in self.rods:
            self._simulator.detect_contact_between(rod, ground).using(
                ea.RodPlaneContactWithAnisotropicFriction,
                k=plane.stiffness,
                nu=plane.damping,
                slip_velocity_tol=plane.slip_tolerance,
                static_mu_array=np.array(plane.static_friction),
                kinetic_mu_array=np.array(plane.kinetic_friction),
            )
        if not corrected:
            for body, cylinder in zip(self.bodies, cylinders, strict=True):
                self._simulator.detect_contact_between(body, ground).using(
                    ea.CylinderPlaneContact, k=cylinder.ground_stiffness, nu=cylinder.ground_damping
                )

    def hold(self, rod: int, couple: Array, bend_stiffness: Array) -> None:
        """Hold a muscle couple at Voronoi points [N m], (3, n - 1), as an equivalent shift of rest curvature."""
        self.rods[rod].rest_kappa[:] -= couple / bend_stiffness

    def advance(self, n_steps: int) -> None:
        """Take steps of position Verlet."""
        step, simulator, dt, time = self._stepper.step, self._simulator, self.dt, self.time
        for _ in range(n_steps):
            time = step(simulator, time, dt)
        self.time = time

    def set_state(self, motions: Sequence[tuple[Array, Array, Array, Array]], time: float) -> None:
        """Set positions, velocities, directors and angular velocities of rods and bodies, and the time."""
        for mine, given in zip(self.motions, motions, strict=True):
            for array, values in zip(mine, given, strict=True):
                array[:] = values
        self.time = time

    @property
    def motions(self) -> list[tuple[Array, Array, Array, Array]]:
        """Positions, velocities, directors and angular velocities of each rod, then of each body."""
        return [
            (each.position_collection, each.velocity_collection, each.director_collection, each.omega_collection)
            for each in (*self.rods, *self.bodies)
        ]


# contact, corrected


class CylinderContact(ea.RodCylinderContact):
    """A rod on a cylinder."""

    def apply_contact(self, system_one: Any, system_two: Any, time: Any = 0.0) -> None:
        body = system_two
        _meet_body(self, system_one, body, body.length * body.director_collection[2, :, 0], body.radius)


class SphereContact(ea.RodSphereContact):
    """A rod on a sphere."""

    def apply_contact(self, system_one: Any, system_two: Any, time: Any = 0.0) -> None:
        _meet_body(self, system_one, system_two, np.zeros(3), system_two.radius)


class RimContact(ea.CylinderPlaneContact):
    """A cylinder on a plane, in contact at three points of either rim: the lowest one and those at 120 degrees."""

    def apply_contact(self, system_one: Any, system_two: Any, time: Any = 0.0) -> None:
        body, n = system_one, system_two.normal
        axis, spin = body.director_collection[2, :, 0], _spin(body, 0)
        down = -n + (n @ axis) * axis
        down /= np.linalg.norm(down)
        for end, turn in itertools.product((0.5, -0.5), (0.0, 2.0 * np.pi / 3.0, -2.0 * np.pi / 3.0)):
            spoke = np.cos(turn) * down + np.sin(turn) * np.cross(axis, down)
            arm = end * body.length * axis + body.radius * spoke
            point, force = body.position_collection + arm[:, None], np.zeros((3, 1))
            velocity = body.velocity_collection + np.cross(spin, arm)[:, None]
            _calculate_contact_forces_cylinder_plane(
                system_two.origin, n, 0.0, self.k, self.nu, 0.0, point, velocity, force
            )
            if force[:, 0] @ n > 0.0:
                body.external_forces += force
                body.external_torques[:, 0] += body.director_collection[:, :, 0] @ np.cross(arm, force[:, 0])


class PairContact(ea.RodRodContact):
    """A rod on another rod."""

    def apply_contact(self, system_one: Any, system_two: Any, time: Any = 0.0) -> None:
        for i in range(system_one.n_elems):
            for j in range(system_two.n_elems):
                _meet(system_one, i, system_two, j, self.k, self.nu)


class SelfContact(ea.RodSelfContact):
    """A rod on itself."""

    def apply_contact(self, system_one: Any, system_two: Any, time: Any = 0.0) -> None:
        rod = system_one
        x = rod.position_collection
        radius = _rest_radii(rod)
        middle, reach = 0.5 * (x[:, 1:] + x[:, :-1]), radius + 0.5 * rod.lengths
        for i in range(rod.n_elems):
            skip = int(1 + np.ceil(0.8 * np.pi * radius[i] / rod.lengths[i]))
            near = np.linalg.norm(middle - middle[:, i : i + 1], axis=0) < reach + reach[i]
            for j in np.flatnonzero(near[: max(i - skip + 1, 0)]):
                _meet(rod, j, rod, i, self.k, self.nu)


def _meet(one: Any, i: int, two: Any, j: int, k: float, nu: float) -> None:
    """Add the forces between an element of one rod and an element of another."""
    first, second = _element(one, i), _element(two, j)
    between = first[0] + 0.5 * first[1] - second[0] - 0.5 * second[1]
    if np.linalg.norm(between) > 0.5 * (one.lengths[i] + two.lengths[j]) + first[2] + second[2]:
        return
    met = _overlap(*first, *second, CENTRING * second[2] ** 2)
    if met is None:
        return
    g, n, s, t = met
    u = _axis_velocity(one, i, s) - _axis_velocity(two, j, t)
    f = max(k * g + nu * u @ n, 0.0) * n
    _load(one, i, s, -f)
    _load(two, j, t, f)


def _meet_body(law: Any, rod: Any, body: Any, edge: Array, radius: float) -> None:
    """Add the forces between the elements of a rod and a body, an axis swept by a ball."""
    centre, spin = body.position_collection[:, 0], _spin(body, 0)
    start, longest = centre - 0.5 * edge, float(np.linalg.norm(edge))
    for k in range(rod.n_elems):
        a, e, r = _element(rod, k)
        if np.linalg.norm(a + 0.5 * e - centre) > 0.5 * (longest + rod.lengths[k]) + r + radius:
            continue
        met = _overlap(a, e, r, start, edge, radius, 0.0)
        if met is None:
            continue
        g, n, s, _ = met
        arm = (r - 0.5 * g) * n
        body_arm = a + s * e + arm - centre
        u = _axis_velocity(rod, k, s) + np.cross(_spin(rod, k), arm)
        u = u - body.velocity_collection[:, 0] - np.cross(spin, body_arm)
        N = max(law.k * g + law.nu * u @ n, 0.0)
        slip = u - (u @ n) / (n @ n) * n
        most = law.friction_coefficient * N
        rub = min(law.velocity_damping_coefficient, most / np.linalg.norm(slip)) * slip if slip.any() else 0.0 * slip
        f = N * n + rub
        _load(rod, k, s, -f)
        rod.external_torques[:, k] -= rod.director_collection[:, :, k] @ np.cross(arm, rub)
        body.external_forces[:, 0] += f
        body.external_torques[:, 0] += body.director_collection[:, :, 0] @ np.cross(body_arm, f)


def _rest_radii(rod: Any) -> Array:
    return np.sqrt(rod.volume / (np.pi * rod.rest_lengths))


def _element(rod: Any, k: int) -> tuple[Array, Array, float]:
    """Return the start, edge and rest radius of an element."""
    return rod.position_collection[:, k].copy(), rod.lengths[k] * rod.tangents[:, k], float(_rest_radii(rod)[k])


def _overlap(
    a: Array, e: Array, r1: float, b: Array, f: Array, r2: float, c2: float
) -> tuple[float, Array, float, float] | None:
    """Return the overlap of two segments, the normal n and the closest points, if they overlap.

    Closest points are the best of those inside and on the four edges of [0, 1] x [0, 1].
    """
    c1, between = CENTRING * r1**2, b - a

    def squared(s: float, t: float) -> float:
        towards = between + t * f - s * e
        return float(towards @ towards + c1 * (s - 0.5) ** 2 + c2 * (t - 0.5) ** 2)

    ee, ff, ef = e @ e + c1, f @ f + c2, e @ f
    on_e, on_f = between @ e + 0.5 * c1, between @ f - 0.5 * c2
    places = [(s, float(np.clip((s * ef - on_f) / ff, 0.0, 1.0)) if ff > 0.0 else 0.0) for s in (0.0, 1.0)]
    places += [(float(np.clip((t * ef + on_e) / ee, 0.0, 1.0)), t) for t in (0.0, 1.0)]
    if ff > 0.0:
        s, t = np.linalg.solve([[ee, -ef], [-ef, ff]], [on_e, -on_f])
        places += [(float(s), float(t))] if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0 else []
    s, t = min(places, key=lambda place: squared(*place))
    d = np.sqrt(squared(s, t))
    return (r1 + r2 - d, (between + t * f - s * e) / d, s, t) if d < r1 + r2 else None


def _spin(system: Any, k: int) -> Array:
    return system.director_collection[:, :, k].T @ system.omega_collection[:, k]


def _axis_velocity(rod: Any, k: int, s: float) -> Array:
    v = rod.velocity_collection
    return (1.0 - s) * v[:, k] + s * v[:, k + 1]


def _load(rod: Any, k: int, s: float, f: Array) -> None:
    """Add a force at the point s of an element."""
    rod.external_forces[:, k] += (1.0 - s) * f
    rod.external_forces[:, k + 1] += s * f


def _law(contact: Contact, *, friction: bool) -> dict[str, float]:
    if not friction:
        return {"k": contact.stiffness, "nu": contact.damping}
    return {
        "k": contact.stiffness,
        "nu": contact.damping,
        "friction_coefficient": contact.friction,
        "velocity_damping_coefficient": contact.slip_damping,
    }


def _body(cylinder: Cylinder, corrected: bool) -> ea.Cylinder:
    Q, volume = cylinder.directors, np.pi * cylinder.radius**2 * cylinder.length
    body = ea.Cylinder(np.array(cylinder.start), Q[2], Q[0], cylinder.length, cylinder.radius, cylinder.mass / volume)
    if corrected:
        body.mass_second_moment_of_inertia[:] = np.diag(cylinder.inertia)[..., None]
        body.inv_mass_second_moment_of_inertia[:] = np.diag(1.0 / cylinder.inertia)[..., None]
    return body


def _rod(rod: Rod) -> ea.CosseratRod:
    first, last = rod.position[:, 0], rod.position[:, -1]
    length = float(np.linalg.norm(last - first))
    return ea.CosseratRod.straight_rod(
        rod.n_elements,
        first.copy(),
        (last - first) / length,
        rod.directors[0, :, 0].copy(),
        length,
        rod.radius.copy(),
        rod.density,
        youngs_modulus=rod.youngs_modulus,
        shear_modulus=rod.shear_modulus,
        position=rod.position.copy(),
        directors=rod.directors.copy(),
        rest_kappa=rod.rest_kappa.copy(),
        rest_sigma=rod.rest_sigma.copy(),
    )


def both(
    rods: Sequence[Rod], dt: float, *, couple: Array | None = None, corrected: bool = True, **loads: Any
) -> tuple[Model, State, Control, Twin]:
    """Return our scene at rest and its twin; the first rod's muscles hold ``couple`` [N m], (3, n - 1)."""
    model, twin = build_model(rods, **loads), Twin(rods, dt=dt, corrected=corrected, **loads)
    state, control = at_rest(model, rods, cylinders=loads.get("cylinders", ()))
    if couple is not None:
        first = int(model.first_slot[0])
        control.couple[0, :, first : first + couple.shape[1]] = couple
        twin.hold(0, couple, rods[0].bend_stiffness)
    return model, state, control, twin


def motions(model: Model, state: State) -> list[tuple[Array, Array, Array, Array]]:
    """Return views of our motion, in the form of `Twin.motions`."""
    bodies = [
        (
            state.body_x[0, b][:, None],
            state.body_v[0, b][:, None],
            state.body_Q[0, b][:, :, None],
            state.body_w[0, b][:, None],
        )
        for b in range(model.cylinders.mass.size)
    ]
    return [*(motion(model, state, rod=r) for r in range(model.n_elements.size)), *bodies]


def distance(model: Model, state: State, twin: Twin) -> float:
    """Return the largest difference of positions [m]."""
    return max(
        float(np.abs(ours[0] - theirs[0]).max())
        for ours, theirs in zip(motions(model, state), twin.motions, strict=True)
    )


def worst_step(
    rods: Sequence[Rod], dt: float, n_states: int, *, couple: Array | None = None, **loads: Any
) -> tuple[float, int]:
    """Return the largest error of one step from random states, and the number of states with contact.

    Errors of v and w are relative to their largest change, or to a tenth of the largest over all states if
    that is larger; those of x and Q are absolute.
    """
    model, state, control, twin = both(rods, dt, couple=couple, **loads)
    rng = np.random.default_rng(0)
    differences, changes, n_touching = [], [], 0
    for number in range(n_states):
        # sliding (partly, if the slip tolerance is large) or sticking
        speed = (1.0, 1e-9)[number % 2]
        for r, rod in enumerate(rods):
            disturb(rod, model, state, rng, speed=speed, number=r)
        for b, cylinder in enumerate(loads.get("cylinders", ())):
            disturb_body(cylinder, state, rng, number=b)
        state.time[0] = time = rng.uniform(0.0, 3.0)
        before = [tuple(a.copy() for a in each) for each in motions(model, state)]
        twin.set_state(before, time)
        advance(model, state, control, 0, 1, dt, 1)
        twin.advance(1)
        n_touching += bool((state.body_touch + state.rod_touch).any())
        differences.append(_largest(motions(model, state), twin.motions))
        changes.append(_largest(twin.motions, before))
    change = np.maximum(changes, 0.1 * np.max(changes, axis=0))
    change[:, :, (0, 2)] = 1.0
    return float((differences / change).max()), n_touching


def _largest(these: Sequence[tuple[Array, ...]], those: Sequence[tuple[Array, ...]]) -> Array:
    """Return the largest differences of x, v, Q and w of each rod and body, (rods and bodies, 4)."""
    return np.array(
        [
            [np.abs(a - b).max() for a, b in zip(this, that, strict=True)]
            for this, that in zip(these, those, strict=True)
        ]
    )
