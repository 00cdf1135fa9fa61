"""Sweeps: syntax, trials, the table, and continuing; without Ray."""

import csv
import importlib.util

import pytest
import yaml

from elastica_gym.commands.train import TrainArguments, config_of
from elastica_gym.console.bad_input import BadInputError
from elastica_gym.rl import sweep
from elastica_gym.rl.sweep import Range, Trial
from tests.agents.commands import FORWARD, REACH
from tests.commands.test_command_line import run

VALUES = {
    **{"n_envs": 2, "policy": "MlpPolicy", "n_steps": 20, "batch_size": 20, "n_epochs": 2},
    "env_kwargs": {"duration": 0.5},
}


@pytest.fixture
def config(tmp_path):
    """Runs of two iterations."""
    file = tmp_path / "config.yml"
    file.write_text(yaml.safe_dump({"default": VALUES}))
    arguments = TrainArguments(
        env=FORWARD, config=file, steps=80, threads=1, evaluations=1, evaluation_episodes=2, recordings=0
    )
    return config_of(arguments)


def test_values_are_separated_by_commas_outside_of_brackets():
    found = sweep.parse_values(["gamma=0.95,0.98", "net={pi: [64, 64]},{pi: [8, 8]}", "n_envs=32"])
    assert found == {"gamma": [0.95, 0.98], "net": [{"pi": [64, 64]}, {"pi": [8, 8]}], "n_envs": [32]}


def test_ranges():
    texts = ["learning_rate=lin_log(1e-4,1e-3)", "n_epochs=int(4,12)", "clip_range=choice(0.1,0.2)"]
    assert sweep.parse_ranges(texts) == [
        Range("learning_rate", "lin_", "log", (1e-4, 1e-3)),
        Range("n_epochs", "", "int", (4, 12)),
        Range("clip_range", "", "choice", (0.1, 0.2)),
    ]


def test_a_setting_and_its_sampled_value_are_the_same():
    decaying = Range("learning_rate", "lin_", "log", (1e-4, 1e-3))
    assert decaying.setting(0.00034) == "lin_0.00034"
    assert decaying.sampled(decaying.setting(1 / 3000)) == 1 / 3000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--set", "gama=0.9,0.95"], "Unknown key of the ppo configuration 'gama'; did you mean 'gamma'?"),
        (["--set", "gamma=0.9,1.5"], "gamma must be a number from 0 to 1, got 1.5"),
        (["--set", "gamma=0.9,0.9"], "The values of gamma must differ"),
        (["--set", "n_timesteps=10,20"], "n_timesteps is the same for all trials: give it with --steps"),
        (["--search", "gamma=0.9"], "Expected KEY=KIND(LOW,HIGH)"),
        (["--search", "gamma=lag(0.9,0.99)"], "Unknown kind of search 'lag'; did you mean 'log'?"),
        (["--search", "gamma=uniform(0.9,1.1)"], "gamma must be a number from 0 to 1, got 1.1"),
        (["--search", "gamma=uniform(0.99,0.9)"], "uniform needs a lowest and a highest value"),
        (["--search", "gamma=uniform(low,0.9)"], "The range of gamma needs numbers, got 'low'"),
        (["--search", "n_epochs=uniform(4,12)"], "n_epochs must be a whole number"),
        (["--search", "gamma=log(0,1)"], "log needs values above 0"),
        (["--search", "gamma=uniform(0.9,0.95)", "gamma=uniform(0.9,0.99)"], "can be searched once"),
        (["--search", "gamma=uniform(0.9,0.95)", "--set", "n_epochs=2,4"], "--search 'n_epochs=choice(2,4)'"),
        (["--search", "gamma=uniform(0.9,0.95)", "--set", "gamma=0.9"], "gamma is both set and searched"),
        (["--search", "gamma=uniform(0.9,0.95)", "--env", FORWARD, REACH], "a single environment"),
        (["--seeds", "1", "1"], "seeds must be one or several different values"),
        (["--seeds", "-1"], "seeds must be from 0"),
        (["--evaluations", "0"], "evaluations must be at least 1"),
        (["--env", "elastica_gym/SnakeForwrd-v1"], "did you mean 'elastica_gym/SnakeForward-v1'?"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)  # fmt: skip
def test_bad_input_is_named_before_anything_is_written(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["elastica-gym sweep", *arguments, "--out", str(tmp_path / "out")])
    monkeypatch.setattr("elastica_gym.rl.cluster.require_ray", lambda *packages: None)
    from elastica_gym.commands import run

    with pytest.raises(SystemExit):
        run("sweep")
    error = capsys.readouterr().err
    assert message in error and len(error.splitlines()) == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(importlib.util.find_spec("ray") is not None, reason="Ray is installed")
def test_missing_ray_is_named():
    assert "ray is not installed" in (text := run("sweep", status=2)) and "elastica-gym[ray]" in text


