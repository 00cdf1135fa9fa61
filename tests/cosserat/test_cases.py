"""The cases of `scripts/cases` keep to theory, and write their pictures."""

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

CASES = Path(__file__).parents[2] / "scripts" / "cases"
NAMES = sorted(path.stem for path in CASES.glob("*.py") if path.stem != "case")


@pytest.mark.parametrize("name", NAMES)
def test_theory(name, monkeypatch):
    monkeypatch.syspath_prepend(str(CASES))
    result = importlib.import_module(name).measure()
    assert result.error <= result.bound


def test_first_script_of_the_readme(capsys):
    text = (CASES.parents[1] / "README.md").read_text()
    (block,) = [each for each in re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL) if "Simulator" in each]
    exec(compile(block, "README.md", "exec"), {"__name__": "readme"})
    assert "[" in capsys.readouterr().out


def test_picture(tmp_path):
    pytest.importorskip("matplotlib")
    command = [sys.executable, str(CASES / "link.py"), "--out", str(tmp_path)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=CASES.parents[1])
    assert "within" in done.stdout
    assert (tmp_path / "link.png").stat().st_size > 1000
