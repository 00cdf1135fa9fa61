"""No environment gives energy from nothing that a policy could live on, and no element turns inside out."""

import pytest

from elastica_gym.envs import IDS
from scripts.audit_energy import POLICIES, audit

LARGEST = 0.01
"""Energy from nothing that is allowed, over the work of the muscles"""
SHORTEST = 0.3
"""Least length of an element over its length at rest: 0 is flat, and below it is inside out"""
QUICK = [
    ("elastica_gym/SnakeForward-v1", "full"),
    ("elastica_gym/SnakeForward-v1", "shipped"),
    ("elastica_gym/OctopusGrab-v1", "scripted"),
    ("elastica_gym/OctopusCrawl-v1", "full"),
]


def check(env_id: str, policy: str, steps: int) -> None:
    audits = dict(audit(env_id, policy, episodes=2, steps=steps, seed=0))
    for name, result in audits.items():
        assert result.muscles > 0.0
        # what passes through a kind of load is no gain
        assert max(result.gains.values()) < LARGEST, (name, result.gains)
        assert result.shortest > SHORTEST, (name, result.shortest)


@pytest.mark.parametrize(("env_id", "policy"), QUICK)
def test_no_energy_comes_from_nothing(env_id, policy):
    check(env_id, policy, steps=12)


@pytest.mark.slow
@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("env_id", IDS)
def test_no_energy_comes_from_nothing_over_episodes(env_id, policy):
    check(env_id, policy, steps=100)
