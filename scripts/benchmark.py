"""Measure how fast the physics is beside PyElastica 1.0.0, and how fast the environments are.

``python scripts/benchmark.py`` prints tables and JSON; ``--start`` only measures how long a first step takes.
"""

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
INSTALL = 'pip install "elastica-gym[train,bench]"'
IDS = ("elastica_gym/SnakeForward-v0", "elastica_gym/SnakeReach-v0")
SIZES = (20, 50, 100, 200)
DAMPING = 0.002
"""Of velocities, as the original's damping of translation [1/s]"""
TARGETS = {50: 35.0, 200: 22.0}
"""How many times PyElastica's speed is demanded, by number of elements"""
THREADS_TARGET = 1.7
COLD_LIMIT, WARM_LIMIT = 40.0, 3.0
"""Time to the first step, with and without compiling [s]"""
WARM_UP = 2.0
"""Time after which the snake is timed, crawling at full strength [s]"""
STEPS_THEIRS, STEPS_OURS = 100, 1000
"""Steps of a slice, which so takes milliseconds of either program"""
SLICES = 8
"""A pair is the best of as many slices of each program, in turn, so that other work on the machine spoils few"""

FIRST_STEP = """
import time
start = time.perf_counter()
import elastica_gym, gymnasium
env = gymnasium.make("elastica_gym/SnakeForward-v0")
env.reset(seed=0)
env.step(env.action_space.sample())
print(time.perf_counter() - start)
"""


def main() -> None:
    """Measure what was asked for, and print it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--start", action="store_true", help="only the time to the first step, cold and warm")
    parser.add_argument("--pairs", type=int, default=9, help="interleaved pairs of measurements (default: 9)")
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="numbers of elements")
    parser.add_argument("--json", type=Path, help="also write the JSON to this file")
    arguments = parser.parse_args()
    if arguments.pairs < 1 or min(arguments.sizes) < 2:
        parser.error("--pairs must be at least 1, and --sizes at least 2")
    if arguments.start:
        print(describe_start(measure_start()))
        return
    require_extras()
    results: dict[str, Any] = {"machine": describe_machine()}
    results["physics"] = [measure_physics(n, arguments.pairs) for n in arguments.sizes]
    results["environments"] = [measure_environments(each, arguments.pairs) for each in IDS]
    results["start"] = measure_start()
    show(results)
    text = json.dumps(results, indent=2)
    print(text)
    if arguments.json:
        arguments.json.write_text(text + "\n")


def require_extras() -> None:
    """Exit with the command that mends it unless what is compared with is installed."""
    try:
        import elastica  # noqa: F401
        import rich  # noqa: F401
    except ImportError as error:
        sys.exit(f"the benchmark needs {error.name}, which is not installed: {INSTALL}")
    if version("pyelastica") != "1.0.0":
        sys.exit(f"the benchmark compares with pyelastica 1.0.0, not {version('pyelastica')}: {INSTALL}")


def describe_machine() -> dict[str, Any]:
    """Return what the numbers depend on."""
    import llvmlite.binding

    names = ("elastica-gym", "numpy", "numba", "llvmlite", "gymnasium", "pyelastica")
    return {
        "cpu": cpu_name(), "llvm_cpu": llvmlite.binding.get_host_cpu_name(), "cpus": os.cpu_count(),
        "system": platform.platform(), "python": platform.python_version(), "versions": {n: found(n) for n in names},
    }  # fmt: skip


def cpu_name() -> str:
    """Return the processor's name as the system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.machine())


def found(name: str) -> str:
    """Return the version of a package, or where it comes from if it is not installed."""
    try:
        return version(name)
    except ImportError:
        return "source"


# physics


def measure_physics(n: int, n_pairs: int) -> dict[str, Any]:
    """Time a step of the snake of n elements, damping and static friction on, in both programs on one thread."""
    sys.path.insert(0, str(ROOT))
    from elastica_gym.cosserat import advance
    from tests.cosserat import oracle
    from tests.cosserat.scenes import GRAVITY, TIME_STEP, WAVE, ground, motion, snake

    dt, loads = TIME_STEP * 50 / n, {"gravity": GRAVITY, "planes": [ground()], "waves": [WAVE]}
    agreement = require_agreement(n, dt, loads)
    model, state, control, twin = oracle.both([snake(n, damping_rate=DAMPING)], dt, **loads)
    advance(model, state, control, 0, 1, dt, round(WARM_UP / dt))
    twin.set_state([motion(model, state)], float(state.time[0]))
    twin.advance(STEPS_THEIRS)
    ours, theirs = [], []
    for _ in range(n_pairs):
        slices = [(timed(lambda: twin.advance(STEPS_THEIRS)),
                   timed(lambda: advance(model, state, control, 0, 1, dt, STEPS_OURS)))
                  for _ in range(SLICES)]  # fmt: skip
        best_theirs, best_ours = (min(column) for column in zip(*slices, strict=True))
        theirs.append(best_theirs / STEPS_THEIRS)
        ours.append(best_ours / STEPS_OURS)
    ratios = [b / a for a, b in zip(ours, theirs, strict=True)]
    return {
        "elements": n, "dt": dt, "ours_us": 1e6 * statistics.median(ours),
        "pyelastica_us": 1e6 * statistics.median(theirs), "ratio": statistics.median(ratios), "ratios": ratios,
        "target": TARGETS.get(n),
        "simulated_seconds_per_second": dt / statistics.median(ours), "agreement": agreement,
    }  # fmt: skip


