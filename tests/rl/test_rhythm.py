"""A policy that observes the clocks of the strokes it learns."""

import numpy as np
import pytest
import torch
from stable_baselines3 import PPO

from elastica_gym.rl.hyperparameters import CONFIGS, algorithm_arguments, load
from elastica_gym.rl.policies import load_run
from elastica_gym.rl.rhythm import MOST, Rhythms
from elastica_gym.rl.vec_env import make_batch_vec_env
from tests.agents.commands import SMALL, SMALL_EPISODES, run

PERIODS = (0.37, 1.85)
RETURN = "elastica_gym/OctopusReturn-v1"


@pytest.fixture
def envs():
    made = make_batch_vec_env(RETURN, n_envs=2)
    yield made
    made.close()


def rhythms(envs):
    names, duration = envs.batch.observation_names, envs.batch.max_episode_steps * envs.batch.control_dt
    return Rhythms(envs.observation_space, time_left=names.index("time_left"), duration=duration, periods=PERIODS)


def test_clocks_follow_the_time_of_the_episode(envs):
    features, n = rhythms(envs), len(envs.batch.observation_names)
    observations = envs.reset()
    for step in range(12):
        clocks = features(torch.as_tensor(observations))[:, n:].numpy()
        angle = 2.0 * np.pi * step * envs.batch.control_dt / np.array(PERIODS)
        np.testing.assert_allclose(clocks, np.tile([*np.sin(angle), *np.cos(angle)], (2, 1)), atol=1e-4)
        observations, *_ = envs.step(np.zeros((2, 42), np.float32))


def test_observations_are_scaled(envs):
    features, n = rhythms(envs), len(envs.batch.observation_names)
    seen = torch.randn(1000, n) * torch.linspace(0.1, 20.0, n) + torch.linspace(-3.0, 3.0, n)
    seen[:, 0] = 0.5
    features.fit(seen)
    scaled = features(seen)[:, :n]
    assert scaled.abs().max() <= MOST
    torch.testing.assert_close(scaled.mean(dim=0), torch.zeros(n), atol=1e-3, rtol=0.0)
    torch.testing.assert_close(scaled[:, 1:].std(dim=0), torch.ones(n - 1), atol=1e-3, rtol=0.0)
    assert torch.all(scaled[:, 0] == 0.0)


def test_a_saved_model_keeps_scale_and_clocks(envs, tmp_path):
    values = load("ppo", RETURN, config=CONFIGS / "imitation.yml") | {"n_envs": 2, "n_steps": 8, "batch_size": 16}
    model = PPO(env=envs, **algorithm_arguments(values))
    observations = envs.reset()
    model.policy.features_extractor.fit(torch.randn(100, observations.shape[1]))
    model.save(tmp_path / "model.zip")
    wanted, _ = model.predict(observations, deterministic=True)
    given, _ = PPO.load(tmp_path / "model.zip").predict(observations, deterministic=True)
    np.testing.assert_array_equal(given, wanted)


def test_runs_start_from_the_networks_of_another(tmp_path):
    small = (*SMALL, "--imitate", 80, "--steps", 0, "--config", CONFIGS / "imitation.yml", "--set", SMALL_EPISODES)
    run("agents.train", "--env", RETURN, "--folder", tmp_path / "first", *small)
    run("agents.train", "--env", RETURN, "--folder", tmp_path / "second", *small, "--start-from", tmp_path / "first")
    first, second = (load_run(tmp_path / name)[0] for name in ("first", "second"))
    assert first.normalization is None
    start, end = (policy.model.policy.state_dict()["action_net.weight"] for policy in (first, second))
    # differently initialised weights would stay different
    assert torch.nn.functional.cosine_similarity(start.flatten(), end.flatten(), dim=0) > 0.5
