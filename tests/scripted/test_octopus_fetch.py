"""The policy file that fetches the object by script, using observations only."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from elastica_gym.envs.handling import Handling
from elastica_gym.envs.tasks.octopus_fetch import observe_goal
from elastica_gym.files import shipped
from elastica_gym.rl.policy_file import FilePolicy
from elastica_gym.scripted import octopus_fetch as octopus_script

POLICY = shipped("pretrained") / "octopus_fetch_script.py"
FETCH = "elastica_gym/OctopusFetch-v1"


@pytest.fixture
def make():
    """Make a batch of octopuses at the default target, and close it at the end."""
    made = []

    def batch(env_id=FETCH, **kwargs):
        made.append(gymnasium.make_vec(env_id, num_envs=2, autoreset_mode=AutoresetMode.DISABLED, **kwargs))
        return made[-1].unwrapped

    yield batch
    for env in made:
        env.close()


def test_the_file_acts_like_the_script(make):
    batch = make(spread="default")
    observations, _ = batch.reset(seed=[3, 4])
    policy = FilePolicy(POLICY)
    policy.reset([0, 0])
    played = []
    for _ in range(24):
        actions = policy(observations, batch)
        assert batch.action_space.contains(actions)
        np.testing.assert_allclose(actions, octopus_script.fetch(batch), atol=1e-6)
        played.append(actions)
        observations, *_ = batch.step(actions)
    assert np.ptp(np.array(played), axis=0).max() > 0.5


def test_the_file_infers_from_the_goal_whether_the_object_is_grabbed(make):
    batch = make("elastica_gym/OctopusReturn-v1")
    observations, _ = batch.reset(seed=[3, 4])
    assert (batch.situation().progress.grabbed == 1.0).all()
    policy = FilePolicy(POLICY)
    policy.reset([0, 0])
    sight, home = octopus_script.see(observations), observations[:, 208:210].astype(float)
    np.testing.assert_allclose(sight.goal, home, atol=1e-6)
    carrying = octopus_script.carry(home, np.zeros(2), np.where(sight.ahead >= 0.0, 1, 0))
    np.testing.assert_allclose(policy(observations, batch), carrying, atol=1e-6)


def test_it_carries_the_object_away_until_it_has_crawled(make):
    batch = make(spread="arc")
    batch.reset(seed=[3, 4])
    for _ in range(20):
        batch.step(octopus_script.fetch(batch))
    names = {name: column for column, name in enumerate(Handling._fields)}
    home = batch.observations[:, 208:210].astype(float)
    assert np.linalg.norm(home, axis=1).min() > 0.0
    for grabbed, crawled, sign in ((1.0, 0.0, -1.0), (1.0, 1.0, 1.0)):
        batch.progress[:, names["grabbed"]], batch.progress[:, names["crawled"]] = grabbed, crawled
        observations = batch.observations
        observations[:, 206:210] = observe_goal(batch.situation())
        np.testing.assert_allclose(octopus_script.see(observations).goal, sign * home, atol=1e-6)


def test_the_script_computes_true_positions(make):
    batch = make(spread="arc")
    batch.reset(seed=[3, 4])
    for _ in range(6):
        batch.step(octopus_script.fetch(batch))
    sight, situation = octopus_script.see(batch.observations), batch.situation()
    handled, head = situation.progress, situation.pose.head
    away = np.hypot(handled.base_x - head[:, 0], handled.base_z - head[:, 2])
    np.testing.assert_allclose(np.hypot(sight.ahead, sight.right), away, atol=1e-5)
    np.testing.assert_allclose(sight.levels, batch.levels, atol=1e-6)
    # tolerance for observed nodes 83 mm apart on a bending arm
    np.testing.assert_allclose(sight.gap, handled.reach, atol=0.05)
