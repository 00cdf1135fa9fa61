"""The stable time step with joints, contacts, planes and drag: above it there is a warning and the run is unstable."""

import warnings

import numpy as np
import pytest

import elastica_gym.cosserat as ea
from elastica_gym.bodies.octopus import octopus
from elastica_gym.bodies.snake import snake
from elastica_gym.engine import Rod, build_model
from elastica_gym.engine.stability import require_stable_model
from elastica_gym.engine.surroundings import Contact, Cylinder, Plane

X, Y, Z = np.eye(3)


class Simulator(
    ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Connections, ea.CallBacks, ea.Damping, ea.Contact
):
    pass


def make_rod(start=(0.0, 0.0, 0.0), direction=Z, normal=Y, n=8, **options):
    """A rod so soft that it does not limit the time step."""
    given = dict(youngs_modulus=1e2, shear_modulus=4e1)
    return ea.CosseratRod.straight_rod(n, start, direction, normal, 0.4, 0.02, 1000.0, **{**given, **options})


def joined(cls, **law):
    def declare(sim):
        rods = make_rod(), make_rod((0.0, 0.0, 0.4))
        for rod in rods:
            sim.append(rod)
        sim.connect(*rods, -1, 0).using(cls, **law)
        return rods

    return declare


def body_joined(sim):
    rod, ball = make_rod(), ea.Sphere(np.array([0.0, 0.0, 0.4]), 0.05, 500.0)
    for system in (rod, ball):
        sim.append(system)
    sim.connect(rod, ball, -1, 0).using(ea.FreeJoint, k=1e6, nu=0.0)
    return rod, ball


def lying(k, nu):
    def declare(sim):
        rod = make_rod((0.0, 0.02, 0.0))
        for system in (rod, ea.Plane(np.zeros(3), Y)):
            sim.append(system)
        sim.add_forcing_to(rod).using(ea.GravityForces)
        sim.detect_contact_between(rod, sim[1]).using(ea.RodPlaneContact, k=k, nu=nu)
        return (rod,)

    return declare


def dragged(sim):
    rod = make_rod()
    sim.append(rod)
    sim.dampen(rod).using(ea.RayleighDissipation, damping_constant=1e4)
    return (rod,)


def viscous(sim):
    rod = make_rod(nu=1e3, nu_for_torques=0.0)
    sim.append(rod)
    return (rod,)


def spinning(sim):
    rod = make_rod(nu=0.0, nu_for_torques=10.0)
    sim.append(rod)
    return (rod,)


SCENES = {
    "spring": (joined(ea.FreeJoint, k=1e6, nu=0.0), "joint of CosseratRod 0 and CosseratRod 1"),
    "damper": (joined(ea.FreeJoint, k=0.0, nu=1e4), "joint of CosseratRod 0 and CosseratRod 1"),
    "torque": (joined(ea.FixedJoint, k=1.0, nu=0.0, kt=1e4), "torque of a joint"),
    "damping of a torque": (joined(ea.FixedJoint, k=1.0, nu=0.0, kt=0.0, nut=10.0), "torque of a joint"),
    "body": (body_joined, "joint of CosseratRod 0 and Sphere 1"),
    "plane": (lying(1e6, 0.0), "CosseratRod 0 with a plane"),
    "damping of a plane": (lying(1.0, 1e4), "CosseratRod 0 with a plane"),
    "drag": (dragged, "RayleighDissipation on CosseratRod 0"),
    "viscosity": (viscous, "viscosity of CosseratRod 0"),
    "viscosity of spin": (spinning, "viscosity of CosseratRod 0"),
}
"""The declaration, and its name in the warning"""


def largest_speed(declare, part):
    """Return the largest speed after a start at 1 mm/s and 10 mrad/s, at a fraction of the stable time step."""
    sim = Simulator()
    systems = declare(sim)
    sim.finalize()
    bound, rng = ea.stable_time_step(sim), np.random.default_rng(0)
    assert bound < 0.2 * min(ea.stable_time_step(rod) for rod in systems if isinstance(rod, ea.CosseratRod))
    for system in systems:
        system.velocity_collection[:] = 1e-3 * rng.standard_normal(system.velocity_collection.shape)
        system.omega_collection[:] = 1e-2 * rng.standard_normal(system.omega_collection.shape)
    ea.integrate(ea.PositionVerlet(), sim, 300 * part * bound, 300, progress_bar=False)
    speeds = [np.abs(each).max() for s in systems for each in (s.velocity_collection, s.omega_collection)]
    return max(speeds)


