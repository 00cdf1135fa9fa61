"""Animals are mirror-symmetric, and their policies mirror-equivariant."""

import gymnasium
import numpy as np
import pytest
import torch
from numpy.testing import assert_allclose
from stable_baselines3 import PPO
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize

import elastica_gym  # noqa: F401
from elastica_gym.envs.batch import CLOCK_PERIOD
from elastica_gym.rl.rhythm import RhythmicPolicy
from elastica_gym.rl.symmetry import SymmetricPolicy

IDS = ("elastica_gym/OctopusCrawl-v1", "elastica_gym/SnakeForward-v1")
TRAINED = (*IDS, "elastica_gym/SnakeSteer-v1")
"""Environments trained with such a policy; the second snake has more observations"""


def mirrored(envs, values, names=None):
    index, sign = envs.body.mirror.image(names or envs.body.activation_names)
    return values[..., index] * sign


def write_mirror_image(envs):
    """Make the second environment the mirror image of the first, in a mirror plane through the head."""
    s, body = envs.state, envs.body
    first, n = int(body.model.first_slot[0]), int(body.model.n_elements[0])
    nodes, elements = slice(first, first + n + 1), slice(first, first + n)
    is_swapped = bool(body.mirror.arms)
    order = slice(None, None, -1 if is_swapped else 1)
    hx, hz = envs.pose.heading[0]
    normal = np.array([hx, 0.0, hz] if is_swapped else [-hz, 0.0, hx])
    P = np.eye(3) - 2.0 * np.outer(normal, normal)
    place = envs.pose.head[0]
    s.x[1, :, nodes] = (P @ (s.x[0, :, nodes] - place[:, None]) + place[:, None])[:, order]
    s.v[1, :, nodes] = (P @ s.v[0, :, nodes])[:, order]
    # frames stay right-handed: tangents flip if counted from the other end, otherwise binormals
    turned = np.array([1.0, 1.0, -1.0] if is_swapped else [1.0, -1.0, 1.0])
    s.Q[1, :, :, elements] = turned[:, None, None] * np.einsum("ij,kjn->kin", P, s.Q[0, :, :, elements])[:, :, order]
    s.w[1, :, elements] = -turned[:, None] * s.w[0, :, elements][:, order]
    for name in ("radius", "length"):
        getattr(s, name)[1, elements] = getattr(s, name)[0, elements][order]
    # the object keeps its axis, so its normal flips
    turned = np.array([-1.0, 1.0, 1.0])
    s.body_x[1], s.body_v[1] = (s.body_x[0] - place) @ P + place, s.body_v[0] @ P
    s.body_Q[1], s.body_w[1] = turned[:, None] * (s.body_Q[0] @ P), -turned * s.body_w[0]
    flat, at = P[::2, ::2], place[::2]
    # a direction, preceded by home or followed by the starting point
    pairs = envs.goal[0].reshape(-1, 2)
    is_direction = np.arange(len(pairs)) == (1 if is_swapped else 0)
    envs.goal[1] = np.where(is_direction[:, None], pairs @ flat, (pairs - at) @ flat + at).ravel()


@pytest.mark.parametrize("env_id", IDS)
@pytest.mark.parametrize("seed", range(3))
def test_the_dynamics_are_mirror_symmetric(env_id, seed):
    # short steps: friction and contact amplify rounding tenfold per millisecond
    envs = gymnasium.make_vec(env_id, num_envs=2, control_dt=0.001).unwrapped
    envs.reset(seed=seed)
    write_mirror_image(envs)
    action = np.random.default_rng(seed).uniform(-0.7, 0.7, 42)
    # rolls are observed at the end of an element, which may be its beginning in the mirror;
    # the clock of the image may be half a period later
    names = envs.observation_names
    left_out = ("roll/", "clock/") if envs.body.mirror.arms else ("clock/",)
    chosen = [i for i, name in enumerate(names) if not name.startswith(left_out)]
    for _ in range(3):
        seen, *_ = envs.step(np.stack([action, mirrored(envs, action)]))
        assert_allclose(seen[1, chosen], mirrored(envs, seen[0], names)[chosen], rtol=0, atol=1e-5)


