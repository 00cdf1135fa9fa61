"""The library from the user's side: simulators, own classes, callbacks, restarts, errors."""

import pickle
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import elastica_gym.cosserat as ea

# a power of two, so that n DT/n is DT for all n
DT = 2.0**-17
X, Y, Z = np.eye(3)


class Simulator(
    ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Connections, ea.CallBacks, ea.Damping, ea.Contact
):
    pass


def make_rod(n=12, **options):
    given = dict(youngs_modulus=1e5, shear_modulus=4e4)
    return ea.CosseratRod.straight_rod(n, np.zeros(3), Z, Y, 0.3, 0.01, 1000.0, **{**given, **options})


def simulator(*rods):
    sim = Simulator()
    for rod in rods:
        sim.append(rod)
    return sim


def integrate(sim, n_steps, start=0.0, stepper=None):
    return ea.integrate(stepper or ea.PositionVerlet(), sim, n_steps * DT, n_steps, start, progress_bar=False)


# the user's own classes


class OwnEndpointForces(ea.NoForces):
    def __init__(self, force):
        self.force = force

    def apply_forces(self, system, time=0.0):
        system.external_forces[..., -1] += self.force * min(1.0, time / 1e-3)


class EndpointForcesWithTorques(ea.NoForces):
    """As in PyElastica's advanced guide."""

    def __init__(self, end_force, ramp_up_time=0.0):
        self.end_force, self.ramp_up_time = end_force, ramp_up_time

    def apply_forces(self, system, time=0.0):
        system.external_forces[..., -1] += self.end_force * min(1.0, time / self.ramp_up_time)

    def apply_torques(self, system, time=0.0):
        arm = np.array([0.0, 0.0, 0.5 * system.lengths[-1]])
        force = self.end_force * min(1.0, time / self.ramp_up_time)
        system.external_torques[..., -1] += np.cross(arm, system.director_collection[..., -1] @ force)


class OwnConstraint(ea.ConstraintBase):
    def __init__(self, fixed_position, fixed_directors, **kwargs):
        super().__init__(**kwargs)
        self.position, self.directors = fixed_position, fixed_directors

    def constrain_values(self, rod, time):
        rod.position_collection[..., 0] = self.position
        rod.director_collection[..., 0] = self.directors

    def constrain_rates(self, rod, time):
        rod.velocity_collection[..., 0] = 0.0
        rod.omega_collection[..., 0] = 0.0


class OwnDamper(ea.DamperBase):
    def dampen_rates(self, system, time):
        system.velocity_collection *= np.exp(-4.0 * DT)
        system.omega_collection *= np.exp(-4.0 * DT)


class OwnJoint(ea.FreeJoint):
    """Methods of joints before 1.0 had no time argument."""

    def apply_forces(self, system_one, index_one, system_two, index_two):
        super().apply_forces(system_one, index_one, system_two, index_two)

    def apply_torques(self, system_one, index_one, system_two, index_two):
        pass


class OwnContact(ea.NoContact):
    def apply_contact(self, system_one, system_two):
        system_one.external_forces[..., 0] += 0.01 * X
        system_two.external_forces[..., 0] -= 0.01 * X


def by_either(built_in, own):
    """Return final positions of a rod with a built-in feature, and with the equivalent own class."""
    found = []
    for declare in (built_in, own):
        rods = make_rod(), make_rod()
        sim = simulator(*rods)
        declare(sim, *rods)
        sim.finalize()
        rods[0].velocity_collection[0] = np.linspace(0.0, 0.1, 13)
        integrate(sim, 400)
        found.append(np.stack([rod.position_collection for rod in rods]))
    return found


CLAMP = dict(constrained_position_idx=(0,), constrained_director_idx=(0,))
PAIRS = {
    "load": (
        lambda s, a, b: s.add_forcing_to(a).using(ea.EndpointForces, np.zeros(3), 0.01 * X, ramp_up_time=1e-3),
        lambda s, a, b: s.add_forcing_to(a).using(OwnEndpointForces, 0.01 * X),
    ),
    "constraint": (
        lambda s, a, b: s.constrain(a).using(ea.OneEndFixedBC, **CLAMP),
        lambda s, a, b: s.constrain(a).using(OwnConstraint, **CLAMP),
    ),
    "damper": (
        lambda s, a, b: s.dampen(a).using(ea.AnalyticalLinearDamper, uniform_damping_constant=4.0),
        lambda s, a, b: s.dampen(a).using(OwnDamper),
    ),
    "joint": (
        lambda s, a, b: s.connect(a, b, -1, 0).using(ea.FreeJoint, k=10.0, nu=0.1),
        lambda s, a, b: s.connect(a, b, -1, 0).using(OwnJoint, k=10.0, nu=0.1),
    ),
    "contact": (
        lambda s, a, b: (
            s.add_forcing_to(a).using(ea.EndpointForces, 0.01 * X, np.zeros(3)),
            s.add_forcing_to(b).using(ea.EndpointForces, -0.01 * X, np.zeros(3)),
        ),
        lambda s, a, b: s.detect_contact_between(a, b).using(OwnContact),
    ),
}


