import csv
import itertools
from types import SimpleNamespace

import numpy as np
import pytest
import torch
import yaml
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.vec_env import VecNormalize

from elastica_gym.commands.train import TrainArguments, _started
from elastica_gym.envs import observation_names
from elastica_gym.rl import hyperparameters, training, transfer
from elastica_gym.rl.cards import command_of, load_pretrained, read_card
from elastica_gym.rl.policies import load_run
from elastica_gym.rl.run_files import METRICS, read_table
from elastica_gym.rl.seeds import training_seeds
from elastica_gym.rl.vec_env import make_batch_vec_env
from tests.agents.commands import FORWARD, REACH, SMALL, SMALL_EPISODES, SMALL_PPO, run

CRAWL, STEER = "elastica_gym/OctopusCrawl-v1", "elastica_gym/SnakeSteer-v1"


@pytest.fixture(scope="module")
def ppo_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "ppo"
    output = run(
        "agents.train",
        "--env",
        FORWARD,
        "--steps",
        200,
        "--folder",
        folder,
        *SMALL_PPO,
        "gamma=0.9",
        "learning_rate=lin_0.001",
        "--recordings",
        1,
    )
    assert f"python -m agents.evaluate --run {folder}" in output
    return folder


def test_a_run_writes_its_files(ppo_run):
    names = {path.name for path in ppo_run.iterdir()}
    assert names == {
        "config.yml",
        "model.zip",
        "vecnormalize.pkl",
        "metrics.csv",
        "evaluations.csv",
        "learning_curve.png",
        "checkpoints",
        "recordings",
        "best",
    }
    config = yaml.safe_load((ppo_run / "config.yml").read_text())
    assert config["env"] == FORWARD and config["algo"] == "ppo" and config["seed"] == 0 and config["steps"] == 200
    assert config["hyperparameters"]["gamma"] == 0.9 and config["hyperparameters"]["n_envs"] == 2
    assert "torch" in config["versions"]
    assert (ppo_run / "learning_curve.png").read_bytes().startswith(b"\x89PNG")
    assert len(list((ppo_run / "recordings").glob("*.rrd"))) == 1


def test_tables_of_a_run(ppo_run):
    rows = list(csv.DictReader((ppo_run / "metrics.csv").open()))
    assert [int(row["steps"]) for row in rows] == [40, 80, 120, 160, 200]
    assert float(rows[0]["length"]) == 10
    assert float(rows[1]["learning_rate"]) == pytest.approx(0.001 * 0.6)
    last = rows[-1]
    terms = sum(float(value) for key, value in last.items() if key.startswith("reward_"))
    assert terms == pytest.approx(float(last["return"]), abs=1e-4)
    evaluations = list(csv.DictReader((ppo_run / "evaluations.csv").open()))
    assert [int(row["steps"]) for row in evaluations] == [0, 200]


def test_the_model_with_the_best_evaluation_is_kept(ppo_run):
    evaluations = list(csv.DictReader((ppo_run / "evaluations.csv").open()))
    best, config = load_run(ppo_run / "best")
    assert best.model.num_timesteps == int(max(evaluations, key=lambda row: float(row["return"]))["steps"])
    assert config == load_run(ppo_run)[1]


def test_the_loop_equals_that_of_stable_baselines3(ppo_run):
    values = yaml.safe_load((ppo_run / "config.yml").read_text())["hyperparameters"]
    env = VecNormalize(
        make_batch_vec_env(FORWARD, n_envs=2, **values["env_kwargs"]), **hyperparameters.normalize_arguments(values)
    )
    torch.set_num_threads(1)
    model = PPO(env=env, seed=0, device="cpu", **hyperparameters.algorithm_arguments(values))
    env.venv.seed(training_seeds(0, 0, 2))
    model.learn(200)
    trained, _ = load_run(ppo_run)
    for name, value in model.policy.state_dict().items():
        assert torch.equal(value, trained.model.policy.state_dict()[name]), name
    np.testing.assert_array_equal(env.obs_rms.mean, trained.normalization.obs_rms.mean)


def test_evaluation_of_a_run(ppo_run, tmp_path):
    output = run("agents.evaluate", "--run", ppo_run, "--episodes", 3, "--json", tmp_path / "out" / "numbers.json")
    assert "reward: forward" in output and "success rate" in output and "diverged" in output
    assert "return_mean" in (tmp_path / "out" / "numbers.json").read_text()


def test_curves_of_several_runs(ppo_run, tmp_path):
    run("agents.plot_curves", "--env", FORWARD, "--runs", ppo_run, ppo_run, "--out", tmp_path / "curves.png")
    assert (tmp_path / "curves.png").read_bytes().startswith(b"\x89PNG")
    assert REACH in run("agents.plot_curves", "--env", REACH, "--runs", ppo_run, status=2)


def test_a_run_starts_from_the_networks_of_another(ppo_run, tmp_path):
    # with learning rate zero, the saved networks are the initial ones
    run(
        "agents.train",
        "--env",
        FORWARD,
        "--steps",
        40,
        "--start-from",
        ppo_run,
        "--folder",
        tmp_path / "next",
        *SMALL_PPO,
        "learning_rate=0.0",
    )
    begun, theirs = (load_run(folder)[0] for folder in (tmp_path / "next", ppo_run))
    weights = begun.model.policy.state_dict()
    for name, value in theirs.model.policy.state_dict().items():
        assert torch.equal(value, weights[name]) == (name != "log_std"), name
    assert begun.normalization.obs_rms.count > theirs.normalization.obs_rms.count
    output = run(
        "agents.train",
        "--env",
        CRAWL,
        "--steps",
        40,
        "--start-from",
        ppo_run,
        "--folder",
        tmp_path / "misfit",
        *SMALL_PPO,
        status=2,
    )
    assert "do not fit" in output and FORWARD in output and "missing here: " in output


