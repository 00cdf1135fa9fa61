"""Each feature of the library against PyElastica 1.0.0: the same script, run by both."""

import importlib
import warnings
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest

import elastica_gym.cosserat as ours
from tests.engine.scenes import loop, rotations

theirs = pytest.importorskip("elastica", reason="pip install 'elastica-gym[bench]'")
oracle = pytest.importorskip("tests.engine.oracle", reason="pip install 'elastica-gym[bench]'")

DT = 1e-5
N = 12
X, Y, Z = np.eye(3)
QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def make_rod(lib, n=N, start=(0.0, 0.0, 0.0), direction=Z, normal=Y, length=0.3, radius=0.01, **options):
    return lib.CosseratRod.straight_rod(
        n,
        np.array(start),
        np.array(direction),
        np.array(normal),
        length,
        radius,
        1000.0,
        youngs_modulus=1e5,
        shear_modulus=4e4,
        **options,
    )


def shake(rod, seed=0):
    """Set a rod in motion and bend it."""
    rng = np.random.default_rng(seed)
    rod.velocity_collection[:] += 0.05 * rng.standard_normal(rod.velocity_collection.shape)
    rod.omega_collection[:] += 2.0 * rng.standard_normal(rod.omega_collection.shape)


def simulator(lib):
    class Simulator(
        lib.BaseSystemCollection, lib.Constraints, lib.Forcing, lib.Connections, lib.Damping, lib.Contact, lib.CallBacks
    ):
        pass

    return Simulator()


def run(lib, scene, n_steps=1000, stepper="PositionVerlet"):
    sim = simulator(lib)
    systems = scene(lib, sim)
    sim.finalize()
    # after finalize, which would damp the velocities once in PyElastica
    for seed, system in enumerate(systems):
        shake(system, seed)
    lib.integrate(getattr(lib, stepper)(), sim, n_steps * DT, n_steps, progress_bar=False)
    return systems


# constraints


