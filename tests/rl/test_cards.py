"""Pretrained policies and their cards."""

import shutil

import numpy as np
import pytest

from elastica_gym.console.bad_input import BadInputError
from elastica_gym.rl import cards, hyperparameters
from elastica_gym.rl.evaluation import evaluate
from elastica_gym.rl.policies import load_run
from tests.agents.commands import FORWARD, REACH, ROOT, SMALL_PPO, run
from tests.agents.test_bad_input import refused

CARD = {
    "name",
    "environment",
    "package",
    "env_kwargs",
    "algorithm",
    "seed",
    "command",
    "steps",
    "wall_time_minutes",
    "score",
    "intervals",
    "scored_with",
    "scored_on",
    "trained_on",
    "hyperparameters",
    "versions",
}


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "run"
    run("agents.train", "--steps", 40, "--seed", 7, "--folder", folder, *SMALL_PPO, "--evaluations", 0)
    return folder


@pytest.fixture(scope="module")
def published(trained, tmp_path_factory):
    folder = tmp_path_factory.mktemp("pretrained")
    run("agents.publish", "--run", trained, "--name", "a_snake", "--episodes", 2, "--out", folder)
    return folder


def test_a_published_policy_acts_as_its_run(trained, published):
    policy, card = cards.load_pretrained("a_snake", published)
    original, _ = load_run(trained)
    seen = np.random.default_rng(0).normal(0.0, 2.0, (5, *original.model.observation_space.shape)).astype(np.float32)
    np.testing.assert_array_equal(policy(seen, None), original(seen, None))
    assert set(card) == CARD
    assert card["environment"] == FORWARD and card["seed"] == 7 and card["score"]["episodes"] == 2
    assert card["steps"] == 40 and "--steps 40" in card["command"] and "n_steps=20" in card["command"]
    for where in ("scored_on", "trained_on"):
        assert set(card[where]) == {"cpu", "kernels", "commit"} and "compiled for" in card[where]["cpu"]
    # saved without the optimiser's moments
    assert (published / "a_snake.zip").stat().st_size < 0.6 * (trained / "model.zip").stat().st_size
    assert sorted(path.name for path in published.iterdir()) == ["a_snake.npz", "a_snake.yml", "a_snake.zip"]


def test_scoring_a_policy_again_changes_nothing_else(published, tmp_path):
    shutil.copytree(published, tmp_path, dirs_exist_ok=True)
    output = run("agents.publish", "--name", "a_snake", "--episodes", 3, "--seed", 2_000_007, "--out", tmp_path)
    old, new = cards.read_card("a_snake", published), cards.read_card("a_snake", tmp_path)
    assert "a_snake.yml" in output and "--episodes 3 --seed 2000007" in new["scored_with"]
    assert (new["score"]["episodes"], new["score"]["first_seed"]) == (3, 2_000_007)
    changed = {"score", "scored_with"}
    assert {key: new[key] for key in CARD - changed} == {key: old[key] for key in CARD - changed}
    assert (tmp_path / "a_snake.zip").read_bytes() == (published / "a_snake.zip").read_bytes()


def test_the_commands_of_cards_reproduce_the_run(trained):
    import shlex

    _, config = load_run(trained)
    words = shlex.split(cards.command_of(config))
    overrides = hyperparameters.parse_overrides(words[words.index("--set") + 1 :])
    assert hyperparameters.load("ppo", FORWARD, overrides=overrides) == config["hyperparameters"]
    assert "--imitate" not in words and "--imitate 80" in cards.command_of(config | {"imitate": 80})


def test_a_folder_that_would_become_too_large_is_left_unchanged(trained, published, tmp_path, monkeypatch):
    shutil.copytree(published, tmp_path, dirs_exist_ok=True)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    policy, _ = load_run(trained)
    monkeypatch.setattr(cards, "LARGEST", sum(map(len, before.values())))
    with pytest.raises(BadInputError, match="at most"):
        cards.write_pretrained(tmp_path, "another_snake", policy, {})
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_unknown_names():
    message = refused("agents.evaluate", "--pretrained", "snake_forwards_ppo")
    assert "did you mean 'snake_forward_ppo'? Valid: snake_forward_ppo, " in message
    for name in cards.names():
        assert name in message
    assert "with snake or octopus in it" in refused("agents.publish", "--run", ROOT, "--name", "worm")
    assert "either --run DIR, --pretrained NAME" in refused("agents.evaluate", "--policy", "zero", "--pretrained", "x")


def test_damaged_statistics(published, tmp_path):
    (tmp_path / "x.npz").write_bytes((published / "a_snake.npz").read_bytes()[:200])
    with pytest.raises(BadInputError, match="are damaged"):
        cards.read_statistics(tmp_path / "x.npz")


@pytest.mark.parametrize("name", cards.names())
def test_shipped_policies_have_cards_and_load(name):
    policy, card = cards.load_pretrained(name)
    assert set(card) == CARD and card["name"] == name
    assert "snake" in name or "octopus" in name
    assert card["score"]["episodes"] >= 100 and card["score"]["first_seed"] >= 2_000_000
    score = card["score"]
    for quantity, mean in (("return", "return_mean"), ("distance", "distance_mean"), ("success", "success_rate")):
        low, high = score["elsewhere95"][quantity]
        assert low <= score[mean] <= high
    # the interval of a difference of two independent means is 1.4 times as wide as that of either
    low, high = score["elsewhere95"]["distance"]
    assert high - low == pytest.approx(2.0 * 2.0**0.5 * score["distance_ci95"], abs=2e-4)
    assert "another CPU" in card["intervals"]
    normalize = hyperparameters.normalize_arguments(card["hyperparameters"]) or {"norm_obs": False}
    assert normalize.get("norm_obs", True) == (policy.normalization is not None)
    env_kwargs = {**card["env_kwargs"], "duration": 0.2}
    result = evaluate(policy, card["environment"], episodes=2, seed=0, env_kwargs=env_kwargs)
    assert np.isfinite(result.returns).all() and result.divergences == 0


def test_shipped_policies_are_small():
    assert {"snake_forward_ppo", "snake_reach_ppo"} <= set(cards.names())
    assert sum(path.stat().st_size for path in cards.PRETRAINED.iterdir()) < cards.LARGEST


def test_shipped_snakes_match_their_cards():
    """On episodes used neither in training nor for the cards' scores."""
    forward, card = cards.load_pretrained("snake_forward_ppo")
    result = evaluate(forward, FORWARD, episodes=4, seed=3_000_000)
    assert result.distances.mean() > 0.75 * card["score"]["distance_mean"] > 0.4
    reach, card = cards.load_pretrained("snake_reach_ppo")
    assert card["score"]["success_rate"] >= 0.95
    assert evaluate(reach, REACH, episodes=4, seed=3_000_000).successes.sum() >= 3
