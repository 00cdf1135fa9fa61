"""Rewards favour the right behaviour."""

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from elastica_gym.scripted import scripted_policy
from elastica_gym.scripted.gaits import snake_crawl

from .conftest import still

SEEDS = 12


def returns(env, act):
    """Returns of the first episode of each environment."""
    env.reset(seed=1)
    total, running = np.zeros(env.num_envs), np.ones(env.num_envs, dtype=bool)
    for _ in range(env.max_episode_steps):
        _, reward, terminated, truncated, _ = env.step(act(env))
        total += reward * running
        running &= ~(terminated | truncated)
    return total


def beats(good, bad):
    """Whether the mean of ``good`` exceeds that of ``bad`` by three standard errors."""
    error = np.sqrt(good.var(ddof=1) / good.size + bad.var(ddof=1) / bad.size)
    return good.mean() - bad.mean() > 3.0 * error


def test_scripted_policy_beats_zero_and_random(env_id, make_vec):
    env = make_vec(env_id, SEEDS, duration=None, autoreset_mode=AutoresetMode.DISABLED)
    rng = np.random.default_rng(0)
    scripted = returns(env, scripted_policy(env.task))
    assert beats(scripted, returns(env, still))
    assert beats(scripted, returns(env, lambda env: rng.uniform(-1.0, 1.0, env.action_space.shape)))


def place(env, heads):
    """Place the target of each environment at given distances from the head [m]."""
    env.goal[:, 0] = env.pose.head[:, 0] + heads
    env.goal[:, 1] = env.pose.head[:, 2]


def test_reaching_early_beats_reaching_late_and_hovering(make_vec):
    """Three snakes approach their targets: one reaches it early, one late, and one hovers just outside."""
    env = make_vec("elastica_gym/SnakeReach-v1", 3, duration=5.0, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=[0, 0, 0])
    place(env, 0.5)
    total, running = np.zeros(3), np.ones(3, dtype=bool)
    for step in range(env.max_episode_steps):
        if step == 5:
            place(env, np.array([0.0, 0.06, 0.06]))
        if step == 80:
            place(env, np.array([0.0, 0.0, 0.06]))
        _, reward, terminated, truncated, info = env.step(still(env))
        total += reward * running
        running &= ~(terminated | truncated)
    assert info["is_success"].tolist() == [True, True, False]
    assert total[0] > total[1] > total[2]
    assert total[1] - total[2] > 5.0


def test_targets_fill_the_ring_uniformly(make_vec):
    env = make_vec("elastica_gym/SnakeReach-v1", 2000)
    env.reset(seed=0)
    away = (env.goal[:, :2] - env.pose.centre[:, [0, 2]]) / env.body.sensors.length
    radius, bearing = np.hypot(*away.T), np.arctan2(*away.T)
    assert radius.min() >= 0.5 and radius.max() <= 1.5
    # quartiles of area and bearing, both uniform
    np.testing.assert_allclose(np.quantile((radius**2 - 0.25) / 2.0, [0.25, 0.5, 0.75]), [0.25, 0.5, 0.75], atol=0.04)
    np.testing.assert_allclose(np.quantile(bearing / np.pi, [0.25, 0.5, 0.75]), [-0.5, 0.0, 0.5], atol=0.08)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_forward_rewards_distance_along_the_initial_heading(make_vec, sign):
    env = make_vec("elastica_gym/SnakeForward-v1", 2)
    env.reset(seed=3)
    heading = env.goal[:, :2]
    first = int(env.body.model.first_slot[0])
    nodes = slice(first, first + env.body.rods[0].n_elements + 1)
    env.state.v[:] = 0.0
    env.state.v[:, 0, nodes], env.state.v[:, 2, nodes] = sign * heading[:, :1], sign * heading[:, 1:]
    _, _, _, _, info = env.step(still(env))
    assert (sign * info["reward_forward"] > 0.0).all()
    np.testing.assert_allclose(info["reward_forward"], 10.0 * info["distance"] / 0.35, rtol=1e-9)


def test_heading_rewards_turning_back_as_much_as_turning_away_costs(make_vec):
    env = make_vec("elastica_gym/SnakeForward-v1", 2, duration=2.0)
    env.reset(seed=3)
    total, off_course = np.zeros(2), np.zeros(2)
    for step in range(30):
        _, _, _, _, info = env.step(snake_crawl(env, np.full(2, 1.0 if step < 20 else -1.0)))
        total += info["reward_heading"]
        cosine = (env.pose.heading * env.goal[:, :2]).sum(axis=1)
        assert (info["reward_heading"] > 0.0).tolist() == (np.arccos(cosine) < off_course).tolist()
        off_course = np.arccos(cosine)
    np.testing.assert_allclose(total, -3.0 * off_course, atol=1e-6)
    assert (off_course > 0.1).all()


@pytest.mark.slow
def test_the_scripted_octopus_crawls_half_a_metre(make_vec):
    env = make_vec("elastica_gym/OctopusCrawl-v1", 64, duration=None, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    made, running = np.zeros(64), np.ones(64, dtype=bool)
    for _ in range(env.max_episode_steps):
        _, _, terminated, truncated, info = env.step(scripted_policy(env.task)(env))
        made = np.where(running, info["distance"], made)
        running &= ~(terminated | truncated)
    assert made.mean() > 0.5


def test_toppling_ends_an_octopus_and_costs(make_vec):
    env = make_vec("elastica_gym/OctopusCrawl-v1", 2, duration=2.0, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    # both arms lift fully
    lift = np.zeros((2, 42))
    lift[0, 14:28] = 1.0
    for _ in range(40):
        _, reward, terminated, _, info = env.step(lift)
        if terminated[0]:
            break
    assert terminated.tolist() == [True, False]
    assert env.termination_reasons[info["termination_reason"][0]] == "toppled"
    assert info["reward_toppled"].tolist() == [-10.0, 0.0]
    assert reward[0] < -9.0
