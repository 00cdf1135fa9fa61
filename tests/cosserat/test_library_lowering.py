"""Lowering of features to rows: followed arrays, the order of constraints, calls by hand, and diverging runs."""

import copy
import pickle
import warnings

import numpy as np
import pytest

import elastica_gym.cosserat as ea
from elastica_gym.cosserat.experimental.connection_contact_joint import parallel_connection as side

DT = 2.0**-17
X, Y, Z = np.eye(3)
MU = np.array([0.3, 0.4, 0.5])
CLAMP = dict(constrained_position_idx=(0,), constrained_director_idx=(0,))


class Simulator(
    ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Connections, ea.CallBacks, ea.Damping, ea.Contact
):
    pass


def make_rod(n=12, start=(0.0, 0.0, 0.0), direction=Z, normal=Y, length=0.3, radius=0.01, **options):
    given = dict(youngs_modulus=1e5, shear_modulus=4e4)
    return ea.CosseratRod.straight_rod(n, start, direction, normal, length, radius, 1000.0, **{**given, **options})


def simulator(*systems):
    sim = Simulator()
    for system in systems:
        sim.append(system)
    return sim


def integrate(sim, n_steps, start=0.0):
    return ea.integrate(ea.PositionVerlet(), sim, n_steps * DT, n_steps, start, progress_bar=False)


def shake(system, seed):
    rng = np.random.default_rng(seed)
    system.velocity_collection[:] = 0.05 * rng.standard_normal(system.velocity_collection.shape)
    system.omega_collection[:] = 2.0 * rng.standard_normal(system.omega_collection.shape)


# the order of constraints


class Carry(ea.ConstraintBase):
    """Moves the first node along X at 1 m/s."""

    def constrain_values(self, system, time):
        system.position_collection[:, 0] = time * X

    def constrain_rates(self, system, time):
        system.velocity_collection[:, 0] = X


@pytest.mark.parametrize("is_own_last", [True, False])
def test_the_constraint_declared_last_wins(is_own_last):
    rod, other = make_rod(), make_rod()
    sim = simulator(rod, other)
    if is_own_last:
        sim.constrain(rod).using(ea.OneEndFixedBC, **CLAMP)
        sim.constrain(rod).using(Carry)
    else:
        sim.constrain(rod).using(Carry)
        sim.constrain(rod).using(ea.OneEndFixedBC, **CLAMP)
        sim.constrain(other).using(ea.OneEndFixedBC, **CLAMP)
    sim.finalize()
    time = integrate(sim, 200)
    assert rod.position_collection[0, 0] == pytest.approx(time if is_own_last else 0.0, abs=1e-12)
    assert rod.velocity_collection[0, 0] == float(is_own_last)
    # systems without an own class before stay in the compiled step
    assert sim.simulation.scene.pins.slot.size == 1


# diverging runs


def test_a_diverging_run_warns_once_of_system_and_step():
    calm, wild = make_rod(), make_rod(start=(1.0, 0.0, 0.0))
    sim = simulator(ea.Plane(np.zeros(3), Y), calm, wild)
    sim.finalize()
    integrate(sim, 100)
    wild.velocity_collection[1, 3] = np.nan
    with pytest.warns(RuntimeWarning, match="CosseratRod 2 are infinite or NaN since step 101;") as caught:
        time = integrate(sim, 100, 100 * DT)
        ea.PositionVerlet().step(sim, time, DT)
    assert len(caught) == 1
    assert np.isfinite(calm.position_collection).all()


class EveryStep(ea.CallBackBaseClass):
    def make_callback(self, system, time, current_step):
        pass


class Kick(ea.NoForces):
    """Applies an infinite force after a given time."""

    def apply_forces(self, system, time=0.0):
        if time > 37 * DT:
            system.external_forces[1, -1] = np.inf


