import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.rl.test_curves import assert_inside

ROOT = Path(__file__).parents[2]


def run(script, *arguments):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, str(ROOT / "scripts" / script), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment)


def test_muscles(tmp_path):
    pytest.importorskip("matplotlib")
    done = run("draw_muscles.py", "--output", tmp_path / "new" / "muscles.png")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "new" / "muscles.png").stat().st_size > 20_000


def test_animals(tmp_path):
    image = pytest.importorskip("PIL.Image")
    path = tmp_path / "animals.png"
    done = run("make_picture.py", "--output", path, "--size", 320, 120, "--duration", 1)
    if "pictures need MuJoCo" in done.stderr or "cannot draw offscreen" in done.stderr:
        pytest.skip(done.stderr)
    assert done.returncode == 0, done.stderr
    assert image.open(path).size == (320, 250)


def test_animation_of_an_environment(tmp_path):
    image = pytest.importorskip("PIL.Image")
    small = ("--env", "elastica_gym/OctopusMove-v1", "--size", 120, 80, "--every", 4)
    done = run("make_animations.py", *small, "--out", tmp_path / "new")
    if "pictures need MuJoCo" in done.stderr or "cannot draw offscreen" in done.stderr:
        pytest.skip(done.stderr)
    assert done.returncode == 0, done.stderr
    film = image.open(tmp_path / "new" / "OctopusMove.gif")
    assert film.size == (120, 80)
    assert film.n_frames > 2
    assert film.info["duration"] == 200


def test_labels_of_the_activations_are_not_cut_off(monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    import draw_activations

    assert_inside(draw_activations.draw())
