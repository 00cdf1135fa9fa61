"""Observations are correct."""

import gymnasium
import numpy as np
import pytest

from .conftest import still

FORWARD = "elastica_gym/SnakeForward-v1"


def columns(env, observations, prefix):
    return observations[:, [k for k, name in enumerate(env.observation_names) if name.startswith(prefix)]]


def test_first_observation_has_curvature_and_contact(make_vec):
    env = make_vec(FORWARD, 16)
    observations, _ = env.reset(seed=0)
    # in the plane, curvature about the normal is minus the rate at which the heading turns to the right
    first = int(env.body.model.first_slot[0])
    tangents = np.diff(env.state.x[:, :, first : first + 51], axis=2)
    angles = np.unwrap(np.arctan2(tangents[:, 2], tangents[:, 0]), axis=1)
    expected = np.diff(angles, axis=1) / (0.35 / 50) / env.body.sensors.curvature_scale
    joints = env.body.sensors.joints - first
    felt = columns(env, observations, "curvature/")[:, 0::3]
    np.testing.assert_allclose(np.abs(felt), np.abs(expected[:, joints]), atol=2e-6)
    np.testing.assert_allclose(columns(env, observations, "contact/").mean(axis=1), 1.0, rtol=1e-6)


def test_roll_is_observed(make_vec):
    env = make_vec(FORWARD, 2)
    observations, _ = env.reset(seed=0)
    felt = columns(env, observations, "roll/")
    np.testing.assert_allclose(felt[:, 0::2], 1.0, atol=1e-6)
    np.testing.assert_allclose(felt[:, 1::2], 0.0, atol=1e-6)
    twist = np.zeros((2, 42))
    twist[:, [28, 35]] = 1.0, -1.0
    for _ in range(20):
        observations, *_ = env.step(twist)
    felt = columns(env, observations, "roll/").reshape(2, -1, 2)
    np.testing.assert_allclose(np.hypot(felt[..., 0], felt[..., 1]), 1.0, atol=1e-2)
    assert np.abs(felt[..., 1]).max() > 0.1


def test_a_step_of_no_duration_moves_nothing(make_vec):
    env = make_vec(FORWARD, 2)
    env.reset(seed=0)
    np.testing.assert_array_equal(env.state.time, 0.0)
    np.testing.assert_array_equal(env.state.step, 0)
    np.testing.assert_array_equal(env.state.couple, 0.0)


def test_levels_are_those_of_the_couples(make_vec):
    env = make_vec(FORWARD, 2)
    env.reset(seed=0)
    for action in np.random.default_rng(0).uniform(-1.0, 1.0, (5, 2, 42)):
        env.step(action)
    expected = np.einsum("ba,acl->bcl", env.levels, env.body.couples)
    np.testing.assert_allclose(env.state.couple, expected, atol=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_bend_to_the_right_turns_to_the_right(make_vec, sign):
    """Right is forward x up: +z for a snake along +x with y up."""
    from elastica_gym.scripted.gaits import snake_crawl

    env = make_vec(FORWARD, 4, duration=5.0)
    env.reset(seed=0)
    start = np.arctan2(env.pose.heading[:, 1], env.pose.heading[:, 0])
    turned = np.zeros(4)
    before = start
    for _ in range(99):
        env.step(snake_crawl(env, np.full(4, sign)))
        now = np.arctan2(env.pose.heading[:, 1], env.pose.heading[:, 0])
        turned += np.angle(np.exp(1j * (now - before)))
        before = now
    assert (sign * turned > 1.0).all()


def test_too_few_elements_raise():
    with pytest.raises(ValueError, match="n_elements must be at least 16, not 3"):
        gymnasium.make_vec(FORWARD, num_envs=1, body_kwargs={"n_elements": 3})


REACH = "elastica_gym/OctopusReach-v1"


def in_the_heads_frame(env, i, vector):
    """Return the forward, up and right component of a vector in the lab."""
    x, z = env.pose.heading[i]
    return [vector[0] * x + vector[2] * z, vector[1], vector[2] * x - vector[0] * z]


def test_the_object_is_observed(make_vec):
    env = make_vec(REACH, 3)
    env.reset(seed=0)
    for i, (x, z) in enumerate(env.pose.heading):
        # half a metre to the right of the head, along forward x up
        env.state.body_x[i, 0, [0, 2]] = env.pose.head[i, [0, 2]] + 0.5 * np.array([-z, x])
    env.state.body_v[:, 0], env.state.body_w[:, 0] = [0.3, 0.1, -0.2], [0.5, -1.0, 2.0]
    # a step so short that nothing moves
    env.sim_dt = 1e-9
    observations = env.step(still(env))[0]
    np.testing.assert_allclose(columns(env, observations, "object/0/position/")[:, [0, 2]], [[0.0, 0.5]] * 3, atol=1e-4)
    for i in range(3):
        spin = env.state.body_Q[i, 0].T @ env.state.body_w[i, 0]
        for name, vector in (("axis", env.state.body_Q[i, 0, 2]), ("velocity", env.state.body_v[i, 0]), ("spin", spin)):
            felt = columns(env, observations, f"object/0/{name}/")[i]
            np.testing.assert_allclose(felt, in_the_heads_frame(env, i, vector), atol=1e-5)
    # a column of radius 0.05 m, half a metre from a head of radius 0.125 m
    np.testing.assert_allclose(columns(env, observations, "object/0/gap"), 0.325, atol=0.01)
    np.testing.assert_allclose(columns(env, observations, "goal/"), [[0.0, 1.0]] * 3, atol=1e-4)


def test_home_is_observed(make_vec):
    env = make_vec(REACH, 2)
    observations, _ = env.reset(seed=0)
    np.testing.assert_allclose(columns(env, observations, "home/"), 0.0, atol=1e-7)
    x, z = env.pose.heading.T
    env.goal[:, 0] = env.pose.head[:, 0] + 0.3 * x - 0.2 * z
    env.goal[:, 1] = env.pose.head[:, 2] + 0.3 * z + 0.2 * x
    env.sim_dt = 1e-9
    observations = env.step(still(env))[0]
    np.testing.assert_allclose(columns(env, observations, "home/"), [[0.3, 0.2]] * 2, atol=1e-4)


@pytest.mark.parametrize(
    ("spread", "nearest", "furthest", "low", "high"),
    [("arc", 0.4, 0.4, 0.0, 90.0), ("anywhere", 0.4, 0.8, -180.0, 180.0), ("default", 0.4, 0.4, 90.0, 90.0)],
)
def test_position_of_the_object(make_vec, spread, nearest, furthest, low, high):
    env = make_vec(REACH, 400, spread=spread)
    observations, _ = env.reset(seed=0)
    way = columns(env, observations, "object/0/position/")[:, [0, 2]]
    away, bearing = np.hypot(*way.T), np.degrees(np.arctan2(way[:, 1], way[:, 0]))
    assert nearest - 1e-5 <= away.min() and away.max() <= furthest + 1e-5
    assert low - 1e-3 <= bearing.min() < low + 5.0 and high - 5.0 < bearing.max() <= high + 1e-3
    assert (env.pose.gaps > 0.015).all()
    np.testing.assert_allclose(env.state.body_Q[:, 0, 2], [[0.0, 1.0, 0.0]] * 400, atol=1e-9)
