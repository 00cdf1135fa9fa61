import gymnasium
import numpy as np
import pytest
from stable_baselines3 import PPO

from agents import policies
from agents.checks import BadInputError
from agents.evaluate import Evaluation, confidence, evaluate, success_interval
from agents.vec_env import make_batch_vec_env
from tests.agents.commands import FORWARD, REACH, run

SHORT = {"duration": 1.0}


def untrained(env_id: str) -> policies.TrainedPolicy:
    env = make_batch_vec_env(env_id, n_envs=1)
    return policies.TrainedPolicy(PPO("MlpPolicy", env, seed=0, device="cpu"), None)


def per_episode(result: Evaluation) -> dict[str, np.ndarray]:
    return {"return": result.returns, "length": result.lengths, "distance": result.distances, **result.terms}


@pytest.mark.parametrize("policy", [*policies.BASELINES, "network"])
@pytest.mark.parametrize("env_id", [FORWARD, REACH])
def test_an_episode_depends_on_its_seed_alone(env_id, policy, monkeypatch):
    acting = untrained(env_id) if policy == "network" else policies.baseline(policy)
    together = evaluate(acting, env_id, episodes=5, seed=10, env_kwargs=SHORT)
    later = evaluate(acting, env_id, episodes=2, seed=12, n_threads=1, env_kwargs=SHORT)
    monkeypatch.setattr("agents.evaluate.LARGEST_BATCH", 2)
    in_turns = evaluate(acting, env_id, episodes=5, seed=10, env_kwargs=SHORT)
    np.testing.assert_array_equal(together.seeds, np.arange(10, 15))
    for name, values in per_episode(together).items():
        np.testing.assert_array_equal(values, per_episode(in_turns)[name])
        np.testing.assert_array_equal(values[2:4], per_episode(later)[name])


def test_evaluation_is_what_the_single_environment_does():
    result = evaluate(policies.baseline("zero"), FORWARD, episodes=2, seed=4, env_kwargs=SHORT)
    env = gymnasium.make(FORWARD, **SHORT)
    for i, seed in enumerate((4, 5)):
        env.reset(seed=seed)
        total, done = 0.0, False
        while not done:
            _, reward, terminated, truncated, info = env.step(np.zeros(42, np.float32))
            total, done = total + reward, terminated or truncated
        assert result.returns[i] == pytest.approx(total)
        assert result.distances[i] == info["distance"]
        assert result.reasons[i] == env.unwrapped.termination_reasons[info["termination_reason"]]
    env.close()


def test_summary_counts_divergences():
    reasons = np.array(["diverged", "time_limit", "diverged"], dtype=object)
    numbers = np.array([1.0, 2.0, 3.0])
    result = Evaluation(np.arange(3), numbers, numbers, numbers, numbers > 2, reasons, {"forward": numbers})
    summary = result.summary()
    assert summary["divergences"] == 2
    assert summary["return_mean"] == 2.0 and summary["terms"] == {"forward": 2.0}
    assert summary["return_ci95"] == pytest.approx(4.303 / np.sqrt(3), rel=1e-3)  # t(2) is 4.303


def test_intervals():
    assert np.isnan(confidence(np.array([1.0])))
    low, high = success_interval(np.ones(50, bool))
    assert 0.9 < low < high <= 1.0 + 1e-12
    assert success_interval(np.array([True, False]))[0] == pytest.approx(0.0945, abs=1e-3)


def test_a_model_of_another_environment_is_refused():
    with pytest.raises(BadInputError, match="The model observes"):
        evaluate(untrained(REACH), FORWARD, episodes=1, seed=0, env_kwargs=SHORT)


def test_the_command_prints_a_table_and_records(tmp_path):
    output = run("agents.evaluate", "--policy", "scripted", "--env", FORWARD, "--episodes", 2, "--record", tmp_path)
    for expected in ("return", "distance", "reward: forward", "95 %", "success rate", "diverged", "0 of 2"):
        assert expected in output
    assert len(list(tmp_path.glob("*.rrd"))) == 1
