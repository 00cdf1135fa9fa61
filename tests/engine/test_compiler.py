"""Compiled kernels: cached between processes, recompiled when their source changes, and vectorised."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import llvmlite.binding
import pytest

ROOT = Path(__file__).parents[2]

# an entry in one file that calls a helper in another: small, so that it compiles quickly
HELPER = "from ..jit.compiler import inline\n\n\n@inline\ndef value(x):\n    return x + {}\n"
PROBE = "from ..jit.compiler import entry\nfrom .helper import value\n\n\n@entry\ndef probe(x):\n    return value(x)\n"
RUN = "from elastica_gym.engine.kernels.probe import probe; print(probe(1.0))"


@pytest.fixture
def copied(tmp_path):
    """Copy the package and add a small kernel; return the folder that holds it."""
    package = tmp_path / "elastica_gym"
    without = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "elastica_gym" / "engine", package / "engine", ignore=without)
    (package / "__init__.py").write_text("")
    (package / "engine" / "kernels" / "helper.py").write_text(HELPER.format("1.0"))
    (package / "engine" / "kernels" / "probe.py").write_text(PROBE)
    return tmp_path


def start(folder, code, **variables):
    ours = {"PYTHONPATH": str(folder), "ELASTICA_GYM_CACHE_DIR": str(folder / "cache")}
    return subprocess.Popen(
        [sys.executable, "-c", code],
        env={**os.environ, **ours, **variables},
        cwd=folder,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


def run(folder, code=RUN, **variables):
    """Return status, stdout and stderr of a process."""
    process = start(folder, code, **variables)
    output, errors = process.communicate(timeout=120)
    return process.returncode, output.strip(), errors


def test_cached_and_announced(copied):
    assert run(copied)[:2] == (0, "2.0")
    status, output, errors = run(copied)
    assert (status, output, errors) == (0, "2.0", "")


def test_changed_callee_in_another_file(copied):
    status, output, errors = run(copied)
    assert "compiling probe" in errors
    (copied / "elastica_gym" / "engine" / "kernels" / "helper.py").write_text(HELPER.format("2.0"))
    status, output, errors = run(copied)
    assert (status, output) == (0, "3.0")
    assert "compiling probe" in errors


def test_entry_outside_the_physics(copied):
    """An entry of another package is recompiled when its own file changes."""
    outside = copied / "elastica_gym" / "outside.py"
    text = "from elastica_gym.engine.jit.compiler import entry\n\n\n@entry\ndef probe(x):\n    return x * {}\n"
    code = "from elastica_gym.outside import probe; print(probe(1.0))"
    for factor in ("5.0", "7.0"):
        outside.write_text(text.format(factor))
        assert run(copied, code)[:2] == (0, factor)


def test_two_cold_processes_at_once(copied):
    both = [start(copied, RUN) for _ in range(2)]
    for process in both:
        output, errors = process.communicate(timeout=120)
        assert (process.returncode, output.strip()) == (0, "2.0"), errors
    assert run(copied)[2] == ""


def test_folder_that_cannot_be_written(copied):
    (copied / "file").write_text("")
    status, _, errors = run(copied, ELASTICA_GYM_CACHE_DIR=str(copied / "file" / "cache"))
    assert status != 0
    assert "cannot write compiled kernels" in errors and "ELASTICA_GYM_CACHE_DIR" in errors


def test_home_that_cannot_be_written(copied):
    """Kernels are then cached in the temporary folder."""
    (copied / "file").write_text("")
    temporary = copied / "temporary"
    temporary.mkdir()
    elsewhere = dict(ELASTICA_GYM_CACHE_DIR="", XDG_CACHE_HOME=str(copied / "file"), TMPDIR=str(temporary))
    assert run(copied, **elsewhere)[:2] == (0, "2.0")
    assert list(temporary.rglob("*.nbi"))


def test_disk_that_is_full(copied):
    """The kernel then works, but is not cached."""
    code = (
        "import tempfile; from numba.core import caching\n"
        "def full(*args): raise OSError(28, 'No space left on device')\n"
        "caching.IndexDataCacheFile.save = full\n"
    ) + RUN
    status, output, errors = run(copied, code)
    assert (status, output) == (0, "2.0")
    assert "not kept" in errors and "No space left" in errors


# LLVM's code of the stages

ASSEMBLY = """
import inspect, re, sys
from numba import types
from elastica_gym.engine.kernels.contact import plane
from elastica_gym.engine.kernels.rod import curvature, dynamics, kinematics, strains

row, scalar = types.Array(types.float64, 1, "C"), types.float64
rows = types.UniTuple(row, 3)
shape = {
    **dict.fromkeys("x v w force torque kappa lever axis couple target before after stress push axial axial_material "
                    "rest_kappa rest_sigma S J B inv_inertia".split(), rows),
    **dict.fromkeys("h dt rate k_plane nu_plane surface_tol surface_part slip_tol".split(), scalar),
    **dict.fromkeys(("first", "n"), types.uint64), **dict.fromkeys(("is_balanced", "is_muscular"), types.boolean),
    "Q": types.UniTuple(rows, 3),
    "share": types.UniTuple(row, 2), "weight": types.UniTuple(row, 2),
}
for stage in (kinematics.kinematics, strains.stretch, strains.strains, curvature.relative_rotation, curvature.logarithm,
              curvature.bending, plane.normal_response, plane.slip_velocity, plane.kinetic_friction,
              plane.static_friction, dynamics.dynamics):
    stage.compile(tuple(shape.get(name, row) for name in inspect.signature(stage.py_func).parameters))
    code = "".join(stage.inspect_asm().values())
    print(stage.py_func.__name__, len(re.findall(r"vfn?m(?:add|sub)\\d+pd.*[yz]mm", code)))
"""


def test_stages_are_vectorised(tmp_path):
    features = llvmlite.binding.get_host_cpu_features()
    if not features.get("fma"):
        pytest.skip("this CPU has no vector fused multiply-add")
    environment = dict(os.environ, ELASTICA_GYM_CACHE_DIR=str(tmp_path), PYTHONPATH=str(ROOT))
    output = subprocess.run(
        [sys.executable, "-c", ASSEMBLY], env=environment, check=True, capture_output=True, text=True, timeout=300
    ).stdout
    counts = {name: int(count) for name, count in (line.split() for line in output.splitlines())}
    assert len(counts) == 11
    assert all(count > 0 for count in counts.values()), counts