def test_a_run_starts_from_a_pretrained_policy(tmp_path):
    run(
        "agents.train",
        "--env",
        REACH,
        "--steps",
        40,
        "--start-from",
        "snake_reach_ppo",
        "--folder",
        tmp_path / "next",
        *SMALL_PPO,
        "learning_rate=0.0",
    )
    begun, theirs = load_run(tmp_path / "next")[0], load_pretrained("snake_reach_ppo")[0]
    weights = begun.model.policy.state_dict()
    for name, value in theirs.model.policy.state_dict().items():
        assert torch.equal(value, weights[name]) == (name != "log_std"), name
    # those of its training, and forty more
    assert begun.normalization.obs_rms.count >= read_card("snake_reach_ppo")["steps"] + 40
    np.testing.assert_allclose(begun.normalization.obs_rms.mean, theirs.normalization.mean, atol=1e-3)
    config = yaml.safe_load((tmp_path / "next" / "config.yml").read_text())
    assert config["start_from"] == "snake_reach_ppo" and "--start-from snake_reach_ppo" in command_of(config)
    output = run(
        "agents.train",
        "--env",
        REACH,
        "--start-from",
        "snake_rech_ppo",
        "--folder",
        tmp_path / "none",
        *SMALL_PPO,
        status=2,
    )
    assert "snake_rech_ppo is neither" in output and "snake_reach_ppo" in output


def test_new_observations_have_no_effect_at_first(ppo_run, tmp_path):
    run(
        "agents.train",
        "--env",
        STEER,
        "--steps",
        40,
        "--start-from",
        ppo_run,
        "--folder",
        tmp_path / "next",
        *SMALL_PPO,
        "learning_rate=0.0",
    )
    begun, theirs = (load_run(folder)[0] for folder in (tmp_path / "next", ppo_run))
    before, now = observation_names(FORWARD), observation_names(STEER)
    new = [i for i, name in enumerate(now) if name not in before]
    assert [now[i] for i in new] == ["goal/speed", "pace/forward", "pace/right"]
    seen = np.random.default_rng(0).normal(size=(5, len(now))).astype(np.float32)
    actions = theirs.model.predict(np.delete(seen, new, axis=1), deterministic=True)[0]
    assert np.abs(actions).max() > 1e-3
    np.testing.assert_allclose(begun.model.predict(seen, deterministic=True)[0], actions, atol=1e-6)


def test_statistics_of_new_observations():
    known = RunningMeanStd(shape=(2,))
    known.mean[:], known.var[:], known.count = [1.0, 2.0], [3.0, 4.0], 1e6
    wide = transfer.statistics(known, 3, transfer.places(["a", "c"], ["a", "b", "c"]))
    assert wide.mean.tolist() == [1.0, 0.0, 2.0] and wide.var.tolist() == [3.0, 0.0, 4.0]
    assert wide.count == transfer.KNOWN
    assert transfer.statistics(known, 2, [0, 1]) is known


@pytest.mark.slow
def test_a_minute_is_a_budget(tmp_path, monkeypatch):
    # a clock that advances by a second per reading, so that nothing depends on the machine
    seconds = itertools.count()
    monkeypatch.setattr(training, "time", SimpleNamespace(monotonic=lambda: float(next(seconds))))
    overrides = [SMALL_EPISODES, "n_steps=20", "batch_size=20", "n_epochs=2", "learning_rate=lin_0.001"]
    arguments = TrainArguments(minutes=1.0, n_envs=2, evaluations=0, recordings=0, folder=tmp_path, set=overrides)
    folder, config = _started(arguments)
    (folder / "config.yml").write_text(yaml.safe_dump(config))
    assert training.Training(folder, config, resume=False).run()
    rows = list(csv.DictReader((folder / "metrics.csv").open()))
    rates = [float(row["learning_rate"]) for row in rows]
    assert len(rates) > 1 and rates == sorted(rates, reverse=True) and rates[-1] < 0.8 * 0.001
    assert float(rows[-1]["seconds"]) <= 60.0


def test_sac_is_resumed_with_its_replay_buffer(tmp_path):
    folder = tmp_path / "run"
    run(
        "agents.train",
        "--algo",
        "sac",
        "--env",
        REACH,
        "--steps",
        300,
        "--folder",
        folder,
        *SMALL,
        "--set",
        "learning_starts=100",
        "gradient_steps=1",
        "batch_size=16",
        "buffer_size=600",
        SMALL_EPISODES,
    )
    assert _filled(folder) == 256
    before = load_run(folder)[0].model
    assert isinstance(before, SAC)
    run("agents.train", "--resume", folder, "--steps", 800)
    assert _filled(folder) == 300
    after = load_run(folder)[0].model
    assert after.num_timesteps == 1024 and after._n_updates > before._n_updates > 100


def test_metrics_of_sac_have_columns_for_losses_from_the_start(tmp_path):
    folder = tmp_path / "run"
    run(
        "agents.train",
        "--algo",
        "sac",
        "--steps",
        1024,
        "--folder",
        folder,
        *SMALL,
        "--evaluations",
        0,
        "--set",
        "learning_starts=600",
        "gradient_steps=1",
        "batch_size=16",
        "buffer_size=600",
        SMALL_EPISODES,
    )
    metrics = read_table(folder / METRICS)
    for name in ("actor_loss", "critic_loss", "ent_coef", "n_updates", "learning_rate"):
        assert np.isfinite(metrics[name]).tolist() == [False, True], name


def _filled(folder) -> int:
    newest = max((folder / "checkpoints").iterdir())
    with np.load(newest / "replay_buffer.npz") as saved:
        return len(saved["rewards"])