def require_agreement(n: int, dt: float, loads: dict[str, Any]) -> dict[str, float]:
    """Exit unless both programs compute the same on the scene that is timed."""
    from elastica_gym.cosserat import advance
    from tests.cosserat import oracle
    from tests.cosserat.scenes import LENGTH, snake

    rod = snake(n, damping_rate=DAMPING)
    model, state, control, twin = oracle.both([rod], dt, **loads)
    advance(model, state, control, 0, 1, dt, 100)
    twin.advance(100)
    distance, step = oracle.distance(model, state, twin), oracle.worst_step([rod], dt, 50, **loads)[0]
    # PyElastica adds 1e-14 m to the length of an element, which the strains of short ones show (docs/differences.md)
    allowed = 1e-11 + 2e-14 * n / LENGTH
    if not (distance < 1e-9 and step < allowed):
        sys.exit(f"the programs do not agree at n = {n}: {distance:.2g} m after 100 steps (1e-9 allowed), "
                 f"{step:.2g} in a step from a random state ({allowed:.2g} allowed)")  # fmt: skip
    return {"metres_after_100_steps": distance, "relative_in_one_step": step}


def timed(call: Callable[[], object]) -> float:
    """Return how long a call takes [s]."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


# environments


def measure_environments(env_id: str, n_pairs: int, num_envs: int = 64, n_steps: int = 20) -> dict[str, Any]:
    """Time environment steps of a batch on one thread and on two, random actions."""
    import gymnasium
    import numpy as np
    from gymnasium.vector import AutoresetMode

    import elastica_gym  # noqa: F401

    envs = [gymnasium.make_vec(env_id, num_envs=num_envs, n_threads=n, autoreset_mode=AutoresetMode.SAME_STEP)
            for n in (1, 2)]  # fmt: skip
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (n_steps, num_envs, 42)).astype(np.float32)

    def run(env: Any) -> None:
        for action in actions:
            env.step(action)

    for env in envs:
        env.reset(seed=0)
        run(env)
    rates = [[num_envs * n_steps / timed(lambda env=env: run(env)) for env in envs] for _ in range(n_pairs)]
    one, two = (statistics.median(column) for column in zip(*rates, strict=True))
    sim_dt, n_substeps = envs[0].unwrapped.sim_dt, envs[0].unwrapped.n_substeps
    for env in envs:
        env.close()
    return {
        "id": env_id, "environments": num_envs, "sim_dt": sim_dt, "substeps": n_substeps,
        "steps_per_second_one_thread": one, "steps_per_second_two_threads": two,
        "threads_ratio": statistics.median(b / a for a, b in rates), "target": THREADS_TARGET,
    }  # fmt: skip


# the first step


def measure_start() -> dict[str, float]:
    """Return the time from import to the end of the first step, with an empty cache and with a full one [s]."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "ELASTICA_GYM_CACHE_DIR": folder}
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
        times = [subprocess.run([sys.executable, "-c", FIRST_STEP], env=environment, stdout=subprocess.PIPE, text=True,
                                check=True).stdout for _ in range(2)]  # fmt: skip
    cold, warm = (float(line) for line in times)
    return {"cold_s": cold, "warm_s": warm}


def describe_start(start: dict[str, float]) -> str:
    """Return a line on how long a first step takes."""
    return (f"first step: {start['cold_s']:.1f} s cold (at most {COLD_LIMIT:g}), "
            f"{start['warm_s']:.1f} s warm (at most {WARM_LIMIT:g})")  # fmt: skip


# what is printed


def show(results: dict[str, Any]) -> None:
    """Print the tables."""
    from rich.console import Console
    from rich.table import Table

    console = Console()
    physics = Table(title="One step of the snake on one thread [μs], beside PyElastica 1.0.0")
    for column in ("elements", "PyElastica", "here", "ratio", "demanded", "simulated s per s"):
        physics.add_column(column, justify="right")
    for row in results["physics"]:
        demanded = "" if row["target"] is None else f"{row['target']:g}"
        physics.add_row(f"{row['elements']}", f"{row['pyelastica_us']:.1f}", f"{row['ours_us']:.2f}",
                        f"{row['ratio']:.1f}", demanded, f"{row['simulated_seconds_per_second']:.1f}")  # fmt: skip
    environments = Table(title="Environment steps per second, 64 environments, random actions")
    for column in ("id", "one thread", "two threads", "ratio", "demanded"):
        environments.add_column(column, justify="left" if column == "id" else "right")
    for row in results["environments"]:
        environments.add_row(row["id"], f"{row['steps_per_second_one_thread']:,.0f}",
                             f"{row['steps_per_second_two_threads']:,.0f}", f"{row['threads_ratio']:.2f}",
                             f"{row['target']:g}")  # fmt: skip
    console.print(physics, environments)
    console.print(describe_start(results["start"]), highlight=False)


if __name__ == "__main__":
    main()