@pytest.mark.parametrize(("built_in", "own"), PAIRS.values(), ids=PAIRS.keys())
def test_own_class_equals_the_built_in_one(built_in, own):
    expected, found = by_either(built_in, own)
    assert np.abs(expected - found).max() < 1e-14


# Python methods called by a subclass without overrides must agree with the compiled rows

PYTHON = {
    ea.GravityForces: ("add_forcing_to", (np.array([0.1, -9.8, 2.0]),), {}, ("apply_forces", "apply_torques")),
    ea.EndpointForces: ("add_forcing_to", (0.01 * X, 0.02 * Y, 2e-3), {}, ("apply_forces", "apply_torques")),
    ea.EndpointForcesSinusoidal: ("add_forcing_to", (0.01, 0.02, 2e-3), {}, ("apply_forces", "apply_torques")),
    ea.UniformForces: ("add_forcing_to", (0.05, Y), {}, ("apply_forces", "apply_torques")),
    ea.UniformTorques: ("add_forcing_to", (1e-3, X), {}, ("apply_forces", "apply_torques")),
    ea.ReciprocalTension: ("add_forcing_to", (), {}, ("apply_forces", "apply_torques")),
    ea.SlenderBodyTheory: ("add_forcing_to", (0.3,), {}, ("apply_forces", "apply_torques")),
    ea.FixedConstraint: ("constrain", (), CLAMP, ("constrain_values", "constrain_rates")),
    ea.GeneralConstraint: (
        "constrain",
        (),
        dict(**CLAMP, rotational_constraint_selector=np.array([True, False, True])),
        ("constrain_values", "constrain_rates"),
    ),
    ea.LaplaceDissipationFilter: ("dampen", (3,), {}, ("dampen_rates",)),
    ea.AnalyticalLinearDamper: ("dampen", (), dict(damping_constant=0.1, time_step=DT), ("dampen_rates",)),
}


def through_super(cls, name):
    """Return an override that only calls super."""
    return lambda self, *arguments: getattr(cls, name)(self, *arguments)


@pytest.mark.parametrize("cls", PYTHON, ids=lambda cls: cls.__name__)
def test_subclass_that_calls_super(cls):
    declare, args, kwargs, methods = PYTHON[cls]
    own = type("Own", (cls,), {name: through_super(cls, name) for name in methods})
    expected, found = by_either(
        lambda s, a, b: getattr(s, declare)(a).using(cls, *args, **kwargs),
        lambda s, a, b: getattr(s, declare)(a).using(own, *args, **kwargs),
    )
    assert np.abs(expected - found).max() < 1e-13


# reciprocal tension


def thick_ring():
    rod = ea.CosseratRod.ring_rod(16, np.zeros(3), Z, Y, 0.5, 0.03, 1000.0, youngs_modulus=1e5, shear_modulus=4e4)
    rod.rest_kappa[1] = 3.0
    rod.rest_sigma[2] = 0.02
    return rod


def thick_rod():
    rod = ea.CosseratRod.straight_rod(12, np.zeros(3), Z, Y, 0.3, 0.03, 1000.0, youngs_modulus=1e5, shear_modulus=4e4)
    rod.rest_kappa[0] = 3.0
    return rod


class OwnTension(ea.ReciprocalTension):
    """A subclass is called, since it may change during a run."""


@pytest.mark.parametrize("make", [thick_ring, thick_rod])
def test_tension_agrees_with_its_formula_and_is_internal(make):
    found = []
    for tension in (ea.ReciprocalTension, OwnTension, None):
        rod = make()
        sim = simulator(rod)
        if tension is not None:
            sim.add_forcing_to(rod).using(tension)
        sim.finalize()
        rng = np.random.default_rng(0)
        rod.velocity_collection[:] = 0.3 * rng.standard_normal(rod.velocity_collection.shape)
        rod.omega_collection[:] = 10.0 * rng.standard_normal(rod.omega_collection.shape)
        integrate(sim, 300)
        found.append(rod.position_collection.copy())
    assert np.abs(found[0] - found[1]).max() < 1e-12 < 1e-6 < np.abs(found[0] - found[2]).max()
    OwnTension().apply_forces(rod)
    force = rod.external_forces
    assert np.abs(force).max() > 1e-3
    assert np.abs(force.sum(axis=1)).max() < 1e-13
    assert np.abs(np.cross(rod.position_collection, force, axis=0).sum(axis=1)).max() < 1e-13


