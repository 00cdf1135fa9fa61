"""The starter kit from a newcomer's side: the notebook from top to bottom, and the script's policy."""

import importlib.util
import json
import re

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

from elastica_gym.bodies import octopus
from elastica_gym.envs.tasks.octopus_fetch import TASK
from tests.agents.commands import ROOT

SCRIPTS = ROOT / "scripts"


@pytest.fixture
def small(monkeypatch, tmp_path):
    """Shrink the notebook's work: temporary output, short video, few targets, short training."""
    for name, value in {
        "OUT": tmp_path,
        "SECONDS": 0.5,
        "TARGETS": 1,
        "STEPS": 40,
        "TRAIN": "--n-envs 2 --set n_steps=20 batch_size=20 n_epochs=2",
    }.items():
        monkeypatch.setenv(f"STARTER_KIT_{name}", str(value))
    monkeypatch.setenv("COLUMNS", "200")
    return tmp_path


def test_the_notebook_runs_from_top_to_bottom(offscreen, small):
    notebook = nbformat.read(SCRIPTS / "starter_kit.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells)
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(SCRIPTS)}}).execute()
    text = "\n".join(output.get("text", "") for cell in notebook.cells for output in cell.get("outputs", []))
    assert "home/forward" in text and len(re.findall(r"│ total ", text)) == 2
    assert json.loads((small / "my_policy.json").read_text())["error"] == ""
    for name in ("rollout.rrd", "rollout.mp4", "hackathon.mp4", "activations.png", "trained/model.zip"):
        assert (small / name).stat().st_size > 1000


def load(path):
    spec = importlib.util.spec_from_file_location("starter_kit", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_notebook_and_script_have_the_same_policy():
    cells = nbformat.read(SCRIPTS / "starter_kit.ipynb", as_version=4).cells
    text = next(cell.source for cell in cells if "POLICY.write_text" in cell.source).split('"""')[1]
    theirs, script = {}, load(SCRIPTS / "starter_kit.py")
    exec(text, theirs)
    rng = np.random.default_rng(0)
    for _ in range(5):
        observation = rng.uniform(-1.0, 1.0, 210).astype(np.float32)
        np.testing.assert_array_equal(theirs["policy"](observation), script.policy(observation))


def test_the_policy_reads_the_object_at_the_right_indices():
    script, names = load(SCRIPTS / "starter_kit.py"), TASK.layout(octopus()).names
    assert names.index("goal/forward") == script.SEEN_FORWARD
    assert names.index("goal/right") == script.SEEN_RIGHT
