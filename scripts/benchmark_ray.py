"""Measure how RLlib scales with environment runners: ``python scripts/benchmark_ray.py --env-runners 1 2 4``.

Prints environment steps per second of the clock, while experience is collected and over whole iterations, and per
second of CPU time, of the runners and of the learner, which depend less on what else the machine does. Needs RLlib
(docs/how_to/ray.md).
"""

import argparse
import os
import tempfile
import time
from pathlib import Path
from typing import Any

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
    rows = [measure(arguments.env, n, arguments.iterations, arguments.address) for n in arguments.env_runners]
    print(f"{cpu()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    print("runners  collecting  training | per CPU second: a runner  the learner")
    for n, row in zip(arguments.env_runners, rows, strict=True):
        print(f"{n:7d}  {row[0]:10,.0f}  {row[1]:8,.0f} | {row[2]:24,.0f}  {row[3]:11,.0f}")


def measure(env_id: str, runners: int, iterations: int, address: str | None) -> tuple[float, float, float, float]:
    """Return environment steps per second of collecting, of an iteration, of a runner's CPU and of the learner's."""
    config = config_of(TrainArguments(env=env_id, engine="rllib", env_runners=runners, recordings=0))
    with tempfile.TemporaryDirectory() as folder:
        training = RllibTraining(Path(folder), config, resume=False, address=address)
        training.algorithm.train()
        steps, collecting, started = 0, 0.0, time.perf_counter()
        runners_before, learner_before = cpu_of_runners(training), time.process_time()
        for _ in range(iterations):
            before = time.perf_counter()
            result = training.algorithm.train()
            steps += result["env_runners"]["num_env_steps_sampled"]
            # the learner updates the networks after all experience is in
            learning = result["timers"]["learner_update_timer"]
            collecting += time.perf_counter() - before - learning
        seconds = time.perf_counter() - started
        learner = time.process_time() - learner_before
        runner = cpu_of_runners(training) - runners_before
        training.close()
    return steps / collecting, steps / seconds, steps / runner, steps / learner


def cpu_of_runners(training: Any) -> float:
    """Return the CPU time of all runners [s]."""
    return sum(
        training.algorithm.env_runner_group.foreach_env_runner(
            lambda runner: time.process_time(), local_env_runner=False
        )
    )


if __name__ == "__main__":
    main()
