import importlib.util
import subprocess
import sys

import numpy as np
import pytest

from elastica_gym.viz import Camera, Stage, framing, render_frames, write_video
from elastica_gym.viz.frames import animal

SIZE = {"width": 160, "height": 100}


def require(module):
    """Skip without importing: how MuJoCo draws is chosen at its import."""
    if importlib.util.find_spec(module) is None:
        pytest.skip(f"{module} is not installed")


@pytest.fixture(scope="module")
def drawn(reach):
    require("mujoco")
    try:
        with Stage(**SIZE):
            pass
    except RuntimeError as error:
        pytest.skip(str(error))
    picked = [0, len(reach.nodes) - 1]
    return render_frames(reach.nodes[picked], reach.radii[picked], target=reach.target[0], **SIZE)


def test_frames_show_a_moving_animal_and_a_target(drawn):
    assert drawn.shape == (2, 100, 160, 3)
    assert drawn.dtype == np.uint8
    red, green, blue = np.moveaxis(drawn.astype(int), -1, 0)
    animal_is = (green > red + 20) & (green >= blue)
    target_is = (red > green + 60) & (red > blue + 60)
    assert (animal_is.sum(axis=(1, 2)) > 30).all()
    assert (target_is.sum(axis=(1, 2)) > 5).all()
    assert (animal_is[0] != animal_is[1]).any()


def test_true_size(drawn, reach):
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


@pytest.mark.parametrize("azimuth", [0.0, 30.0, 200.0])
@pytest.mark.parametrize("elevation", [-20.0, -60.0])
def test_framing_sees_everything(azimuth, elevation):
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
    require("imageio_ffmpeg")
    path = write_video(drawn, tmp_path / "new" / "a.mp4")
    assert path.stat().st_size > 500
    with pytest.raises(OSError):
        write_video(drawn, path / "b.mp4")


def test_bad_arguments():
    with pytest.raises(ValueError, match=r"positions must have the shape \(T, N, 3\), not \(4, 3\)"):
        render_frames(np.zeros((4, 3)), np.ones(3))
    with pytest.raises(ValueError, match="width must be positive, not 0"):
        Stage(width=0)
    with pytest.raises(ValueError, match="4 nodes and 2 radii do not make rods"):
        animal(np.zeros((4, 3)), np.ones(2))


def test_where_nothing_can_draw_the_error_says_what_to_install():
    require("mujoco")
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