@pytest.mark.slow
def test_a_shear_stiff_rod_bends_without_flutter_with_reciprocal_tension():
    """The published beam, at twice the load and for a shorter time, against Timoshenko's deflection."""
    length, radius, young, shear, force = 3.0, 0.25, 1e6, 1e6 / 0.3, -30.0
    area = np.pi * radius**2
    exact = force * length / (27 / 28 * shear * area) + force * length**3 / (3.0 * young * area**2 / (4.0 * np.pi))
    errors = []
    for has_tension in (False, True):
        rod = ea.CosseratRod.straight_rod(
            100, np.zeros(3), Z, Y, length, radius, 5000.0, 0.1, young, shear_modulus=shear
        )
        sim = simulator(rod)
        sim.constrain(rod).using(ea.OneEndFixedBC, **CLAMP)
        sim.add_forcing_to(rod).using(ea.EndpointForces, np.zeros(3), force * X, ramp_up_time=250.0)
        if has_tension:
            sim.add_forcing_to(rod).using(ea.ReciprocalTension)
        sim.finalize()
        ea.integrate(ea.PositionVerlet(), sim, 500.0, 1_850_000, progress_bar=False)
        errors.append(abs(rod.position_collection[0, -1] / exact - 1.0))
    assert not errors[0] < 0.1
    assert errors[1] < 0.03


class Pulled(ea.EndpointForces):
    """Overrides nothing, but registers its instance."""

    def __init__(self, found, **kwargs):
        super().__init__(**kwargs)
        found.append(self)


def test_a_subclass_may_be_changed_during_a_run():
    rod, found = make_rod(), []
    sim = simulator(rod)
    sim.add_forcing_to(rod).using(Pulled, found, start_force=np.zeros(3), end_force=np.zeros(3))
    sim.finalize()
    integrate(sim, 5)
    assert not rod.velocity_collection[0].any()
    found[0].end_force = 0.1 * X
    integrate(sim, 5, 5 * DT)
    assert rod.velocity_collection[0, -1] > 0.0


class Softer(ea.RodSelfContact):
    """A subclass of a compiled-only feature, without overrides."""


def test_a_subclass_of_a_compiled_feature_equals_its_base():
    rod = make_rod()
    sim = simulator(rod)
    sim.detect_contact_between(rod, rod).using(Softer, k=1.0, nu=0.0)
    sim.finalize()
    integrate(sim, 2)
    assert sim.simulation.scene.rod_contacts.stiffness.tolist() == [1.0]


def test_torques_of_the_advanced_guide():
    rod = make_rod()
    sim = simulator(rod)
    sim.constrain(rod).using(ea.OneEndFixedBC, **CLAMP)
    sim.add_forcing_to(rod).using(EndpointForcesWithTorques, 0.01 * X)
    sim.finalize()
    with np.errstate(divide="ignore"):
        integrate(sim, 300)
    assert rod.position_collection[0, -1] > 1e-6


class Failing(ea.NoForces):
    def apply_forces(self, system, time=0.0):
        if time > 50 * DT:
            raise FloatingPointError("the user's own error")


def test_error_in_own_class_propagates_to_the_caller():
    rod = make_rod()
    sim = simulator(rod)
    sim.add_forcing_to(rod).using(Failing)
    sim.finalize()
    with pytest.raises(FloatingPointError, match="the user's own error"):
        integrate(sim, 100)


def test_external_force_acts_once():
    rod = make_rod()
    sim = simulator(rod)
    sim.finalize()
    stepper, time = ea.PositionVerlet(), 0.0
    rod.external_forces[1, 4] = 2.0
    time = stepper.step(sim, time, DT)
    assert np.isclose(rod.velocity_collection[1, 4], DT * 2.0 / rod.mass[4])
    assert not rod.external_forces.any()
    momentum = (rod.mass * rod.velocity_collection).sum(axis=1)
    stepper.step(sim, time, DT)
    assert np.allclose((rod.mass * rod.velocity_collection).sum(axis=1), momentum, atol=1e-18)


# callbacks


class Record(ea.CallBackBaseClass):
    def __init__(self, every=None):
        self.seen = []
        if every is not None:
            self.every = every

    def make_callback(self, system, time, current_step):
        self.seen.append((current_step, time, system))