@pytest.mark.parametrize(("env_id", "delay"), list(zip(IDS, (0.0, 0.5), strict=True)))
def test_the_image_of_an_undulating_body_observes_the_clock_half_a_period_later(env_id, delay):
    envs = gymnasium.make_vec(env_id, num_envs=1).unwrapped
    names = envs.observation_names
    clock = [names.index("clock/sine"), names.index("clock/cosine")]
    seen = [envs.reset(seed=0)[0], *(envs.step(np.zeros((1, 42)))[0] for _ in range(20))]
    later = int(delay * CLOCK_PERIOD / envs.control_dt)
    for now, then in zip(seen, seen[later:], strict=False):
        assert_allclose(mirrored(envs, now, names)[:, clock], then[:, clock], atol=1e-6)


@pytest.mark.parametrize("env_id", TRAINED)
def test_mirroring_twice_is_the_identity(env_id):
    envs = gymnasium.make_vec(env_id, num_envs=1).unwrapped
    names = envs.observation_names
    values = np.arange(1.0, len(names) + 1.0)
    assert not np.array_equal(mirrored(envs, values, names), values)
    assert np.array_equal(mirrored(envs, mirrored(envs, values, names), names), values)


@pytest.mark.parametrize("policy", [SymmetricPolicy, RhythmicPolicy])
@pytest.mark.parametrize("env_id", TRAINED)
def test_policies_need_nothing_but_the_spaces(env_id, policy, tmp_path):
    """Code that replaces all other arguments, such as Optuna in rl_zoo3, can create one."""
    env = VecNormalize(DummyVecEnv([lambda: Monitor(gymnasium.make(env_id, duration=0.5))]))
    model = PPO(policy, env, n_steps=8, batch_size=8, device="cpu", policy_kwargs=dict(net_arch=[8]))
    model.learn(8)
    seen = env.reset()
    wanted, _ = model.predict(seen, deterministic=True)
    model.save(tmp_path / "model.zip")
    model.policy.save(tmp_path / "policy.pt")
    for loaded in (
        PPO.load(tmp_path / "model.zip", env=env),
        PPO.load(tmp_path / "model.zip"),
        policy.load(tmp_path / "policy.pt"),
    ):
        np.testing.assert_array_equal(loaded.predict(seen, deterministic=True)[0], wanted)


@pytest.mark.parametrize("policy", [SymmetricPolicy, RhythmicPolicy])
def test_spaces_without_names_are_refused(policy):
    observations = gymnasium.spaces.Box(-1.0, 1.0, (159,))
    with pytest.raises(ValueError, match=f"{policy.__name__} needs the spaces of an elastica_gym environment, not Box"):
        policy(observations, gymnasium.spaces.Box(-1.0, 1.0, (42,)), lambda _: 1e-3)


@pytest.mark.parametrize("env_id", TRAINED)
def test_the_policy_is_mirror_equivariant(env_id):
    envs = gymnasium.make_vec(env_id, num_envs=5).unwrapped
    torch.manual_seed(0)
    policy = SymmetricPolicy(envs.single_observation_space, envs.single_action_space, lambda _: 1e-3, ortho_init=False)
    seen = envs.reset(seed=0)[0]
    there = mirrored(envs, seen, envs.observation_names).astype(np.float32)
    actions, _ = policy.predict(seen, deterministic=True)
    assert np.abs(actions).max() > 0.01
    assert_allclose(policy.predict(there, deterministic=True)[0], mirrored(envs, actions), atol=1e-6)
    with torch.no_grad():
        values = [policy.predict_values(torch.as_tensor(each)).numpy() for each in (seen, there)]
    assert np.abs(values[0]).max() > 1e-3
    assert_allclose(values[0], values[1], atol=1e-5)