def test_the_grid_has_every_combination():
    trials = sweep.grid([FORWARD, "my_lab:my_lab/Reach-v0"], [0, 1], {"gamma": [0.9, 0.95]})
    assert len({trial.folder for trial in trials}) == len(trials) == 8
    assert trials[0].folder == "SnakeForward-v1/gamma=0.9-seed=0" and trials[-1].seed == 1


def test_folders_of_long_settings_differ():
    one, other = (Trial(FORWARD, 0, {"policy_kwargs": f"dict(net_arch=[{n}])" + 100 * " "}) for n in (64, 128))
    assert one.folder != other.folder and len(one.folder) < 130 and "[" not in one.folder


def test_a_trial_is_an_ordinary_run_that_is_not_repeated(config, tmp_path):
    trial = Trial(FORWARD, 3, {"gamma": 0.9})
    score = sweep.run_trial(tmp_path, trial, config)
    folder = tmp_path / trial.folder
    written = yaml.safe_load((folder / "config.yml").read_text())
    assert written["seed"] == 3 and written["hyperparameters"]["gamma"] == 0.9
    assert "evaluation at 80 steps" in (folder / sweep.LOG).read_text()
    before = (folder / "model.zip").stat().st_mtime_ns
    assert sweep.run_trial(tmp_path, trial, config) == score
    assert (folder / "model.zip").stat().st_mtime_ns == before
    (row,) = sweep.rows_of(tmp_path)
    assert row["status"] == "finished" and row["retries"] == 0 and row["score"] == score and row["steps"] == 80


def test_a_trial_whose_process_died_continues_from_its_checkpoint(config, tmp_path, monkeypatch):
    from elastica_gym.rl.training import Training

    trial, checkpoint = Trial(FORWARD, 0, {}), Training._checkpoint

    def die(self):
        checkpoint(self)
        raise KeyboardInterrupt

    config["checkpoint_minutes"] = 0.0
    monkeypatch.setattr(Training, "_checkpoint", die)
    with pytest.raises(KeyboardInterrupt):
        sweep.run_trial(tmp_path, trial, config)
    assert [row["status"] for row in sweep.rows_of(tmp_path)] == ["running"]
    monkeypatch.setattr(Training, "_checkpoint", checkpoint)
    sweep.run_trial(tmp_path, trial, config)
    (row,) = sweep.rows_of(tmp_path)
    assert (row["status"], row["retries"], row["steps"]) == ("finished", 1, 80)
    metrics = list(csv.DictReader((tmp_path / trial.folder / "metrics.csv").open()))
    assert [line["steps"] for line in metrics] == ["40", "80"]


def test_a_trial_that_fails_is_in_the_table_and_tried_again(config, tmp_path):
    trial = Trial(FORWARD, 0, {"env_kwargs": {"duration": -1.0}})
    for retries in (0, 1):
        sweep.run_trial(tmp_path, trial, config)
        (row,) = csv.DictReader(sweep.table_csv(sweep.rows_of(tmp_path)).splitlines())
        assert row["status"] == "failed" and row["retries"] == str(retries)
        assert "duration must be" in row["error"] and row["score"] == "nan"


@pytest.fixture
def ended(tmp_path):
    """A sweep of two settings and two seeds, one of which still runs."""
    for gamma, seed, score in ((0.9, 0, 1.0), (0.9, 1, 3.0), (0.95, 0, 4.0), (0.95, 1, None)):
        trial = Trial(FORWARD, seed, {"gamma": gamma})
        record = sweep.announce(tmp_path, trial)
        if score is not None:
            rows = [f"0,0.0,0.1,{2 * score}", f"40,{score},0.2,0.0", f"80,{score - 1},0.3,0.0"]
            (tmp_path / trial.folder / "evaluations.csv").write_text(
                "\n".join(["steps,return,distance,success", *rows]) + "\n"
            )
            sweep._write(tmp_path / trial.folder, {**record, "status": "finished"})
    return tmp_path


def test_the_score_is_that_of_the_best_checkpoint(ended):
    rows = sweep.rows_of(ended)
    assert [row["score"] for row in rows[:3]] == [4.0, 3.0, 1.0] and rows[0]["score_steps"] == 40
    assert rows[0]["distance"] == 0.2 and rows[3]["status"] == "waiting"


def test_a_search_continues_with_the_settings_whose_seeds_have_not_ended(ended):
    ranges = [Range("gamma", "", "uniform", (0.8, 1.0))]
    finished, unfinished = sweep.evaluated_points(ended, FORWARD, [0, 1], ranges)
    assert finished == [({"gamma": 0.9}, 2.0)] and unfinished == [{"gamma": 0.95}]


def test_another_configuration_needs_another_folder(config, tmp_path):
    sweep.open_sweep(tmp_path, {FORWARD: config})
    sweep.open_sweep(tmp_path, {FORWARD: config, "elastica_gym/SnakeReach-v1": config})
    with pytest.raises(BadInputError, match="has another steps for elastica_gym/SnakeForward-v1: use another --out"):
        sweep.open_sweep(tmp_path, {FORWARD: {**config, "steps": 90}})