@pytest.mark.parametrize(("every", "steps"), [(None, list(range(8))), (3, [0, 3, 6])])
def test_callback_interval(every, steps):
    records = []

    class Kept(Record):
        def __init__(self):
            super().__init__(every)
            records.append(self)

    rod = make_rod()
    sim = simulator(rod)
    sim.collect_diagnostics(rod).using(Kept)
    sim.collect_diagnostics(...).using(Kept)
    sim.collect_diagnostics({"a": rod}).using(Kept)
    sim.finalize()
    integrate(sim, 7)
    assert [step for step, _, _ in records[0].seen] == steps
    assert np.allclose([time for _, time, _ in records[0].seen], DT * np.array(steps))
    assert [record.seen[0][2] for record in records] == [rod, (rod,), {"a": rod}]


def test_export(tmp_path):
    rod = make_rod()
    sim = simulator(rod)
    sim.collect_diagnostics(rod).using(
        ea.ExportCallBack, step_skip=10, filename="rod", directory=str(tmp_path), method="npz", file_save_interval=50
    )
    sim.collect_diagnostics(rod).using(ea.ExportCallBack, 10, str(tmp_path / "seed"), "pickle", save_every=1e8)
    sim.finalize()
    integrate(sim, 120)
    sim.close()
    files = sorted(path.name for path in tmp_path.iterdir())
    assert files == ["rod_00.npz", "rod_01.npz", "rod_02.npz", "seed_00.pkl"]
    steps = [np.load(tmp_path / name)["step"].tolist() for name in files[:3]]
    assert steps == [list(range(0, 50, 10)), list(range(50, 100, 10)), [100, 110, 120]]
    assert np.load(tmp_path / "rod_00.npz")["position"].shape[1:] == (3, 13)
    assert pickle.loads((tmp_path / "seed_00.pkl").read_bytes())["step"].size == 13


def test_temporary_exports_keep_every_file():
    rod = make_rod()
    sim = simulator(rod)
    sim.collect_diagnostics(rod).using(ea.ExportCallBack, 10, "rod", method="tempfile", file_save_interval=50)
    sim.finalize()
    integrate(sim, 120)
    sim.close()
    (callback,) = sim.simulation.callbacks
    last = Path(callback.get_last_saved_path())
    files = sorted(last.parent.iterdir())
    assert [path.name for path in files] == ["rod_00.pkl", "rod_01.pkl", "rod_02.pkl"]
    steps = [step for path in files for step in pickle.loads(path.read_bytes())["step"]]
    assert steps == list(range(0, 121, 10))


KILLED = """
import os, signal, sys
import numpy as np
import elastica_gym.cosserat as ea

class Simulator(ea.BaseSystemCollection, ea.CallBacks):
    pass

class Kill(ea.CallBackBaseClass):
    every = 10

    def make_callback(self, system, time, current_step):
        if current_step == 130:
            os.kill(os.getpid(), signal.SIGKILL)

sim = Simulator()
sim.append(ea.CosseratRod.straight_rod(12, np.zeros(3), [0, 0, 1], [0, 1, 0], 0.3, 0.01, 1000.0, youngs_modulus=1e5))
for method in ("npz", "pickle"):
    sim.collect_diagnostics(sim[0]).using(ea.ExportCallBack, 10, method, sys.argv[1], method, file_save_interval=50)
sim.collect_diagnostics(sim[0]).using(Kill)
sim.finalize()
ea.integrate(ea.PositionVerlet(), sim, 1e-2, 1000, progress_bar=False)
"""


def test_a_kill_loses_only_samples_not_yet_written(tmp_path):
    killed = subprocess.run([sys.executable, "-c", KILLED, tmp_path], check=False)
    assert killed.returncode == -signal.SIGKILL
    whole = list(range(0, 91, 10))
    steps = np.concatenate([np.load(path)["step"] for path in sorted(tmp_path.glob("npz_*.npz"))])
    assert steps.tolist() == whole
    steps = [pickle.loads(path.read_bytes())["step"] for path in sorted(tmp_path.glob("pickle_*.pkl"))]
    assert np.concatenate(steps).tolist() == whole


# restarts, and runs in several parts


def moving():
    rods = make_rod(nu=0.01), make_rod()
    sim = simulator(*rods)
    sim.constrain(rods[0]).using(ea.OneEndFixedBC, **CLAMP)
    sim.connect(rods[0], rods[1], -1, 0).using(ea.FixedJoint, k=10.0, nu=0.1, kt=0.01)
    sim.add_forcing_to(rods[1]).using(ea.GravityForces)
    sim.dampen(rods[1]).using(ea.LaplaceDissipationFilter, 3)
    sim.finalize()
    rods[1].omega_collection[:] = 10.0 * np.random.default_rng(0).standard_normal(rods[1].omega_collection.shape)
    return sim, rods