def test_the_first_diverged_step_is_found_within_eight_or_exactly_in_single_steps():
    for number, name in enumerate(("CosseratRod 0", "Sphere 1")):
        sim = simulator(make_rod(), ea.Sphere(np.zeros(3), 0.05, 500.0))
        sim.add_forcing_to(sim[number]).using(Kick)
        sim.finalize()
        with pytest.warns(RuntimeWarning, match=f"{name} are infinite or NaN since a step from 33 to 40;"):
            sim.simulation.advance(ea.PositionVerlet().scheme, DT, 200, 0.0)
            sim.simulation.warn_of_divergence()
        sim = simulator(make_rod(), ea.Sphere(np.zeros(3), 0.05, 500.0))
        sim.add_forcing_to(sim[number]).using(Kick)
        sim.collect_diagnostics(sim[0]).using(EveryStep)
        sim.finalize()
        with pytest.warns(RuntimeWarning, match=f"{name} are infinite or NaN since step 38;"):
            integrate(sim, 200)


# followed arrays


def test_material_written_later_changes_gravity_too():
    rod = make_rod()
    sim = simulator(rod)
    sim.add_forcing_to(rod).using(ea.GravityForces, -9.8 * Y)
    sim.finalize()
    integrate(sim, 1)
    rod.mass[:] *= 2.0
    integrate(sim, 100, DT)
    assert rod.compute_velocity_center_of_mass()[1] == pytest.approx(-9.8 * 101 * DT, rel=1e-12)


def test_dampers_stay_unchanged_when_other_features_change():
    force = np.zeros(3)
    rod = make_rod()
    sim = simulator(rod)
    sim.dampen(rod).using(
        ea.AnalyticalLinearDamper, translational_damping_constant=0.1, rotational_damping_constant=0.0
    )
    sim.add_forcing_to(rod).using(ea.EndpointForces, force, np.zeros(3))
    sim.finalize()
    rates = sim.simulation.scene.decay.node_rate.copy()
    rod.mass[:] *= 2.0
    force[0] = 1.0
    integrate(sim, 1)
    assert np.array_equal(sim.simulation.scene.decay.node_rate, rates)
    assert rod.velocity_collection[0, 0] == pytest.approx(DT / rod.mass[0] * np.exp(-rates.max() * DT), rel=1e-12)


def test_a_plane_moved_between_runs():
    rod, plane = make_rod(start=(0.0, 0.02, 0.0)), ea.Plane(np.zeros(3), Y)
    sim = simulator(rod, plane)
    sim.detect_contact_between(rod, plane).using(ea.RodPlaneContact, k=10.0, nu=0.0)
    sim.finalize()
    integrate(sim, 10)
    assert np.abs(rod.velocity_collection).max() < 1e-15
    plane.origin = 0.015 * Y
    integrate(sim, 10, 10 * DT)
    assert rod.velocity_collection[1].min() > 0.0


# copies


def test_a_finalized_simulator_cannot_be_copied():
    sim = simulator(make_rod())
    twin = copy.deepcopy(sim)
    assert twin.get_system_index(twin[0]) == 0
    twin = pickle.loads(pickle.dumps(sim))
    twin.constrain(twin[0]).using(ea.OneEndFixedBC, **CLAMP)
    twin.finalize()
    sim.finalize()
    for action in (copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="save_state"):
            action(sim)


# calls by hand


def crossing():
    thick = dict(length=0.5, radius=0.025)
    return [
        make_rod(start=(-0.25, 0.0, 0.0), direction=X, **thick),
        make_rod(10, start=(-0.1, 0.047, -0.25), direction=Z, normal=X, **thick),
    ]


