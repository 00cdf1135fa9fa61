"""The commands as a user runs them, in a separate process."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
FORWARD = "elastica_gym/SnakeForward-v1"
REACH = "elastica_gym/SnakeReach-v1"
SMALL = ("--n-envs", "2", "--evaluations", "1", "--evaluation-episodes", "2", "--recordings", "0")
SMALL_EPISODES = "env_kwargs={duration: 0.5}"
SMALL_PPO = (*SMALL, "--set", "n_steps=20", "batch_size=20", "n_epochs=2", SMALL_EPISODES)
"""Two environments whose episodes have 10 control steps; an iteration is 40 environment steps."""


def arguments(module: str, *args: str | Path) -> list[str]:
    """Return the command line that runs a module of agents."""
    return [sys.executable, "-m", module, *map(str, args)]


def environment() -> dict[str, str]:
    """Return environment variables that let the commands find this repository."""
    return {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200"}


def run(module: str, *args: str | Path, status: int = 0, **options: object) -> str:
    """Run a module of agents to its end, and return its output."""
    done = subprocess.run(
        arguments(module, *args), env=environment(), cwd=ROOT, capture_output=True, text=True, timeout=400, **options
    )  # type: ignore[call-overload]
    output = done.stdout + done.stderr
    assert done.returncode == status, output
    return output
