"""Families of gaits, and the search for the best of them."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from elastica_gym.bodies import octopus, snake
from elastica_gym.console.bad_input import BadInputError
from elastica_gym.rl import cmaes, policies
from elastica_gym.rl.cards import load_pretrained
from elastica_gym.rl.evaluation import Evaluation, evaluate, run_episodes
from elastica_gym.rl.run_files import GAIT, SEARCH, read_table
from elastica_gym.rl.vec_env import make_batch_vec_env
from elastica_gym.scripted import families as gaits
from tests.agents.commands import FORWARD, REACH, ROOT, run
from tests.agents.test_bad_input import refused

PNG = b"\x89PNG"
SEARCHED = ROOT / "agents" / "searched"


def starts(gait: gaits.Gait) -> np.ndarray:
    return np.array([parameter.start for parameter in gait.parameters])


def standing(body, angles, *, elapsed=7):
    """A batch, as used by gaits, with its goals at these angles, and its observations."""
    batch = SimpleNamespace(
        body=body,
        num_envs=len(angles),
        elapsed=np.full(len(angles), elapsed),
        control_dt=0.05,
        observation_names=("goal/forward", "goal/right"),
    )
    return batch, np.stack([np.cos(angles), np.sin(angles)], axis=1)


def test_the_wave_begins_as_the_published_gait():
    short = {"duration": 1.0}
    ours = evaluate(gaits.GaitPolicy(gaits.WAVE, starts(gaits.WAVE)), FORWARD, episodes=2, seed=3, env_kwargs=short)
    published = evaluate(policies.baseline("seed_gait"), FORWARD, episodes=2, seed=3, env_kwargs=short)
    np.testing.assert_array_equal(ours.returns, published.returns)
    assert len(gaits.WAVE.parameters) == 7


@pytest.mark.parametrize("name", ["wave", "steered_wave"])
def test_candidates_in_a_batch_are_independent(name):
    gait, env_id, seeds = gaits.GAITS[name], REACH, [5, 9]
    spreads = [parameter.spread for parameter in gait.parameters]
    two = starts(gait) + 0.5 * np.random.default_rng(0).uniform(-1.0, 1.0, (2, len(spreads))) * spreads

    def distances(values, seeds):
        env = make_batch_vec_env(env_id, n_envs=len(seeds), duration=1.0)
        result = run_episodes(gaits.GaitPolicy(gait, values), env, seeds)
        env.close()
        np.testing.assert_array_equal(result.seeds, seeds)
        return result.distances

    together = distances(two, seeds * 2)
    np.testing.assert_array_equal(together[:2], distances(two[0], seeds))
    np.testing.assert_array_equal(together[2:], distances(two[1], seeds))
    assert together[0] != together[2]


def test_a_steered_wave_bends_towards_the_goal():
    batch, seen = standing(snake(), np.array([-0.5, 0.0, 0.5]))
    policy = gaits.GaitPolicy(gaits.STEERED_WAVE, starts(gaits.STEERED_WAVE))
    policy.reset([0])
    left, straight, right = policy(seen, batch) @ batch.body.couples[:, 0].sum(axis=1)
    assert abs(left - right) > 2.0 * abs(left + right - 2.0 * straight)
    body = batch.body
    bend = gaits.turn_activations(body) @ body.couples[:, 0].sum(axis=1)
    assert (right - straight) * bend > 0.0 > (left - straight) * bend


def test_the_strokes_of_the_arms_are_mirror_images():
    values = starts(gaits.STROKE) + np.random.default_rng(0).normal(0.0, 0.3, len(gaits.STROKE.parameters))
    values[0] = 0.8
    # ahead to the right, and its mirror image, behind to the right
    batch, seen = standing(octopus(), np.array([0.4, np.pi - 0.4, -0.4]))
    policy = gaits.GaitPolicy(gaits.STROKE, values)
    policy.reset([0])
    ahead, behind, left = policy(seen, batch).reshape(3, 3, 2, 7)
    np.testing.assert_allclose(ahead[:, 0], behind[:, 1], atol=1e-6)
    np.testing.assert_allclose(ahead[:, 1], behind[:, 0], atol=1e-6)
    assert np.abs(ahead[:, 0] - ahead[:, 1]).max() > 0.05 and np.abs(ahead - left).max() > 0.05


def searched_for(folder, target, monkeypatch, *, evaluations=2000):
    """Search with an objective whose maximum, 0, is at a target in units of the parameters' spreads."""
    config = {
        "env": FORWARD,
        "gait": None,
        "seed": 0,
        "evaluations": evaluations,
        "minutes": None,
        "restarts": 1,
        "population": 20,
        "threads": 1,
        "evaluation_episodes": 1,
        "evaluation_seed": 0,
    }
    spreads = np.array([parameter.spread for parameter in gaits.WAVE.parameters])

    def values(self, env, candidates, seeds):
        flat = np.zeros(len(candidates))
        result = Evaluation(flat, flat, flat, flat, flat > 0, flat, {})
        return -np.sum(((candidates - starts(gaits.WAVE)) / spreads - target) ** 2, axis=1), result

    monkeypatch.setattr(cmaes.Search, "_values", values)
    monkeypatch.setattr(cmaes.Search, "_compile", lambda self: None)
    search = cmaes.Search(folder, config)
    search.run()
    return search, gaits.load_gait(folder / GAIT)[0].values[0], spreads


