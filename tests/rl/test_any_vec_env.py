"""`BatchVecEnv` on batches that are not this package's: Gymnasium's own, and one with no more than the vector API."""

import functools

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box, Dict, Discrete
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.wrappers.vector import NormalizeReward, RecordEpisodeStatistics
from stable_baselines3 import PPO
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv

from elastica_gym.rl import BatchVecEnv
from tests.agents.commands import FORWARD

N = 4
SAME_STEP = {"autoreset_mode": AutoresetMode.SAME_STEP}


class Corridor(gymnasium.Env):
    """Walk to one side; the goal is right, and infos differ from step to step."""

    observation_space = Dict({"place": Box(-9.0, 9.0, (1,), np.float32), "side": Discrete(2)})
    action_space = Box(-1.0, 1.0, (2,), np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.place = self.np_random.uniform(-1.0, 1.0) + (options or {}).get("shift", 0.0)
        self.steps = 0
        return self._observe(), {"start": self.place}

    def step(self, action):
        self.place += float(action[0])
        self.steps += 1
        info = {"nested": {"place": self.place}} if self.steps % 2 else {"name": f"step {self.steps}"}
        return self._observe(), self.place, self.place > 3.0, self.steps >= 5, info

    def _observe(self):
        return {"place": np.array([self.place], np.float32), "side": np.int64(self.place > 0.0)}

    def double(self, number):
        return 2 * number + self.steps


def cart_poles(mode="sync", **kwargs):
    return gymnasium.make_vec("CartPole-v1", num_envs=N, vectorization_mode=mode, vector_kwargs=SAME_STEP, **kwargs)


def corridors(kind=gymnasium.vector.SyncVectorEnv):
    return kind([Corridor] * N, **SAME_STEP)


def assert_same(mine, other):
    if isinstance(mine, dict):
        assert mine.keys() == other.keys()
        for key in mine:
            assert_same(mine[key], other[key])
    else:
        np.testing.assert_array_equal(mine, other)
        assert np.asarray(mine).dtype == np.asarray(other).dtype


def assert_same_rollouts(mine, other, actions):
    """Compare observations, rewards, ends and infos, but for the seconds of an episode."""
    for env in (mine, other):
        env.seed(7)
        env.set_options({})
    assert_same(mine.reset(), other.reset())
    ends = {True: 0, False: 0}
    for action in actions:
        assert mine.reset_infos == other.reset_infos
        ours, theirs = mine.step(action), other.step(action)
        for a, b in zip(ours[:3], theirs[:3], strict=True):
            assert_same(a, b)
        for a, b in zip(ours[3], theirs[3], strict=True):
            for episode in (info["episode"] for info in (a, b) if "episode" in info):
                del episode["t"]
                episode["r"] = round(episode["r"], 6)
            assert_same(a, b)
            if "episode" in a:
                ends[a["TimeLimit.truncated"]] += 1
    return ends


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_rollouts_of_cart_poles_equal_those_of_dummy_vec_env(mode):
    made = functools.partial(gymnasium.make, "CartPole-v1", max_episode_steps=30)
    mine = BatchVecEnv(cart_poles(mode, max_episode_steps=30))
    actions = np.random.default_rng(0).integers(2, size=(100, N))
    ends = assert_same_rollouts(mine, DummyVecEnv([lambda: Monitor(made())] * N), actions)
    assert ends[True] > 0 and ends[False] > 0
    mine.close()


def test_dict_observations_continuous_actions_and_infos_equal_those_of_dummy_vec_env():
    mine, other = BatchVecEnv(corridors()), DummyVecEnv([lambda: Monitor(Corridor())] * N)
    ends = assert_same_rollouts(mine, other, np.random.default_rng(1).uniform(-1, 1, (40, N, 2)).astype(np.float32))
    assert ends[True] > 0 and ends[False] > 0
    for env in (mine, other):
        env.seed(1)
        env.set_options({"shift": 2.0})
    assert_same(mine.reset(), other.reset())


def test_ppo_learns_the_cart_pole():
    env = BatchVecEnv(gymnasium.make_vec("CartPole-v1", num_envs=8, vectorization_mode="sync", vector_kwargs=SAME_STEP))
    arguments = dict(n_steps=32, batch_size=256, gamma=0.98, gae_lambda=0.8, learning_rate=3e-3)
    returns = [episode["r"] for episode in PPO("MlpPolicy", env, seed=0, **arguments).learn(4096).ep_info_buffer]
    # the random policy's is 22
    assert np.mean(returns[-20:]) > 50.0


@pytest.mark.parametrize("kind", [gymnasium.vector.SyncVectorEnv, gymnasium.vector.AsyncVectorEnv])
def test_attributes_and_methods_are_those_of_each_environment(kind):
    env = BatchVecEnv(corridors(kind))
    env.reset()
    env.step(np.ones((N, 2), np.float32))
    assert env.get_attr("steps", indices=[0, 2]) == [1, 1]
    assert env.env_method("double", 4, indices=1) == [9]
    env.set_attr("steps", [3])
    assert env.get_attr("steps") == [[3]] * N
    with pytest.raises(ValueError, match="share 'steps'"):
        env.set_attr("steps", 1, indices=[0])
    env.close()


def test_wrapped_batches_are_adapted():
    inner = gymnasium.make_vec(FORWARD, num_envs=2, duration=0.2, **SAME_STEP)
    env = BatchVecEnv(NormalizeReward(RecordEpisodeStatistics(inner)))
    env.seed(0)
    env.reset()
    total = 0.0
    for _ in range(4):
        _, rewards, dones, infos = env.step(np.ones((2, 42), np.float32))
        total += rewards
    assert dones.all() and infos[0]["termination_reason"] == "time_limit"
    assert [info["episode"]["r"] for info in infos] == pytest.approx(total)
    assert {"distance", *env.term_keys} <= infos[1]["episode"].keys()
    assert env.get_attr("control_dt") == [inner.control_dt] * 2


class Counter(VectorEnv):
    """No more than Gymnasium asks: one generator, and neither masks nor ``final_info``."""

    num_envs, single_observation_space, single_action_space = 2, Box(0.0, 9.0, (1,), np.float32), Discrete(2)
    metadata = SAME_STEP
    render_mode = None

    def reset(self, *, seed: int | None = None, options=None):
        super().reset(seed=seed)
        self.counts = self.np_random.integers(3, size=2).astype(np.float32)
        return self.counts[:, None].copy(), {}

    def step(self, actions):
        self.counts += 1.0
        over = self.counts >= 4.0
        final = {"final_obs": self.counts[:, None].copy()} if over.any() else {}
        self.counts[over] = 0.0
        infos = {"count": self.counts.copy(), **final}
        return self.counts[:, None].copy(), np.ones(2), over, np.zeros(2, bool), infos


def test_a_batch_with_one_generator_and_no_masks_is_adapted():
    env = BatchVecEnv(Counter())
    env.seed(3)
    first = env.reset()
    env.seed(3)
    np.testing.assert_array_equal(first, env.reset())
    infos = [env.step(np.zeros(2, int))[3] for _ in range(4)]
    assert infos[0][1]["count"] == first[1, 0] + 1.0
    (end,) = [each[0] for each in infos if "episode" in each[0]]
    assert end["terminal_observation"] == [4.0] and end["episode"]["l"] == 4 - first[0, 0]
    assert not end["TimeLimit.truncated"]


def test_errors_name_the_argument():
    with pytest.raises(ValueError, match=r"batch has autoreset_mode AutoresetMode\.NEXT_STEP"):
        BatchVecEnv(gymnasium.make_vec("CartPole-v1", num_envs=2))
    with pytest.raises(TypeError, match=r"batch must be a gymnasium\.vector\.VectorEnv, not Corridor"):
        BatchVecEnv(Corridor())
    env = BatchVecEnv(cart_poles())
    env.set_options([{"low": -0.01}, *[{}] * (N - 1)])
    with pytest.raises(ValueError, match="options must be the same"):
        env.reset()
    with pytest.raises(ValueError, match="seed must have one number"):
        env.seed([1])
