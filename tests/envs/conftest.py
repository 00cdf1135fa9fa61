import gymnasium
import numpy as np
import pytest

from elastica_gym.envs import GOAL_IDS, IDS, task_of

from .tentacle_reach import TENTACLE
from .toy import TOY, TOY_GOAL

SHORT = 0.5
"""Episode duration in most tests [s]: ten control steps"""


@pytest.fixture(params=(*IDS, TOY, TENTACLE))
def env_id(request):
    return request.param


@pytest.fixture(params=(*IDS, TOY, TENTACLE, *GOAL_IDS, TOY_GOAL))
def any_id(request):
    """Also ids with dict observations, for tests that do not read them."""
    return request.param


@pytest.fixture
def make_vec():
    """Make batches, by default with short episodes, and close them."""
    made = []

    def make(env_id, num_envs=2, *, duration=SHORT, **kwargs):
        made.append(gymnasium.make_vec(env_id, num_envs=num_envs, duration=duration, **kwargs))
        return made[-1].unwrapped

    yield make
    for env in made:
        env.close()


def random_actions(env_id, seed, steps, num_envs=1):
    shape = (steps, num_envs, task_of(env_id).make_body().n_activations)
    return np.random.default_rng(seed).uniform(-1.0, 1.0, shape).astype(np.float32)


def still(env):
    """Return the action that leaves the muscles at rest."""
    return np.zeros(env.action_space.shape)


def flat(observations):
    """Observations as one array; those of a dict are concatenated."""
    if isinstance(observations, dict):
        return np.concatenate(list(observations.values()), axis=-1)
    return observations
