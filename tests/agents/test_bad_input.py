"""Bad input gives one line with the cause and the allowed values, and a non-zero status; nothing is lost."""

import importlib.metadata
import resource
import subprocess
import sys

import pytest

from elastica_gym.console import bad_input as checks
from elastica_gym.rl import policies
from elastica_gym.rl.checkpoints import checkpoint_folders, find_damage
from elastica_gym.versions import lowest_of
from tests.agents.commands import FORWARD, ROOT, SMALL_PPO, environment, run


def refused(module: str, *args: object, status: int = 2) -> str:
    output = run(module, *args, status=status)
    assert "Traceback" not in output
    assert output.count("\nerror: ") + output.startswith("error: ") == 1
    return output


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "run"
    run("agents.train", "--steps", 40, "--folder", folder, *SMALL_PPO, "--evaluations", 0)
    return folder


def test_unknown_environment():
    assert f"did you mean '{FORWARD}'" in refused("agents.train", "--env", "elastica_gym/SnakeForwards-v1")
    assert f"did you mean '{FORWARD}'" in refused("agents.evaluate", "--policy", "zero", "--env", "SnakeForward-v1")


def test_unknown_algorithm():
    assert "'pppo'; did you mean 'ppo'? Valid: ppo, sac." in refused("agents.train", "--algo", "pppo")