def test_the_search_finds_the_maximum(tmp_path, monkeypatch):
    target = np.array([1.0, -1.0, 0.5, 0.0, -0.5, 1.0, -0.8])
    search, found, spreads = searched_for(tmp_path, target, monkeypatch)
    np.testing.assert_allclose((found - starts(gaits.WAVE)) / spreads, target, atol=0.01)
    assert search.evaluations >= 2000 and search.best > -1e-3
    table = read_table(tmp_path / SEARCH)
    assert set(table["restart"]) >= {0.0, 1.0}
    assert np.all(np.diff(table["best_so_far"][np.isfinite(table["best_so_far"])]) >= 0.0)


def test_the_table_ends_with_the_result_of_the_last_trial(tmp_path, monkeypatch):
    search, _, _ = searched_for(tmp_path, np.full(7, 0.5), monkeypatch, evaluations=20)
    assert read_table(tmp_path / SEARCH)["best_so_far"].tolist() == [pytest.approx(search.best, rel=1e-5)]


def test_the_command_searches_and_its_gait_is_evaluated(tmp_path):
    folder = tmp_path / "search"
    small = "--population", 4, "--restarts", 1, "--evaluation-episodes", 2
    output = run("agents.search", "--env", FORWARD, "--evaluations", 8, *small, "--folder", folder)
    assert f"python -m agents.evaluate --policy {folder / GAIT}" in output
    table = read_table(folder / SEARCH)
    assert table["evaluations"].tolist() == [4.0, 8.0] and table["restart"].tolist() == [0.0, 1.0]
    assert (folder / "search.png").read_bytes().startswith(PNG)
    found = yaml.safe_load((folder / GAIT).read_text())
    assert found["gait"] == "wave" and len(found["parameters"]) == 7
    run("agents.evaluate", "--policy", folder / GAIT, "--episodes", 2, "--seed", 1_000_000, "--json", tmp_path / "e")
    evaluated = json.loads((tmp_path / "e").read_text())
    assert evaluated["env"] == FORWARD
    assert evaluated["distance_mean"] == pytest.approx(found["score"]["distance_mean"], abs=1e-12)
    assert 0.0 < evaluated["distance_mean"] < 1.0
    assert "already has a search" in refused("agents.search", "--folder", folder)


@pytest.mark.parametrize("path", sorted(SEARCHED.glob("*.yml")), ids=lambda path: path.stem)
def test_shipped_gaits_match_their_files(path):
    policy, env_id = gaits.load_gait(path)
    score = yaml.safe_load(path.read_text())["score"]
    result = evaluate(policy, env_id, episodes=2, seed=3_000_000)
    assert result.distances.mean() == pytest.approx(score["distance_mean"], rel=0.1)


def test_the_shipped_snake_beats_the_shipped_gait():
    found = yaml.safe_load((SEARCHED / "snake_forward_wave.yml").read_text())["score"]["distance_mean"]
    learned = load_pretrained("snake_forward_ppo")[1]["score"]["distance_mean"]
    assert learned > 1.2 * found > 0.48


def test_bad_searches_are_refused(tmp_path):
    assert "The gait 'stroke' is for the octopus" in refused("agents.search", "--gait", "stroke", "--out", tmp_path)
    assert "population must be at least 4, got 1" in refused("agents.search", "--population", 1, "--out", tmp_path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("[1]", "is not a gait: no env, gait, parameters"),
        (f"{{env: {FORWARD}, gait: wafe, parameters: {{}}}}", "'wafe'; did you mean 'wave'"),
        (f"{{env: {FORWARD}, gait: wave, parameters: {{coefficient_0: 1}}}}", "needs a number for each of"),
    ],
)
def test_files_that_are_not_gaits(tmp_path, content, message):
    (tmp_path / GAIT).write_text(content)
    with pytest.raises(BadInputError, match=message):
        gaits.load_gait(tmp_path / GAIT)
    with pytest.raises(BadInputError, match="Cannot read the gait"):
        gaits.load_gait(tmp_path / "none.yml")
