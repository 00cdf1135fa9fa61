"""Each feature of the documented library beside PyElastica 1.0.0: the same script, run by either."""

import warnings

import numpy as np
import pytest

import elastica_gym.cosserat as ours

theirs = pytest.importorskip("elastica", reason="pip install 'elastica-gym[bench]'")

DT = 1e-5
N = 12
X, Y, Z = np.eye(3)
QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def make_rod(lib, n=N, start=(0.0, 0.0, 0.0), direction=Z, normal=Y, length=0.3, radius=0.01, **options):
    return lib.CosseratRod.straight_rod(
        n, np.array(start), np.array(direction), np.array(normal), length, radius, 1000.0, youngs_modulus=1e5,
        shear_modulus=4e4, **options,
    )  # fmt: skip


def shake(rod, seed=0):
    """Set a rod in motion, and bend it."""
    rng = np.random.default_rng(seed)
    rod.velocity_collection[:] += 0.05 * rng.standard_normal(rod.velocity_collection.shape)
    rod.omega_collection[:] += 2.0 * rng.standard_normal(rod.omega_collection.shape)


def simulator(lib):
    class Simulator(
        lib.BaseSystemCollection, lib.Constraints, lib.Forcing, lib.Connections, lib.Damping, lib.Contact, lib.CallBacks
    ):
        pass

    return Simulator()


def run(lib, scene, n_steps=1000):
    sim = simulator(lib)
    systems = scene(lib, sim)
    sim.finalize()
    # after finalize, where theirs would damp the velocities once
    for seed, system in enumerate(systems):
        shake(system, seed)
    stepper = lib.PositionVerlet()
    lib.integrate(stepper, sim, n_steps * DT, n_steps, progress_bar=False)
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
        lib.GeneralConstraint, constrained_position_idx=(0, -1), constrained_director_idx=(0, 3),
        translational_constraint_selector=np.array([True, False, True]),
        rotational_constraint_selector=np.array([True, True, False]),
    )  # fmt: skip
    return [rod]


def helical(lib, sim):
    rod = make_rod(lib)
    sim.append(rod)
    sim.constrain(rod).using(
        lib.HelicalBucklingBC, constrained_position_idx=(0, -1), constrained_director_idx=(0, -1),
        twisting_time=600 * DT, slack=0.001, number_of_rotations=0.05,
    )  # fmt: skip
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
            lib.MuscleTorques, base_length=0.3, b_coeff=np.array([1e-3, 2e-3, 1e-3, 3e-3]), period=0.02,
            wave_number=4.0, phase_shift=0.3, direction=np.array([0.0, 0.6, 0.8]), rest_lengths=rod.rest_lengths,
            ramp_up_time=0.005, with_spline=with_spline,
        )  # fmt: skip
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
    "free": free, "one end fixed": one_end_fixed, "fixed": fixed, "general": general, "helical": helical,
    "gravity": loaded("GravityForces", np.array([0.1, -9.8, 2.0])),
    "endpoint": loaded("EndpointForces", 0.01 * X, np.array([0.0, 0.02, -0.01]), ramp_up_time=0.006),
    "sinusoidal": loaded("EndpointForcesSinusoidal", 0.01, 0.02, 0.005, Z, Y),
    "uniform force": loaded("UniformForces", 0.05, Y), "uniform torque": loaded("UniformTorques", 1e-3, X),
    "muscles": muscles(True), "muscles without spline": muscles(False),
    "slender body": loaded("SlenderBodyTheory", 0.3),
    "free joint": joined("FreeJoint", k=50.0, nu=0.01),
    "hinge": joined("HingeJoint", k=50.0, nu=0.01, kt=0.02, normal_direction=np.array([1.0, 0.5, 0.0])),
    "fixed joint": joined("FixedJoint", k=50.0, nu=0.01, kt=0.01, nut=1e-5),
    "fixed joint at rest turned": joined("FixedJoint", k=50.0, nu=0.0, kt=0.01, rest_rotation_matrix=QUARTER),
    "uniform damper": damped("AnalyticalLinearDamper", uniform_damping_constant=5.0, time_step=DT),
    "physical damper": damped("AnalyticalLinearDamper", translational_damping_constant=0.02,
                              rotational_damping_constant=1e-6, time_step=DT),
    "deprecated damper": damped("AnalyticalLinearDamper", damping_constant=0.1, time_step=DT),
    "laplace filter": damped("LaplaceDissipationFilter", filter_order=3),
    "constrained and damped": constrained_and_damped, "tapered": tapered,
}  # fmt: skip
"""A function each of a library and a simulator, that returns the systems to compare"""


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