def one_end_fixed(lib, sim):
    rod = make_rod(lib)
    sim.append(rod)
    sim.constrain(rod).using(lib.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    return [rod]


def fixed(lib, sim):
    rod = make_rod(lib)
    sim.append(rod)
    sim.constrain(rod).using(lib.FixedConstraint, constrained_position_idx=(0, 5, -1), constrained_director_idx=(2, -1))
    return [rod]


def general(lib, sim):
    rod = make_rod(lib)
    sim.append(rod)
    sim.constrain(rod).using(
        lib.GeneralConstraint,
        constrained_position_idx=(0, -1),
        constrained_director_idx=(0, 3),
        translational_constraint_selector=np.array([True, False, True]),
        rotational_constraint_selector=np.array([True, True, False]),
    )
    return [rod]


def helical(lib, sim):
    rod = make_rod(lib)
    sim.append(rod)
    sim.constrain(rod).using(
        lib.HelicalBucklingBC,
        constrained_position_idx=(0, -1),
        constrained_director_idx=(0, -1),
        twisting_time=600 * DT,
        slack=0.001,
        number_of_rotations=0.05,
    )
    return [rod]


def free(lib, sim):
    rod = make_rod(lib)
    sim.append(rod)
    sim.constrain(rod).using(lib.FreeBC)
    return [rod]


# loads


def loaded(cls, *args, **kwargs):
    def scene(lib, sim):
        rod = make_rod(lib)
        sim.append(rod)
        sim.add_forcing_to(rod).using(getattr(lib, cls), *args, **kwargs)
        return [rod]

    return scene


def muscles(with_spline):
    def scene(lib, sim):
        rod = make_rod(lib)
        sim.append(rod)
        sim.add_forcing_to(rod).using(
            lib.MuscleTorques,
            base_length=0.3,
            b_coeff=np.array([1e-3, 2e-3, 1e-3, 3e-3]),
            period=0.02,
            wave_number=4.0,
            phase_shift=0.3,
            direction=np.array([0.0, 0.6, 0.8]),
            rest_lengths=rod.rest_lengths,
            ramp_up_time=0.005,
            with_spline=with_spline,
        )
        return [rod]

    return scene


# joints


def joined(cls, *args, **kwargs):
    def scene(lib, sim):
        rods = [make_rod(lib), make_rod(lib, start=(0.001, 0.0, 0.3), n=8)]
        for rod in rods:
            sim.append(rod)
        sim.connect(rods[0], rods[1], first_connect_idx=-1, second_connect_idx=0).using(
            getattr(lib, cls), *args, **kwargs
        )
        return rods

    return scene


def side_by_side(lib, sim):
    """One joint per pair of elements: PyElastica uses the norm over all pairs of a joint as their distance."""
    joints = importlib.import_module(f"{lib.__name__}.experimental.connection_contact_joint.parallel_connection")

    class Mended(joints.SurfaceJointSideBySide):
        """PyElastica's cannot be made: it passes arguments to a base without any."""

        def __init__(self, **options):
            vars(self).update(options)

    rods = [make_rod(lib), make_rod(lib, start=(0.0205, 0.0, 0.0), n=10)]
    for rod in rods:
        sim.append(rod)
    one, two, offset = joints.get_connection_vector_straight_straight_rod(*rods, (1, 9), (1, 9))
    for j in range(8):
        sim.connect(rods[0], rods[1], first_connect_idx=np.array([1 + j]), second_connect_idx=np.array([1 + j])).using(
            Mended if lib is theirs else joints.SurfaceJointSideBySide,
            k=np.array([50.0]),
            nu=np.array([0.01]),
            k_repulsive=np.array([1e4]),
            rod_one_direction_vec_in_material_frame=one[:, j : j + 1].copy(),
            rod_two_direction_vec_in_material_frame=two[:, j : j + 1].copy(),
            offset_btw_rods=offset[j : j + 1],
        )
    return rods


def off_axis(cls, **kwargs):
    def scene(lib, sim):
        path = f"{lib.__name__}.experimental.connection_contact_joint.generic_system_type_connection"
        rods = [make_rod(lib), make_rod(lib, start=(0.02, 0.0, 0.3), n=8)]
        for rod in rods:
            sim.append(rod)
        sim.connect(rods[0], rods[1], first_connect_idx=-1, second_connect_idx=0).using(
            getattr(importlib.import_module(path), cls),
            point_system_one=np.array([0.01, 0.0, 0.002]),
            point_system_two=np.array([-0.01, 0.001, 0.0]),
            **kwargs,
        )
        return rods

    return scene


# dampers


def damped(cls, **kwargs):
    def scene(lib, sim):
        rod = make_rod(lib)
        sim.append(rod)
        sim.dampen(rod).using(getattr(lib, cls), **kwargs)
        return [rod]

    return scene


def constrained_and_damped(lib, sim):
    rod = one_end_fixed(lib, sim)[0]
    sim.dampen(rod).using(lib.AnalyticalLinearDamper, uniform_damping_constant=3.0, time_step=DT)
    sim.dampen(rod).using(lib.LaplaceDissipationFilter, filter_order=4)
    return [rod]


# material


def tapered(lib, sim):
    rod = make_rod(lib, radius=np.linspace(0.012, 0.005, N))
    rod.shear_matrix[:] *= 0.5
    rod.bend_matrix[2, 2] *= 3.0
    rod.rest_kappa[0] = 2.0
    rod.rest_sigma[2] = 0.01
    sim.append(rod)
    return [rod]


SCENES = {
    "free": free,
    "one end fixed": one_end_fixed,
    "fixed": fixed,
    "general": general,
    "helical": helical,
    "gravity": loaded("GravityForces", np.array([0.1, -9.8, 2.0])),
    "endpoint": loaded("EndpointForces", 0.01 * X, np.array([0.0, 0.02, -0.01]), ramp_up_time=0.006),
    "sinusoidal": loaded("EndpointForcesSinusoidal", 0.01, 0.02, 0.005, Z, Y),
    "uniform force": loaded("UniformForces", 0.05, Y),
    "uniform torque": loaded("UniformTorques", 1e-3, X),
    "muscles": muscles(True),
    "muscles without spline": muscles(False),
    "slender body": loaded("SlenderBodyTheory", 0.3),
    "free joint": joined("FreeJoint", k=50.0, nu=0.01),
    "hinge": joined("HingeJoint", k=50.0, nu=0.01, kt=0.02, normal_direction=np.array([1.0, 0.5, 0.0])),
    "fixed joint": joined("FixedJoint", k=50.0, nu=0.01, kt=0.01, nut=1e-5),
    "fixed joint at rest turned": joined("FixedJoint", k=50.0, nu=0.0, kt=0.01, rest_rotation_matrix=QUARTER),
    "side by side": side_by_side,
    "off axis, free": off_axis("GenericSystemTypeFreeJoint", k=50.0, nu=0.01),
    "off axis, fixed": off_axis("GenericSystemTypeFixedJoint", k=50.0, nu=0.01, kt=0.01, nut=1e-5),
    "uniform damper": damped("AnalyticalLinearDamper", uniform_damping_constant=5.0, time_step=DT),
    "physical damper": damped(
        "AnalyticalLinearDamper", translational_damping_constant=0.02, rotational_damping_constant=1e-6, time_step=DT
    ),
    "deprecated damper": damped("AnalyticalLinearDamper", damping_constant=0.1, time_step=DT),
    "laplace filter": damped("LaplaceDissipationFilter", filter_order=3),
    "constrained and damped": constrained_and_damped,
    "tapered": tapered,
}
"""Functions of a library and a simulator that return the systems to compare"""


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES.keys())
def test_trajectory(scene):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        expected, found = run(theirs, scene), run(ours, scene)
    for a, b in zip(found, expected, strict=True):
        assert np.abs(b.position_collection).max() < 10.0
        assert np.abs(a.position_collection - b.position_collection).max() < 1e-9
        assert np.abs(a.director_collection - b.director_collection).max() < 1e-7
    assert np.abs(expected[0].velocity_collection).max() > 0.0


