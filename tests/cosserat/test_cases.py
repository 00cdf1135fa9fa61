"""The cases of `scripts/cases` agree with theory and write their pictures."""

import importlib
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

CASES = Path(__file__).parents[2] / "scripts" / "cases"
NAMES = sorted(path.stem for path in CASES.glob("*.py") if path.stem != "case")


@pytest.fixture
def load(monkeypatch):
    """Return a function that imports a case."""
    monkeypatch.syspath_prepend(str(CASES))
    return importlib.import_module


@pytest.mark.parametrize("name", NAMES)
def test_theory(name, load):
    result = load(name).measure()
    assert result.error <= result.bound


def test_a_thick_butterfly_conserves_energy_only_with_reciprocal_tension(load):
    case = load("butterfly")
    # a shorter step does not help
    assert all(case.drift(case.fly(case.PUBLISHED, part)[1]) > 0.05 for part in (0.2, 0.05))
    whole, half = (case.drift(case.fly(case.PUBLISHED, part, is_reciprocal=True)[1]) for part in (0.2, 0.1))
    assert half < 0.55 * whole < 0.55 * 1e-2


def test_a_plectoneme_is_in_contact_with_itself(load):
    case = load("plectoneme")
    nodes = case.wind()[1][-1]
    apart = np.linalg.norm(nodes[:, :, None] - nodes[:, None, :], axis=0)
    i, j = np.indices(apart.shape)
    far_along = apart[i - j > 4.0 * np.pi * case.RADIUS / case.LENGTH * case.N]
    # contact is a spring, compressed by a tenth of a radius
    assert 1.8 * case.RADIUS < far_along.min() < 2.0 * case.RADIUS
    assert case.compute_writhe(nodes[None], case.LENGTH)[0] < -2.5


@pytest.mark.slow
def test_helical_buckling_converges_with_second_order(load):
    case, sizes = load("helical_buckling"), (100, 200, 400)
    errors = [case.error(n, case.slopes(n)) for n in sizes]
    assert -np.polyfit(np.log(sizes), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.2)


def test_first_script_of_the_documentation(capsys):
    text = (CASES.parents[1] / "docs" / "library.md").read_text()
    (block,) = [each for each in re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL) if "Simulator" in each]
    exec(compile(block, "library.md", "exec"), {"__name__": "readme"})
    assert "[" in capsys.readouterr().out


def test_picture(tmp_path):
    pytest.importorskip("matplotlib")
    command = [sys.executable, str(CASES / "link.py"), "--out", str(tmp_path)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=CASES.parents[1])
    assert "within" in done.stdout
    assert (tmp_path / "link.png").stat().st_size > 1000
