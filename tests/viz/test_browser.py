"""What a browser shows, in a headless Chromium; skipped where there is none."""

import shutil
import subprocess
import sys

import numpy as np
import pytest

from elastica_gym.viz import write_recording
from tests.agents.commands import ROOT, environment
from tests.viz.test_replay import free_port

pytest.importorskip("playwright")
pytest.importorskip("rerun")
image = pytest.importorskip("PIL.Image")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not (shutil.which("chromium") or shutil.which("google-chrome")), reason="no Chromium"),
]


def test_the_viewer_shows_the_animal(forward, tmp_path):
    recording, picture = write_recording(forward, tmp_path / "forward.rrd"), tmp_path / "viewer.png"
    ports = ["--port", str(free_port()), "--data-port", str(free_port())]
    command = [sys.executable, str(ROOT / "scripts" / "screenshot_viewer.py"), str(recording), "--out", str(picture)]
    done = subprocess.run([*command, *ports], env=environment(), capture_output=True, text=True, timeout=500)
    assert done.returncode == 0, done.stderr
    pixels = np.asarray(image.open(picture).convert("RGB"), dtype=int)
    # the body is the only thing that is green: grey ground, white panels
    red, green, blue = pixels[:, : pixels.shape[1] // 2].reshape(-1, 3).T
    assert np.sum((green > red + 30) & (blue > red + 20)) > 200
