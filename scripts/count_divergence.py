"""Count divergences of the simulation under random actions, each held for one control step."""

import dataclasses

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

from elastica_gym.console.bad_input import BadInputError, check_bounds, choose, require_extra, run_command
from elastica_gym.envs import GOAL_IDS, IDS, TerminationReason


@dataclasses.dataclass
class Arguments:
    """Count divergences under actions drawn uniformly from [-1, 1]."""

    env: tuple[str, ...] = IDS
    """Environment ids."""
    steps: int = 100_000
    """Control steps per environment."""
    n_envs: int = 100
    """Environments in the batch."""
    seed: int = 0
    """Seed of environments and actions."""
    sim_dt: float | None = None
    """Time step of the physics [s]; default the body's."""


def count(env_id: str, arguments: Arguments) -> tuple[int, int, float]:
    """Return the number of divergences, that of control steps, and the time step of the physics [s]."""
    from elastica_gym.progress import track

    n = arguments.n_envs
    try:
        env = gymnasium.make_vec(env_id, num_envs=n, autoreset_mode=AutoresetMode.SAME_STEP, sim_dt=arguments.sim_dt)
    except ValueError as error:
        raise BadInputError(f"The environment refuses its arguments: {error}") from error
    env.reset(seed=arguments.seed)
    rng = np.random.default_rng(arguments.seed)
    diverged, rounds = 0, -(-arguments.steps // n)
    for _ in track(range(rounds), env_id):
        info = env.step(rng.uniform(-1.0, 1.0, env.action_space.shape))[4]
        if "final_info" in info:
            diverged += int(np.sum(info["final_info"]["termination_reason"] == TerminationReason.DIVERGED))
    env.close()
    return diverged, rounds * n, env.unwrapped.sim_dt  # type: ignore[attr-defined]


def main() -> None:
    """Run the command line."""
    require_extra("train")
    import tyro
    from rich.console import Console
    from rich.table import Table

    arguments = tyro.cli(Arguments)
    for env_id in arguments.env:
        choose("environment", env_id, (*IDS, *GOAL_IDS))
    check_bounds(dataclasses.asdict(arguments), {"steps": 1, "n_envs": 1, "seed": 0})
    table = Table(title="Divergence under random actions")
    for column in ("environment", "time step (s)", "control steps", "diverged", "per 10,000"):
        table.add_column(column)
    for env_id in arguments.env:
        diverged, steps, dt = count(env_id, arguments)
        table.add_row(env_id, f"{dt:.3g}", f"{steps:,}", str(diverged), f"{1e4 * diverged / steps:.2f}")
    Console().print(table)


if __name__ == "__main__":
    run_command(main)
