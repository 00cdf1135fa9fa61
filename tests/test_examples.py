"""Every example runs as a user runs it, and every block of Python in the documentation."""

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.agents.commands import SMALL_PPO, environment

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "scripts" / "examples"
OPTIONAL = {"agilerl", "skrl", "sbx", "tianshou", "torchrl"}
"""Modules whose blocks are left out where they are not installed"""
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))]


def run(*command, folder):
    variables = environment() | {"PYTHONPATH": f"{ROOT}:{EXAMPLES}"}
    done = subprocess.run(
        [sys.executable, *map(str, command)], cwd=folder, env=variables, capture_output=True, text=True, timeout=400
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_every_example_is_tested():
    tested = {"ppo_single_file", "sb3_ppo", "hindsight", "my_policy", "my_task", "my_body"}
    assert {path.stem for path in EXAMPLES.glob("*.py")} == tested


def test_ppo_in_one_file(tmp_path):
    # past the end of the first episodes, which all end in the same step
    output = run(EXAMPLES / "ppo_single_file.py", "--steps", 1000, "--num-envs", 4, "--rollout", 50, folder=tmp_path)
    assert [line.split()[1] for line in output.splitlines()] == ["200", "400", "600", "800", "1,000"]


def test_its_advantages_bootstrap_truncated_episodes_and_not_terminated_ones(monkeypatch):
    monkeypatch.syspath_prepend(str(EXAMPLES))
    import numpy as np
    import ppo_single_file

    rewards, values = np.ones((2, 2)), np.full((3, 2), 10.0)
    terminated = np.array([[True, False], [False, False]])
    ended = np.array([[True, True], [False, False]])
    found = ppo_single_file.advantages_of(rewards, values, ended, terminated, gamma=0.5, decay=1.0)
    np.testing.assert_allclose(found, [[1.0 - 10.0, 1.0 + 5.0 - 10.0], [1.0 + 5.0 - 10.0] * 2])


def test_stable_baselines3(tmp_path):
    run(EXAMPLES / "sb3_ppo.py", "--steps", 200, "--num-envs", 4, folder=tmp_path)
    assert (tmp_path / "snake_ppo.zip").exists()


@pytest.mark.slow
def test_hindsight(tmp_path):
    run(EXAMPLES / "hindsight.py", "--steps", 1700, "--num-envs", 4, "--learning-starts", 1600, folder=tmp_path)
    assert (tmp_path / "snake_her.zip").exists()


def test_a_policy_file_crawls(tmp_path):
    file = EXAMPLES / "my_policy.py"
    run("-m", "agents.evaluate", "--policy", file, "--env", "elastica_gym/SnakeForward-v1", "--episodes", 4,
        "--json", tmp_path / "numbers.json", folder=ROOT)  # fmt: skip
    distance = float(re.search(r'"distance_mean": ([-\d.e]+)', (tmp_path / "numbers.json").read_text())[1])
    assert distance > 0.1


@pytest.mark.parametrize("env_id", ["my_task:my_lab/SnakeTurn-v0", "my_body:my_lab/WormForward-v0"])
def test_a_task_and_a_body_of_ones_own_are_trained_and_evaluated(env_id, tmp_path):
    config = tmp_path / "config.yml"
    config.write_text(f"{env_id.partition(':')[2]}:\n  n_envs: 2\n  n_timesteps: 80\n  policy: MlpPolicy\n")
    run("-m", "agents.train", "--env", env_id, "--config", config, "--steps", 80, *SMALL_PPO, "--folder",
        tmp_path / "run", folder=ROOT)  # fmt: skip
    run("-m", "agents.evaluate", "--run", tmp_path / "run", "--episodes", 2, folder=ROOT)


@pytest.mark.parametrize("page", [page for page in PAGES if "```python" in page.read_text()], ids=lambda p: p.stem)
def test_blocks_of_python_run(page, tmp_path):
    """In the order of the page, each after those before it."""
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)
    script = tmp_path / "page.py"
    script.write_text("\n".join(block for block in blocks if can_run(block)))
    run(script, folder=tmp_path)


def can_run(block):
    imported = set(re.findall(r"^(?:from|import) (\w+)", block, re.MULTILINE))
    return all(find_spec(name) for name in imported & OPTIONAL)
