import importlib.util
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from elastica_gym.viz import Camera, Figure, Stage, framing, render_frames, write_video
from elastica_gym.viz.frames import animal, animal_of, figures, home, outline

SIZE = {"width": 160, "height": 100}


@pytest.fixture(scope="module")
def drawn(reach, offscreen):
    return render_frames(reach, [0, len(reach.step) - 1], **SIZE)


def test_frames_show_a_moving_animal_and_a_target(drawn):
    assert drawn.shape == (2, 100, 160, 3)
    assert drawn.dtype == np.uint8
    red, green, blue = np.moveaxis(drawn.astype(int), -1, 0)
    animal_is = (green > red + 20) & (green >= blue)
    target_is = (red > green + 60) & (red > blue + 60)
    assert (animal_is.sum(axis=(1, 2)) > 30).all()
    assert (target_is.sum(axis=(1, 2)) > 5).all()
    assert (animal_is[0] != animal_is[1]).any()


def test_true_size(drawn):
    radius = 0.05
    nodes = np.array([[0.0, radius, 0.0], [0.2, radius, 0.0]])
    with Stage(**SIZE) as stage:
        camera = Camera(look_at=(0.1, radius, 0.0), distance=1.0, elevation=-90.0)
        empty, full = stage.draw([], camera), stage.draw([animal(nodes, np.array([radius]), head=None)], camera)
    # shadows darken, but the body is green
    seen = (full[..., 1].astype(int) > full[..., 0] + 20) & (full != empty).any(axis=-1)
    metres_per_pixel = 2 * (1.0 - radius) * np.tan(np.deg2rad(16.0)) / SIZE["height"]
    assert seen.any(axis=0).sum() * metres_per_pixel == pytest.approx(0.2 + 2 * radius, abs=0.03)
    assert seen.any(axis=1).sum() * metres_per_pixel == pytest.approx(2 * radius, abs=0.03)


def test_objects_and_a_head_in_the_middle(drawn, octopus):
    head, plain = animal_of(octopus, 0), replace(octopus, head_node=120)
    assert len(head.begin) == 120
    assert len(animal_of(plain, 0).begin) == 121
    # full colour at the head, pale at both tips
    assert head.rgba[:, 0].argmin() in (59, 60)
    assert head.rgba[0, 0] == pytest.approx(head.rgba[-1, 0])
    camera = framing(outline(octopus, [0]), 1.6)
    with Stage(**SIZE, unit=octopus.body_length) as stage:
        alone, both = stage.draw([head], camera), stage.draw(figures(octopus, 0), camera)
    # the object is taller than thick in the picture
    seen = np.abs(both.astype(int) - alone).max(axis=-1) > 40
    assert seen.any(axis=1).sum() > seen.any(axis=0).sum() > 4


def test_home_is_a_disc_on_the_ground(drawn, octopus):
    (disc,) = home(octopus, 0)
    assert disc.begin[0] == pytest.approx(octopus.home[0]) and disc.is_flat
    camera = Camera(look_at=octopus.home[0], distance=2.0, elevation=-90.0)
    with Stage(**SIZE) as stage:
        red, green, blue = np.moveaxis(stage.draw([disc], camera).astype(int), -1, 0)
        everything = stage.draw(figures(octopus, 0), framing(outline(octopus, [0]), 1.6))
    blue_is = (blue > red + 40) & (blue > green + 20)
    metres_per_pixel = 4.0 * np.tan(np.deg2rad(16.0)) / SIZE["height"]
    for axis in (0, 1):
        assert blue_is.any(axis=axis).sum() * metres_per_pixel == pytest.approx(0.2, abs=0.04)
    assert everything.shape == (SIZE["height"], SIZE["width"], 3)


def test_a_home_left_behind_is_in_the_picture(octopus, forward):
    far = replace(octopus, home=octopus.home + np.array([3.0, 0.0, 0.0]))
    assert outline(far, [0])[:, 0].max() == pytest.approx(far.home[0, 0])
    assert home(forward, 0) == []


def test_cylinders_end_flat(drawn):
    ends = {"begin": np.array([[0.0, 0.0, 0.0]]), "end": np.array([[0.0, 0.4, 0.0]]), "radii": 0.1}
    camera = Camera(look_at=(0.0, 0.3, 0.0), distance=2.0, elevation=0.0)
    heights = []
    with Stage(**SIZE) as stage:
        empty = stage.draw([], camera)
        for is_flat in (True, False):
            figure = Figure(**ends, rgba=(0.0, 0.0, 0.0, 1.0), is_flat=is_flat)
            seen = np.abs(stage.draw([figure], camera).astype(int) - empty).max(axis=-1) > 60
            heights.append(seen.any(axis=1).sum())
    metres_per_pixel = 2 * 2.0 * np.tan(np.deg2rad(16.0)) / SIZE["height"]
    assert (heights[1] - heights[0]) * metres_per_pixel == pytest.approx(0.1, abs=0.03)


@pytest.mark.parametrize("azimuth", [0.0, 30.0, 200.0])
@pytest.mark.parametrize("elevation", [-20.0, -60.0])
def test_framing_includes_everything(azimuth, elevation):
    points = np.random.default_rng(0).normal(size=(50, 3)) * [1.0, 0.1, 0.5]
    camera = framing(points, 1.6, azimuth=azimuth, elevation=elevation)
    az, el = np.deg2rad((azimuth, elevation))
    away = np.array([np.sin(az) * np.cos(el), np.sin(el), -np.cos(az) * np.cos(el)])
    right = np.array([np.cos(az), 0.0, np.sin(az)])
    from_eye = points - (camera.look_at - camera.distance * away)
    high = np.tan(np.deg2rad(16.0)) * (from_eye @ away)
    assert (np.abs(from_eye @ np.cross(right, away)) < high).all()
    assert (np.abs(from_eye @ right) < 1.6 * high).all()


def test_video(drawn, tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    path = write_video(drawn, tmp_path / "new" / "a.mp4")
    assert path.stat().st_size > 500
    with pytest.raises(OSError):
        write_video(drawn, path / "b.mp4")


def test_bad_arguments(forward):
    for moments in ([], [41], [-1]):
        with pytest.raises(ValueError, match="moments must be indices from 0 to 40, not"):
            render_frames(forward, moments)
    with pytest.raises(ValueError, match="width must be positive, not 0"):
        Stage(width=0)
    with pytest.raises(ValueError, match="4 nodes and 2 radii do not make rods"):
        animal(np.zeros((4, 3)), np.ones(2))


def test_without_a_renderer_the_error_says_what_to_install():
    if importlib.util.find_spec("mujoco") is None:
        pytest.skip("mujoco is not installed")
    code = (
        "import ctypes.util\n"
        "ctypes.util.find_library = lambda name: None\n"
        "from elastica_gym.viz import Stage\n"
        "try:\n    Stage()\n"
        "except RuntimeError as error:\n    print(error)\n"
    )
    environment = {"PATH": "/usr/bin:/bin", "PYTHONPATH": ":".join(sys.path)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    if sys.platform.startswith("linux"):
        assert "apt-get install libegl1" in done.stdout