@pytest.mark.parametrize(("declare", "culprit"), SCENES.values(), ids=SCENES.keys())
def test_the_stable_time_step_of_a_simulator(declare, culprit):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert largest_speed(declare, 0.85) < 1.0
    with pytest.warns(RuntimeWarning, match=f"largest stable one of .*{culprit}"):
        # a plane does not pull: a rod that rebounds from it returns more slowly than it would oscillate
        assert not largest_speed(declare, 2.0 if "plane" in culprit else 1.15) < 5.0


def pressed(cls, make, law):
    sim, systems = Simulator(), make()
    for system in systems:
        sim.append(system)
    sim.detect_contact_between(systems[0], systems[-1]).using(cls, **law)
    sim.finalize()
    return sim


def parallel():
    return make_rod(), make_rod((0.039, 0.0, 0.0))


def beside():
    return make_rod(), ea.Cylinder(np.array([0.049, 0.0, 0.1]), Z, Y, 0.2, 0.03, 800.0)


CONTACTS = {
    "rods": (ea.RodRodContact, parallel, dict(k=1e6, nu=0.0), "CosseratRod 0 with CosseratRod 1"),
    "itself": (ea.RodSelfContact, lambda: (make_rod(),), dict(k=1e6, nu=0.0), "CosseratRod 0 with itself"),
    "cylinder": (ea.RodCylinderContact, beside, dict(k=1e6, nu=0.0), "CosseratRod 0 with Cylinder 1"),
    "damping": (ea.RodCylinderContact, beside, dict(k=1.0, nu=1e4), "CosseratRod 0 with Cylinder 1"),
    "friction": (
        ea.RodCylinderContact,
        beside,
        dict(k=1.0, nu=0.0, friction_coefficient=0.5, velocity_damping_coefficient=1e4),
        "friction of CosseratRod 0",
    ),
    "cylinder on plane": (
        ea.CylinderPlaneContact,
        lambda: (beside()[1], ea.Plane(np.zeros(3), Y)),
        dict(k=1e8, nu=0.0),
        "Cylinder 0 with a plane",
    ),
}


@pytest.mark.parametrize(("cls", "make", "law", "culprit"), CONTACTS.values(), ids=CONTACTS.keys())
def test_too_stiff_contact_is_named_in_a_warning(cls, make, law, culprit):
    with pytest.warns(RuntimeWarning, match=f"largest stable one of .*{culprit}"):
        ea.integrate(ea.PositionVerlet(), pressed(cls, make, law), 1e-3, 1, progress_bar=False)
    soft = {name: 1e-3 if name in ("k", "nu") else 0.0 for name in law}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ea.integrate(ea.PositionVerlet(), pressed(cls, make, soft), 1e-3, 1, progress_bar=False)


def test_the_warning_at_finalize_includes_joints():
    sim = Simulator()
    rod, _ = joined(ea.FreeJoint, k=1e6, nu=0.0)(sim)
    sim.dampen(rod).using(ea.AnalyticalLinearDamper, uniform_damping_constant=1.0, time_step=1e-3)
    with pytest.warns(RuntimeWarning, match="a joint of CosseratRod 0"):
        sim.finalize()


@pytest.mark.parametrize(
    ("options", "culprit"),
    [
        (dict(planes=[Plane(stiffness=1e9)]), "plane"),
        (dict(planes=[Plane(damping=1e6)]), "plane"),
        (dict(rod_contact=Contact(stiffness=1e9)), "rod 0 with itself"),
        (
            dict(
                cylinders=[
                    Cylinder(
                        start=(1.0, 0.0, 0.0),
                        direction=Y,
                        normal=X,
                        length=0.1,
                        radius=0.1,
                        mass=1.0,
                        rods=Contact(stiffness=1e9),
                        ground_stiffness=1.0,
                    )
                ]
            ),
            "rod 0 with body 0",
        ),
    ],
)
def test_models_of_environments_reject_too_stiff_contacts(options, culprit):
    rod = Rod.straight(
        8,
        start=(0, 0, 0),
        direction=Z,
        normal=Y,
        length=0.4,
        radius=0.02,
        density=1000.0,
        youngs_modulus=1e2,
        shear_modulus=4e1,
    )
    require_stable_model(build_model([rod]), 1e-3)
    with pytest.raises(ValueError, match=f"{culprit} to be stable, not 0.001 s"):
        require_stable_model(build_model([rod], **options), 1e-3)


@pytest.mark.parametrize("make", [snake, octopus])
def test_shipped_bodies_are_stable(make):
    body = make()
    require_stable_model(body.model, body.sim_dt)
