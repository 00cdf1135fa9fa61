"""Properties of every rod: energy, momentum, symmetry under rigid motion, action and reaction."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import elastica_gym.cosserat as ea
from elastica_gym.engine import Rod, advance, at_rest, build_model, stable_time_step
from elastica_gym.engine.model import Array

from .scenes import energy, momenta, motion, rotations

X, Y, Z = np.eye(3)
LENGTH = 0.5
few = settings(max_examples=15)


class Shape(NamedTuple):
    """Parameters of a rod and its motion."""

    n: int
    """Number of elements"""
    taper: float
    """Radius at the end over radius at the start"""
    slenderness: float
    """Radius over element length at the start"""
    young: float
    """Y [Pa]"""
    ratio: float
    """G/Y"""
    density: float
    """[kg/m^3]"""
    speed: float
    """Speed of nodes over the speed of sound, which is also the size of the resulting strains"""
    seed: int
    """Seed of its curve and velocities"""


shapes = st.builds(
    Shape,
    n=st.integers(3, 24),
    taper=st.floats(0.3, 1.0),
    slenderness=st.floats(0.1, 1.0),
    young=st.sampled_from([1e4, 1e6, 1e8]),
    ratio=st.floats(0.33, 1.0),
    density=st.floats(300.0, 3000.0),
    speed=st.floats(1e-6, 1e-3),
    seed=st.integers(0, 2**32 - 1),
)


def described(shape: Shape, is_planar: bool = False) -> Rod:
    """Return a rod at rest along a random curve around +z, in space or in the yz-plane."""
    rng = np.random.default_rng(shape.seed)
    a, b = np.cumsum(rng.uniform(-0.3, 0.3, (2, shape.n)), axis=1) * [[not is_planar], [1.0]]
    a, b = np.tanh(a), np.tanh(b)
    edges = LENGTH / shape.n * np.stack([np.sin(a), np.cos(a) * np.sin(b), np.cos(a) * np.cos(b)])
    radius = shape.slenderness * LENGTH / shape.n * np.linspace(1.0, shape.taper, shape.n)
    rod = Rod.through(
        np.cumsum(np.concatenate([np.zeros((3, 1)), edges], axis=1), axis=1),
        normal=X,
        radius=radius,
        density=shape.density,
        youngs_modulus=shape.young,
        shear_modulus=shape.ratio * shape.young,
    )
    return replace(rod, rest_kappa=rod.curvature)


def documented(rod: Rod, **options: float) -> ea.CosseratRod:
    """Return the same rod in the library."""
    return ea.CosseratRod.straight_rod(
        rod.n_elements,
        rod.position[:, 0],
        Z,
        X,
        LENGTH,
        rod.radius,
        rod.density,
        youngs_modulus=rod.youngs_modulus,
        shear_modulus=rod.shear_modulus,
        position=rod.position,
        directors=rod.directors,
        rest_kappa=rod.rest_kappa,
        **options,
    )


def velocities(shape: Shape, is_planar: bool = False) -> tuple[Array, Array]:
    """Return velocities of nodes [m/s], (3, n + 1), and angular velocities of elements [rad/s], (3, n)."""
    rng = np.random.default_rng([shape.seed, 1])
    speed = shape.speed * np.sqrt(shape.young / shape.density)
    v = speed * (rng.standard_normal((3, 1)) + rng.standard_normal((3, shape.n + 1)))
    w = speed * shape.n / LENGTH * rng.standard_normal((3, shape.n))
    return v * [[not is_planar], [1.0], [1.0]], w * [[1.0], [not is_planar], [not is_planar]]


def moved(rod: ea.CosseratRod, shape: Shape) -> ea.CosseratRod:
    """Return the rod with the shape's velocities."""
    rod.velocity_collection, rod.omega_collection = velocities(shape)
    return rod


class Simulator(
    ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Connections, ea.CallBacks, ea.Damping, ea.Contact
):
    """A simulator with all features used."""


def simulator(*systems: object) -> Simulator:
    made = Simulator()
    for system in systems:
        made.append(system)
    return made


def run(made: Simulator, dt: float, n_steps: int) -> None:
    ea.integrate(ea.PositionVerlet(), made, n_steps * dt, n_steps, progress_bar=False)


# energy

STEPS = st.sampled_from([0.4, 0.2, 0.1])
"""Fractions of the stable step. Position Verlet conserves energy up to (omega dt)^2/8, with omega dt up to 2"""