def folded():
    """A rod of two overlapping parallel parts joined by an arc."""
    angle = np.linspace(0.0, np.pi, 9)[1:-1]
    run = np.linspace(0.0, 0.4, 16)
    points = [(0.0, each) for each in run]
    points += [(0.0225 * (1.0 - np.cos(a)), 0.4 + 0.0225 * np.sin(a)) for a in angle]
    points += [(0.045, each) for each in run[::-1]]
    nodes = np.array([(x, 0.0, z) for x, z in points]).T
    tangents = np.diff(nodes, axis=1)
    tangents /= np.linalg.norm(tangents, axis=0)
    n = tangents.shape[1]
    up = np.repeat(Y[:, None], n, axis=1)
    return [
        make_rod(n, radius=0.025, position=nodes, directors=np.stack([up, np.cross(tangents, up, axis=0), tangents]))
    ]


def on_plane():
    return [make_rod(start=(0.0, 0.00995, 0.0)), ea.Plane(np.zeros(3), Y)]


def on_cylinder():
    cylinder = ea.Cylinder(np.array([0.02, 0.037, 0.21]), Z, Y, 0.2, 0.03, 800.0)
    return [make_rod(start=(-0.15, 0.0, 0.31), direction=X), cylinder]


def on_sphere():
    return [make_rod(start=(-0.15, 0.0, 0.31), direction=X), ea.Sphere(np.array([0.0, 0.058, 0.31]), 0.05, 500.0)]


def leaning():
    return [ea.Cylinder(np.array([0.0, 0.029, 0.0]), Z, Y, 0.2, 0.03, 800.0), ea.Plane(np.zeros(3), Y)]


def beside():
    return [make_rod(), make_rod(10, start=(0.0205, 0.0, 0.0))]


def in_line():
    return [make_rod(), make_rod(8, start=(0.001, 0.0, 0.3))]


def alone():
    return [make_rod(start=(0.0, 0.00995, 0.0))]


PRESS, RUB = dict(k=500.0, nu=0.5), dict(friction_coefficient=0.4, velocity_damping_coefficient=3.0)
FRICTION = dict(slip_velocity_tol=0.02, static_mu_array=2.0 * MU, kinetic_mu_array=MU)
FLOOR = dict(plane_origin=np.zeros(3), plane_normal=Y)
SPRING = dict(k=50.0, nu=0.01)
BESIDE = dict(
    k=50.0,
    nu=0.01,
    k_repulsive=1e4,
    offset_btw_rods=np.full(8, 5e-4),
    rod_one_direction_vec_in_material_frame=np.repeat(X[:, None], 8, axis=1),
    rod_two_direction_vec_in_material_frame=-np.repeat(X[:, None], 8, axis=1),
)
PAIRS = np.arange(1, 9), np.arange(1, 9)
MUSCLES = dict(
    base_length=0.3,
    b_coeff=np.array([1e-3, 2e-3, 1e-3, 3e-3]),
    period=0.02,
    wave_number=4.0,
    phase_shift=0.3,
    direction=np.array([0.0, 0.6, 0.8]),
    rest_lengths=np.full(12, 0.025),
    ramp_up_time=1e-4,
    with_spline=True,
)