@pytest.mark.parametrize("stepper", [ea.PositionVerlet(), ea.PEFRL()], ids=["verlet", "pefrl"])
def test_a_run_is_bitwise_the_same_in_parts_or_restarted(stepper, tmp_path):
    sim, rods = moving()
    integrate(sim, 1500, stepper=stepper)
    whole = [rod.position_collection.copy() for rod in rods]

    sim, rods = moving()
    time = integrate(sim, 700, stepper=stepper)
    ea.save_state(sim, tmp_path / "saved", time)
    sim, rods = moving()
    time = ea.load_state(sim, tmp_path / "saved")
    for part in (1, 99, 700):
        time = ea.integrate(stepper, sim, part * DT, part, time, progress_bar=False)
    for rod, expected in zip(rods, whole, strict=True):
        assert np.array_equal(rod.position_collection, expected)


def test_a_restart_of_a_body_sliding_on_a_plane_is_bitwise_the_same(tmp_path):
    """The saved state includes friction, which is the warm start of the solver."""

    def rubbing():
        body, sim = ea.Cylinder(np.array([0.0, 0.02, 0.0]), X, Y, 0.1, 0.02, 500.0), Simulator()
        for system in (body, ea.Plane(np.zeros(3), Y)):
            sim.append(system)
        sim.add_forcing_to(body).using(ea.GravityForces, np.array([1.0, -9.8, 0.3]))
        sim.detect_contact_between(body, sim[1]).using(
            ea.CylinderPlaneContact, k=1e4, nu=10.0, friction_coefficient=0.5
        )
        sim.finalize()
        return sim, body

    sim, body = rubbing()
    integrate(sim, 2000)
    whole = body.position_collection.copy(), body.omega_collection.copy()
    sim, body = rubbing()
    ea.save_state(sim, tmp_path / "saved", integrate(sim, 700))
    sim, body = rubbing()
    integrate(sim, 1300, ea.load_state(sim, tmp_path / "saved"))
    assert np.array_equal(body.position_collection, whole[0])
    assert np.array_equal(body.omega_collection, whole[1])


def test_script_with_its_own_loop():
    sim, rods = moving()
    integrate(sim, 50)
    expected = rods[1].position_collection.copy()
    sim, rods = moving()
    stepper = ea.PositionVerlet()
    do_step, stages = ea.extend_stepper_interface(stepper, sim)
    time = 0.0
    for _ in range(50):
        time = do_step(stepper, stages, sim, time, DT)
    assert np.array_equal(rods[1].position_collection, expected)


def test_progress_is_shown_on_request(capfd):
    sim, _ = moving()
    for wanted in (True, False):
        ea.integrate(ea.PositionVerlet(), sim, 50 * DT, 50, progress_bar=wanted)
        assert ("integrating ..." in capfd.readouterr().err) == wanted


def test_order_of_the_steppers():
    """Halving the step divides the error by 4 in position Verlet and by 16 in PEFRL.

    For a rod that only stretches: torques that depend on angular velocity reduce the order.
    """

    def end(stepper, n_steps):
        rod = make_rod(4)
        sim = simulator(rod)
        sim.constrain(rod).using(ea.OneEndFixedBC, **CLAMP)
        sim.add_forcing_to(rod).using(ea.EndpointForces, np.zeros(3), 0.3 * Z)
        sim.finalize()
        ea.integrate(stepper, sim, 0.02, n_steps, progress_bar=False)
        return rod.position_collection.copy()

    exact = end(ea.PEFRL(), 4000)
    for stepper, order in ((ea.PositionVerlet(), 2), (ea.PEFRL(), 4)):
        errors = [np.abs(end(stepper, n) - exact).max() for n in (100, 200)]
        assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.3)


# attributes


def test_attributes_are_arrays_before_finalize_and_views_after():
    rod = make_rod()
    rod.shear_matrix = 2.0 * rod.shear_matrix
    rod.bend_matrix[2, 2, :] = 0.5
    sim = simulator(rod)
    sim.finalize()
    model, first = sim.simulation.model, sim.simulation.model.first_slot[0]
    assert np.allclose(model.bend[2, first : first + 11], 0.5)
    assert np.shares_memory(rod.position_collection, sim.simulation.state.x)
    rod.velocity_collection = np.ones((3, 13))
    assert (sim.simulation.state.v[0][:, first : first + 13] == 1.0).all()
    # material written later is read when compiled code is next entered
    rod.mass[:] = 7.0
    integrate(sim, 1)
    assert (model.mass[first : first + 13] == 7.0).all()
    assert np.allclose(model.inv_mass[first : first + 13], 1.0 / 7.0)