def test_unknown_hyperparameter():
    assert "'learning_rat'; did you mean 'learning_rate'" in refused("agents.train", "--set", "learning_rat=0.1")


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (("--set", "learning_rate=fast"), "learning_rate must be a number, 0 or more, or 'lin_<number>', got 'fast'"),
        (("--set", "gamma=abc"), "gamma must be a number from 0 to 1, got 'abc'"),
        (("--set", "gamma=1.5"), "gamma must be a number from 0 to 1, got 1.5"),
        (("--set", "n_steps=-3"), "n_steps must be a whole number from 1 to 1,000,000,000, got -3"),
        (("--set", "n_epochs=2.5"), "n_epochs must be a whole number from 1 to 1,000,000,000, got 2.5"),
        (("--set", "normalize_advantage=1"), "normalize_advantage must be true or false, got 1"),
        (("--set", "clip_range=[0.1]"), "clip_range must be a number above 0, or 'lin_<number>', got [0.1]"),
        (("--set", "policy_kwargs=3"), "policy_kwargs must be a mapping such as {key: value}, or none (null), got 3"),
        (("--set", "policy_kwargs={net_arc: [8]}"), "key of policy_kwargs 'net_arc'; did you mean 'net_arch'"),
        (
            ("--set", "policy_kwargs={net_arch: [-8]}"),
            "net_arch of policy_kwargs must be a list of sizes of layers, or dict(pi=[...], vf=[...]), got [-8]",
        ),
        (("--set", "policy=MlpPolicy", "policy_kwargs=dict(log_std_init='x')"), "log_std_init of policy_kwargs must"),
        (("--set", "policy=os.path"), "policy must be a subclass of ActorCriticPolicy for ppo, got 'os.path'"),
        (("--set", "policy=nowhere.Policy"), "There is no policy 'nowhere.Policy'"),
        (("--algo", "sac", "--set", "train_freq=[2, episode]"), "train_freq must be in steps where n_envs is not 1"),
        (
            ("--algo", "sac", "--set", "ent_coef=automatic"),
            "ent_coef must be a number, 0 or more, or 'auto', or 'auto_<number>', got 'automatic'",
        ),
        (("--set", "gamma"), "Expected KEY=VALUE, got 'gamma'"),
        (("--set", "gamma=["), "The value of gamma is not YAML: '['"),
        (("--set", "n_timesteps=abc"), "n_timesteps must be a number of environment steps from 1 to 1,000,000,000"),
        (("--set", "normalize=dict(norm_ob=True)"), "Unknown key of normalize 'norm_ob'; did you mean 'norm_obs'"),
        (("--set", "policy=Mlp"), "Unknown policy 'Mlp'; did you mean 'MlpPolicy'"),
        (("--set", "batch_size=1"), "Stable-Baselines3 refuses the hyperparameters: "),
        (("--set", "env_kwargs={sim_dt: 1.0}"), "The environment refuses its arguments: sim_dt"),
        (("--n-envs", "0"), "n_envs must be a whole number from 1 to 4,096, got 0"),
        (("--steps", "0"), "steps must be at least 1, got 0"),
        (("--minutes", "0"), "minutes must be at least 0.001, got 0"),
        (("--minutes", "nan"), "minutes must be at least 0.001, got nan"),
        (("--seed", "4294967296"), "seed must be from 0 to 4294967295, got 4294967296"),
        (("--evaluation-seed", "1999981"), "evaluation_seed must be from 1000000 to 1999980, got 1999981: 20 seeds"),
    ],
)
def test_bad_training_options(option, message, tmp_path):
    folder = tmp_path / "run"
    assert message in refused("agents.train", "--folder", folder, *option)
    assert not list(folder.glob("*"))  # the same folder can be used again


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (("--threads", 0), "threads must be at least 1, got 0"),
        (("--threads", 4097), "threads must be at most 4096, got 4097"),
        (("--seed", -1), "seed must be at least 0, got -1"),
        (("--episodes", 0), "episodes must be at least 1, got 0"),
    ],
)
def test_bad_evaluation_options(option, message):
    assert message in refused("agents.evaluate", "--policy", "zero", "--env", FORWARD, *option)


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (("--env", "elastica_gym/SnakeForwards-v1"), f"'elastica_gym/SnakeForwards-v1'; did you mean '{FORWARD}'"),
        (("--env", FORWARD, "--n-envs", 0), "n_envs must be at least 1, got 0"),
        (("--env", FORWARD, "--sim-dt", 1.0), "The environment refuses its arguments: sim_dt"),
    ],
)
def test_bad_options_of_count_divergence(option, message):
    assert message in refused("scripts.count_divergence", *option)


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (("scripts.make_table", "--episodes", 0), "episodes must be at least 1, got 0"),
        (("scripts.make_table", "--minutes", "nan"), "minutes must be at least 0.001, got nan"),
        (("scripts.make_table", "--seeds", 0), "seeds must be at least 1, got 0"),
        (("scripts.search_carrying", "--grabs", 0), "grabs must be at least 1, got 0"),
        (("scripts.search_carrying", "--population", 4096, "--trials", 2), "population times trials, must be at most"),
        (("agents.search", "--population", 5000), "The environment refuses its arguments: num_envs"),
        (("scripts.quickstart", "--episodes", 0), "episodes must be at least 1, got 0"),
        (("scripts.starter_kit", "--targets", 0), "targets must be at least 1, got 0"),
        (("scripts.starter_kit", "--spread", "ark"), "Unknown spread 'ark'; did you mean 'arc'"),
        (("scripts.make_animations", "--env", "OctopusFetch"), "did you mean 'elastica_gym/OctopusFetch-v1'"),
        (("scripts.make_animations", "--every", 0), "every must be at least 1, got 0"),
        (("scripts.make_animations", "--size", 0, 0), "size must be two even numbers up to 2048, got 0 0"),
        (("scripts.draw_activations", "--output", "/proc/x/y.png"), "Cannot write into the folder /proc/x"),
        (("scripts.draw_muscles", "--output", "/proc/x/y.png"), "Cannot write into the folder /proc/x"),
        (("scripts.score", "--policy", "nowhere.py"), "There is no policy nowhere.py"),
    ],
)
def test_scripts_refuse_bad_options_in_one_line(command, message, tmp_path):
    module, *options = command
    # commands with a default output must not write into the repository
    out = ("--out", tmp_path) if module.rpartition(".")[2] in ("make_table", "quickstart", "starter_kit") else ()
    out = ("--folder", tmp_path) if module == "agents.search" else out
    out = ("--out", tmp_path / "gait.yml") if module == "scripts.search_carrying" else out
    assert message in refused(module, *options, *out)


def test_unknown_spread():
    octopus = "--policy", "zero", "--env", "elastica_gym/OctopusReach-v1"
    assert "'everywhere'; did you mean 'anywhere'? Valid: anywhere, arc, default." in refused(
        "agents.evaluate", *octopus, "--spread", "everywhere"
    )


def test_the_gait_of_the_snake_is_refused_for_the_octopus():
    message = refused("agents.evaluate", "--policy", "seed_gait", "--env", "elastica_gym/OctopusCrawl-v1")
    assert "seed_gait is the snake's published gait" in message


def test_unknown_policy():
    assert "'scriptd'; did you mean 'scripted'" in refused("agents.evaluate", "--policy", "scriptd", "--env", FORWARD)
    assert "either --run DIR, --pretrained NAME or --policy" in refused("agents.evaluate", "--env", FORWARD)


