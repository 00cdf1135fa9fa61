"""Contact in the library: it separates overlapping systems, and conserves momentum and angular momentum."""

import numpy as np
import pytest

import elastica_gym.cosserat as ea
from elastica_gym import engine
from elastica_gym.engine import Contact, at_rest, build_model

DT = 2.0**-16
X, Y, Z = np.eye(3)


class Simulator(ea.BaseSystemCollection, ea.Forcing, ea.Connections, ea.Contact):
    pass


def make_rod(start, direction=Z, normal=Y, n=10):
    return ea.CosseratRod.straight_rod(
        n,
        np.array(start),
        np.array(direction),
        np.array(normal),
        0.2,
        0.01,
        1000.0,
        youngs_modulus=1e6,
        shear_modulus=4e5,
    )


def make_cylinder():
    return ea.Cylinder(np.array([-0.1, 0.035, 0.1]), X, Z, 0.2, 0.03, 500.0)


def run(sim, n_steps):
    sim.finalize()
    ea.integrate(ea.PositionVerlet(), sim, n_steps * DT, n_steps, progress_bar=False)


def momenta(*systems):
    """Return momentum and angular momentum about the origin of all systems, (6,)."""
    total = np.zeros(6)
    for system in systems:
        p = np.atleast_1d(system.mass) * system.velocity_collection
        spin = np.einsum("ijk,jk->ik", system.mass_second_moment_of_inertia, system.omega_collection)
        if isinstance(system, ea.CosseratRod):
            spin = spin / system.dilatation
        total[:3] += p.sum(axis=1)
        total[3:] += np.cross(system.position_collection, p, axis=0).sum(axis=1)
        total[3:] += np.einsum("jik,jk->i", system.director_collection, spin)
    return total


# in each, one system moves towards the other
CONTACTS = {
    "rod on rod": (lambda: make_rod((-0.1, 0.018, 0.1), X, Z), ea.RodRodContact, {}),
    "rod on cylinder": (make_cylinder, ea.RodCylinderContact, {}),
    "rod on cylinder, rubbing": (
        make_cylinder,
        ea.RodCylinderContact,
        dict(velocity_damping_coefficient=10.0, friction_coefficient=0.5),
    ),
    "rod on sphere": (lambda: ea.Sphere(np.array([0.0, 0.038, 0.1]), 0.03, 500.0), ea.RodSphereContact, {}),
}


@pytest.mark.parametrize("is_joint", [False, True], ids=["contact", "as in 0.2.x"])
@pytest.mark.parametrize(("make", "cls", "options"), CONTACTS.values(), ids=CONTACTS.keys())
def test_overlapping_systems_separate(make, cls, options, is_joint):
    rod, other, sim = make_rod((0.0, 0.0, 0.0)), make(), Simulator()
    sim.append(rod)
    sim.append(other)
    if is_joint:
        sim.connect(rod, other).using(ea.ExternalContact, k=1e3, nu=0.1, **options)
    else:
        sim.detect_contact_between(rod, other).using(cls, k=1e3, nu=0.1, **options)
    sim.finalize()
    rod.velocity_collection[:] = np.array([[0.05], [0.1], [0.0]])
    before, way = momenta(rod, other), other.position_collection[1].mean()
    ea.integrate(ea.PositionVerlet(), sim, 1000 * DT, 1000, progress_bar=False)
    assert other.position_collection[1].mean() > way + 1e-5
    assert np.allclose(momenta(rod, other)[:3], before[:3], atol=1e-14)
    assert np.allclose(momenta(rod, other)[3:], before[3:], atol=1e-7)


def test_only_declared_pairs_touch():
    rods = [make_rod((0.0, 0.0, 0.0)), make_rod((-0.1, 0.018, 0.1), X, Z), make_rod((-0.1, -0.018, 0.1), X, Z)]
    sim = Simulator()
    for rod in rods:
        sim.append(rod)
    sim.detect_contact_between(rods[0], rods[1]).using(ea.RodRodContact, k=1e3, nu=0.0)
    run(sim, 50)
    assert rods[1].velocity_collection.any()
    assert not rods[2].velocity_collection.any()


def heap(laws):
    """Return crossing rods, with contact between those with a law, and their simulator."""
    rng, rods, sim = np.random.default_rng(0), [], Simulator()
    for _ in range(12):
        direction = rng.standard_normal(3)
        rods.append(
            make_rod(
                0.05 * rng.standard_normal(3) - 0.1 * direction / np.linalg.norm(direction),
                direction,
                np.cross(direction, X + Y),
            )
        )
        sim.append(rods[-1])
    for i, one in enumerate(rods):
        for two in rods[i + 1 :]:
            for law in laws(i):
                sim.detect_contact_between(one, two).using(ea.RodRodContact, **law)
    sim.finalize()
    for rod in rods:
        rod.velocity_collection[:] = 0.5 * rng.standard_normal((3, 11))
    return sim, rods


def nodes_of(rods):
    return np.stack([rod.position_collection for rod in rods])


def advance(sim, n_steps):
    ea.integrate(ea.PositionVerlet(), sim, n_steps * DT, n_steps, progress_bar=False)


def test_a_heap_agrees_with_the_environments():
    """The environments check pairs of elements in another way."""
    law = dict(stiffness=1e3, damping=0.5)
    sim, rods = heap(lambda _: [dict(k=1e3, nu=0.5)])
    model, _ = build_model([rod.as_continuum() for rod in rods], rod_contact=Contact(**law)), None
    state, control = at_rest(model, [rod.as_continuum() for rod in rods])
    state.v[:] = sim.simulation.state.v
    assert np.array_equal(state.x, sim.simulation.state.x)
    before = state.v.copy()
    engine.advance(model, state, control, 0, 1, DT, 40)
    advance(sim, 40)
    assert np.abs(state.v - before).max() > 0.1
    assert np.abs(state.x - sim.simulation.state.x).max() < 1e-12


