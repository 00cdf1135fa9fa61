import numpy as np
import pytest

from elastica_gym.scripted import scripted_policy
from elastica_gym.viz import Rollout, run_rollout


def scripted(observations, env):
    return scripted_policy(env.task)(env)


def pushing(observations, env):
    """Bend the second arm to the right, towards the object on the arc."""
    actions = np.zeros((env.num_envs, 42))
    actions[:, 7] = 0.7
    return actions


@pytest.fixture(scope="session")
def forward() -> Rollout:
    return run_rollout("elastica_gym/SnakeForward-v1", scripted, seed=3, duration=2.0)


@pytest.fixture(scope="session")
def octopus() -> Rollout:
    return run_rollout("elastica_gym/OctopusReach-v1", pushing, seed=3, duration=1.0)


@pytest.fixture(params=["forward", "octopus"])
def either(request) -> Rollout:
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="session")
def reach() -> Rollout:
    return run_rollout("elastica_gym/SnakeReach-v1", scripted, seed=3)
