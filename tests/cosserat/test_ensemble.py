"""Independent systems run in parallel on the CPUs, with bitwise the same results as in one simulation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import elastica_gym.cosserat as ea
from elastica_gym.cosserat import ensemble
from elastica_gym.cosserat.ensemble import Ensemble, _groups

DT = 2.0**-17
_, Y, Z = np.eye(3)


class Simulator(
    ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Connections, ea.CallBacks, ea.Damping, ea.Contact
):
    pass


class OwnForce(ea.NoForces):
    pass


class Recorder(ea.CallBackBaseClass):
    def __init__(self, every, seen, name):
        super().__init__()
        self.every, self.seen, self.name = every, seen, name

    def make_callback(self, system, time, current_step):
        self.seen.append((self.name, current_step, system.position_collection.copy()))


@pytest.fixture(autouse=True)
def two_cpus(monkeypatch):
    monkeypatch.setattr(ensemble, "available_cpus", lambda: 2)


def make_rod(n, place):
    return ea.CosseratRod.straight_rod(
        n, np.array([place, 0.0, 0.0]), Z, Y, 0.3, 0.01, 1000.0, nu=0.1, youngs_modulus=1e5, shear_modulus=4e4
    )


def scene(*sizes, every=2500):
    """Return a simulator of rods that are each held and pulled, and the list that its callbacks fill."""
    sim, seen = Simulator(), []
    for number, n in enumerate(sizes):
        rod = make_rod(n, float(number))
        sim.append(rod)
        sim.constrain(rod).using(ea.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
        sim.add_forcing_to(rod).using(ea.EndpointForces, np.zeros(3), np.array([0.01 * (number + 1), 0.0, 0.0]), 1e-3)
        sim.dampen(rod).using(ea.AnalyticalLinearDamper, damping_constant=0.1, time_step=DT)
        if every:
            sim.collect_diagnostics(rod).using(Recorder, every, seen, number)
    return sim, seen


def integrate(sim, n_steps, start=0.0):
    return ea.integrate(ea.PositionVerlet(), sim, n_steps * DT, n_steps, start, progress_bar=False)


def moved(sim):
    return [
        array.copy()
        for rod in sim
        for array in (rod.position_collection, rod.director_collection, rod.velocity_collection, rod.omega_collection)
    ]


def test_ensemble_equals_one_simulation_bit_for_bit(monkeypatch):
    apart, seen_apart = scene(40, 17, 33, every=2000)
    apart.finalize()
    assert isinstance(apart.simulation, Ensemble)
    assert sorted(len(part.rods) for part in apart.simulation.parts) == [1, 2]
    monkeypatch.setattr(ensemble, "available_cpus", lambda: 1)
    together, seen_together = scene(40, 17, 33, every=2000)
    together.finalize()
    assert not isinstance(together.simulation, Ensemble)
    # long runs on threads, then one too short for threads
    for n_steps in (5000, 10):
        assert integrate(apart, n_steps) == integrate(together, n_steps)
    for one, two in zip(moved(apart), moved(together), strict=True):
        assert np.array_equal(one, two)
    assert apart.simulation.steps == together.simulation.steps == 5010
    assert [each[:2] for each in seen_apart] == [each[:2] for each in seen_together]
    assert len(seen_apart) > 6
    assert all(np.array_equal(one[2], two[2]) for one, two in zip(seen_apart, seen_together, strict=True))


def test_ensemble_is_saved_and_resumed(tmp_path):
    whole, _ = scene(40, 20)
    whole.finalize()
    integrate(whole, 4000)
    saved, _ = scene(40, 20)
    saved.finalize()
    ea.save_state(saved, tmp_path, integrate(saved, 2500))
    again, _ = scene(40, 20)
    again.finalize()
    assert isinstance(again.simulation, Ensemble)
    integrate(again, 1500, ea.load_state(again, tmp_path))
    for one, two in zip(moved(whole), moved(again), strict=True):
        assert np.array_equal(one, two)


def test_external_loads_act_on_every_part():
    sim, _ = scene(40, 20)
    sim.finalize()
    for rod in sim:
        rod.external_forces[1, :] = 1.0
    ea.PositionVerlet().step(sim, 0.0, DT)
    assert all((rod.velocity_collection[1, 1:] > 0.0).all() and not rod.external_forces.any() for rod in sim)


def join(sim):
    sim.connect(sim[0], sim[1], first_connect_idx=-1, second_connect_idx=0).using(ea.FreeJoint, k=1.0, nu=0.0)


def touch(sim):
    sim.detect_contact_between(sim[0], sim[1]).using(ea.RodRodContact, k=1.0, nu=0.0)


def call(sim):
    sim.add_forcing_to(sim[1]).using(OwnForce)


def look_often(sim):
    sim.collect_diagnostics(sim[0]).using(Recorder, 100, [], 0)


@pytest.mark.parametrize("add", [join, touch, call, look_often])
def test_coupled_systems_run_in_one_simulation(add):
    sim, _ = scene(40, 20)
    add(sim)
    sim.finalize()
    assert not isinstance(sim.simulation, Ensemble)


def test_a_plane_does_not_join_systems():
    sim, _ = scene(40, 20)
    plane = ea.Plane(plane_origin=np.zeros(3), plane_normal=Y)
    sim.append(plane)
    for rod in list(sim)[:2]:
        sim.detect_contact_between(rod, plane).using(ea.RodPlaneContact, k=1.0, nu=0.0)
    sim.finalize()
    assert isinstance(sim.simulation, Ensemble)
    assert [part.scene.planes.stiffness.tolist() for part in sim.simulation.parts] == [[1.0], [1.0]]


class Joined:
    def __init__(self, *systems):
        self.systems = systems


class Sized:
    def __init__(self, n_elems):
        self.n_elems = n_elems


@given(st.data())
def test_joined_systems_are_in_one_group(data):
    movers = [Sized(n) for n in data.draw(st.lists(st.integers(1, 50), min_size=1, max_size=12))]
    place = st.sampled_from(movers)
    joints = [Joined(*pair) for pair in data.draw(st.lists(st.tuples(place, place), max_size=8))]
    n_most = data.draw(st.integers(1, 5))
    groups = _groups(movers, {"connections": joints, "forcing": [Joined(movers[0])]}, n_most)
    assert 1 <= len(groups) <= n_most
    assert sorted(id(each) for group in groups for each in group) == sorted(map(id, movers))
    assert all(groups)
    for joint in joints:
        (group,) = (each for each in groups if joint.systems[0] in each)
        assert joint.systems[1] in group
    if not joints:
        loads = [sum(each.n_elems for each in group) for group in groups]
        assert max(loads) - min(loads) <= max(each.n_elems for each in movers)
