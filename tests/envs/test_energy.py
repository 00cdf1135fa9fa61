"""No environment has a spurious energy source that a policy could exploit, and no element is inverted."""

import pytest

from elastica_gym.envs import IDS
from scripts.audit_energy import POLICIES, audit

LARGEST = 0.01
"""Allowed spurious energy, over the work of the muscles"""
SHORTEST = 0.3
"""Minimum length of an element over its rest length: 0 is flat, and below 0 is inverted"""
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
        # energy stored and returned by a load is no gain
        assert max(result.gains.values()) < LARGEST, (name, result.gains)
        assert result.shortest > SHORTEST, (name, result.shortest)


@pytest.mark.parametrize(("env_id", "policy"), QUICK)
def test_there_is_no_spurious_energy(env_id, policy):
    check(env_id, policy, steps=12)


@pytest.mark.slow
@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("env_id", IDS)
def test_there_is_no_spurious_energy_over_episodes(env_id, policy):
    check(env_id, policy, steps=100)
