"""``import elastica_gym`` is light: it does not import training or rendering libraries."""

import json
import subprocess
import sys

HEAVY = ("torch", "stable_baselines3", "rerun", "matplotlib", "mujoco", "scipy.interpolate", "scipy.optimize")


def test_import_does_not_load_heavy_modules():
    code = f"import json, sys, elastica_gym; print(json.dumps([m for m in {HEAVY!r} if m in sys.modules]))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert json.loads(found) == []


def test_import_takes_less_than_half_a_second_beyond_its_dependencies():
    """In CPU time, minimum of a few runs, which depends little on the machine's load."""
    code = (
        "import time, numpy, numba, gymnasium; t = time.process_time(); import elastica_gym; "
        "print(time.process_time() - t)"
    )
    command = [sys.executable, "-c", code]
    taken = [float(subprocess.run(command, capture_output=True, text=True, check=True).stdout) for _ in range(3)]
    assert min(taken) < 0.5
