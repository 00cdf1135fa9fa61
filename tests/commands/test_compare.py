"""Comparing runs: settings, intervals, files."""

import csv

import numpy as np
import pytest
import yaml
from scipy import stats

from elastica_gym.rl import comparison
from elastica_gym.rl.run_files import EVALUATIONS
from tests.commands.test_command_line import run

STEPS = (0, 100, 200)


@pytest.fixture
def runs(tmp_path):
    """Two seeds of each of two values of gamma; the return at the end is 10 gamma + seed."""
    folders = []
    for gamma in (0.5, 0.9):
        for seed in (0, 1):
            folder = tmp_path / f"run-{gamma}-{seed}"
            folder.mkdir()
            config = {"env": "elastica_gym/SnakeForward-v1", "algo": "ppo", "seed": seed, "steps": 200}
            (folder / "config.yml").write_text(yaml.safe_dump({**config, "hyperparameters": {"gamma": gamma}}))
            last = 10.0 * gamma + seed
            rows = [f"{s},{last * s / 200},0.5,{0.1 * s / 200},0.0,{seed},{last * s / 200}" for s in STEPS]
            columns = "steps,return,return_ci95,distance,distance_ci95,success,reward_forward"
            (folder / EVALUATIONS).write_text("\n".join([columns, *rows]) + "\n")
            folders.append(folder)
    return folders


def test_runs_are_told_apart_by_what_differs_but_the_seed(runs):
    assert [s.name for s in comparison.settings_of(runs)] == ["gamma=0.5", "gamma=0.9"]
    assert [len(s.runs) for s in comparison.settings_of(runs)] == [2, 2]
    assert [s.name for s in comparison.settings_of(runs, ["seed"])] == ["seed=0", "seed=1"]
    assert len(comparison.settings_of(runs, ["gamma", "seed"])) == 4
    assert [s.name for s in comparison.settings_of(runs[:2])] == ["all runs"]


def test_the_interval_is_students(runs):
    curve = comparison.curve_of(comparison.settings_of(runs)[0].tables, "return")
    assert curve.mean[-1] == pytest.approx(5.5)
    low, _ = stats.t.interval(0.95, 1, loc=5.5, scale=stats.sem([5.0, 6.0]))
    assert curve.half[-1] == pytest.approx(5.5 - low)
    assert np.isnan(comparison.interval(np.ones((1, 3)))).all()


def test_the_command_writes_picture_tables_and_recording(runs, tmp_path):
    text = run("compare", *runs, "--by", "gamma", "--out", tmp_path / "out")
    assert "gamma=0.9" in text
    rows = list(csv.DictReader((tmp_path / "out" / "scores.csv").open()))
    assert [float(row["return"]) for row in rows] == [5.5, 9.5]
    assert [row["runs"] for row in rows] == ["2", "2"]
    assert len((tmp_path / "out" / "curves.csv").read_text().splitlines()) == 1 + 4 * len(STEPS)
    assert (tmp_path / "out" / "comparison.png").read_bytes()[:4] == b"\x89PNG"
    assert (tmp_path / "out" / "comparison.rrd").read_bytes()[:3] == b"RRF"


def test_bad_input_is_named(runs, tmp_path):
    assert "Unknown setting 'gama'; did you mean 'gamma'?" in run("compare", *runs, "--by", "gama", status=2)
    assert "is the folder of a run with evaluations" in run("compare", tmp_path, status=2)


def test_what_is_no_run_with_evaluations_is_left_out(runs, tmp_path):
    (runs[0] / EVALUATIONS).write_text("")
    (tmp_path / "empty").mkdir()
    output = run("compare", *runs, tmp_path / "empty", "--out", tmp_path / "out")
    assert f"Left out, as no run with evaluations: {runs[0]}, {tmp_path / 'empty'}" in output
    rows = csv.DictReader((tmp_path / "out" / "scores.csv").open())
    assert sum(int(row["runs"]) for row in rows) == len(runs) - 1
