"""``elastica-gym``: every command from its help to what it leaves behind."""

import subprocess
import sys

import pytest

import elastica_gym
from elastica_gym.commands import COMMANDS
from elastica_gym.envs import GOAL_IDS, IDS
from elastica_gym.files import shipped
from tests.agents.commands import ROOT, environment
from tests.agents.commands import run as run_module

PROGRAM = "from elastica_gym.commands import main; main()"


def run(*arguments, status=0):
    """Run ``elastica-gym``, and return what it printed."""
    return run_module("elastica_gym.commands", *arguments, status=status)


def test_help_names_every_command():
    text = run("--help")
    assert text == run()
    for name, what in COMMANDS.items():
        assert f"  {name} " in text and what in text


@pytest.mark.parametrize("name", COMMANDS)
def test_help_of_a_command_shows_examples(name):
    text = run(name, "--help")
    assert f"Examples:\n  elastica-gym {name}" in text


def test_an_unknown_command_suggests_the_nearest():
    output = run("trian", status=2)
    assert "Unknown command 'trian'; did you mean 'train'?" in output and "Traceback" not in output


def test_the_version():
    assert run("--version") == f"elastica-gym {elastica_gym.__version__}\n"


def test_modules_in_the_current_folder_are_found(tmp_path):
    """As the installed program starts, without Python's own entry for the current folder."""
    (tmp_path / "my_module.py").write_text("print('imported')\n")
    command = [sys.executable, "-P", "-c", PROGRAM, "train", "--env", "my_module:my_lab/Nothing-v0"]
    done = subprocess.run(command, cwd=tmp_path, env=environment(), capture_output=True, text=True)
    assert done.returncode == 2 and "imported" in done.stdout
    assert "Unknown environment 'my_lab/Nothing-v0'" in done.stderr


def test_list_has_every_environment_and_policy():
    text = run("list")
    assert all(env_id in text for env_id in (*IDS, *GOAL_IDS))
    assert all(path.stem in text for path in shipped("pretrained").glob("*.yml"))


def test_doctor_reports_versions_and_drawing():
    text = run("doctor")
    assert elastica_gym.__version__ in text and "compiled kernels" in text and "offscreen drawing" in text


def test_bench_measures_each_environment_and_thread_count():
    text = run("bench", "--envs", 2, "--seconds", 0.1, "--env", "elastica_gym/SnakeForward-v1", "--threads", 2)
    assert text.count("elastica_gym/SnakeForward-v1") == 2
    assert "seconds must be at least" in run("bench", "--seconds", 0, status=2)


@pytest.mark.parametrize("policy", ["zero", "scripted", "snake_forward_ppo", "agents/searched/snake_forward_wave.yml"])
def test_play_records(policy, tmp_path):
    pytest.importorskip("rerun")
    path = tmp_path / "folder" / "episode.rrd"
    run("play", policy, "--env", "elastica_gym/SnakeForward-v1", "--to", path)
    assert path.read_bytes()[:3] == b"RRF"


@pytest.mark.slow
def test_play_films(tmp_path, offscreen):
    path = tmp_path / "episode.gif"
    run("play", "zero", "--env", "elastica_gym/SnakeForward-v1", "--to", path)
    assert path.read_bytes()[:3] == b"GIF"


def test_play_refuses_what_it_does_not_know():
    assert "did you mean 'snake_forward_ppo'" in run("play", "snake_forwrd_ppo", status=2)
    assert "to must be window, browser" in run("play", "zero", "--to", "film.avi", status=2)
    assert "needs --env" in run("play", "zero", "--to", "x.rrd", status=2)


WITHOUT_TORCH = """
import sys
class Gone:
    def find_spec(self, name, *_):
        if name.partition(".")[0] in ("torch", "stable_baselines3", "matplotlib", "cma"):
            raise ModuleNotFoundError(name)
sys.meta_path.insert(0, Gone())
"""


def test_the_demo_needs_no_torch(tmp_path):
    pytest.importorskip("rerun")
    path = tmp_path / "fetch.rrd"
    command = [sys.executable, "-c", WITHOUT_TORCH + PROGRAM, "demo", "--to", str(path)]
    done = subprocess.run(command, env=environment(), cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert path.stat().st_size > 100_000
