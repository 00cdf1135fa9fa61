"""The ground supports every animal under any action: penetration is at most a fraction of the radius."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from elastica_gym.envs import IDS
from elastica_gym.rl.cards import load_pretrained, names, read_card
from elastica_gym.rl.policies import FullStrengthPolicy, Policy, ZeroPolicy, baseline

RESTING, STRIKING = 0.25, 0.5
"""Allowed penetration at rest and at most, as fractions of the radius"""
PIECES = 8
"""Measurements per control step"""
SHIPPED = {name: read_card(name)["environment"] for name in names()}


class Probe:
    """An integrator that measures the penetration of elements into the ground, over their rest radii."""

    def __init__(self, batch):
        self.batch, self.team, self.deepest = batch, batch.integrator, 0.0
        rod = batch.body.rods[0]
        first = int(batch.body.model.first_slot[0])
        self.nodes, self.radius = slice(first, first + rod.n_elements + 1), rod.radius

    def depth(self) -> float:
        height = self.batch.state.x[:, 1, self.nodes]
        return float((1.0 - 0.5 * (height[:, 1:] + height[:, :-1]) / self.radius).max())

    def advance(self, n_envs, dt, n_substeps, then):
        cuts = np.linspace(0, n_substeps, PIECES + 1).round().astype(int)
        for piece in np.diff(cuts):
            self.team.advance(n_envs, dt, int(piece), then)
            self.deepest = max(self.deepest, self.depth())


def probed(env_id: str, policy: Policy, steps: int) -> Probe:
    """Run a policy in four environments, beyond the end of episodes, and return the probe."""
    env = gymnasium.make_vec(env_id, num_envs=4, autoreset_mode=AutoresetMode.DISABLED, n_threads=1)
    batch = env.unwrapped
    policy.reset(range(4))
    observations, _ = env.reset(seed=0)
    probe = batch.integrator = Probe(batch)
    for _ in range(steps):
        observations, *_ = env.step(policy(observations, batch))
    assert np.isfinite(batch.state.x).all()
    return probe


@pytest.mark.parametrize("env_id", IDS)
def test_penetration_at_rest_is_small(env_id):
    assert probed(env_id, ZeroPolicy(), 30).depth() < RESTING


@pytest.mark.parametrize("env_id", IDS)
@pytest.mark.parametrize("policy", [FullStrengthPolicy(), baseline("random")], ids=["full strength", "random"])
def test_penetration_at_impact_is_small(env_id, policy):
    assert -0.1 < probed(env_id, policy, 40).deepest < STRIKING


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_policies_do_not_exploit_soft_ground(name):
    assert probed(SHIPPED[name], load_pretrained(name)[0], 80).deepest < STRIKING