def test_trajectory_by_pefrl():
    """For a rod without loads and dampers, which act more than once per step in PyElastica."""
    (expected,), (found,) = (run(lib, tapered, stepper="PEFRL") for lib in (theirs, ours))
    assert np.abs(found.position_collection - expected.position_collection).max() < 1e-9


@pytest.mark.parametrize("cls", ["MyCallBack", "ExportCallBack"])
def test_callbacks_record_the_same(cls, tmp_path):
    noted = []
    for lib in (theirs, ours):
        sim, folder, history = simulator(lib), tmp_path / lib.__name__, defaultdict(list)
        rod = one_end_fixed(lib, sim)[0]
        options = (
            dict(callback_params=history)
            if cls == "MyCallBack"
            else dict(filename="rod", directory=str(folder), method="npz", file_save_interval=1000)
        )
        sim.collect_diagnostics(rod).using(getattr(lib, cls), step_skip=7, **options)
        sim.finalize()
        shake(rod)
        lib.integrate(lib.PositionVerlet(), sim, 100 * DT, 100, progress_bar=False)
        if cls == "ExportCallBack":
            sim.close()
            (path,) = folder.glob("*.npz")
            history = dict(np.load(path))
        noted.append({name: np.array(values) for name, values in history.items()})
    expected, found = noted
    assert expected["step"].tolist() == list(range(0, 100, 7))
    assert found.keys() >= expected.keys()
    for name, values in expected.items():
        assert np.abs(found[name] - values).max() < 1e-9 * max(1.0, np.abs(values).max()), name


def test_attributes_agree():
    """Attributes computed when read agree with those that PyElastica stores."""
    rods = []
    for lib in (theirs, ours):
        sim = simulator(lib)
        rod = make_rod(lib, radius=np.linspace(0.012, 0.005, N))
        sim.append(rod)
        sim.finalize()
        shake(rod)
        lib.integrate(lib.PositionVerlet(), sim, 300 * DT, 300, progress_bar=False)
        rods.append(rod)
    a, b = rods
    # PyElastica's are half a step old: update them
    a.compute_internal_forces_and_torques(0.0)
    for name in (
        "lengths",
        "tangents",
        "radius",
        "dilatation",
        "voronoi_dilatation",
        "sigma",
        "kappa",
        "internal_stress",
        "internal_couple",
        "internal_forces",
        "internal_torques",
        "dilatation_rate",
        "mass",
        "volume",
        "density",
        "rest_lengths",
        "rest_voronoi_lengths",
        "shear_matrix",
        "bend_matrix",
        "mass_second_moment_of_inertia",
        "inv_mass_second_moment_of_inertia",
    ):
        expected, found = getattr(a, name), getattr(b, name)
        assert found.shape == expected.shape, name
        assert np.abs(found - expected).max() <= 1e-7 * max(np.abs(expected).max(), 1e-12), name
    for name in (
        "translational_energy",
        "rotational_energy",
        "bending_energy",
        "shear_energy",
        "position_center_of_mass",
        "velocity_center_of_mass",
    ):
        method = f"compute_{name}"
        assert np.allclose(getattr(b, method)(), getattr(a, method)(), rtol=1e-7, atol=1e-15), name


# rigid bodies


def make_cylinder(lib):
    body = lib.Cylinder(np.array([0.0, 0.01, 0.31]), Z, Y, 0.2, 0.03, 800.0)
    # PyElastica omits the length in the inertia
    inertia = ours.Cylinder(np.zeros(3), Z, Y, 0.2, 0.03, 800.0).mass_second_moment_of_inertia
    body.mass_second_moment_of_inertia[:] = inertia
    if lib is theirs:
        body.inv_mass_second_moment_of_inertia[..., 0] = np.linalg.inv(inertia[..., 0])
    return body


def tumbling(lib, sim):
    body, ball = make_cylinder(lib), lib.Sphere(np.array([1.0, 0.0, 0.0]), 0.05, 500.0)
    rod = make_rod(lib)
    for system in (body, ball, rod):
        sim.append(system)
    sim.add_forcing_to(body).using(lib.GravityForces, np.array([0.1, -9.8, 2.0]))
    sim.add_forcing_to(body).using(lib.UniformTorques, 0.02, X)
    sim.add_forcing_to(ball).using(lib.EndpointForces, 0.3 * Y, np.zeros(3), ramp_up_time=1e-3)
    sim.add_forcing_to(body).using(lib.EndpointForces, 0.02 * X, np.zeros(3), ramp_up_time=0.002)
    return [body, ball, rod]