def test_errors_of_attributes():
    rod = make_rod()
    with pytest.raises(ValueError, match=r"mass must have shape \(13,\)"):
        rod.mass = np.ones(5)
    rod.shear_matrix[0, 1, 0] = 1.0
    with pytest.raises(ValueError, match="shear_matrix must be diagonal"):
        simulator(rod).finalize()
    rod.shear_matrix[0, 1, 0] = 0.0
    sim = simulator(rod)
    sim.finalize()
    rod.shear_matrix[0, 1, 0] = 1.0
    with pytest.raises(ValueError, match="shear_matrix must be diagonal"):
        integrate(sim, 1)


def test_derived_attributes_may_be_written():
    """As required in PyElastica, which stores them; only position, volume and rest lengths have an effect."""
    rod = make_rod()
    lengths = np.linspace(0.02, 0.03, 12)
    rod.position_collection[2, 1:] = np.cumsum(lengths)
    rod.rest_lengths[:] = rod.lengths[:] = lengths
    rod.rest_voronoi_lengths[:] = 0.5 * (lengths[1:] + lengths[:-1])
    rod.volume[:] = np.pi * 0.01**2 * lengths
    rod.radius[:] = 0.01
    rod.kappa[:] = rod.sigma[:] = 0.0
    sim = simulator(rod)
    sim.finalize()
    assert rod.lengths == pytest.approx(lengths)
    assert rod.radius == pytest.approx(0.01)
    integrate(sim, 100)
    assert np.abs(rod.velocity_collection).max() < 1e-9
    # as environments do when they reset a rod
    for name in ("acceleration_collection", "alpha_collection", "internal_forces", "internal_torques"):
        getattr(rod, name).fill(0.0)
    rod.dilatation.fill(2.0)
    rod.lengths[:] = 1.0
    assert rod.lengths == pytest.approx(lengths)


def test_actuation_by_rest_curvature_during_a_run():
    rod = make_rod(nu=0.5)
    sim = simulator(rod)
    sim.finalize()
    integrate(sim, 100)
    rod.rest_kappa[0] = 3.0
    integrate(sim, 5000)
    assert rod.kappa[0].mean() > 0.03


def test_pickle():
    _, rods = moving()
    again = pickle.loads(pickle.dumps(rods[0]))
    assert np.array_equal(again.position_collection, rods[0].position_collection)


@pytest.mark.parametrize(
    ("options", "ratio"),
    [
        (dict(), 3.0),
        (dict(nu=0.1), 1.5),
        (dict(poisson_ratio=0.25), 1.25),
        (dict(nu=0.1, shear_modulus=2.5e4), 4.0),
    ],
)
def test_shear_modulus(options, ratio):
    rod = make_rod(**{"shear_modulus": None, **options})
    assert rod.bend_matrix[0, 0, 0] / rod.bend_matrix[2, 2, 0] == pytest.approx(0.5 * ratio)


# errors


def refuses(action, *words, error=Exception):
    with pytest.raises(error) as caught:
        action()
    for word in words:
        assert word in str(caught.value)


def test_errors_of_simulators():
    rod = make_rod()
    refuses(lambda: Simulator().finalize(), "append a rod", error=RuntimeError)
    refuses(lambda: simulator(rod, rod), "already", error=ValueError)
    refuses(lambda: simulator("rod"), "not str", error=TypeError)
    refuses(lambda: Simulator().constrain(rod), "append it first", error=ValueError)
    refuses(lambda: ea.BaseSystemCollection().constrain(rod), "Constraints", error=AttributeError)
    sim = simulator(rod)
    sim.constrain(rod)
    refuses(sim.finalize, "constraint", "did you forget .using", error=RuntimeError)
    refuses(lambda: integrate(simulator(rod), 10), "finalize()", error=RuntimeError)


def test_errors_of_using():
    rod = make_rod()
    sim = simulator(rod)
    refuses(lambda: simulator(rod).constrain(rod).using(ea.GravityForces), "ConstraintBase", error=TypeError)
    declared = sim.add_forcing_to(rod)
    declared.using(ea.GravityForces)
    refuses(lambda: declared.using(ea.GravityForces), "already", error=RuntimeError)
    sim.add_forcing_to(rod).using(ea.EndpointForces)
    refuses(sim.finalize, "EndpointForces", "start_force", error=TypeError)
    refuses(lambda: sim.connect(rod, rod, -1, 99), "second_connect_idx", "99", error=IndexError)


def test_adding_after_finalize_raises():
    sim, rods = moving()
    for action in (sim.finalize, lambda: sim.append(make_rod()), lambda: sim.add_forcing_to(rods[0])):
        refuses(action, "finalized", error=RuntimeError)