WITHOUT = """
import importlib.metadata, runpy, sys
gone = {"cma", "matplotlib", "stable_baselines3", "torch"}
class Gone:
    def find_spec(self, name, *_):
        if name.partition(".")[0] in gone:
            raise ModuleNotFoundError(name)
sys.meta_path.insert(0, Gone())
there = importlib.metadata.version
def version(name):
    if name.replace("-", "_") in gone:
        raise importlib.metadata.PackageNotFoundError(name)
    return there(name)
importlib.metadata.version = version
sys.argv = sys.argv[1:]
runpy.run_path(sys.argv[0], run_name="__main__")
"""
"""Runs a program without the packages of the extra train"""


@pytest.mark.parametrize(
    "program",
    [
        "agents/train.py",
        "agents/evaluate.py",
        "agents/search.py",
        "scripts/score.py --policy x",
        "scripts/make_table.py",
        "scripts/count_divergence.py",
        "scripts/search_carrying.py",
        "scripts/draw_muscles.py",
        "scripts/draw_activations.py",
    ],
)
def test_missing_packages(program):
    command = [sys.executable, "-c", WITHOUT, *program.split()]
    done = subprocess.run(command, env=environment(), cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("\n") == 1 and "error: stable-baselines3 is not installed, torch is" in done.stderr
    assert done.stderr.endswith(": pip install 'elastica-gym[train]'\n")


@pytest.mark.parametrize("program", ["agents/train.py", "scripts/score.py"])
def test_help_needs_no_packages(program):
    command = [sys.executable, "-c", WITHOUT, program, "--help"]
    done = subprocess.run(command, env=environment(), cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0 and "Examples:" in done.stdout, done.stderr


def test_old_packages(monkeypatch):
    there = importlib.metadata.version
    monkeypatch.setattr(importlib.metadata, "version", lambda p: "0.25.1rc2" if p == "rerun-sdk" else there(p))
    lowest = lowest_of("viz")["rerun-sdk"]
    message = f"rerun-sdk 0.25.1rc2 is older than {lowest}: pip install 'elastica-gym[viz]'"
    assert checks.missing_extra("viz") == message


def test_out_of_memory(tmp_path):
    # more than a process can address, even with overcommit
    huge = "--n-envs", 1024, "--set", "n_steps=1000000000"
    output = refused("agents.train", "--folder", tmp_path, *huge, status=1)
    assert "error: not enough memory: " in output


def test_unwritable_folder():
    assert "Cannot write into the folder /proc/runs" in refused("agents.train", "--folder", "/proc/runs")
    output = refused("agents.evaluate", "--policy", "zero", "--env", FORWARD, "--record", "/proc/rec")
    assert "Cannot write into the folder /proc/rec" in output


def test_a_run_is_not_overwritten(finished):
    before = (finished / "model.zip").read_bytes()
    assert "already has a run" in refused("agents.train", "--folder", finished)
    assert (finished / "model.zip").read_bytes() == before


def test_full_disk_keeps_the_last_checkpoint(finished):
    """A limit on file size simulates the full disk: a write fails midway."""
    before = checkpoint_folders(finished / "checkpoints")

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))

    output = run("agents.train", "--resume", finished, "--steps", 80, status=1, preexec_fn=limit)
    assert "Traceback" not in output
    assert "File too large" in output
    assert f"python -m agents.train --resume {finished}" in output
    assert checkpoint_folders(finished / "checkpoints") == before
    assert find_damage(before[-1]) is None


def test_nothing_to_resume(tmp_path):
    assert "is not the folder of a run" in refused("agents.train", "--resume", tmp_path / "nowhere")
    (tmp_path / "config.yml").write_text("env: [")
    assert "config.yml is damaged" in refused("agents.train", "--resume", tmp_path)
    assert "config.yml is damaged" in refused("agents.evaluate", "--run", tmp_path)


@pytest.mark.parametrize("content", [b"", b"PK", b"no zip"])
def test_damaged_model(tmp_path, content):
    (tmp_path / "config.yml").write_text(
        f"{{env: {FORWARD}, algo: ppo, seed: 0, hyperparameters: {{normalize: true}}}}"
    )
    (tmp_path / "model.zip").write_bytes(content)
    with pytest.raises(checks.BadInputError, match=r"model.zip is missing or damaged"):
        policies.load_run(tmp_path)


def test_damaged_statistics(finished, tmp_path):
    for name in ("config.yml", "model.zip"):
        (tmp_path / name).write_bytes((finished / name).read_bytes())
    with pytest.raises(checks.BadInputError, match=r"vecnormalize.pkl are missing or damaged"):
        policies.load_run(tmp_path)
    (tmp_path / "vecnormalize.pkl").write_bytes((finished / "vecnormalize.pkl").read_bytes()[:100])
    assert "vecnormalize.pkl are missing or damaged" in refused("agents.evaluate", "--run", tmp_path)
