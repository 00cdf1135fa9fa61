"""A network first imitates the scripted policy, then learns from rewards."""

from contextlib import nullcontext

import numpy as np
import torch

from elastica_gym.rl.hyperparameters import algorithm_arguments, load
from elastica_gym.rl.imitation import CRITIC_UPDATES, LEARNING_RATES, ROUNDS, _difference, critic_alone
from elastica_gym.rl.policies import load_run
from elastica_gym.rl.run_files import EVALUATIONS, METRICS, read_table
from elastica_gym.rl.vec_env import make_batch_vec_env
from elastica_gym.scripted import scripted_policy
from tests.agents.commands import FORWARD, SMALL_PPO, run
from tests.agents.test_bad_input import refused

NO_STEP = "learning_rate=0.0"


def difference_from_script(policy) -> float:
    """Mean square difference of actions from the script's, in states that the script visits."""
    env = make_batch_vec_env(FORWARD, n_envs=2)
    env.seed(50)
    observations, differences = env.reset(), []
    for _ in range(10):
        scripted = np.clip(scripted_policy(env.batch.task)(env.batch), -1.0, 1.0)
        differences.append(np.mean((policy(observations, env.batch) - scripted) ** 2))
        observations, *_ = env.step(scripted)
    env.close()
    return float(np.mean(differences))


def test_imitation_comes_near_the_script(tmp_path):
    for name, steps in (("not", 0), ("imitates", 320)):
        run("agents.train", "--steps", 40, "--imitate", steps, "--folder", tmp_path / name, *SMALL_PPO, NO_STEP)
    untaught, taught = (load_run(tmp_path / name)[0] for name in ("not", "imitates"))
    assert difference_from_script(taught) < 0.25 * difference_from_script(untaught)
    assert taught.normalization.obs_rms.count > 320


def test_imitation_of_the_same_task_continues_from_the_trained_networks(tmp_path):
    taught, later = tmp_path / "taught", tmp_path / "later"
    run("agents.train", "--steps", 0, "--imitate", 320, "--folder", taught, *SMALL_PPO)
    run("agents.train", "--steps", 0, "--imitate", 40, "--start-from", taught, "--folder", later, *SMALL_PPO)
    before, after = (load_run(folder)[0] for folder in (taught, later))
    assert after.normalization.obs_rms.count < before.normalization.obs_rms.count + 40
    assert difference_from_script(after) < 1.2 * difference_from_script(before)


def test_a_resumed_imitation_run_equals_an_uninterrupted_one(tmp_path):
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    begin = ("agents.train", "--imitate", 80)
    last = 40 * (CRITIC_UPDATES + 2)
    run(*begin, "--steps", last, "--folder", whole, *SMALL_PPO, "learning_rate=0.0006")
    run(*begin, "--steps", 80, "--folder", parts, *SMALL_PPO, "learning_rate=0.0006")
    run("agents.train", "--resume", parts, "--steps", last)
    one, other = (load_run(folder)[0].model.policy.state_dict() for folder in (whole, parts))
    for name, value in one.items():
        assert torch.equal(value, other[name]), name


def test_the_critic_learns_alone_at_first():
    from stable_baselines3 import PPO

    env = make_batch_vec_env(FORWARD, n_envs=2)
    model = PPO(env=env, **algorithm_arguments(load("ppo", FORWARD) | {"n_steps": 20, "batch_size": 20}))
    before = {name: value.clone() for name, value in model.policy.state_dict().items()}
    for first in (True, False):
        with critic_alone(model) if first else nullcontext():
            model.learn(80)
        assert (model.policy.optimizer.param_groups[0]["lr"] == LEARNING_RATES[0]) == first
        changed = {name for name, value in model.policy.state_dict().items() if not torch.equal(value, before[name])}
        assert {name for name in changed if "value_net" in name}
        assert bool({name for name in changed if "value_net" not in name}) != first
    env.close()


def test_only_ppo_imitates():
    assert "only ppo can imitate" in refused("agents.train", "--algo", "sac", "--imitate", "100")


def test_zero_steps_keep_the_imitated_policy(tmp_path):
    output = run("agents.train", "--steps", 0, "--imitate", 160, "--folder", tmp_path, *SMALL_PPO)
    evaluations = read_table(tmp_path / EVALUATIONS)
    # after the first round and at the end
    assert evaluations["steps"].tolist() == [160 / ROUNDS, 160], output
    # learning from rewards may follow later
    run("agents.train", "--resume", tmp_path, "--steps", 40)
    assert load_run(tmp_path)[0].model.num_timesteps == 200
    assert read_table(tmp_path / METRICS)["steps"].tolist() == [200]


def test_actions_beyond_saturation_are_no_difference():
    actions = torch.tensor([[1.0, -1.0, 1.0, 0.5]])
    assert _difference(torch.tensor([[1.7, -2.0, 1.0, 0.5]]), actions) == 0.0
    torch.testing.assert_close(_difference(torch.tensor([[-2.0, -1.0, 0.0, 1.5]]), actions), torch.tensor(11.0 / 4.0))
