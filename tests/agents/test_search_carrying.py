"""The search for the gait with which the scripted octopus carries its object home."""

import subprocess
import sys
from types import ModuleType

import gymnasium
import numpy as np
import pytest
import yaml
from gymnasium.vector import AutoresetMode

from elastica_gym.scripted.octopus_fetch import HOMEWARD, carry
from tests.agents.commands import ROOT, environment

RETURN = "elastica_gym/OctopusReturn-v1"


@pytest.fixture
def script(monkeypatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    import search_carrying

    return search_carrying


def make(n: int):
    return gymnasium.make_vec(RETURN, num_envs=n, duration=1.0, autoreset_mode=AutoresetMode.DISABLED).unwrapped


def test_a_gait_is_restored_from_its_numbers(script):
    gait = HOMEWARD
    again = script.gait_of(script.numbers_of(gait))
    np.testing.assert_array_equal(script.numbers_of(again), script.numbers_of(gait))
    assert (again.course, again.width) == (gait.course, gait.width)


def test_trials_begin_where_environments_were(script):
    """Combined in another order and number, they continue bit for bit."""
    batch, other = make(3), make(4)
    batch.reset(seed=5)
    other.reset(seed=9)
    batch.step(batch.levels.copy())
    saved = batch.get_state()
    order = [2, 0, 2, 1]
    other.set_state({**other.get_state(), **script.together([script.each_of(saved, i) for i in order])})
    mine, *_ = batch.step(batch.levels.copy())
    theirs, *_ = other.step(other.levels.copy())
    np.testing.assert_array_equal(theirs, mine[order])


def test_the_first_arm_carries_as_the_mirror_image():
    """Ahead and behind are exchanged, and so are the arms' activations; the last direction uses a slow gait."""
    way = np.array([[0.3, -0.4], [-0.1, -0.5], [0.2, 0.3]])
    time = np.array([0.1, 0.75, 1.3])
    second = carry(way, time, np.ones(3, dtype=np.int64))
    first = carry(way * [-1.0, 1.0], time, np.zeros(3, dtype=np.int64))
    arms = second.reshape(3, 3, 2, 7)
    np.testing.assert_array_equal(first.reshape(3, 3, 2, 7), arms[:, :, ::-1])
    assert np.ptp(second[:, 7:14]) == 0.0 and (second[:, 7:14] == 1.0).all()


def test_a_short_search(tmp_path):
    out = tmp_path / "found" / "gait.yml"
    command = [
        sys.executable,
        "scripts/search_carrying.py",
        "--generations",
        "1",
        "--population",
        "4",
        "--trials",
        "1",
        "--grabs",
        "4",
        "--out",
        str(out),
    ]
    done = subprocess.run(command, cwd=ROOT, env=environment(), capture_output=True, text=True, timeout=400)
    assert done.returncode == 0 and f"wrote {out}" in done.stdout, done.stdout + done.stderr
    found = yaml.safe_load(out.read_text())
    assert np.shape(found["table"]) == (3, 9) and len(found["steering"]) == 9
    assert found["period"] == pytest.approx(HOMEWARD.period, abs=0.05)
