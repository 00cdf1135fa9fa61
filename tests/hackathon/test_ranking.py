"""Ranking a folder of submissions."""

import csv
import os
import subprocess
import sys

from tests.agents.commands import ROOT

STILL = "import numpy as np\n\n\ndef policy(observation):\n    return np.zeros(42)\n"
BROKEN = "def policy(observation):\n    raise ValueError('tired')\n"


def run(*arguments, status=0):
    command = [sys.executable, str(ROOT / "scripts" / "rank.py"), *map(str, arguments)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200"}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=600)
    assert done.returncode == status, done.stderr
    return done.stdout + done.stderr


def test_submissions_are_ranked_and_failures_keep_their_row(tmp_path):
    (tmp_path / "still.py").write_text(STILL)
    (tmp_path / "broken.py").write_text(BROKEN)
    (tmp_path / "notes.txt").write_text("no submission")
    script = ROOT / "agents" / "pretrained" / "octopus_fetch_script.py"
    (tmp_path / "fetch.py").write_text(script.read_text())
    output = run(tmp_path, "--targets", 1, "--target-seed", 7, "--out", tmp_path / "new" / "ranking.csv")
    rows = list(csv.DictReader((tmp_path / "new" / "ranking.csv").open()))
    assert [row["submission"] for row in rows] == ["fetch.py", "broken.py", "still.py"]
    assert [row["rank"] for row in rows] == ["1", "2", "2"]
    assert float(rows[0]["points"]) > 0.0 == float(rows[1]["points"])
    assert "tired" in rows[1]["error"] and rows[2]["error"] == ""
    assert "ranking.csv" in output


def test_a_folder_without_submissions_is_refused(tmp_path):
    assert "folder must hold submissions" in run(tmp_path, status=2)
