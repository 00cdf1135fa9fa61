"""Print the energy balance under each policy: the work of each kind of load, relative to that of the muscles.

Muscles may add energy; friction and damping remove it. Any other energy source is a fault that learning may exploit:
non-conservative loads of strains (imbalance), or ground and contact that return more energy than they absorbed. So is
an inverted element.
"""

import dataclasses
from collections.abc import Iterator

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

from elastica_gym.console.bad_input import check_bounds, choose, require_extra, run_command
from elastica_gym.engine.energy import Ledger
from elastica_gym.engine.model import Model, State
from elastica_gym.envs import IDS
from elastica_gym.rl.seeds import TEST

POLICIES = ("random", "full", "scripted", "shipped")
CONSERVATIVE = {"ground": ("ground reaction", "ground spring"), "contact": ("contact spring",)}
"""Kinds of load that must not add energy; the energy left in springs at the end is negligible"""
PASSIVE = ("ground friction", "contact friction", "ground damping", "contact damping", "damping")
"""Kinds of load that must remove energy"""
SOURCES = ("strains", *CONSERVATIVE, *PASSIVE)
"""Possible spurious sources of energy, in the order of `Audit.gains`"""


@dataclasses.dataclass
class Arguments:
    """Audit every environment under random and full-strength actions, its script and its shipped policies."""

    env: tuple[str, ...] = IDS
    """Environment ids."""
    policies: tuple[str, ...] = POLICIES
    """Any of random, full, scripted and shipped."""
    episodes: int = 4
    """Parallel episodes per policy."""
    steps: int = 100
    """Control steps of each episode."""
    seed: int = TEST.start
    """Seed of the first episode."""


@dataclasses.dataclass(frozen=True)
class Audit:
    """Work over episodes, relative to that of the muscles."""

    muscles: float
    """Work of the muscles, mean over episodes [J]"""
    work: dict[str, float]
    """Work of each kind of load over that of the muscles"""
    imbalance: float
    """Spurious energy from the loads of strains, over the work of the muscles"""
    shortest: float
    """Minimum length of an element along its director d3, over its rest length; below 0 it is inverted"""

    @property
    def gains(self) -> dict[str, float]:
        """Spurious energy by source, over the work of the muscles; at most 0 without a fault."""
        gains = {name: sum(self.work[kind] for kind in kinds) for name, kinds in CONSERVATIVE.items()}
        return {"strains": self.imbalance, **gains, **{kind: self.work[kind] for kind in PASSIVE}}


def audit(env_id: str, policy: str, *, episodes: int, steps: int, seed: int) -> Iterator[tuple[str, Audit]]:
    """Audit an environment under a kind of policy; yields nothing if it has none of that kind."""
    from elastica_gym.rl.cards import load_pretrained, names, read_card
    from elastica_gym.rl.policies import FullStrengthPolicy, baseline

    if policy != "shipped":
        chosen = FullStrengthPolicy() if policy == "full" else baseline(policy)
        yield policy, _audit(env_id, chosen, episodes, steps, seed)
        return
    for name in names():
        if read_card(name)["environment"] == env_id:
            yield name, _audit(env_id, load_pretrained(name)[0], episodes, steps, seed)


def _audit(env_id: str, policy: object, episodes: int, steps: int, seed: int) -> Audit:
    env = gymnasium.make_vec(env_id, num_envs=episodes, autoreset_mode=AutoresetMode.DISABLED, n_threads=1)
    batch = env.unwrapped
    policy.reset([seed + i for i in range(episodes)])
    observations, _ = env.reset(seed=seed)
    # autoreset is off: the physics continues when an episode ends
    ledger = batch.integrator = Ledger(batch.body.model, batch.state, batch.control)
    shortest = np.inf
    for _ in range(steps):
        observations = env.step(policy(observations, batch))[0]
        shortest = min(shortest, _shortest(batch.body.model, batch.state))
    env.close()
    muscles = ledger.work["muscles"].mean()
    work = {kind: float(work.mean() / muscles) for kind, work in ledger.work.items()}
    return Audit(float(muscles), work, float(ledger.imbalance.mean() / muscles), shortest)


def _shortest(model: Model, state: State) -> float:
    """Return the minimum stretch of an element along its director d3."""
    along = (state.Q[:, 2, :, :-1] * np.diff(state.x, axis=2)).sum(axis=1)
    is_element = model.rest_length[:-1] > 0.0
    return float((along * model.inv_rest_length[:-1])[:, is_element].min())


def main() -> None:
    """Run the command line."""
    require_extra("train")
    import tyro
    from rich.console import Console
    from rich.table import Table

    from elastica_gym.progress import track

    arguments = tyro.cli(Arguments)
    for env_id in arguments.env:
        choose("environment", env_id, IDS)
    for policy in arguments.policies:
        choose("policy", policy, POLICIES)
    check_bounds(dataclasses.asdict(arguments), {"episodes": 1, "steps": 1, "seed": 0})
    table = Table(
        title="Energy over the work of the muscles: positive values are spurious. "
        "Shortest element, over its rest length"
    )
    pairs = [(env_id, policy) for env_id in arguments.env for policy in arguments.policies]
    rows = []
    for env_id, policy in track(pairs, "audits"):
        for name, result in audit(
            env_id, policy, episodes=arguments.episodes, steps=arguments.steps, seed=arguments.seed
        ):
            gains = (f"{100.0 * gain:.2f} %" for gain in result.gains.values())
            rows.append((env_id.partition("/")[2], name, f"{result.muscles:.3g} J", *gains, f"{result.shortest:.2f}"))
    for column in ("environment", "policy", "muscles", *SOURCES, "shortest"):
        table.add_column(column)
    for row in rows:
        table.add_row(*row)
    Console(width=200).print(table)


if __name__ == "__main__":
    run_command(main)