def test_attributes_agree():
    """What is computed when read is what PyElastica stores."""
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
    # theirs are half a step old: bring them up to date
    a.compute_internal_forces_and_torques(0.0)
    for name in ("lengths", "tangents", "radius", "dilatation", "voronoi_dilatation", "sigma", "kappa",
                 "internal_stress", "internal_couple", "internal_forces", "internal_torques", "dilatation_rate", "mass",
                 "volume", "density", "rest_lengths", "rest_voronoi_lengths", "shear_matrix", "bend_matrix",
                 "mass_second_moment_of_inertia", "inv_mass_second_moment_of_inertia"):  # fmt: skip
        expected, found = getattr(a, name), getattr(b, name)
        assert found.shape == expected.shape, name
        assert np.abs(found - expected).max() <= 1e-7 * max(np.abs(expected).max(), 1e-12), name
    for name in ("translational_energy", "rotational_energy", "bending_energy", "shear_energy",
                 "position_center_of_mass", "velocity_center_of_mass"):  # fmt: skip
        method = f"compute_{name}"
        assert np.allclose(getattr(b, method)(), getattr(a, method)(), rtol=1e-7, atol=1e-15), name


# rigid bodies


def make_cylinder(lib):
    body = lib.Cylinder(np.array([0.0, 0.01, 0.31]), Z, Y, 0.2, 0.03, 800.0)
    # the original leaves the length out of the inertia
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


def held_body(lib, sim):
    rod, body = rod_on_body("FixedJoint", k=50.0, nu=0.01, kt=0.01)(lib, sim)
    sim.constrain(body).using(lib.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    return [rod, body]


BODIES = {
    "tumbling": tumbling, "rod on body, free": rod_on_body("FreeJoint", k=50.0, nu=0.01),
    "rod on body, fixed": rod_on_body("FixedJoint", k=50.0, nu=0.01, kt=0.01, nut=1e-5), "held body": held_body,
}  # fmt: skip


@pytest.mark.parametrize("scene", BODIES.values(), ids=BODIES.keys())
def test_bodies(scene):
    test_trajectory(scene)


# planes: a whole step, since friction amplifies rounding

MU = np.array([0.3, 0.4, 0.5])


def on_plane(friction, tolerance=1e-8):
    def scene(lib, sim):
        rod = make_rod(lib, start=(0.0, 0.01, 0.0))
        plane = lib.Plane(np.array([0.0, 1e-5, 0.0]), np.array([0.0, 1.0, 0.0]))
        sim.append(rod)
        sim.append(plane)
        sim.add_forcing_to(rod).using(lib.GravityForces, np.array([0.1, -9.8, 2.0]))
        contact = sim.detect_contact_between(rod, plane)
        if friction:
            contact.using(lib.RodPlaneContactWithAnisotropicFriction, k=10.0, nu=1e-3, slip_velocity_tol=tolerance,
                          static_mu_array=2.0 * MU, kinetic_mu_array=MU)  # fmt: skip
        else:
            contact.using(lib.RodPlaneContact, k=10.0, nu=1e-3)
        return [rod]

    return scene


PLANES = {"response": on_plane(False), "sliding": on_plane(True), "sticking": on_plane(True, 0.1)}


@pytest.mark.parametrize("scene", PLANES.values(), ids=PLANES.keys())
def test_planes(scene):
    (a,), (b,) = run(theirs, scene, 1), run(ours, scene, 1)
    change = np.abs(a.velocity_collection).max()
    assert np.abs(a.velocity_collection - b.velocity_collection).max() < 1e-11 * change
    assert np.abs(a.omega_collection - b.omega_collection).max() < 1e-11 * np.abs(a.omega_collection).max()


# rings


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


def test_ring():
    test_trajectory(ring)
