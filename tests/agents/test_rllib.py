"""``--engine rllib``: what it takes from the configuration, what it refuses, and training."""

import csv

import numpy as np
import pytest
import yaml

from elastica_gym.console.bad_input import BadInputError
from elastica_gym.rl import comparison, hyperparameters, rllib_engine
from elastica_gym.rl.cluster import require_ray
from elastica_gym.rl.evaluation import evaluate
from elastica_gym.rl.policies import load_run
from elastica_gym.rl.run_files import read_table
from tests.agents.commands import FORWARD, run


def has_rllib():
    try:
        require_ray("ray", "ray.rllib")
    except BadInputError:
        return False
    return True


needs_rllib = pytest.mark.skipif(not has_rllib(), reason="RLlib is not installed")


def test_the_shipped_configuration_corresponds_but_for_what_is_named():
    values = hyperparameters.load("ppo", FORWARD)
    assert rllib_engine.left_out(values) == [
        "target_kl=0.15",
        "policy=elastica_gym.rl.symmetry.SymmetricPolicy",
        "norm_reward=True",
    ]
    kept = rllib_engine.own_hyperparameters(values)
    assert hyperparameters.checked("ppo", kept) == kept and rllib_engine.left_out(kept) == []
    assert rllib_engine.layers(kept) == ([128, 128], "tanh")
    arguments = rllib_engine.training_arguments(kept, steps=1000)
    assert arguments["lr"] == [[0, 0.0006], [1000, 0.0]] and arguments["train_batch_size_per_learner"] == 64 * 50
    assert (arguments["minibatch_size"], arguments["num_epochs"], arguments["lambda_"]) == (800, 8, 0.92)


@pytest.mark.parametrize("kwargs", ["dict(net_arch=dict(pi=[8], vf=[16]))", "dict(activation_fn=nn.Softsign)"])
def test_other_networks_are_refused(kwargs):
    with pytest.raises(BadInputError, match="--engine rllib"):
        rllib_engine.layers({"policy": "MlpPolicy", "policy_kwargs": kwargs})


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--imitate", 1000), "--engine rllib does not support --imitate, got 1000"),
        (("--algo", "sac"), "--engine rllib trains with ppo only, got --algo sac"),
        (("--minutes", 1), "--engine rllib needs --steps"),
        (("--env-runners", 0), "env_runners must be at least 1, got 0"),
    ],
    ids=str,
)
def test_senseless_combinations_are_refused(arguments, message, tmp_path, monkeypatch, capsys):
    from elastica_gym.commands import run

    command = ("--engine", "rllib", *arguments, "--folder", tmp_path / "run")
    monkeypatch.setattr("sys.argv", ["elastica-gym train", *map(str, command)])
    with pytest.raises(SystemExit):
        run("train")
    assert message in capsys.readouterr().err and not (tmp_path / "run").exists()


@pytest.mark.skipif(has_rllib(), reason="RLlib is installed")
def test_missing_rllib_is_named(tmp_path):
    text = run("agents.train", "--engine", "rllib", "--folder", tmp_path / "run", status=2)
    assert "is not installed" in text and not (tmp_path / "run").exists()


@needs_rllib
@pytest.mark.slow
def test_rllib_learns_to_crawl_and_the_run_is_an_ordinary_one(tmp_path):
    """Episodes of 1 s, in which the return of random actions is below 0."""
    config = tmp_path / "config.yml"
    values = {
        **{"n_envs": 16, "n_steps": 50, "batch_size": 200, "n_epochs": 8, "learning_rate": 0.001, "gamma": 0.9},
        **{"policy": "MlpPolicy", "normalize": "dict(norm_obs=True, norm_reward=False)"},
        **{"policy_kwargs": "dict(net_arch=[64, 64], log_std_init=-1.0)", "env_kwargs": {"duration": 1.0}},
    }
    config.write_text(yaml.safe_dump({"default": values}))
    folder = tmp_path / "run"
    options = ("--env", FORWARD, "--evaluations", 2, "--evaluation-episodes", 8, "--recordings", 0, "--threads", 1)
    run("agents.train", "--engine", "rllib", "--config", config, "--env-runners", 1, "--steps", STEPS // 2,
        *options, "--folder", folder)  # fmt: skip
    assert len(read_table(folder / "metrics.csv")["steps"]) == STEPS // 2 / 800

    # continue to twice the steps
    run("agents.train", "--resume", folder, "--steps", STEPS)
    metrics = read_table(folder / "metrics.csv")
    assert metrics["steps"].tolist() == list(range(800, STEPS + 1, 800))
    random = evaluate(RandomActions(), FORWARD, episodes=16, seed=1_000_000, env_kwargs={"duration": 1.0})
    assert np.mean(metrics["return"][-3:]) > max(metrics["return"][0], random.returns.mean()) + 0.01

    # the saved model is the one that was evaluated
    policy, _ = load_run(folder)
    again = evaluate(policy, FORWARD, episodes=8, seed=1_000_000, env_kwargs={"duration": 1.0})
    last = list(csv.DictReader((folder / "evaluations.csv").open()))[-1]
    assert again.returns.mean() == pytest.approx(float(last["return"]), rel=1e-4)
    assert [setting.name for setting in comparison.settings_of([folder])] == ["all runs"]


STEPS = 16_000


class RandomActions:
    """Actions as random as those of the untrained policy, whose standard deviation is 1/e."""

    def reset(self, seeds):
        self._random = np.random.default_rng(0)

    def __call__(self, observations, batch):
        return self._random.normal(0.0, np.exp(-1.0), batch.action_space.shape).astype(np.float32)
