"""Count how often the simulation diverges under random actions, each held for one control step."""

import dataclasses

import gymnasium
import numpy as np
import tyro
from gymnasium.vector import AutoresetMode
from rich.console import Console
from rich.table import Table
from tqdm import tqdm

from elastica_gym.envs import IDS


@dataclasses.dataclass
class Arguments:
    """Count divergences under actions drawn uniformly from [-1, 1]."""

    env: tuple[str, ...] = IDS
    """Environment ids."""
    steps: int = 100_000
    """Control steps of each."""
    n_envs: int = 100
    """Environments in the batch."""
    seed: int = 0
    """Seed of environments and actions."""
    sim_dt: float | None = None
    """Time step of the physics [s]; by default the body's."""


def count(env_id: str, arguments: Arguments) -> tuple[int, int, float]:
    """Return the divergences, the control steps they happened in, and the time step of the physics [s]."""
    n = arguments.n_envs
    env = gymnasium.make_vec(env_id, num_envs=n, autoreset_mode=AutoresetMode.SAME_STEP, sim_dt=arguments.sim_dt)
    env.reset(seed=arguments.seed)
    rng = np.random.default_rng(arguments.seed)
    diverged, rounds = 0, -(-arguments.steps // n)
    for _ in tqdm(range(rounds), desc=env_id):
        info = env.step(rng.uniform(-1.0, 1.0, env.action_space.shape))[4]
        if "final_info" in info:
            diverged += int(np.sum(info["final_info"]["termination_reason"] == "diverged"))
    env.close()
    return diverged, rounds * n, env.unwrapped.sim_dt  # type: ignore[attr-defined]


def main() -> None:
    """Run the command line."""
    arguments = tyro.cli(Arguments)
    table = Table(title="Divergence under random actions")
    for column in ("environment", "time step (s)", "control steps", "diverged", "per 10,000"):
        table.add_column(column)
    for env_id in arguments.env:
        diverged, steps, dt = count(env_id, arguments)
        table.add_row(env_id, f"{dt:.3g}", f"{steps:,}", str(diverged), f"{1e4 * diverged / steps:.2f}")
    Console().print(table)


if __name__ == "__main__":
    main()
