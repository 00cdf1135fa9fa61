"""Recordings of the library's simulations."""

import subprocess
import sys

import numpy as np
import pytest

import elastica_gym.cosserat as ea

rr = pytest.importorskip("rerun")

DT, SKIP = 1e-5, 50
X, Y, Z = np.eye(3)


class Simulator(ea.BaseSystemCollection, ea.Forcing, ea.CallBacks):
    pass


class Kept(ea.MyCallBack):
    pass


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A falling rod, ring, cylinder and sphere, with their positions from other callbacks."""
    material = dict(density=1000.0, youngs_modulus=1e5)
    systems = [
        ea.CosseratRod.straight_rod(8, np.zeros(3), X, Y, 0.2, 0.01, **material),
        ea.CosseratRod.ring_rod(12, np.array([0.0, 0.0, 1.0]), X, Y, 0.5, 0.01, **material),
        ea.Cylinder(np.array([0.0, 0.5, 0.0]), X, Y, 0.1, 0.02, 500.0),
        ea.Sphere(np.array([0.0, 1.0, 0.0]), 0.03, 500.0),
    ]
    sim, kept = Simulator(), [ea_lists() for _ in systems]
    for system, lists in zip(systems, kept, strict=True):
        sim.append(system)
        sim.add_forcing_to(system).using(ea.GravityForces)
        sim.collect_diagnostics(system).using(Kept, step_skip=SKIP, callback_params=lists)
    path = tmp_path_factory.mktemp("systems") / "new" / "falling.rrd"
    sim.collect_diagnostics(...).using(ea.RerunCallBack, step_skip=SKIP, path=path)
    sim.finalize()
    ea.integrate(ea.PositionVerlet(), sim, 400 * DT, 400, progress_bar=False)
    sim.close()
    return path, systems, kept


def ea_lists():
    return {name: [] for name in ("time", "step", "position", "directors", "velocity")}


def column(path, entity, component):
    chunks = rr.chunk.RrdReader(path).stream().filter(content=entity, components=component, is_static=False).to_chunks()
    assert len(chunks) == 1
    batch = chunks[0].to_record_batch()
    return batch, batch.column(component)


@pytest.mark.parametrize(
    ("entity", "number", "component"),
    [
        ("/rods/0/nodes", 0, "Points3D:positions"),
        ("/rods/1/nodes", 1, "Points3D:positions"),
        ("/bodies/0", 2, "Cylinders3D:centers"),
        ("/bodies/1", 3, "Ellipsoids3D:centers"),
    ],
)
def test_reading_back_gives_the_same_positions(recording, entity, number, component):
    path, _, kept = recording
    batch, values = column(path, entity, component)
    expected = np.array(kept[number]["position"]).transpose(0, 2, 1)
    assert np.array_equal(values.flatten().flatten().to_numpy().reshape(expected.shape), expected.astype(np.float32))
    assert batch.column("step").to_numpy().tolist() == kept[number]["step"] == list(range(0, 401, SKIP))
    assert batch.column("sim_time").cast("int64").to_numpy() / 1e9 == pytest.approx(kept[number]["time"], abs=1e-9)
    assert expected[-1, :, 1].mean() < expected[0, :, 1].mean()


def test_capsules_close_a_ring(recording):
    path, systems, _ = recording
    lengths = column(path, "/rods/1/body", "Capsules3D:lengths")[1]
    assert [len(each) for each in lengths] == [12] * 9
    assert np.asarray(lengths[0].as_py()) == pytest.approx(systems[1].rest_lengths, rel=1e-6)


def test_energy(recording):
    path, systems, _ = recording
    energy = column(path, "/energy/translational", "Scalars:scalars")[1].flatten().to_numpy()
    assert energy[0] == 0.0
    assert energy[-1] == pytest.approx(sum(each.compute_translational_energy() for each in systems), rel=1e-12)


SCRIPT = """
import sys
from elastica_gym.cosserat import *

class Simulator(BaseSystemCollection, CallBacks):
    pass

sim = Simulator()
sim.append(Sphere([0.0, 0.0, 0.0], 0.1, 1000.0))
sim.collect_diagnostics(sim[0]).using(RerunCallBack, step_skip=1, path=sys.argv[1])
sim.finalize()
assert "mujoco" not in sys.modules
raise SystemExit("the user's own error")
"""


def test_written_when_python_exits(tmp_path):
    path = tmp_path / "end.rrd"
    done = subprocess.run([sys.executable, "-c", SCRIPT, path], capture_output=True, text=True, check=False)
    assert "the user's own error" in done.stderr
    assert str(path) in done.stdout
    assert len(column(path, "/bodies/0", "Ellipsoids3D:centers")[1]) == 1


def test_without_rerun_the_error_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(ImportError, match=r"pip install 'elastica-gym\[viz\]'"):
        ea.RerunCallBack(step_skip=10, path=tmp_path / "a.rrd")
