"""``import elastica_gym`` is light: whoever steps an environment does not wait for what trains or draws."""

import json
import subprocess
import sys

HEAVY = ("torch", "stable_baselines3", "rerun", "matplotlib", "mujoco", "scipy.interpolate", "scipy.optimize")


def test_import_brings_none_of_the_heavy_ones():
    code = f"import json, sys, elastica_gym; print(json.dumps([m for m in {HEAVY!r} if m in sys.modules]))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert json.loads(found) == []