def off_by_steps(part: float) -> float:
    return 0.2 * part**2


@few
@given(shape=shapes, part=STEPS, is_balanced=st.booleans())
def test_energy_of_a_free_rod_is_conserved(shape, part, is_balanced):
    rod = described(shape, is_planar=True)
    model = build_model([rod], is_balanced=is_balanced)
    state, control = at_rest(model, [rod])
    motion(model, state)[1][:], motion(model, state)[3][:] = velocities(shape, is_planar=True)
    start = energy(rod, model, state)
    for _ in range(20):
        advance(model, state, control, 0, 1, part * stable_time_step(rod), 100)
        assert energy(rod, model, state) == pytest.approx(start, rel=off_by_steps(part) + shape.speed)


def dampers(rod: ea.CosseratRod, rate: float) -> dict[str, dict[str, float]]:
    """Return arguments of each kind of damper that slow nodes at about a given rate [1/s]."""
    inertia = rod.mass_second_moment_of_inertia[0, 0].mean()
    return {
        "none": {},
        "nu": {},
        "uniform": dict(uniform_damping_constant=rate),
        "deprecated": dict(damping_constant=rate),
        "physical": dict(
            translational_damping_constant=rate * rod.mass.mean(), rotational_damping_constant=rate * inertia
        ),
    }


