"""The benchmark table: its statistics, and the command that computes it cell by cell."""

import importlib.util
import json
import re
import subprocess
import sys

import numpy as np
import pytest

from elastica_gym.console.bad_input import BadInputError
from tests.agents.commands import ROOT, environment

SCRIPT = ROOT / "scripts" / "make_table.py"
spec = importlib.util.spec_from_file_location("make_table", SCRIPT)
assert spec is not None and spec.loader is not None
make_table = importlib.util.module_from_spec(spec)
sys.modules["make_table"] = make_table
spec.loader.exec_module(make_table)


def command(*arguments, status=0):
    line = [sys.executable, str(SCRIPT), *map(str, arguments)]
    done = subprocess.run(line, env=environment(), cwd=ROOT, capture_output=True, text=True, timeout=400)
    assert done.returncode == status, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    return done.stdout + done.stderr


def test_the_interquartile_mean_leaves_out_a_quarter_on_either_side():
    assert make_table.interquartile_mean(np.array([-1e9, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 1e9])) == 3.5


def test_intervals_cover_the_truth_and_grow_with_the_difference_between_seeds():
    rng = np.random.default_rng(1)
    same = rng.normal(1.0, 0.5, (3, 100))
    low, high = make_table.bootstrap_interval(same)
    assert low < make_table.interquartile_mean(same.ravel()) < high
    # the standard error of an interquartile mean of 300 normal draws is 1.1 times that of the mean
    assert 0.06 < high - low < 0.2
    apart = same + np.array([[-1.0], [0.0], [1.0]])
    wide_low, wide_high = make_table.bootstrap_interval(apart)
    assert wide_high - wide_low > 4.0 * (high - low)
    covered = [
        bounds[0] < 0.0 < bounds[1]
        for bounds in (make_table.bootstrap_interval(rng.normal(0.0, 1.0, (1, 50))) for _ in range(60))
    ]
    assert 50 <= sum(covered) <= 60


def test_cells():
    cells = make_table.cells_of(make_table.Arguments())
    assert len(set(cells)) == len(cells)
    for env_id in make_table.IDS:
        kinds = [cell.policy for cell in cells if cell.env_id == env_id]
        assert kinds[:3] == ["zero", "random", "scripted"] and kinds.count("cma") == 1 and kinds.count("ppo") == 3
    assert len({cell.env for cell in cells if cell.policy == "sac"}) == 3
    shipped = {cell.env for cell in cells if cell.policy == "pretrained"}
    assert shipped == set(make_table.pretrained()) >= {"SnakeForward-v1", "OctopusCrawl-v1"}
    few = make_table.cells_of(make_table.Arguments(only=("elastica_gym/SnakeReach-v1", "sac", "zero"), seeds=2))
    assert [cell.name for cell in few] == ["SnakeReach-v1-zero-0", "SnakeReach-v1-sac-0", "SnakeReach-v1-sac-1"]


def test_the_table_is_computed_cell_by_cell(tmp_path):
    """With a few seconds of training, after a kill during a cell, which leaves a folder without a result."""
    cells = tmp_path / "cells"
    killed = cells / "SnakeForward-v1-ppo-0"
    killed.mkdir(parents=True)
    (killed / "config.yml").write_text("of a run that was killed")
    options = "--minutes", 0.02, "--seeds", 1, "--episodes", 2, "--out", tmp_path
    which = "--only", "SnakeForward-v1", "zero", "cma", "ppo"
    assert "0 of 3 cells are there already" in command(*options, *which)
    results = {path.stem: json.loads(path.read_text()) for path in cells.glob("*.json")}
    assert sorted(results) == [f"SnakeForward-v1-{policy}-0" for policy in ("cma", "ppo", "zero")]
    for name, cell in results.items():
        assert len(cell["returns"]) == len(cell["distances"]) == 2
        assert (cell["seconds"] > 0.0) == ("zero" not in name)
        assert "compiled for" in cell["cpu"] and "commit" in cell
    table = (tmp_path / "table.md").read_text()
    assert cell["cpu"] in table and "another CPU" in table
    rows = [line.split(" | ") for line in table.splitlines() if line.startswith("| Snake")]
    assert [row[1] for row in rows] == ["zero", "CMA-ES", "PPO"]
    mean, low, high = map(float, re.fullmatch(r"(.*) \((.*) to (.*)\)", rows[1][3]).groups())
    assert low <= mean <= high
    assert mean == pytest.approx(np.mean(results["SnakeForward-v1-cma-0"]["distances"]), abs=1e-3)
    assert (tmp_path / "table.png").read_bytes().startswith(b"\x89PNG")

    written = {path: path.stat().st_mtime_ns for path in cells.glob("*.json")}
    assert "3 of 3 cells are there already" in command(*options, *which)
    assert {path: path.stat().st_mtime_ns for path in cells.glob("*.json")} == written
    assert (tmp_path / "table.md").read_text() == table


def test_cells_of_other_settings_are_not_mixed(tmp_path):
    (tmp_path / "settings.json").write_text('{"minutes": 5.0, "episodes": 2, "evaluation_seed": 2000000, "threads": 2}')
    message = command("--out", tmp_path, "--minutes", 3, "--episodes", 2, "--only", "zero", status=2)
    assert "have minutes 5.0, not 3.0: use another --out" in message
    assert "'pppo'; did you mean 'ppo'" in command("--out", tmp_path, "--only", "pppo", status=2)


@pytest.mark.parametrize("text", ["{", "3", "{}"])
def test_damaged_files_of_a_table_are_named(tmp_path, text):
    (tmp_path / "settings.json").write_text(text)
    message = command("--out", tmp_path, "--only", "zero", status=2)
    assert f"{tmp_path / 'settings.json'} is damaged, delete it" in message
    (tmp_path / "cells").mkdir(exist_ok=True)
    (tmp_path / "cells" / "SnakeForward-v1-zero-0.json").write_text(text)
    with pytest.raises(BadInputError, match=r"SnakeForward-v1-zero-0\.json is damaged, delete it"):
        make_table.read_cells(tmp_path / "cells")


@pytest.mark.slow
def test_off_policy_cells(tmp_path):
    command("--minutes", 0.02, "--seeds", 1, "--episodes", 2, "--out", tmp_path, "--only", "SnakeForward-v1", "sac")
    assert "| SnakeForward-v1 | SAC |" in (tmp_path / "table.md").read_text()
