import pytest

from elastica_gym.viz import Rollout, run_rollout


def scripted(observations, env):
    return env.task.scripted_policy(env)


@pytest.fixture(scope="session")
def forward() -> Rollout:
    return run_rollout("elastica_gym/SnakeForward-v0", scripted, seed=3, duration=2.0)


@pytest.fixture(scope="session")
def reach() -> Rollout:
    return run_rollout("elastica_gym/SnakeReach-v0", scripted, seed=3)
