"""The commands accept tasks registered elsewhere, and policies in Python files."""

import json

import pytest

from elastica_gym.console.bad_input import choose_environment
from elastica_gym.rl.evaluation import evaluate
from elastica_gym.rl.policies import BASELINES, baseline
from tests.agents.commands import FORWARD, SMALL_PPO, run
from tests.agents.test_bad_input import refused
from tests.envs.tentacle_reach import TENTACLE
from tests.envs.toy import TOY, TOY_GOAL

MODULE = "tests.envs.toy"
POLICY = """
import numpy as np

steps = 0

def policy(observation):
    global steps
    steps += 1
    return np.full(42, 0.01 * steps * np.sign(observation[0]), dtype=np.float32)
"""


@pytest.mark.parametrize(
    ("env_id", "term"), [(f"{MODULE}:{TOY}", "away"), (f"tests.envs.tentacle_reach:{TENTACLE}", "approach")]
)
def test_a_task_from_elsewhere_is_trained_evaluated_and_recorded(tmp_path, env_id, term):
    """With an animal of the package, and with one from elsewhere."""
    folder = tmp_path / "run"
    run("agents.train", "--env", env_id, "--steps", 40, "--imitate", 40, "--folder", folder, *SMALL_PPO)
    output = run("agents.evaluate", "--run", folder, "--episodes", 2, "--record", tmp_path / "seen")
    assert f"reward: {term}" in output and list((tmp_path / "seen").glob("*.rrd"))
    run("agents.train", "--resume", folder, "--steps", 80)


def test_an_id_without_the_module_that_registers_it_is_unknown():
    assert f"Unknown environment '{TOY}'" in refused("agents.train", "--env", TOY)
    assert "Cannot import the module 'no_such'" in refused("agents.train", "--env", f"no_such:{TOY}")
    near = refused("agents.evaluate", "--policy", "zero", "--env", f"{MODULE}:tests/SnakeAwa-v0")
    assert f"did you mean '{TOY}'" in near


@pytest.mark.parametrize("name", BASELINES)
def test_policies_that_ignore_observations_are_evaluated_on_goals(name):
    assert choose_environment(TOY_GOAL, goals=True) == TOY_GOAL
    result = evaluate(baseline(name), TOY_GOAL, episodes=2, seed=0, env_kwargs={"duration": 0.5})
    assert set(result.terms) == {"reached", "diverged"}


@pytest.mark.parametrize(
    ("module", "arguments"), [("agents.train", ()), ("agents.evaluate", ("--pretrained", "snake_reach_ppo"))]
)
def test_commands_without_support_for_goals_say_how_to_train_on_them(module, arguments):
    message = refused(module, "--env", "elastica_gym/SnakeReachGoal-v1", *arguments)
    assert "hindsight experience replay, as the docstring of elastica_gym.envs.goal shows" in message


def test_a_python_file_is_evaluated(tmp_path):
    file, numbers = tmp_path / "mine.py", tmp_path / "numbers.json"
    file.write_text(POLICY)
    asked = "--env", FORWARD, "--episodes", 2, "--json", numbers
    output = run("agents.evaluate", "--policy", file, *asked, "--record", tmp_path / "seen")
    assert "mine.py" in output and list((tmp_path / "seen").glob("*.rrd"))
    forced = json.loads(numbers.read_text())
    run("agents.evaluate", "--policy", "zero", *asked)
    assert forced["terms"]["effort"] < json.loads(numbers.read_text())["terms"]["effort"] == 0.0


def test_files_that_are_not_policies(tmp_path):
    file = tmp_path / "mine.py"
    assert f"There is no policy file {file}" in refused("agents.evaluate", "--policy", file, "--env", FORWARD)
    file.write_text("x = 1")
    assert "has no function policy(observation)" in refused("agents.evaluate", "--policy", file, "--env", FORWARD)
    assert f"{file} needs --env" in refused("agents.evaluate", "--policy", file)