def test_two_laws_of_a_pair_add_up():
    one, two = heap(lambda _: [dict(k=1e3, nu=0.0)]), heap(lambda _: [dict(k=6e2, nu=0.0), dict(k=4e2, nu=0.0)])
    for sim, _ in (one, two):
        advance(sim, 20)
    assert np.abs(nodes_of(one[1]) - nodes_of(two[1])).max() < 1e-12


@pytest.mark.parametrize("stray", [0.0, 2e-3], ids=["listed at each step", "kept"])
def test_results_do_not_depend_on_the_neighbour_list(stray):
    """Bitwise, with and without room for a list, and for any list lifetime."""

    def laws(i):
        return [dict(k=1e3 + i, nu=0.5)]

    found = []
    for changes in ({}, {"neighbours": np.zeros(0, dtype=np.int64)}, {"stray": stray}):
        sim, rods = heap(laws)
        contacts = sim.simulation.scene.rod_contacts._replace(**changes)
        sim.simulation.scene = sim.simulation.scene._replace(rod_contacts=contacts)
        advance(sim, 200)
        found.append(nodes_of(rods))
    assert np.array_equal(found[0], found[1])
    assert np.array_equal(found[0], found[2])


def test_a_diverged_run_ends():
    sim, rods = heap(lambda _: [dict(k=1e3, nu=0.5)])
    rods[3].position_collection[1, 4] = np.nan
    rods[7].velocity_collection[0, 2] = 1e300
    advance(sim, 20)
    assert np.isnan(rods[3].position_collection).any()


def test_only_the_declared_rod_touches_a_body():
    rods = [make_rod((0.0, 0.0, 0.0)), make_rod((0.001, 0.0, 0.0))]
    body, sim = make_cylinder(), Simulator()
    for system in (*rods, body):
        sim.append(system)
    sim.detect_contact_between(rods[1], body).using(ea.RodCylinderContact, k=1e3, nu=0.0)
    run(sim, 50)
    assert not rods[0].velocity_collection.any()
    assert rods[1].velocity_collection.any() and body.velocity_collection.any()


def test_rod_touches_itself():
    """A hairpin with overlapping arms opens; without contact it stays."""
    angle = np.linspace(0.0, np.pi, 15)
    arms = np.linspace(0.0, 0.1, 12)[1:]
    y = np.concatenate([np.full(11, 0.009), 0.009 * np.cos(angle), np.full(11, -0.009)])
    z = np.concatenate([-arms[::-1], 0.009 * np.sin(angle), -arms])
    nodes = np.array([np.zeros(y.size), y, z])
    found = []
    for touches in (False, True):
        rod = ea.CosseratRod.straight_rod(
            y.size - 1, nodes[:, 0], Z, X, 0.3, 0.01, 1000.0, youngs_modulus=1e3, shear_modulus=4e2, position=nodes
        )
        rod.rest_kappa[:] = rod.kappa
        sim = Simulator()
        sim.append(rod)
        if touches:
            sim.detect_contact_between(rod, rod).using(ea.RodSelfContact, k=10.0, nu=0.0)
        run(sim, 100)
        found.append(rod.velocity_collection[1, 0])
    assert abs(found[0]) < 1e-9 < 1e-4 < found[1]


def test_cylinder_rests_on_a_plane():
    body, plane, sim = ea.Cylinder(np.zeros(3), Y, X, 0.1, 0.05, 500.0), ea.Plane(np.zeros(3), Y), Simulator()
    sim.append(body)
    sim.append(plane)
    sim.add_forcing_to(body).using(ea.GravityForces)
    sim.detect_contact_between(body, plane).using(ea.CylinderPlaneContact, k=1e4, nu=20.0, friction_coefficient=0.5)
    run(sim, 30_000)
    # three contact points carry it
    depth = body.mass * 9.80665 / (3 * 1e4)
    assert body.position_collection[1, 0] == pytest.approx(0.05 - depth, abs=1e-7)


RING_CONTACTS = {
    "plane": lambda: (ea.RodPlaneContact, ea.Plane(np.zeros(3), Y)),
    "rod": lambda: (ea.RodRodContact, make_rod(X)),
    "rigid body": lambda: (ea.RodCylinderContact, make_cylinder()),
}


@pytest.mark.parametrize("what", RING_CONTACTS)
def test_a_ring_in_contact_raises(what):
    ring, (cls, other), sim = (
        ea.CosseratRod.ring_rod(8, np.zeros(3), Z, Y, 0.5, 0.01, 1000.0, youngs_modulus=1e5),
        RING_CONTACTS[what](),
        Simulator(),
    )
    sim.append(ring)
    sim.append(other)
    sim.detect_contact_between(ring, other).using(cls, k=1.0, nu=0.0)
    with pytest.raises(NotImplementedError, match=f"a ring with a {what} is not supported"):
        sim.finalize()


def test_errors():
    rod, body, plane, sim = make_rod((0.0, 0.0, 0.0)), make_cylinder(), ea.Plane(np.zeros(3), Y), Simulator()
    for system in (rod, body, plane):
        sim.append(system)
    sim.detect_contact_between(rod, plane).using(ea.RodCylinderContact, k=1.0, nu=0.0)
    with pytest.raises(TypeError, match="must be a Cylinder, not a Plane"):
        sim.finalize()
