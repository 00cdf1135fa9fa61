import json
import re

import gymnasium
import numpy as np
import pytest
from PIL import Image
from stable_baselines3 import PPO

from elastica_gym.console.bad_input import BadInputError
from elastica_gym.rl import policies
from elastica_gym.rl.evaluation import Evaluation, confidence, evaluate, success_interval
from elastica_gym.rl.films import check_film, film
from elastica_gym.rl.vec_env import make_batch_vec_env
from tests.agents.commands import FORWARD, REACH, run
from tests.agents.test_bad_input import refused

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
    monkeypatch.setattr("elastica_gym.rl.evaluation.LARGEST_BATCH", 2)
    in_turns = evaluate(acting, env_id, episodes=5, seed=10, env_kwargs=SHORT)
    np.testing.assert_array_equal(together.seeds, np.arange(10, 15))
    for name, values in per_episode(together).items():
        np.testing.assert_array_equal(values, per_episode(in_turns)[name])
        np.testing.assert_array_equal(values[2:4], per_episode(later)[name])


def test_evaluation_equals_the_single_environment():
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


def test_prediction_intervals_for_another_cpu():
    """A second mean over equally many independent episodes is in the interval in 95 % of cases."""
    rng, reasons = np.random.default_rng(0), np.full(100, "time_limit", dtype=object)
    inside = {"return": 0, "distance": 0, "success": 0}
    for _ in range(400):
        here, there = rng.normal(0.8, 0.2, (2, 100)), rng.uniform(size=(2, 100)) < 0.8
        result = Evaluation(np.arange(100), here[0], here[0], here[0], there[0], reasons, {})
        intervals = result.elsewhere()
        for name, other in (("return", here[1]), ("distance", here[1]), ("success", there[1])):
            low, high = intervals[name]
            inside[name] += low <= other.mean() <= high
    for name, count in inside.items():
        assert 0.92 * 400 <= count <= 0.98 * 400, name


def test_json_has_every_episode_and_its_provenance(tmp_path):
    path = tmp_path / "new" / "numbers.json"
    options = "--episodes", 3, "--seed", 7, "--threads", 1, "--json", path
    output = run("agents.evaluate", "--policy", "random", "--env", FORWARD, *options)
    assert f"wrote {path}" in output and "\r" not in output
    told = json.loads(path.read_text(), parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    episodes = told["per_episode"]
    result = evaluate(policies.baseline("random"), FORWARD, episodes=3, seed=7)
    assert [e["seed"] for e in episodes] == [7, 8, 9]
    assert [e["return"] for e in episodes] == result.returns.tolist()
    assert [e["distance"] for e in episodes] == result.distances.tolist()
    assert [e["length"] for e in episodes] == [200] * 3
    assert [e["termination"] for e in episodes] == ["time_limit"] * 3
    assert [e["success"] for e in episodes] == result.successes.tolist()
    for name, values in result.terms.items():
        assert [e["terms"][name] for e in episodes] == values.tolist()
    assert told["return_mean"] == pytest.approx(np.mean([e["return"] for e in episodes]))
    assert told["arguments"]["threads"] == 1 and told["arguments"]["json"] == str(path)
    assert "compiled for" in told["cpu"] and re.fullmatch("[0-9a-f]{20}", told["kernels"])
    assert told["versions"]["numpy"] == np.__version__ and "commit" in told
    assert told["commit"] is None or re.fullmatch("[0-9a-f]{40}( with changes)?", told["commit"])


def test_a_film_of_any_policy(offscreen, tmp_path):
    path = tmp_path / "new" / "film.mp4"
    # an episode that soon succeeds
    which = "--pretrained", "octopus_reach_ppo", "--spread", "arc"
    output = run("agents.evaluate", *which, "--episodes", 1, "--video", path)
    assert f"filmed {path} (" in output and "drawing" in output and "\r" not in output
    assert path.read_bytes()[4:8] == b"ftyp"
    short = film(
        policies.baseline("random"), FORWARD, tmp_path / "film.gif", seed=0, size=(64, 48), every=4, env_kwargs=SHORT
    )
    with Image.open(short) as picture:
        assert picture.size == (64, 48) and picture.n_frames == 6 and picture.info["duration"] == 200


def test_bad_film_options(tmp_path):
    bad = "--policy", "zero", "--env", FORWARD, "--video"
    assert "Unknown kind of film '.mp5'; did you mean '.mp4'" in refused("agents.evaluate", *bad, tmp_path / "a.mp5")
    assert "Cannot write into the folder /proc/films" in refused("agents.evaluate", *bad, "/proc/films/a.mp4")
    for size in ((0, 100), (101, 100), (-2, 2), (4096, 2)):
        with pytest.raises(BadInputError, match="size must be two even numbers up to 2048, got"):
            check_film(tmp_path / "a.mp4", size)


def test_without_a_renderer_the_message_says_what_to_install(tmp_path, monkeypatch):
    def nothing(*_, **__):
        raise RuntimeError("MuJoCo cannot draw offscreen (MUJOCO_GL=): neither EGL nor OSMesa is installed")

    monkeypatch.setattr("elastica_gym.viz.Stage", nothing)
    with pytest.raises(BadInputError, match="no film: MuJoCo cannot draw offscreen"):
        check_film(tmp_path / "a.mp4", (64, 48))


def test_the_command_prints_a_table_and_records(tmp_path):
    output = run("agents.evaluate", "--policy", "scripted", "--env", FORWARD, "--episodes", 2, "--record", tmp_path)
    for expected in ("return", "distance", "reward: forward", "95 %", "success rate", "diverged", "0 of 2"):
        assert expected in output
    assert len(list(tmp_path.glob("*.rrd"))) == 1