def rod_on_body(cls, **kwargs):
    def scene(lib, sim):
        rod, body = make_rod(lib), make_cylinder(lib)
        sim.append(rod)
        sim.append(body)
        sim.connect(rod, body, first_connect_idx=-1, second_connect_idx=0).using(getattr(lib, cls), **kwargs)
        return [rod, body]

    return scene


def body_on_rod(cls, **kwargs):
    def scene(lib, sim):
        rod, body, ball = make_rod(lib), make_cylinder(lib), lib.Sphere(np.array([0.0, 0.07, 0.31]), 0.03, 500.0)
        for system in (rod, body, ball):
            sim.append(system)
        for first, second, index in ((body, rod, -1), (ball, body, 0)):
            sim.connect(first, second, first_connect_idx=0, second_connect_idx=index).using(getattr(lib, cls), **kwargs)
        return [rod, body, ball]

    return scene


def damped_body(lib, sim):
    systems = rod_on_body("FreeJoint", k=50.0, nu=0.01)(lib, sim)
    sim.dampen(systems[1]).using(lib.AnalyticalLinearDamper, uniform_damping_constant=7.0, time_step=DT)
    return systems


def held_body(lib, sim):
    rod, body = rod_on_body("FixedJoint", k=50.0, nu=0.01, kt=0.01)(lib, sim)
    sim.constrain(body).using(lib.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    return [rod, body]


BODIES = {
    "tumbling": tumbling,
    "rod on body, free": rod_on_body("FreeJoint", k=50.0, nu=0.01),
    "rod on body, fixed": rod_on_body("FixedJoint", k=50.0, nu=0.01, kt=0.01, nut=1e-5),
    "held body": held_body,
    "rod on body, hinge": rod_on_body("HingeJoint", k=50.0, nu=0.01, kt=0.02, normal_direction=X),
    "bodies, hinge": body_on_rod("HingeJoint", k=50.0, nu=0.01, kt=0.02, normal_direction=X),
    "bodies, fixed": body_on_rod("FixedJoint", k=50.0, nu=0.01, kt=0.01, nut=1e-5),
    "damped body": damped_body,
}


@pytest.mark.parametrize("scene", BODIES.values(), ids=BODIES.keys())
def test_bodies(scene):
    test_trajectory(scene)


# planes and contact: whole steps from random states, since friction and contact amplify rounding

MU = np.array([0.3, 0.4, 0.5])
GROUND = np.array([0.0, 1.0, 0.0])


def on_plane(friction, tolerance=1e-8, is_load=False):
    def scene(lib, sim, touches):
        rod = make_rod(lib, start=(0.0, 0.01, 0.0))
        sim.append(rod)
        sim.add_forcing_to(rod).using(lib.GravityForces, np.array([0.1, -9.8, 2.0]))
        origin, law = np.array([0.0, 1e-5, 0.0]), dict(k=10.0, nu=1e-3)
        if friction:
            law |= dict(slip_velocity_tol=tolerance, static_mu_array=2.0 * MU, kinetic_mu_array=MU)
        # before 1.0, planes were loads
        if touches and is_load and lib is ours:
            plane = lib.AnisotropicFrictionalPlane if friction else lib.InteractionPlane
            sim.add_forcing_to(rod).using(plane, plane_origin=origin[:, None], plane_normal=GROUND, **law)
        elif touches:
            sim.append(lib.Plane(origin, GROUND))
            contact = lib.RodPlaneContactWithAnisotropicFriction if friction else lib.RodPlaneContact
            sim.detect_contact_between(rod, sim[-1]).using(contact, **law)
        return [rod]

    return scene


def corrected(lib, name):
    """Return a contact class, PyElastica's corrected by docs/differences.md."""
    own = {
        "RodRodContact": oracle.PairContact,
        "RodSelfContact": oracle.SelfContact,
        "RodCylinderContact": oracle.CylinderContact,
        "RodSphereContact": oracle.SphereContact,
        "CylinderPlaneContact": oracle.RimContact,
    }
    return own[name] if lib is theirs else getattr(lib, name)


def touching(name, make_systems, friction=False):
    """Return a scene of two systems in contact, or of one in self contact, which can be switched off."""

    def scene(lib, sim, touches):
        systems = make_systems(lib)
        for system in systems:
            sim.append(system)
        law = dict(k=500.0, nu=0.5)
        if friction:
            law |= dict(friction_coefficient=0.4, velocity_damping_coefficient=3.0)
        if touches:
            sim.detect_contact_between(systems[0], systems[-1]).using(corrected(lib, name), **law)
        return [system for system in systems if not isinstance(system, lib.Plane)]

    return scene


def crossing(lib):
    thick = dict(length=0.5, radius=0.025)
    return [
        make_rod(lib, n=12, start=(-0.25, 0.0, 0.0), direction=X, **thick),
        make_rod(lib, n=10, start=(-0.1, 0.047, -0.25), direction=Z, normal=X, **thick),
    ]


def looped(lib):
    shape = loop(40, size=0.3, gap=0.047, density=1000.0, youngs_modulus=1e5, shear_modulus=4e4, radius=0.025)
    length = float(shape.rest_length.sum())
    return [
        make_rod(
            lib,
            n=40,
            start=shape.position[:, 0],
            direction=shape.directors[2, :, 0],
            normal=shape.directors[0, :, 0],
            length=length,
            radius=0.025,
            position=shape.position.copy(),
            directors=shape.directors.copy(),
        )
    ]


def rod_and(make_body):
    return lambda lib: [make_rod(lib, start=(-0.15, 0.0, 0.31), direction=X), make_body(lib)]


def make_ball(lib):
    return lib.Sphere(np.array([0.0, 0.058, 0.31]), 0.05, 500.0)


def upright(lib):
    """A tilted cylinder next to a rod."""
    body = make_cylinder(lib)
    body.position_collection[:] = np.array([[0.02], [0.037], [0.31]])
    return body


def leaning(lib):
    body = make_cylinder(lib)
    body.position_collection[1] = 0.029
    return [body, lib.Plane(np.zeros(3), np.array([0.0, 1.0, 0.0]))]


CONTACTS = {
    "plane": on_plane(False),
    "plane, sliding": on_plane(True),
    "plane, sticking": on_plane(True, 0.1),
    "plane as a load": on_plane(False, is_load=True),
    "plane as a load, sliding": on_plane(True, is_load=True),
    "rod and rod": touching("RodRodContact", crossing),
    "rod and itself": touching("RodSelfContact", looped),
    "rod and cylinder": touching("RodCylinderContact", rod_and(upright)),
    "rod rubs cylinder": touching("RodCylinderContact", rod_and(upright), friction=True),
    "rod and sphere": touching("RodSphereContact", rod_and(make_ball)),
    "rod rubs sphere": touching("RodSphereContact", rod_and(make_ball), friction=True),
    "cylinder and plane": touching("CylinderPlaneContact", leaning),
}
"""Functions of a library, a simulator and whether there is contact that return the systems to compare"""


def motion(system):
    return (system.position_collection, system.velocity_collection, system.director_collection, system.omega_collection)


def disturbed(rest, rng, speed):
    """Disturb a state at rest: nodes by 1 mm, directors by 0.05 rad, velocities by 0.1 m/s and 2 rad/s."""
    x, v, Q, w = rest
    turns = rotations(0.05 * rng.standard_normal((Q.shape[2], 3)))
    return (
        x + 1e-3 * rng.standard_normal(x.shape),
        speed * 0.1 * rng.standard_normal(v.shape),
        np.einsum("kij,jlk->ilk", turns, Q),
        speed * 2.0 * rng.standard_normal(w.shape),
    )


def prepared(lib, scene, touches=True):
    """Return a function that sets a state, takes a step and returns the new state."""
    sim = simulator(lib)
    systems = scene(lib, sim, touches)
    sim.finalize()
    stepper = lib.PositionVerlet()

    def step(states):
        for system, state in zip(systems, states, strict=True):
            for array, values in zip(motion(system), state, strict=True):
                array[:] = values
        stepper.step(sim, np.float64(0.0), np.float64(DT))
        return [motion(system) for system in systems]

    return [[array.copy() for array in motion(system)] for system in systems], step


@pytest.mark.parametrize("scene", CONTACTS.values(), ids=CONTACTS.keys())
def test_whole_step_from_a_thousand_states(scene):
    """Errors of v and w relative to their largest change, or to a tenth of the largest of all; of x and Q absolute.

    Changes of a body's spin below 1e-4 rad/s are rounding: a spring pushes a ball through its centre.
    """
    rest, ours_step = prepared(ours, scene)
    (_, theirs_step), (_, alone_step) = prepared(theirs, scene), prepared(ours, scene, touches=False)
    rng = np.random.default_rng(0)
    differences, changes, n_touching = [], [], 0
    for number in range(1000):
        # sliding or sticking
        states = [disturbed(each, rng, (1.0, 1e-9)[number % 2]) for each in rest]
        found, expected, alone = ours_step(states), theirs_step(states), alone_step(states)
        n_touching += any((a[1] != b[1]).any() for a, b in zip(found, alone, strict=True))
        differences.append(largest(found, expected))
        changes.append(largest(found, states))
    change = np.maximum(changes, 0.1 * np.max(changes, axis=0))
    change[:, :, 3] = np.maximum(change[:, :, 3], 1e-4)
    change[:, :, (0, 2)] = 1.0
    assert float((differences / change).max()) < 1e-11
    assert n_touching > 900


def largest(these, those):
    """Return the largest differences of x, v, Q and w of each system, (systems, 4)."""
    return np.array(
        [
            [np.abs(a - b).max() for a, b in zip(this, that, strict=True)]
            for this, that in zip(these, those, strict=True)
        ]
    )


# arrays changed between two runs, and features called by hand


def changing(declare, second=None):
    """Return a scene of one rod or two in line, with a feature that uses the changed array."""

    def scene(lib, sim, array):
        rods = [make_rod(lib), make_rod(lib, start=(0.001, 0.0, 0.3), n=8)]
        for rod in rods:
            sim.append(rod)
        declare(lib, sim, rods, array)
        return rods

    return scene


def law(name, *before, after=(), **kwargs):
    return changing(
        lambda lib, sim, rods, array: sim.add_forcing_to(rods[0]).using(
            getattr(lib, name), *before, array, *after, **kwargs
        )
    )


def joint(name, argument, **kwargs):
    return changing(
        lambda lib, sim, rods, array: sim.connect(rods[0], rods[1], -1, 0).using(
            getattr(lib, name), k=50.0, nu=0.01, kt=0.01, **{argument: array}, **kwargs
        )
    )


def muscle(lib, sim, rods, array):
    sim.add_forcing_to(rods[0]).using(
        lib.MuscleTorques,
        base_length=0.3,
        b_coeff=np.array([1e-3, 2e-3, 1e-3, 3e-3]),
        period=0.02,
        wave_number=4.0,
        phase_shift=0.3,
        direction=array,
        rest_lengths=rods[0].rest_lengths,
        ramp_up_time=0.001,
        with_spline=True,
    )


def floor(lib, sim, rods, array):
    sim.append(lib.Plane(array, Y))
    sim.detect_contact_between(rods[0], sim[2]).using(lib.RodPlaneContact, k=10.0, nu=0.0)


def moved_floor(lib, sim, rods, array):
    """The attribute is set to another array, instead of changing the same one."""
    floor(lib, sim, rods, np.array([0.0, -0.1, 0.0]))
    array.moves = lambda: setattr(sim[2], "origin", np.array([[0.0], [-0.001], [0.0]]))


class Mover(np.ndarray):
    moves = None


ARRAYS = {
    "gravity": (law("GravityForces"), np.array([0.1, -9.8, 2.0])),
    "start force": (law("EndpointForces", after=(0.01 * X, 1e-4)), 0.02 * Y),
    "end force": (law("EndpointForces", 0.01 * X, ramp_up_time=1e-4), 0.02 * Y),
    "tangent": (law("EndpointForcesSinusoidal", 0.01, 0.02, 1e-4, after=(Y,)), Z),
    "normal": (law("EndpointForcesSinusoidal", 0.01, 0.02, 1e-4, Z), Y),
    "direction of a force": (law("UniformForces", 0.05), Y),
    "direction of a torque": (law("UniformTorques", 1e-3), X),
    "muscles": (changing(muscle), np.array([0.0, 0.6, 0.8])),
    "hinge": (joint("HingeJoint", "normal_direction"), X),
    "rotation": (joint("FixedJoint", "rest_rotation_matrix"), np.eye(3)),
    "plane": (changing(floor), np.array([0.0, -0.0101, 0.0])),
    "attribute of a plane": (changing(moved_floor), np.zeros(3)),
}
"""Scenes and their arrays"""


@pytest.mark.parametrize(("scene", "given"), ARRAYS.values(), ids=ARRAYS.keys())
def test_changes_of_arrays_between_runs_take_effect_as_in_pyelastica(scene, given):
    ends = []
    for lib in (theirs, ours):
        sim, array = simulator(lib), given.copy().view(Mover)
        rods = scene(lib, sim, array)
        sim.finalize()
        for n in range(2):
            lib.integrate(lib.PositionVerlet(), sim, 100 * DT, 100, n * 100 * DT, progress_bar=False)
            array[...] = array @ QUARTER.T if array.ndim == 2 else 0.9 * array + 0.001 * np.arange(3)
            if array.moves is not None:
                array.moves()
        ends.append(np.concatenate([rod.velocity_collection for rod in rods], axis=1))
    assert np.abs(ends[0]).max() > 1e-7
    assert np.abs(ends[0] - ends[1]).max() < 1e-9 * max(1.0, np.abs(ends[0]).max())


BY_HAND = {
    "gravity": ("GravityForces", (np.array([0.1, -9.8, 2.0]),), {}),
    "uniform force": ("UniformForces", (0.05, Y), {}),
    "endpoint": ("EndpointForces", (0.01 * X, 0.02 * Y, 2e-3), {}),
    "uniform torque": ("UniformTorques", (1e-3, X), {}),
    "sinusoidal": ("EndpointForcesSinusoidal", (0.01, 0.02, 5e-4, Z, Y), {}),
    "slender body": ("SlenderBodyTheory", (0.3,), {}),
    "free joint": ("FreeJoint", (50.0, 0.01), {}),
    "hinge": ("HingeJoint", (50.0, 0.01, 0.02, X), {}),
    "fixed joint": ("FixedJoint", (50.0, 0.01, 0.01, 1e-5), {}),
}


@pytest.mark.parametrize(("name", "args", "kwargs"), BY_HAND.values(), ids=BY_HAND.keys())
def test_loads_by_hand(name, args, kwargs):
    found = []
    for lib in (theirs, ours):
        sim = simulator(lib)
        rods = [make_rod(lib), make_rod(lib, start=(0.001, 0.0, 0.3), n=8)]
        for rod in rods:
            sim.append(rod)
        sim.finalize()
        for seed, rod in enumerate(rods):
            shake(rod, seed)
        feature = getattr(lib, name)(*args, **kwargs)
        ends = (rods[0], -1, rods[1], 0) if "Joint" in name else (rods[0],)
        feature.apply_forces(*ends, time=np.float64(1e-3))
        feature.apply_torques(*ends, time=np.float64(1e-3))
        found.append(np.concatenate([a.ravel() for rod in rods for a in (rod.external_forces, rod.external_torques)]))
    assert np.abs(found[0]).max() > 1e-5
    assert np.abs(found[0] - found[1]).max() < 1e-12 * max(1.0, np.abs(found[0]).max())


HANDED = {
    "plane": ("RodPlaneContact", dict(k=10.0, nu=1e-3)),
    "plane, sliding": (
        "RodPlaneContactWithAnisotropicFriction",
        dict(k=10.0, nu=1e-3, slip_velocity_tol=1e-2, static_mu_array=2.0 * MU, kinetic_mu_array=MU),
    ),
    "rod and rod": ("RodRodContact", dict(k=500.0, nu=0.5)),
    "rod and itself": ("RodSelfContact", dict(k=500.0, nu=0.5)),
    "rod and cylinder": ("RodCylinderContact", dict(k=500.0, nu=0.5)),
    "rod and sphere": ("RodSphereContact", dict(k=500.0, nu=0.5)),
    "cylinder and plane": ("CylinderPlaneContact", dict(k=500.0, nu=0.5)),
}
TOUCHING = {
    "RodRodContact": crossing,
    "RodSelfContact": looped,
    "RodCylinderContact": rod_and(upright),
    "RodSphereContact": rod_and(make_ball),
    "CylinderPlaneContact": leaning,
}


def over_plane(lib):
    return [make_rod(lib, start=(0.0, 0.00995, 0.0)), lib.Plane(np.zeros(3), Y)]


@pytest.mark.parametrize(("name", "law"), HANDED.values(), ids=HANDED.keys())
def test_contact_by_hand(name, law):
    """After another load, which planes balance."""
    found = []
    for lib in (theirs, ours):
        sim = simulator(lib)
        systems = TOUCHING.get(name, over_plane)(lib)
        movers = [system for system in systems if not isinstance(system, lib.Plane)]
        for system in systems:
            sim.append(system)
        sim.finalize()
        for seed, system in enumerate(movers):
            shake(system, seed)
            system.external_forces[1] -= 0.1
            if lib is theirs and hasattr(system, "compute_internal_forces_and_torques"):
                system.compute_internal_forces_and_torques(0.0)
        before = [each.external_forces.copy() for each in movers]
        contact = corrected(lib, name) if name in TOUCHING else getattr(lib, name)
        contact(**law).apply_contact(systems[0], systems[-1])
        found.append(
            np.concatenate([a.ravel() for each in movers for a in (each.external_forces, each.external_torques)])
        )
        assert any(np.abs(each.external_forces - a).max() > 1e-4 for each, a in zip(movers, before, strict=True))
    assert np.abs(found[0] - found[1]).max() < 1e-10 * np.abs(found[0]).max()


# rings


@pytest.fixture(autouse=True)
def straight_rods_need_no_constraints():
    """Undo a side effect of rings in PyElastica: the list of modules that rods need is a class attribute."""
    yield
    theirs.CosseratRod.REQUISITE_MODULES.clear()


def ring(lib, sim):
    rod = lib.CosseratRod.ring_rod(
        16, np.array([0.1, 0.0, 0.0]), Z, Y, 0.5, 0.01, 1000.0, youngs_modulus=1e5, shear_modulus=4e4
    )
    rod.rest_kappa[1] = 1.0
    sim.append(rod)
    sim.add_forcing_to(rod).using(lib.GravityForces, np.array([0.1, -9.8, 2.0]))
    sim.add_forcing_to(rod).using(lib.UniformTorques, 1e-3, X)
    sim.constrain(rod).using(lib.FixedConstraint, constrained_position_idx=(3,))
    return [rod]


def damped_ring(lib, sim):
    rods = [*ring(lib, sim), make_rod(lib)]
    sim.append(rods[1])
    sim.connect(rods[0], rods[1], 4, 0).using(lib.FixedJoint, k=50.0, nu=0.01, kt=0.01)
    # at higher orders, PyElastica's has a seam
    sim.dampen(rods[0]).using(lib.LaplaceDissipationFilter, filter_order=1)
    sim.dampen(rods[0]).using(lib.AnalyticalLinearDamper, uniform_damping_constant=2.0, time_step=DT)
    return rods


def oval(lib, n=16, **options):
    """A ring on an ellipse of 0.2 m by 0.1 m, with our node masses."""
    angle = 2.0 * np.pi * np.arange(n) / n
    nodes = np.stack([0.1 * np.cos(angle), np.zeros(n), 0.05 * np.sin(angle)])
    edges = np.roll(nodes, -1, axis=1) - nodes
    tangents = edges / np.linalg.norm(edges, axis=0)
    up = np.repeat(Y[:, None], n, axis=1)
    rod = lib.CosseratRod.ring_rod(
        n,
        np.zeros(3),
        Z,
        Y,
        0.5,
        0.01,
        1000.0,
        youngs_modulus=1e5,
        shear_modulus=4e4,
        position=nodes,
        directors=np.stack([up, np.cross(tangents, up, axis=0), tangents]),
        **options,
    )
    half = 0.5 * rod.density * rod.volume
    rod.mass[:] = half + np.roll(half, 1)
    return rod


def ring_at_rest(lib, sim):
    rods = [
        lib.CosseratRod.ring_rod(16, np.array([2.0, 0.0, 0.0]), Z, Y, 0.5, 0.01, 1000.0, youngs_modulus=1e5),
        oval(lib),
    ]
    for rod in rods:
        sim.append(rod)
    return rods


def bent(lib, sim):
    """A rod through nodes on an arc, straight at rest."""
    angle = np.linspace(0.0, 1.0, N + 1)
    nodes = 0.3 * np.stack([np.zeros(N + 1), 1.0 - np.cos(angle), np.sin(angle)])
    tangents = np.diff(nodes, axis=1)
    tangents /= np.linalg.norm(tangents, axis=0)
    d1 = np.repeat(X[:, None], N, axis=1)
    rod = make_rod(lib, normal=X, position=nodes, directors=np.stack([d1, np.cross(tangents, d1, axis=0), tangents]))
    sim.append(rod)
    return [rod]


RINGS = {"loaded": ring, "joined and damped": damped_ring, "at rest as built": ring_at_rest, "bent, not a ring": bent}


@pytest.mark.parametrize("scene", RINGS.values(), ids=RINGS.keys())
def test_ring(scene):
    test_trajectory(scene)


def test_the_rest_strain_of_a_ring_is_that_at_finalize():
    """Unless a rest curvature is given, also later; open rods through given nodes straighten."""
    sim = simulator(ours)
    rods = ring_at_rest(ours, sim)
    rods.append(oval(ours, rest_kappa=np.full((3, 16), 1e-3)))
    sim.append(rods[2])
    rods += bent(ours, sim)
    sim.finalize()
    energies = [rod.compute_bending_energy() for rod in rods]
    assert max(energies[:2]) < 1e-25 < 1e-4 < min(energies[2:])
    shape = rods[1].position_collection.copy()
    ours.integrate(ours.PositionVerlet(), sim, 2000 * DT, 2000, progress_bar=False)
    assert np.abs(rods[1].position_collection - shape).max() < 1e-12
    rods[0].rest_kappa[:] = 0.0
    ours.integrate(ours.PositionVerlet(), sim, 2000 * DT, 2000, progress_bar=False)
    assert rods[0].compute_bending_energy() > 1e-4


def test_nodes_of_a_ring_have_half_the_mass_of_each_adjacent_element():
    """PyElastica's have all of the next element's, which shifts the centre of mass by half an element."""
    density = np.linspace(500.0, 1500.0, 16)
    rods = [
        lib.CosseratRod.ring_rod(16, np.zeros(3), Z, Y, 0.5, 0.01, density, youngs_modulus=1e5, shear_modulus=4e4)
        for lib in (ours, theirs)
    ]
    mass = density * rods[0].volume
    assert np.allclose(rods[0].mass, 0.5 * (mass + np.roll(mass, 1)), rtol=1e-14)
    assert np.allclose(rods[1].mass, mass, rtol=1e-14)
    middles = 0.5 * (rods[0].position_collection + np.roll(rods[0].position_collection, -1, axis=1))
    assert np.allclose(rods[0].compute_position_center_of_mass(), (mass * middles).sum(axis=1) / mass.sum())


class Untouched(ours.NoContact):
    def __init__(self, k, nu):
        pass


def test_joined_and_touching_rods(monkeypatch):
    """The scene of the benchmark, with PyElastica's contact corrected."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "scripts"))
    import many_rods

    ends = []
    for lib, contact in ((ours, None), (theirs, oracle.PairContact), (ours, Untouched)):
        sim, rods = many_rods.rows(lib, 4, contact)
        sim.finalize()
        many_rods.shake(rods)
        lib.integrate(lib.PositionVerlet(), sim, 100 * DT, 100, progress_bar=False)
        ends.append(np.stack([rod.position_collection for rod in rods]))
    assert np.abs(ends[0] - ends[1]).max() < 1e-9
    assert np.abs(ends[0] - ends[2]).max() > 1e-5
