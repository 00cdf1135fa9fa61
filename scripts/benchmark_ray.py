"""Measure how RLlib scales with environment runners: ``python scripts/benchmark_ray.py --env-runners 1 2 4``.

Prints environment steps per second while experience is collected and over whole iterations, and what that is per
runner, relative to the first. Needs RLlib (docs/how_to/ray.md).
"""

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

from elastica_gym.commands.train import TrainArguments, config_of
from elastica_gym.rl.machine import cpu
from elastica_gym.rl.rllib_engine import RllibTraining


def main() -> None:
    """Measure each number of runners in turn."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--env", default="elastica_gym/SnakeForward-v1")
    parser.add_argument("--env-runners", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--iterations", type=int, default=4, help="after one that is not counted")
    parser.add_argument("--address", help="of a Ray cluster; by default this machine's cores")
    arguments = parser.parse_args()
    print(cpu())
    print("runners  collecting  training  efficiency of collecting")
    first = None
    for runners in arguments.env_runners:
        collecting, training = measure(arguments.env, runners, arguments.iterations, arguments.address)
        each = collecting / runners
        first = first or each
        print(f"{runners:7d}  {collecting:8,.0f}/s {training:7,.0f}/s  {each / first:.0%}", flush=True)


def measure(env_id: str, runners: int, iterations: int, address: str | None) -> tuple[float, float]:
    """Return median environment steps per second while collecting, and over whole iterations."""
    config = config_of(TrainArguments(env=env_id, engine="rllib", env_runners=runners, recordings=0))
    with tempfile.TemporaryDirectory() as folder:
        training = RllibTraining(Path(folder), config, resume=False, address=address)
        rates = []
        for _ in range(iterations + 1):
            started = time.perf_counter()
            result = training.algorithm.train()
            seconds = time.perf_counter() - started
            steps = result["env_runners"]["num_env_steps_sampled"]
            rates.append((steps / result["timers"]["env_runner_sampling_timer"], steps / seconds))
        training.close()
    return tuple(np.median(rates[1:], axis=0))


if __name__ == "__main__":
    main()
