import subprocess
import sys
import warnings
from dataclasses import replace

import numpy as np
import pytest

from elastica_gym.viz import read_positions, record_rollout, write_recording
from elastica_gym.viz.recording import activation_groups, contact_colors, rotations_from_z

from .conftest import scripted

rr = pytest.importorskip("rerun")


@pytest.fixture(scope="module")
def recording(forward, tmp_path_factory):
    return written(forward, tmp_path_factory)


@pytest.fixture(scope="module")
def octopus_recording(octopus, tmp_path_factory):
    return written(octopus, tmp_path_factory)


def written(rollout, tmp_path_factory):
    with warnings.catch_warnings():
        # rerun only warns of invalid data
        warnings.simplefilter("error")
        return write_recording(rollout, tmp_path_factory.mktemp("viz") / "new" / "rollout.rrd")


def entities(path):
    return {chunk.entity_path for chunk in rr.chunk.RrdReader(path).stream().to_chunks()}


def axes(quaternions):
    x, y, z, w = np.moveaxis(quaternions.astype(float), -1, 0)
    return np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=-1)


def column(path, entity, component):
    chunks = rr.chunk.RrdReader(path).stream().filter(content=entity, components=component, is_static=False).to_chunks()
    assert len(chunks) == 1, "entities are written by columns, as one chunk"
    batch = chunks[0].to_record_batch()
    return batch, batch.column(component)


def test_reading_back_gives_the_same_positions(either, tmp_path_factory):
    times, nodes = read_positions(written(either, tmp_path_factory))
    assert np.array_equal(nodes, either.nodes.astype(np.float32))
    assert times == pytest.approx(either.sim_time, abs=1e-9)


def test_both_timelines(recording, forward):
    batch, _ = column(recording, "/animal/nodes", "Points3D:positions")
    assert np.array_equal(batch.column("step").to_numpy(), forward.step)
    assert str(batch.schema.field("sim_time").type) == "duration[ns]"


def test_capsules_have_the_true_shape(recording, forward):
    begin, end = forward.segments()

    def read(component):
        _, values = column(recording, "/animal/body", f"Capsules3D:{component}")
        flat = values.flatten()
        return (flat.flatten() if component in ("translations", "quaternions") else flat).to_numpy()

    assert read("radii").reshape(forward.radii.shape) == pytest.approx(forward.radii, rel=1e-6)
    assert np.array_equal(read("translations").reshape(begin.shape), begin.astype(np.float32))
    axis = axes(read("quaternions").reshape(*begin.shape[:2], 4))
    assert begin + axis * read("lengths").reshape(begin.shape[:2])[..., None] == pytest.approx(end, abs=1e-7)


def test_objects_have_the_true_shape_position_and_axis(octopus_recording, octopus):
    def read(component):
        batch, values = column(octopus_recording, "/objects", f"Cylinders3D:{component}")
        assert np.array_equal(batch.column("step").to_numpy(), octopus.step)
        assert batch.column("sim_time").cast("int64").to_numpy() / 1e9 == pytest.approx(octopus.sim_time)
        return values.flatten().flatten().to_numpy().reshape(len(octopus.step), 1, -1)

    assert np.array_equal(read("centers"), octopus.object_centre.astype(np.float32))
    assert axes(read("quaternions")) == pytest.approx(octopus.object_axis, abs=1e-6)
    (shape,) = rr.chunk.RrdReader(octopus_recording).stream().filter(content="/objects", is_static=True).to_chunks()
    for component, values in (("lengths", octopus.object_length), ("radii", octopus.object_radius)):
        read_back = shape.to_record_batch().column(f"Cylinders3D:{component}").flatten().to_numpy()
        assert read_back == pytest.approx(values)


def test_contact_is_recorded(octopus_recording, octopus):
    forces = column(octopus_recording, "/animal/object_force", "Scalars:scalars")[1].flatten().to_numpy()
    assert np.array_equal(forces.reshape(octopus.object_force.shape), octopus.object_force)
    assert forces.any()


def test_absent_entities_are_not_logged(recording, octopus_recording):
    assert {"/animal/head", "/animal/trail", "/animal/direction"} <= entities(recording)
    assert not {"/objects", "/animal/object_force", "/target", "/home"} & entities(recording)
    # the octopus's head is its thickest part: no ball must cover it
    assert {"/objects", "/animal/object_force", "/animal/trail", "/animal/direction"} <= entities(octopus_recording)
    assert "/animal/head" not in entities(octopus_recording)


