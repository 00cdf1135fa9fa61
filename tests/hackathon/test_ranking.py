"""Ranking a folder of submissions."""

import csv
import sys

import pytest

from elastica_gym.console.bad_input import BadInputError
from elastica_gym.hackathon import judge
from elastica_gym.hackathon.scoring import GOALS
from tests.agents.commands import ROOT

TOTALS = {"good.py": 80.0, "also_good.py": 80.0, "fair.zip": 30.0}


@pytest.fixture
def ranking(monkeypatch):
    """Return the script, with a judge that knows the totals."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    import rank

    def known(path, env_id, *, targets, target_seed, n_threads):
        if path.name == "damaged.py":
            raise BadInputError("no function policy")
        error = "" if path.name in TOTALS else "too slow"
        goals = dict.fromkeys((*GOALS, "general"), 0.0)
        return {"total": TOTALS.get(path.name, 0.0), **goals, "error": error}

    monkeypatch.setattr(judge, "judge", known)
    return rank


def test_submissions_are_ranked_and_failures_keep_their_row(ranking, tmp_path, monkeypatch, capsys):
    for name in (*TOTALS, "slow.py", "damaged.py", "notes.txt"):
        (tmp_path / name).write_text("")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "config.yml").write_text("")
    out = tmp_path / "new" / "ranking.csv"
    monkeypatch.setattr(sys, "argv", ["rank.py", str(tmp_path), "--out", str(out)])
    ranking.main()
    rows = list(csv.DictReader(out.open()))
    assert [(row["rank"], row["submission"]) for row in rows] == [
        ("1", "also_good.py"), ("1", "good.py"), ("3", "fair.zip"), ("", "damaged.py"), ("", "run"), ("", "slow.py"),
    ]  # fmt: skip
    assert rows[3]["error"] == "no function policy" and rows[5]["error"] == "too slow"
    assert "ranking.csv" in capsys.readouterr().out


def test_a_folder_without_submissions_is_refused(ranking, tmp_path):
    with pytest.raises(BadInputError, match="folder must hold submissions"):
        ranking.submissions(tmp_path)