CONTACTS = {
    ea.RodRodContact: (crossing, PRESS),
    ea.RodSelfContact: (folded, PRESS),
    ea.RodCylinderContact: (on_cylinder, {**PRESS, **RUB}),
    ea.RodSphereContact: (on_sphere, {**PRESS, **RUB}),
    ea.CylinderPlaneContact: (leaning, {**PRESS, "friction_coefficient": 0.3}),
    ea.RodPlaneContact: (on_plane, dict(k=10.0, nu=1e-3)),
    ea.RodPlaneContactWithAnisotropicFriction: (on_plane, dict(k=10.0, nu=1e-3, **FRICTION)),
}
LOADS = {
    ea.GravityForces: (np.array([0.1, -9.8, 2.0]),),
    ea.EndpointForces: (0.01 * X, 0.02 * Y, 1e-4),
    ea.EndpointForcesSinusoidal: (0.01, 0.02, 1e-4),
    ea.UniformForces: (0.05, Y),
    ea.UniformTorques: (1e-3, X),
    ea.ReciprocalTension: (),
    ea.SlenderBodyTheory: (0.3,),
    ea.MuscleTorques: MUSCLES,
    ea.InteractionPlane: dict(k=10.0, nu=1e-3, **FLOOR),
    ea.AnisotropicFrictionalPlane: dict(k=10.0, nu=1e-3, **FLOOR, **FRICTION),
}
JOINTS = {
    ea.FreeJoint: (in_line, (-1, 0), SPRING),
    ea.HingeJoint: (in_line, (-1, 0), dict(**SPRING, kt=0.02, normal_direction=np.array([1.0, 0.5, 0.0]))),
    ea.FixedJoint: (in_line, (-1, 0), dict(**SPRING, kt=0.01, nut=1e-5)),
    ea.ExternalContact: (crossing, (None, None), PRESS),
    ea.SelfContact: (folded, (None, None), PRESS),
    side.SurfaceJointSideBySide: (beside, PAIRS, BESIDE),
}
CONSTRAINTS = {
    ea.OneEndFixedBC: CLAMP,
    ea.FixedConstraint: dict(constrained_position_idx=(0, 5), constrained_director_idx=(2,)),
    ea.GeneralConstraint: dict(**CLAMP, translational_constraint_selector=np.array([True, False, True])),
    ea.HelicalBucklingBC: dict(
        constrained_position_idx=(0, -1),
        constrained_director_idx=(0, -1),
        slack=0.001,
        twisting_time=20 * DT,
        number_of_rotations=0.05,
    ),
    ea.FreeBC: {},
}
DAMPERS = {
    ea.AnalyticalLinearDamper: dict(damping_constant=0.1, time_step=DT),
    ea.LaplaceDissipationFilter: dict(filter_order=3),
    ea.RayleighDissipation: dict(damping_constant=0.5),
}


def declare(sim, cls, systems, built):
    """Declare a feature on systems."""
    if cls in CONTACTS:
        sim.detect_contact_between(systems[0], systems[-1]).using(built, **CONTACTS[cls][1])
    elif cls in JOINTS:
        ends = (None, None) if JOINTS[cls][1][0] is None else JOINTS[cls][1]
        sim.connect(systems[0], systems[-1], *ends).using(built, **JOINTS[cls][2])
    elif cls in CONSTRAINTS:
        sim.constrain(systems[0]).using(built, **CONSTRAINTS[cls])
    elif cls in DAMPERS:
        sim.dampen(systems[0]).using(built, **DAMPERS[cls])
    else:
        given = LOADS[cls]
        args, kwargs = ((), given) if isinstance(given, dict) else (given, {})
        sim.add_forcing_to(systems[0]).using(built, *args, **kwargs)


METHODS = {
    "apply_contact": CONTACTS,
    "apply_forces": {**LOADS, **JOINTS},
    "apply_torques": {**LOADS, **JOINTS},
    "constrain_values": CONSTRAINTS,
    "constrain_rates": CONSTRAINTS,
    "dampen_rates": DAMPERS,
}
ALL = [*CONTACTS, *LOADS, *JOINTS, *CONSTRAINTS, *DAMPERS]


def calling_super(cls):
    """Return a subclass whose methods only call those of the built-in class."""

    def through(name):
        return lambda self, *arguments: getattr(cls, name)(self, *arguments)

    return type("Own", (cls,), {name: through(name) for name, classes in METHODS.items() if cls in classes})