def test_unstable_time_step_gives_a_warning():
    rod = make_rod()
    sim = simulator(rod)
    sim.finalize()
    bound = ea.stable_time_step(rod)
    with pytest.warns(RuntimeWarning, match="stable"):
        ea.integrate(ea.PositionVerlet(), sim, 2.0 * bound, 1, progress_bar=False)


def test_unstable_time_step_of_a_damper_gives_a_warning_at_finalize():
    rod = make_rod()
    sim = simulator(rod)
    sim.dampen(rod).using(ea.AnalyticalLinearDamper, uniform_damping_constant=1.0, time_step=1e-2)
    with pytest.warns(RuntimeWarning, match="stable"):
        sim.finalize()


def test_a_system_cannot_be_added_twice():
    rods = [make_rod() for _ in range(3)]
    sim = simulator(*rods[:2])
    with pytest.raises(ValueError, match="already"):
        sim[0] = rods[1]
    sim[0] = rods[0]
    sim.insert(0, rods[2])
    assert [sim.get_system_index(rod) for rod in rods] == [1, 2, 0]
    del sim[0]
    assert [sim.get_system_index(rod) for rod in rods[:2]] == [0, 1]
    refuses(lambda: sim.get_system_index(rods[2]), "append it first", error=ValueError)


def test_muscles_without_ramp_are_at_full_strength_from_the_start():
    def after_a_step(ramp):
        rod = make_rod()
        sim = simulator(rod)
        sim.add_forcing_to(rod).using(
            ea.MuscleTorques,
            base_length=0.3,
            b_coeff=np.full(6, 1e-3),
            period=1.0,
            wave_number=6.0,
            phase_shift=0.0,
            direction=Y,
            rest_lengths=rod.rest_lengths,
            ramp_up_time=ramp,
            with_spline=True,
        )
        sim.finalize()
        integrate(sim, 1)
        return rod.omega_collection.copy()

    # the middle of the first step is at DT/2
    assert np.abs(after_a_step(0.0)).max() > 0.0
    assert np.allclose(after_a_step(0.0), 2.0 * after_a_step(DT), rtol=1e-12)


def test_dampers_act_on_rigid_bodies():
    bodies = [ea.Cylinder(np.zeros(3), Z, Y, 0.1, 0.02, 500.0), ea.Sphere(np.zeros(3), 0.05, 500.0)]
    sim = simulator(*bodies)
    sim.dampen(bodies[0]).using(ea.AnalyticalLinearDamper, uniform_damping_constant=5.0)
    sim.dampen(bodies[1]).using(
        ea.AnalyticalLinearDamper, translational_damping_constant=0.3, rotational_damping_constant=1e-4
    )
    sim.finalize()
    for body in bodies:
        body.velocity_collection[:] = body.omega_collection[:] = 1.0 * Z[:, None]
    T = integrate(sim, 500)
    ball, J = bodies[1], bodies[1].mass_second_moment_of_inertia[2, 2, 0]
    assert bodies[0].velocity_collection[2, 0] == pytest.approx(np.exp(-5.0 * T), rel=1e-12)
    assert bodies[0].omega_collection[2, 0] == pytest.approx(np.exp(-5.0 * T), rel=1e-12)
    assert ball.velocity_collection[2, 0] == pytest.approx(np.exp(-0.3 / ball.mass * T), rel=1e-12)
    assert ball.omega_collection[2, 0] == pytest.approx(np.exp(-1e-4 / J * T), rel=1e-12)


@pytest.mark.parametrize("order", [1, 4])
def test_filter_of_a_ring_has_no_seam(order):
    """The shortest wave vanishes in one step, wherever it starts; uniform motion stays."""
    ring = ea.CosseratRod.ring_rod(16, np.zeros(3), Z, Y, 0.5, 0.01, 1000.0, youngs_modulus=1e-6)
    sim = simulator(ring)
    sim.dampen(ring).using(ea.LaplaceDissipationFilter, order)
    sim.finalize()
    ring.velocity_collection[0] = 1.0 + np.tile([1.0, -1.0], 8)
    integrate(sim, 1)
    assert np.abs(ring.velocity_collection[0] - 1.0).max() < 1e-9


@pytest.mark.parametrize(
    ("cls", "args"),
    [(ea.LaplaceDissipationFilter, (3,)), (ea.RayleighDissipation, (1.0,)), (ea.SlenderBodyTheory, (1.0,))],
)
def test_features_along_rods_reject_bodies(cls, args):
    body = ea.Sphere(np.zeros(3), 0.05, 500.0)
    sim = simulator(body)
    declare = sim.add_forcing_to if issubclass(cls, ea.NoForces) else sim.dampen
    declare(body).using(cls, *args)
    refuses(sim.finalize, "rod", "Sphere", error=TypeError)


