"""rl_zoo3 trains from the same configuration files."""

import gymnasium
import pytest
from stable_baselines3 import PPO
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize

from elastica_gym.rl.hyperparameters import algorithm_arguments, load
from elastica_gym.rl.symmetry import SymmetricPolicy
from tests.agents.commands import FORWARD, REACH, ROOT, run

pytest.importorskip("rl_zoo3")
optuna = pytest.importorskip("optuna")
from rl_zoo3.hyperparams_opt import HYPERPARAMS_CONVERTER, HYPERPARAMS_SAMPLER  # noqa: E402


@pytest.mark.parametrize(
    ("algo", "env_id", "small"),
    [
        ("ppo", FORWARD, ("n_steps:20", "batch_size:20")),
        ("sac", REACH, ("learning_starts:10", "gradient_steps:1")),
    ],
)
def test_rl_zoo3_trains_from_the_same_file(tmp_path, algo, env_id, small):
    run(
        "rl_zoo3.train",
        "--algo",
        algo,
        "--env",
        env_id,
        "--gym-packages",
        "elastica_gym",
        "--conf-file",
        ROOT / "configs" / f"{algo}.yml",
        "-n",
        40,
        "--eval-freq",
        -1,
        "--num-threads",
        1,
        "--seed",
        1,
        "-f",
        tmp_path,
        "-params",
        "n_envs:2",
        *small,
        "--env-kwargs",
        "duration:0.5",
    )
    assert len(list((tmp_path / algo).rglob("*.zip"))) == 1


@pytest.mark.parametrize("env_id", [FORWARD, "elastica_gym/SnakeSteer-v1", "elastica_gym/OctopusCrawl-v1"])
def test_rl_zoo3_searches_the_hyperparameters_of_our_policies(env_id):
    """Its samples replace all arguments of the policy."""
    values = algorithm_arguments(load("ppo", env_id))
    drawn = optuna.create_study().ask()
    HYPERPARAMS_SAMPLER["ppo"](drawn, 42, 1, {})
    sampled = HYPERPARAMS_CONVERTER["ppo"](drawn.params)
    assert "policy_kwargs" in sampled
    envs = DummyVecEnv([lambda: Monitor(gymnasium.make(env_id, duration=0.5))])
    model = PPO(env=VecNormalize(envs), device="cpu", **values | sampled | {"n_steps": 8, "batch_size": 8})
    assert isinstance(model.learn(8).policy, SymmetricPolicy)