@pytest.mark.parametrize("cls", ALL, ids=lambda cls: cls.__name__)
def test_a_feature_acts_by_hand_as_in_the_compiled_step(cls):
    """Compared after 40 steps from a moving start; the feature must change the motion."""
    make = {**CONTACTS, **JOINTS}.get(cls, (alone,))[0]
    found = []
    for built in (cls, calling_super(cls), None):
        systems = make()
        sim = simulator(*systems)
        movers = [system for system in systems if not isinstance(system, ea.Plane)]
        if built is not None:
            declare(sim, cls, systems, built)
        sim.finalize()
        for seed, system in enumerate(movers):
            shake(system, seed)
        sim.constrain_rates(0.0)
        integrate(sim, 40)
        found.append(
            np.concatenate(
                [system.velocity_collection.ravel() for system in movers]
                + [system.omega_collection.ravel() for system in movers]
            )
        )
    compiled, by_hand, without = found
    assert np.isfinite(compiled).all()
    # RayleighDissipation by hand has no effect, as in PyElastica: its loads are cleared before the next step
    if cls is not ea.RayleighDissipation:
        assert np.abs(compiled - by_hand).max() < 1e-11
    assert np.abs(compiled - without).max() > 1e-6 or cls is ea.FreeBC


def test_a_subclass_of_contact_may_add_to_it():
    class Sticky(ea.RodPlaneContact):
        def apply_contact(self, system_one, system_two, time=0.0):
            super().apply_contact(system_one, system_two, time)
            system_one.external_forces[1] -= 0.5

    rod, plane = on_plane()
    Sticky(k=10.0, nu=0.0).apply_contact(rod, plane)
    assert rod.external_forces[1, 5] == pytest.approx(-0.5 + 10.0 * 5e-5, rel=1e-9)
    with pytest.raises(TypeError, match="Plane"):
        Sticky(k=10.0, nu=0.0).apply_contact(rod, rod)


# tolerances


def fall(scale, tolerance=None, attribute=None):
    """Return the nodes over time, divided by the scale, of a rod that falls on a plane.

    Lengths scale with L, moduli and density are constant, so times scale with L.
    """

    class Ground(ea.RodPlaneContact):
        def __init__(self, **law):
            super().__init__(**law)
            if attribute is not None:
                self.surface_tol = attribute * scale

    n, r = 6, 0.1 * scale
    rod = ea.CosseratRod.straight_rod(
        n, np.array([0.0, 1.05, 0.0]) * r, Z, Y, scale, r, 1000.0, youngs_modulus=1e6, shear_modulus=4e5
    )
    rod.position_collection[1] += 0.1 * r * np.linspace(0.0, 1.0, n + 1) ** 2
    sim = simulator(rod, ea.Plane(np.zeros(3), Y))
    # mass scales with L^3, weight with L^2 like a spring's force
    sim.add_forcing_to(rod).using(ea.GravityForces, np.array([0.0, -2e2, 0.0]) / scale)
    sim.detect_contact_between(rod, sim[1]).using(
        Ground, k=3e4 * scale, nu=20.0 * scale**2, surface_tol=None if tolerance is None else tolerance * scale
    )
    sim.finalize()
    states, dt = [], 1e-4 * scale
    for part in range(10):
        ea.integrate(ea.PositionVerlet(), sim, 40 * dt, 40, part * 40 * dt, progress_bar=False)
        states.append(rod.position_collection / scale)
    return np.stack(states)


@pytest.mark.parametrize("how", [dict(tolerance=1e-4), dict(attribute=1e-4), dict()])
def test_the_motion_of_a_falling_rod_scales(how):
    """From 1 m to 10 um or, with the default tolerance, down to where 1e-4 m is a twentieth of the radius."""
    scales = (1.0, 1e-2, 1e-5) if how else (2e-2, 1e-3, 1e-5)
    first, *others = (fall(scale, **how) for scale in scales)
    assert first[0, 1].min() > first[-1, 1].min()
    assert first[:, 1].min() < 0.1
    for other in others:
        assert np.abs(other - first).max() < 1e-9


def test_a_small_rod_falls_on_a_plane():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        nodes = fall(1e-5)
    # at a height of half a radius, the plane does not hold it
    assert nodes[0, 1, -1] - nodes[3, 1, -1] > 1e-4
