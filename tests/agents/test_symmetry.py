"""The octopus is its own mirror image, and so is what its policy does."""

import gymnasium
import numpy as np
import pytest
import torch
from numpy.testing import assert_allclose

import elastica_gym  # noqa: F401
from agents.symmetry import SymmetricPolicy
from elastica_gym.bodies.octopus import ARMS, N_ELEMENTS, mirror_image
from elastica_gym.muscles import activation_names

CRAWL = "elastica_gym/OctopusCrawl-v0"


def mirror(values, names):
    index, sign = mirror_image(names)
    return values[..., index] * sign


def write_mirror_image(envs):
    """Make the second environment the mirror image of the first, in a mirror through the head, across its axis."""
    s, first = envs.state, int(envs.body.model.first_slot[0])
    nodes, elements = slice(first, first + N_ELEMENTS + 1), slice(first, first + N_ELEMENTS)
    heading = np.array([envs.pose.heading[0, 0], 0.0, envs.pose.heading[0, 1]])
    P = np.eye(3) - 2.0 * np.outer(heading, heading)
    place = s.x[0, :, first + N_ELEMENTS // 2]
    s.x[1, :, nodes] = (P @ (s.x[0, :, nodes] - place[:, None]) + place[:, None])[:, ::-1]
    s.v[1, :, nodes] = (P @ s.v[0, :, nodes])[:, ::-1]
    # counted from the other end, tangents turn round, which keeps the frames right-handed
    turned = np.array([1.0, 1.0, -1.0])
    s.Q[1, :, :, elements] = turned[:, None, None] * np.einsum("ij,kjn->kin", P, s.Q[0, :, :, elements])[:, :, ::-1]
    s.w[1, :, elements] = -turned[:, None] * s.w[0, :, elements][:, ::-1]
    for name in ("radius", "length"):
        getattr(s, name)[1, elements] = getattr(s, name)[0, elements][::-1]
    s.body_x[1], s.body_v[1] = (s.body_x[0] - place) @ P + place, s.body_v[0] @ P
    # the object has no ends to be exchanged: its axis stays what it is, and its normal turns round
    turned = np.array([-1.0, 1.0, 1.0])
    s.body_Q[1] = turned[:, None] * (s.body_Q[0] @ P)
    s.body_w[1] = -turned * s.body_w[0]
    flat, at = P[::2, ::2], place[::2]
    home, direction, start = envs.goal[0].reshape(3, 2)
    envs.goal[1] = np.concatenate([flat @ (home - at) + at, flat @ direction, flat @ (start - at) + at])


@pytest.mark.parametrize("seed", range(4))
def test_the_mirror_image_of_a_crawl_is_a_crawl(seed):
    # short steps: friction amplifies rounding, tenfold in a millisecond
    envs = gymnasium.make_vec(CRAWL, num_envs=2, control_dt=0.005).unwrapped
    envs.reset(seed=seed)
    write_mirror_image(envs)
    action = np.random.default_rng(seed).uniform(-0.7, 0.7, 42)
    actions = np.stack([action, mirror(action, activation_names(ARMS))])
    # rolls are felt at the end of an element that the mirror makes its beginning
    chosen = [i for i, name in enumerate(envs.observation_names) if not name.startswith("roll/")]
    for _ in range(3):
        seen, *_ = envs.step(actions)
        assert_allclose(seen[1, chosen], mirror(seen[0], envs.observation_names)[chosen], rtol=0, atol=1e-5)


def test_twice_mirrored_is_as_before():
    names = gymnasium.make_vec(CRAWL, num_envs=1).unwrapped.observation_names
    values = np.arange(1.0, len(names) + 1.0)
    assert not np.array_equal(mirror(values, names), values)
    assert_allclose(mirror(mirror(values, names), names), values, rtol=0)


def test_the_policy_answers_in_the_mirror_with_the_mirror_image():
    envs = gymnasium.make_vec(CRAWL, num_envs=5).unwrapped
    torch.manual_seed(0)
    policy = SymmetricPolicy(envs.single_observation_space, envs.single_action_space, lambda _: 1e-3, env_id=CRAWL,
                             ortho_init=False)  # fmt: skip
    seen = envs.reset(seed=0)[0]
    there = mirror(seen, envs.observation_names).astype(np.float32)
    actions, _ = policy.predict(seen, deterministic=True)
    assert np.abs(actions).max() > 0.01
    assert_allclose(policy.predict(there, deterministic=True)[0], mirror(actions, activation_names(ARMS)), atol=1e-6)
    with torch.no_grad():
        values = [policy.predict_values(torch.as_tensor(each)).numpy() for each in (seen, there)]
    assert np.abs(values[0]).max() > 1e-3
    assert_allclose(values[0], values[1], atol=1e-5)