def test_contact_as_a_joint_accepts_none_as_indices():
    rod, body = make_rod(), ea.Cylinder(np.array([-0.05, 0.025, 0.1]), X, Y, 0.1, 0.02, 500.0)
    sim = simulator(rod, body)
    sim.connect(rod, body, first_connect_idx=None, second_connect_idx=None).using(ea.ExternalContact, k=100.0, nu=0.1)
    sim.finalize()
    integrate(sim, 10)
    assert body.velocity_collection[1, 0] > 0.0


@pytest.mark.parametrize("name", ["FreeRod", "OneEndFixedRod"])
def test_deprecated_names_warn(name):
    rod = make_rod()
    sim = simulator(rod)
    sim.constrain(rod).using(getattr(ea, name), **(CLAMP if name == "OneEndFixedRod" else {}))
    with pytest.warns(DeprecationWarning, match=name):
        sim.finalize()


ROD = dict(
    n_elements=6,
    start=np.zeros(3),
    direction=Z,
    normal=Y,
    base_length=0.3,
    base_radius=0.01,
    density=1000.0,
    youngs_modulus=1e5,
)


@pytest.mark.parametrize(
    ("name", "value", "error"),
    [
        ("n_elements", 6.0, TypeError),
        ("n_elements", "6", TypeError),
        ("n_elements", True, TypeError),
        ("n_elements", 1, ValueError),
        ("base_length", "long", TypeError),
        ("base_length", None, TypeError),
        ("base_radius", "thin", TypeError),
        ("density", [1000.0, "x"], TypeError),
        ("youngs_modulus", "1e5", TypeError),
        ("start", "origin", TypeError),
        ("start", [0.0, 1.0], ValueError),
        ("normal", None, ValueError),
        ("shear_modulus", [1.0, 2.0], TypeError),
        ("position", "line", TypeError),
        ("nu", "none", TypeError),
        ("rest_kappa", "flat", TypeError),
        ("poisson_ratio", "half", TypeError),
    ],
)
def test_errors_of_rods_name_the_argument(name, value, error):
    refuses(lambda: ea.CosseratRod.straight_rod(**{**ROD, name: value}), name, error=error)


@pytest.mark.parametrize(
    ("kwargs", "words"),
    [
        ({}, ("constrained_position_idx []", "constrained_director_idx []")),
        (dict(constrained_position_idx=(0,)), ("constrained_director_idx []",)),
        (dict(constrained_position_idx=(0.5,), constrained_director_idx=(0,)), ("constrained_position_idx", "0.5")),
        (
            dict(constrained_position_idx=(0,), constrained_director_idx=("first",)),
            ("constrained_director_idx", "first"),
        ),
    ],
)
def test_errors_of_constraints_name_the_indices(kwargs, words):
    rod = make_rod()
    sim = simulator(rod)
    sim.constrain(rod).using(ea.OneEndFixedBC, **kwargs)
    refuses(sim.finalize, *words, error=TypeError)


def test_errors_of_joints_name_the_indices():
    rods = make_rod(), make_rod()
    sim = simulator(*rods)
    refuses(lambda: sim.connect(*rods, 0.5, 0.5), "first_connect_idx", "0.5", error=TypeError)
    sim.connect(*rods, (0, 1), (0,)).using(ea.FreeJoint, k=1.0, nu=0.0)
    refuses(sim.finalize, "first_connect_idx", "second_connect_idx", "2 and 1", error=ValueError)


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda x: ea.FreeJoint(x, 0.0), "k"),
        (lambda x: ea.FixedJoint(1.0, 0.0, 1.0, x), "nut"),
        (lambda x: ea.HingeJoint(1.0, 0.0, x, X), "kt"),
        (lambda x: ea.RodRodContact(1.0, x), "nu"),
        (lambda x: ea.RodCylinderContact(1.0, 0.0, x), "velocity_damping_coefficient"),
        (lambda x: ea.CylinderPlaneContact(1.0, 0.0, x), "friction_coefficient"),
        (lambda x: ea.RodPlaneContact(x, 0.0), "k"),
        (lambda x: ea.UniformForces(x, Y), "force"),
        (lambda x: ea.InteractionPlane(1.0, x, np.zeros(3), Y), "nu"),
        (lambda x: ea.Plane(x, Y), "plane_origin"),
        (lambda x: ea.EndpointForces(x, X), "start_force"),
        (lambda x: ea.GravityForces(x), "acc_gravity"),
        (lambda x: ea.EndpointForces(X, X, x), "ramp_up_time"),
    ],
)
def test_errors_of_features_name_the_argument(make, name):
    refuses(lambda: make("much"), name, "much", error=TypeError)
    refuses(lambda: make(np.nan), name, "nan", error=ValueError)
