"""Spaces of flat environments name their entries, and otherwise equal Gymnasium's."""

import copy
import pickle

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box
from gymnasium.vector.utils import batch_space

from elastica_gym.envs.spaces import NamedBox


@pytest.fixture(params=["observation_space", "action_space"])
def space(request, env_id):
    return getattr(gymnasium.make(env_id), request.param)


def test_it_equals_a_plain_box_of_the_same_bounds(space):
    plain = Box(space.low, space.high, dtype=np.float32)
    assert space == plain and plain == space
    wider = Box(2.0 * space.low - 1.0, space.high, dtype=np.float32)
    assert space != wider and wider != space


@pytest.mark.parametrize("way", [copy.deepcopy, lambda space: pickle.loads(pickle.dumps(space))])
def test_copies_keep_the_names_of_entries(space, way):
    other = way(space)
    assert type(other) is NamedBox and other == space
    assert (other.names, other.mirror, other.duration) == (space.names, space.mirror, space.duration)


def test_batches_of_it_are_gymnasiums(space):
    batch = batch_space(space, 3)
    assert type(batch) is Box and batch.shape == (3, *space.shape)


def test_it_agrees_with_the_environment(env_id, make_vec):
    env = make_vec(env_id, duration=0.5)
    space = env.single_observation_space
    assert space.names == env.observation_names and len(env.single_action_space.names) == env.body.n_activations
    assert space.mirror is env.body.mirror is env.single_action_space.mirror
    assert space.duration == pytest.approx(0.5) == env.duration
    # the clock does not depend on when an episode is truncated
    assert make_vec(env_id, duration=0.5, max_episode_steps=3).single_observation_space.duration == space.duration