def pair_in_a_field(shape: Shape, damper: str, is_joint_damped: bool) -> tuple[Simulator, list, Callable]:
    """Return two jointed rods, one clamped, under gravity and an end force, and a function of their energy.

    It returns the total energy with the potentials of the loads, and its scale [J].
    """
    rate = np.sqrt(shape.young / shape.density) / LENGTH
    rod = described(shape)
    nu = rate * rod.density * rod.area.mean() * (damper == "nu")
    rods = [moved(documented(rod, nu=nu, nu_for_torques=0.25 * nu * rod.radius.min() ** 2), shape) for _ in range(2)]
    rods[0].velocity_collection[:, 0] = rods[0].omega_collection[:, 0] = 0.0
    made = simulator(*rods)
    made.constrain(rods[0]).using(ea.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    k = 0.1 * rods[0].shear_matrix[2, 2, -1] * shape.n / LENGTH
    made.connect(*rods, -1, -1).using(ea.FreeJoint, k=k, nu=0.1 * k / rate * is_joint_damped / shape.n)
    strength = shape.speed * rate**2 * LENGTH
    gravity, pull = strength * Y, strength * rods[0].mass.sum() * X
    for rod in rods:
        made.add_forcing_to(rod).using(ea.GravityForces, gravity)
        if kwargs := dampers(rod, rate)[damper]:
            made.dampen(rod).using(ea.AnalyticalLinearDamper, **kwargs)
    made.add_forcing_to(rods[1]).using(ea.EndpointForces, np.zeros(3), pull)
    made.finalize()

    def energies() -> tuple[float, float]:
        own = sum(
            rod.compute_translational_energy()
            + rod.compute_rotational_energy()
            + rod.compute_shear_energy()
            + rod.compute_bending_energy()
            for rod in rods
        )
        gap = rods[0].position_collection[:, -1] - rods[1].position_collection[:, -1]
        work = sum(float(gravity @ (rod.mass * rod.position_collection).sum(axis=1)) for rod in rods)
        work += float(pull @ rods[1].position_collection[:, -1])
        return own + 0.5 * k * float(gap @ gap) - work, own

    return made, rods, energies


@settings(few, max_examples=40)
@given(
    shape=shapes,
    part=STEPS,
    damper=st.sampled_from(["none", "nu", "uniform", "deprecated", "physical"]),
    is_joint_damped=st.booleans(),
)
def test_energy_does_not_grow_without_work(shape, part, damper, is_joint_damped):
    made, rods, energies = pair_in_a_field(shape, damper, is_joint_damped)
    start, size = energies()
    # in space, energy is conserved to second order of the angles between elements
    off = off_by_steps(part) + shape.speed + 2e-3
    for _ in range(20):
        run(made, part * ea.stable_time_step(rods[0]), round(20 / part))
        now, own = energies()
        size = max(size, own)
        assert now < start + off * size
        if damper == "none" and not is_joint_damped:
            assert now > start - off * size
    if damper != "none":
        assert now < start


# momentum


@few
@given(shape=shapes, is_balanced=st.booleans())
def test_momentum_of_a_free_rod_is_conserved(shape, is_balanced):
    rod = described(shape)
    model = build_model([rod], is_balanced=is_balanced)
    state, control = at_rest(model, [rod])
    v, w = velocities(shape)
    motion(model, state)[1][:], motion(model, state)[3][:] = v, w
    before = momenta(rod, model, state)[0]
    advance(model, state, control, 0, 1, 0.5 * stable_time_step(rod), 500)
    assert np.abs(momenta(rod, model, state)[0] - before).max() < 1e-12 * np.abs(rod.nodal_mass * v).sum()


@few
@given(shape=shapes)
def test_angular_momentum_of_a_free_rod_in_a_plane_is_conserved(shape):
    rod = described(shape, is_planar=True)
    model = build_model([rod])
    state, control = at_rest(model, [rod])
    motion(model, state)[1][:], motion(model, state)[3][:] = velocities(shape, is_planar=True)
    before = momenta(rod, model, state)[1][0]
    advance(model, state, control, 0, 1, 0.5 * stable_time_step(rod), 500)
    x, v, _, w = motion(model, state)
    size = (rod.nodal_mass * np.linalg.norm(x, axis=0) * np.linalg.norm(v, axis=0)).sum() + (rod.inertia * abs(w)).sum()
    # spin changes with stretch, which kicks follow to first order of the time step
    assert abs(momenta(rod, model, state)[1][0] - before) < 0.1 * shape.speed * size


@few
@given(shape=shapes, joint=st.sampled_from(["free", "hinge", "fixed"]))
def test_momentum_of_connected_rods_is_conserved(shape, joint):
    rods = [moved(documented(described(shape)), shape), documented(described(shape))]
    made = simulator(*rods)
    connect(made, rods, joint, 0, 0)
    made.finalize()
    before = sum((rod.mass * rod.velocity_collection).sum(axis=1) for rod in rods)
    run(made, 0.5 * ea.stable_time_step(rods[0]), 500)
    after = sum((rod.mass * rod.velocity_collection).sum(axis=1) for rod in rods)
    size = sum(np.abs(rod.mass * rod.velocity_collection).sum() for rod in rods)
    assert np.abs(after - before).max() < 1e-12 * size


# action and reaction


class LoadsCallBack(ea.CallBackBaseClass):
    """Stores the loads on systems of the last step."""

    def __init__(self, kept: dict) -> None:
        self.kept = kept

    def make_callback(self, system: tuple, time: float, current_step: int) -> None:
        self.kept["loads"] = [(each.external_forces.copy(), each.external_torques.copy()) for each in system]


def loads_on(made: Simulator, *systems: object) -> list[tuple[Array, Array]]:
    """Return external forces, lab frame, and torques, material frame, on systems in their current state."""
    kept: dict = {}
    made.collect_diagnostics(...).using(LoadsCallBack, kept)
    made.finalize()
    # a step so short that nothing moves
    run(made, 1e-14, 1)
    return kept["loads"]


def require_balance(systems: tuple, loads: list[tuple[Array, Array]], has_levers: bool) -> None:
    """Require that forces and torques add up to zero, torques with moments of forces if ``has_levers``."""
    forces = np.concatenate([force for force, _ in loads], axis=1)
    torques = np.concatenate(
        [
            np.einsum("jik,jk->ik", each.director_collection, torque)
            for each, (_, torque) in zip(systems, loads, strict=True)
        ],
        axis=1,
    )
    assert np.abs(forces).max() + np.abs(torques).max() > 0.0
    assert np.abs(forces.sum(axis=1)).max() <= 1e-12 * np.abs(forces).sum()
    if has_levers:
        places = np.concatenate([each.position_collection for each in systems], axis=1)
        torques = np.concatenate([torques, np.cross(places, forces, axis=0)], axis=1)
    assert np.abs(torques.sum(axis=1)).max() <= 1e-12 * np.abs(torques).sum()


def connect(made: Simulator, systems: list, joint: str, *indices: int) -> None:
    """Declare a joint about as stiff as the systems it connects."""
    rod = systems[0]
    k, kt = (0.1 * matrix[2, 2, -1] * rod.n_elems / LENGTH for matrix in (rod.shear_matrix, rod.bend_matrix))
    nu = 0.01 * np.sqrt(k * rod.mass.min())
    kind, more = {
        "free": (ea.FreeJoint, {}),
        "hinge": (ea.HingeJoint, dict(kt=kt, normal_direction=X + 0.2 * Y)),
        "fixed": (ea.FixedJoint, dict(kt=kt, nut=1e-3 * kt, rest_rotation_matrix=rotations([[0.1, -0.2, 0.3]])[0])),
    }[joint]
    made.connect(*systems, *indices).using(kind, k=k, nu=nu, **more)


@few
@given(
    shape=shapes,
    joint=st.sampled_from(["free", "hinge", "fixed"]),
    is_body=st.booleans(),
    ends=st.tuples(st.integers(0, 2), st.integers(0, 2)),
)
def test_action_and_reaction_of_joints(shape, joint, is_body, ends):
    rod = moved(documented(described(shape)), shape)
    if is_body:
        other = ea.Cylinder(0.1 * Y, X + 0.5 * Z, Y, 0.2, 0.05, 500.0)
        other.velocity_collection, other.omega_collection = (np.full((3, 1), size) for size in (0.3, 2.0))
        ends = ends[0], 0
    else:
        other = documented(described(shape._replace(seed=shape.seed + 1)))
    made = simulator(rod, other)
    connect(made, [rod, other], joint, *ends)
    require_balance((rod, other), loads_on(made, rod, other), has_levers=False)


def overlapping(shape: Shape, kind: str) -> tuple[ea.CosseratRod, object, type]:
    """Return a rod, a system that overlaps its middle, and the contact class."""
    rod = moved(documented(described(shape)), shape)
    rng = np.random.default_rng([shape.seed, 2])
    middle, r = rod.position_collection[:, shape.n // 2], float(rod.radius.min())
    away = np.cross(rod.tangents[:, shape.n // 2], rng.standard_normal(3))
    point, along = middle + 1.5 * r * away / np.linalg.norm(away), rng.standard_normal(3)
    normal = np.cross(along, rng.standard_normal(3))
    if kind == "sphere":
        return rod, ea.Sphere(point, 2.0 * r, 500.0), ea.RodSphereContact
    if kind == "cylinder":
        return (
            rod,
            ea.Cylinder(point - 3.0 * r * along, along, normal, 8.0 * r * np.linalg.norm(along), r, 500.0),
            ea.RodCylinderContact,
        )
    along *= 0.5 * LENGTH / np.linalg.norm(along)
    other = ea.CosseratRod.straight_rod(
        7, point - along, along, normal, LENGTH, r, shape.density, youngs_modulus=shape.young
    )
    return rod, other, ea.RodRodContact


@settings(few, max_examples=30)
@given(shape=shapes, kind=st.sampled_from(["rod", "cylinder", "sphere"]), friction=st.floats(0.0, 2.0))
def test_action_and_reaction_of_contact(shape, kind, friction):
    rod, other, contact = overlapping(shape, kind)
    made = simulator(rod, other)
    rubbing = {} if kind == "rod" else dict(velocity_damping_coefficient=5.0, friction_coefficient=friction)
    made.detect_contact_between(rod, other).using(contact, k=1e3, nu=1.0, **rubbing)
    require_balance((rod, other), loads_on(made, rod, other), has_levers=True)


# rigid motion


class Frame(NamedTuple):
    """Position and rotation of the whole scene."""

    turn: Array
    """(3, 3)"""
    shift: Array
    """[m], (3,)"""

    def vector(self, value: Array) -> Array:
        return self.turn @ np.asarray(value, dtype=float)

    def point(self, value: Array) -> Array:
        return self.vector(value) + self.shift

    def rod(self, rod: Rod) -> Rod:
        return replace(
            rod,
            position=self.turn @ rod.position + self.shift[:, None],
            directors=np.einsum("ijk,lj->ilk", rod.directors, self.turn),
        )

    def back(self, points: Array) -> Array:
        return self.turn.T @ (points - self.shift[:, None])


def add_loads(made: Simulator, rods: list, at: Frame, features: set[str]) -> None:
    """Add external loads on the rods."""
    first, second = rods
    strength = float(first.shear_matrix[2, 2, -1])
    if "gravity" in features:
        for rod in rods:
            made.add_forcing_to(rod).using(ea.GravityForces, at.vector([0.1, -9.8, 0.5]))
    if "pull" in features:
        forces = at.vector(-1e-3 * strength * Z), at.vector(1e-3 * strength * X)
        made.add_forcing_to(second).using(ea.EndpointForces, *forces)
    if "muscle" in features:
        made.add_forcing_to(first).using(
            ea.MuscleTorques,
            base_length=LENGTH,
            b_coeff=1e-3 * strength * first.radius.min() * np.array([1, 2, 2, 1]),
            period=1e-2,
            wave_number=6.0,
            phase_shift=0.5,
            direction=at.vector([0.2, 0.9, -0.1]),
            rest_lengths=first.rest_lengths,
            with_spline=True,
        )
    if "uniform" in features:
        made.add_forcing_to(second).using(ea.UniformTorques, 1e-4 * strength, at.vector(Y))
    if "fluid" in features:
        made.add_forcing_to(first).using(ea.SlenderBodyTheory, 0.1)
    if "plane" in features:
        made.add_forcing_to(first).using(
            ea.AnisotropicFrictionalPlane,
            k=1e-3 * strength / LENGTH,
            nu=1e-6,
            plane_origin=at.point(np.zeros(3)),
            plane_normal=at.vector(Y),
            slip_velocity_tol=1e-4,
            static_mu_array=np.array([0.2, 0.3, 0.4]),
            kinetic_mu_array=np.array([0.1, 0.15, 0.2]),
        )


def scene(shape: Shape, at: Frame, features: set[str]) -> tuple[Simulator, tuple]:
    """Return two rods in contact at their starts and a body in contact with the first, in a frame."""
    own = [described(shape), described(shape._replace(seed=shape.seed + 1))]
    own[1] = replace(own[1], position=own[1].position + 1.8 * own[0].radius[0] * X[:, None])
    rods = [documented(at.rod(rod)) for rod in own]
    for rod in rods:
        v, rod.omega_collection = velocities(shape)
        rod.velocity_collection = at.turn @ v
    middle, r = own[0].position[:, shape.n // 2], float(own[0].radius.min())
    start = middle - r * np.array([1.8, 0.1, 1.0])
    body = ea.Cylinder(
        at.point(start), at.vector([0.1, 1.0, 0.2]), at.vector([0.0, 0.2, -1.0]), 3.0 * r, r, shape.density
    )
    body.velocity_collection[:, 0] = at.vector([0.1, 0.0, 0.02])
    made = simulator(*rods, body)
    add_loads(made, rods, at, features)
    k = 0.01 * float(rods[0].shear_matrix[2, 2, -1]) * shape.n / LENGTH
    kt = k * r**2
    if "clamp" in features:
        made.constrain(rods[1]).using(ea.OneEndFixedBC, constrained_position_idx=(-1,), constrained_director_idx=(-1,))
    if "hinge" in features:
        made.connect(*rods, 0, 0).using(ea.HingeJoint, k=k, nu=0.0, kt=kt, normal_direction=at.vector([1.0, 0.2, 0.0]))
    if "fixed" in features:
        made.connect(*rods, 0, 0).using(ea.FixedJoint, k=k, nu=0.0, kt=kt, nut=0.0)
    if "rod contact" in features:
        made.detect_contact_between(*rods).using(ea.RodRodContact, k=k, nu=0.0)
    if "body contact" in features:
        made.detect_contact_between(rods[0], body).using(
            ea.RodCylinderContact, k=k, nu=0.0, velocity_damping_coefficient=1e-3, friction_coefficient=0.5
        )
    made.finalize()
    return made, (*rods, body)


FEATURES = [
    "gravity",
    "pull",
    "muscle",
    "uniform",
    "fluid",
    "plane",
    "clamp",
    "hinge",
    "fixed",
    "rod contact",
    "body contact",
]


@settings(few, max_examples=40)
@given(shape=shapes, features=st.sets(st.sampled_from(FEATURES)), seed=st.integers(0, 2**32 - 1))
def test_moving_the_scene_moves_the_motion(shape, features, seed):
    rng, found = np.random.default_rng(seed), []
    elsewhere = Frame(rotations(2.0 * rng.standard_normal((1, 3)))[0], rng.standard_normal(3))
    # friction between sticking and slipping amplifies rounding from step to step
    n_steps = 10 if "plane" in features else 100
    for at in (Frame(np.eye(3), np.zeros(3)), elsewhere):
        made, systems = scene(shape, at, features)
        run(made, 0.5 * min(ea.stable_time_step(rod) for rod in systems[:2]), n_steps)
        places = np.concatenate([at.back(each.position_collection) for each in systems], axis=1)
        found.append((places, np.concatenate([at.turn.T @ each.velocity_collection for each in systems], axis=1)))
    # rounding of positions causes forces, larger for stiffer rods
    for here, there, rel in zip(*found, (1e-11, 1e-8), strict=True):
        assert np.abs(here - there).max() < rel * np.abs(here).max()
