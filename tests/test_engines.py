"""The script of each RL library, run as a user runs it: it learns on our batch."""

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.agents.commands import environment

ROOT = Path(__file__).parents[1]
ENGINES = ROOT / "scripts" / "examples" / "engines"
SCRIPTS = sorted(path.stem for path in ENGINES.glob("*.py"))
"""Called ``<module>_<algorithm>``"""
LEAST_GAIN = 0.1
"""Four standard errors of the difference of two means over 64 episodes of the untrained policy, 0.018 each"""


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS)
def test_it_learns_to_crawl(script, tmp_path):
    module = script.rpartition("_")[0]
    if find_spec(module) is None:
        pytest.skip(f"{module} is not installed")
    budget = ("--env", "tests.toy_snake:toy/SnakeForward-v0", "--steps", 25_600, "--num-envs", 64, "--seed", 0)
    done = subprocess.run(
        [sys.executable, *map(str, (ENGINES / f"{script}.py", *budget))],
        cwd=tmp_path,
        env=environment() | {"OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    # the first line is of the untrained policy
    returns = [float(value) for value in re.findall(r"^steps.* return +(-?[\d.]+)$", done.stdout, re.MULTILINE)]
    assert len(returns) >= 8, done.stdout
    assert returns[-1] > returns[0] + LEAST_GAIN, returns
