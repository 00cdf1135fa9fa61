"""Version ranges: defined in one place; versions outside are named with the command that fixes them."""

import subprocess
import sys
import tomllib
import warnings
from pathlib import Path

import numba
import numpy as np
import pytest

from elastica_gym import versions

ROOT = Path(__file__).parents[1]
RANGES = {"numpy": ">=2.0", "numba": ">=0.62,<0.69", "gymnasium": ">=1.2"}
INSTALLED = {"numpy": "2.0.0", "numba": "0.68.1", "gymnasium": "1.2"}


def test_ranges_are_those_of_the_project():
    given = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    ranges = versions._ranges(given)
    assert ranges.keys() == set(versions.CHECKED)
    # the installed versions are within
    versions.require_within(ranges, {**INSTALLED, "numpy": np.__version__, "numba": numba.__version__})
    # pip reverses the bounds
    assert versions._ranges(["numba<0.69,>=0.62", "torch>=2.3; extra == 'train'", "numpy>=2.0"]) == {
        "numba": "<0.69,>=0.62",
        "numpy": ">=2.0",
    }


@pytest.mark.parametrize("numba", ["0.62", "0.62.0", "0.62.1", "0.68.1", "0.68.2rc1"])
def test_versions_within_are_silent(numba):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        versions.require_within(RANGES, {**INSTALLED, "numba": numba})


@pytest.mark.parametrize(("name", "version"), [("numba", "0.61.2"), ("numpy", "1.26.4"), ("gymnasium", "1.1.1")])
def test_older_versions_raise_with_a_fix(name, version):
    command = f"not {version}; fix it with: pip install '{name}{RANGES[name]}'"
    with pytest.raises(ImportError) as raised:
        versions.require_within(RANGES, {**INSTALLED, name: version})
    assert command in str(raised.value)


@pytest.mark.parametrize("version", ["0.69", "0.69.0", "0.70.1", "1.0"])
def test_newer_versions_give_a_warning(version):
    with pytest.warns(RuntimeWarning, match=f"not {version}; fix it with: pip install 'numba>=0.62,<0.69'"):
        versions.require_within(RANGES, {**INSTALLED, "numba": version})


def test_import_checks_versions():
    code = "import importlib.metadata as m; real = m.version; m.requires = lambda name: ['numba<0.69,>=0.62']; "
    code += "m.version = lambda name: '0.61.0' if name == 'numba' else real(name); import elastica_gym"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stderr.strip().splitlines()[-1] == (
        "ImportError: elastica_gym works with numba<0.69,>=0.62, not 0.61.0; "
        "fix it with: pip install 'numba<0.69,>=0.62'"
    )
