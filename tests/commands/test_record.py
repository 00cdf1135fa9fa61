"""Datasets in Minari's format: they load back, with the returns of the episodes."""

import re

import numpy as np
import pytest

from elastica_gym.rl.evaluation import evaluate
from elastica_gym.rl.policies import baseline
from tests.commands.test_command_line import run

minari = pytest.importorskip("minari")
pytest.importorskip("h5py")
pytest.importorskip("jax")
FORWARD = "elastica_gym/SnakeForward-v1"


def test_a_dataset_loads_back_with_equal_returns(tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    what = ("--policy", "scripted", "--env", FORWARD, "--episodes", 2, "--seed", 11, "--dataset", "snake/scripted-v0")
    output = run("record", *what)
    dataset = minari.load_dataset("snake/scripted-v0")
    returns = [float(np.sum(episode.rewards)) for episode in dataset.iterate_episodes()]
    expected = evaluate(baseline("scripted"), FORWARD, episodes=2, seed=11).returns
    np.testing.assert_allclose(returns, expected, rtol=1e-12)
    assert float(re.search(r"mean return ([-\d.]+)", output)[1]) == pytest.approx(np.mean(returns), abs=1e-3)
    assert all("is_success" in episode.infos for episode in dataset.iterate_episodes())
    assert "exists already" in run("record", *what, status=2)


def test_names_that_minari_refuses_are_named(tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    what = ("--policy", "zero", "--env", FORWARD, "--episodes", 1)
    assert "got 'no version'" in run("record", *what, "--dataset", "no version", status=2)
