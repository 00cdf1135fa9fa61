"""Environment steps per second on this machine."""

import dataclasses
import time

from ..console.bad_input import check_bounds, choose_environment
from . import parse

LOWEST = {"envs": 1, "seconds": 0.1, "threads": 1}


@dataclasses.dataclass
class BenchArguments:
    """Measure environment steps per second under random actions, on one thread and on several."""

    env: tuple[str, ...] = ("elastica_gym/SnakeForward-v1", "elastica_gym/OctopusReach-v1")
    """Environment ids."""
    envs: int = 64
    """Environments in the batch."""
    seconds: float = 5.0
    """Duration of each measurement [s]."""
    threads: int | None = None
    """Threads of the second measurement; by default one for each CPU."""


def main() -> None:
    """Run the command line."""
    from rich.console import Console
    from rich.table import Table

    from ..engine.threads import available_cpus
    from ..progress import track

    arguments = parse("bench", BenchArguments, "", "--env elastica_gym/OctopusFetch-v1 --envs 32")
    check_bounds(dataclasses.asdict(arguments), LOWEST)
    ids = [choose_environment(env_id, goals=True) for env_id in arguments.env]
    several = arguments.threads or available_cpus()
    cases = [(env_id, threads) for env_id in ids for threads in sorted({1, several})]
    table = Table("environment", "threads", "steps/s", "simulated s/s")
    for env_id, threads in track(cases, "measuring"):
        rate, dt = measure(env_id, arguments.envs, threads, arguments.seconds)
        table.add_row(env_id, str(threads), f"{rate:,.0f}", f"{rate * dt:,.1f}")
    Console().print(table)


def measure(env_id: str, n_envs: int, n_threads: int, seconds: float) -> tuple[float, float]:
    """Return environment steps per second of a batch under random actions, and the control period [s]."""
    import gymnasium
    import numpy as np

    envs = gymnasium.make_vec(env_id, num_envs=n_envs, n_threads=n_threads)
    envs.reset(seed=0)
    rng, shape = np.random.default_rng(0), envs.action_space.shape
    actions = [rng.uniform(-1.0, 1.0, shape).astype(np.float32) for _ in range(16)]
    envs.step(actions[0])
    steps, started = 0, time.perf_counter()
    while (spent := time.perf_counter() - started) < seconds:
        envs.step(actions[steps % 16])
        steps += 1
    dt = envs.unwrapped.control_dt  # type: ignore[attr-defined]
    envs.close()
    return steps * n_envs / spent, dt