def test_all_series_are_recorded(recording, forward):
    _, returns = column(recording, "/return", "Scalars:scalars")
    assert returns.flatten().to_numpy() == pytest.approx(forward.episode_return)
    for term, values in forward.rewards.items():
        assert np.array_equal(column(recording, f"/reward/{term}", "Scalars:scalars")[1].flatten().to_numpy(), values)
    groups = activation_groups(forward)
    assert len(groups) == 6
    read = [column(recording, f"/activations/{g}", "Scalars:scalars")[1].flatten().to_numpy() for g in groups]
    assert np.array_equal(np.concatenate([r.reshape(-1, 7) for r in read], axis=1), forward.activations)
    forces = column(recording, "/animal/normal_force", "Scalars:scalars")[1].flatten().to_numpy()
    assert np.array_equal(forces.reshape(forward.normal_force.shape), forward.normal_force)


def test_target(reach, tmp_path):
    path = write_recording(reach, tmp_path / "reach.rrd")
    _, centres = column(path, "/target", "Ellipsoids3D:centers")
    assert centres.flatten().flatten().to_numpy().reshape(-1, 3) == pytest.approx(reach.target, abs=1e-7)


def test_home_is_a_disc_on_the_ground(octopus_recording, octopus):
    (disc,) = rr.chunk.RrdReader(octopus_recording).stream().filter(content="/home", is_static=True).to_chunks()
    batch = disc.to_record_batch()

    def read(component):
        return batch.column(f"Cylinders3D:{component}").flatten().to_numpy(zero_copy_only=False)

    assert np.stack(read("centers")).ravel() == pytest.approx(octopus.home[0])
    assert read("radii") == pytest.approx([0.1])


def test_a_blueprint_is_embedded(recording):
    reader = rr.chunk.RrdReader(recording)
    (blueprint,) = reader.blueprints()
    views = [c.entity_path for c in reader.stream(store=blueprint).to_chunks() if c.entity_path.startswith("/view/")]
    assert len(views) > 9
    assert blueprint.application_id == reader.recordings()[0].application_id == "elastica_gym"


def test_ten_seconds_take_less_than_two_megabytes(tmp_path):
    path = record_rollout("elastica_gym/SnakeForward-v1", scripted, tmp_path / "ten.rrd", seed=1)
    assert path.stat().st_size < 2_000_000


def test_contact_colors():
    loads, free = np.array([[0.0, 1.0, 2.0, 1.0]]), np.zeros((1, 4))
    colors = contact_colors(loads, free)
    assert colors.shape == (1, 4, 3)
    assert (np.diff(colors[0, :3].astype(int), axis=0) < 0).all()
    assert (contact_colors(free, free) == colors[0, 0]).all()
    touched = contact_colors(loads, np.array([[0.0, 0.0, 3.0, 0.0]]))
    assert (touched == colors).all(axis=-1).tolist() == [[True, True, False, True]]


def test_rotation_to_the_opposite_direction():
    assert rotations_from_z(np.array([0.0, 0.0, -2.0])).tolist() == [1.0, 0.0, 0.0, 0.0]


def test_two_rods(forward, tmp_path):
    fewer = {name: getattr(forward, name)[:, :49] for name in ("radii", "normal_force", "object_force")}
    two = replace(forward, elements_per_rod=(20, 29), **fewer)
    path = write_recording(two, tmp_path / "two.rrd")
    assert len(column(path, "/animal/body", "Capsules3D:radii")[1][0]) == 49


def test_unwritable_path(forward, tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OSError, match="cannot write the recording"):
        write_recording(forward, tmp_path / "file" / "a.rrd")


def test_full_disk_leaves_the_old_recording(forward, tmp_path, monkeypatch):
    path = tmp_path / "a.rrd"
    path.write_text("old")

    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OSError, match=r"cannot write the recording of \d+ bytes: No space left on device"):
        write_recording(forward, path)
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.rrd"]


def test_reading_an_invalid_recording(recording, tmp_path):
    with pytest.raises(FileNotFoundError, match="no recording at"):
        read_positions(tmp_path / "none.rrd")
    cut = tmp_path / "cut.rrd"
    cut.write_bytes(recording.read_bytes()[:20_000])
    with pytest.raises(ValueError, match="not a complete rerun recording"):
        read_positions(cut)
    other = tmp_path / "other.rrd"
    with rr.RecordingStream("other") as stream:
        stream.save(other)
        stream.log("text", rr.TextLog("hello"))
    with pytest.raises(ValueError, match="not a recording of an animal"):
        read_positions(other)


def test_heavy_imports_are_lazy():
    heavy = ("rerun", "mujoco", "matplotlib", "torch", "PIL")
    code = f"import sys, elastica_gym, elastica_gym.viz; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip().splitlines()[-1] == "[]"


def test_without_rerun_the_error_says_what_to_install(forward, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(ImportError, match=r"pip install 'elastica-gym\[viz\]'"):
        write_recording(forward, tmp_path / "a.rrd")
