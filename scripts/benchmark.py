"""Measure the speed of the physics relative to PyElastica 1.0.0, and that of the environments.

``python scripts/benchmark.py`` prints tables and JSON; ``--start`` only measures the time to the first step, and
``--engines`` only the speed of training by the RL libraries that are installed.
"""

import argparse
import contextlib
import io
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from importlib.metadata import version
from importlib.util import find_spec
from multiprocessing import get_context
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
INSTALL = 'pip install "elastica-gym[train,bench]"'
SIZES = (20, 50, 100, 200)
DAMPING = 0.002
"""Damping rate of velocities, as of the original's translational damping [1/s]"""
TARGETS = {50: 35.0, 200: 22.0}
"""Required speed-up over PyElastica on the snake, by number of elements"""
ARMS_TARGET = 30.0
"""Required speed-up on two arms around an object"""
OWN_FORCE_LIMIT = 3.0
STEPPER_RATIO = 2.0
"""Largest time that a user's own empty force may add to a step of the library [us]"""
LIBRARY_STEPS_OURS, LIBRARY_STEPS_THEIRS = 200, 10
THREADS_TARGET = 1.7
ONE_OF_EACH = ("elastica_gym/SnakeForward-v1", "elastica_gym/OctopusReach-v1")
"""One environment per animal; its other tasks have the same physics"""
ENGINES = tuple(sorted(path.stem for path in (ROOT / "scripts" / "examples" / "engines").glob("*.py")))
"""Scripts that train by an RL library, each called ``<module>_<algorithm>``"""
ENGINE_STEPS = 25_600
"""Environment steps of training: two episodes of 64 snakes"""
ADAPTER_LIMIT = 0.03
"""Largest time that the adapter to Stable-Baselines3 may add to a step of 64 snakes, as a fraction of it"""
COLD_LIMIT, WARM_LIMIT = 40.0, 3.0
"""Largest time to the first step, with and without compilation [s]"""
WARM_UP = 2.0
"""Simulated time before the measurement; the snake then crawls at full strength [s]"""
STEPS_OURS = 1000
STEPS_THEIRS, STEPS_THEIRS_ARMS = 100, 20
"""Steps per slice, so that a slice takes milliseconds in either program"""
SLICES = 8
"""Interleaved slices of each program per pair, of which the best counts: this rejects other load on the machine"""

FIRST_STEP = """
import time
start = time.perf_counter()
import elastica_gym, gymnasium
env = gymnasium.make("elastica_gym/SnakeForward-v1")
env.reset(seed=0)
env.step(env.action_space.sample())
print(time.perf_counter() - start)
"""


def main() -> None:
    """Run the requested measurements and print them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--start", action="store_true", help="only the time to the first step, cold and warm")
    parser.add_argument("--engines", action="store_true", help="only training by RL libraries")
    parser.add_argument("--pairs", type=int, default=9, help="interleaved pairs of measurements (default: 9)")
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, help="numbers of elements")
    parser.add_argument("--json", type=Path, help="also write the JSON to this file")
    arguments = parser.parse_args()
    if arguments.pairs < 1 or min(arguments.sizes) < 2:
        parser.error("--pairs must be at least 1, and --sizes at least 2")
    if arguments.start:
        print(describe_start(measure_start()))
        return
    if arguments.engines:
        show_engines(measure_engines(arguments.pairs))
        return
    require_extras()
    sys.path.insert(0, str(ROOT))
    results: dict[str, Any] = {"machine": describe_machine()}
    results["physics"] = [*(measure_snake(n, arguments.pairs) for n in arguments.sizes), measure_arms(arguments.pairs)]
    # PyElastica prints at the end of each run
    with contextlib.redirect_stdout(io.StringIO()):
        results["library"] = [measure_rods(n, arguments.pairs) for n in (4, 36)]
        results["own_force"] = measure_own_force(arguments.pairs)
        results["stepper"] = measure_stepper(arguments.pairs)
    results["environments"] = [measure_environments(each, arguments.pairs) for each in ONE_OF_EACH]
    results["start"] = measure_start()
    show(results)
    text = json.dumps(results, indent=2)
    print(text)
    if arguments.json:
        arguments.json.write_text(text + "\n")


def require_extras() -> None:
    """Exit with the install command unless PyElastica and rich are installed."""
    try:
        import elastica  # noqa: F401
        import rich  # noqa: F401
    except ImportError as error:
        sys.exit(f"the benchmark needs {error.name}, which is not installed: {INSTALL}")
    if version("pyelastica") != "1.0.0":
        sys.exit(f"the benchmark compares with pyelastica 1.0.0, not {version('pyelastica')}: {INSTALL}")


def describe_machine() -> dict[str, Any]:
    """Return the machine and versions that the numbers depend on."""
    import llvmlite.binding

    names = ("elastica-gym", "numpy", "numba", "llvmlite", "gymnasium", "pyelastica")
    return {
        "cpu": cpu_name(),
        "llvm_cpu": llvmlite.binding.get_host_cpu_name(),
        "cpus": os.cpu_count(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "versions": {n: found(n) for n in names},
    }


def cpu_name() -> str:
    """Return the processor's name as reported by the system."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.machine())


def found(name: str) -> str:
    """Return the version of a package, or its source if it is not installed."""
    try:
        return version(name)
    except ImportError:
        return "source"


# physics


def measure_snake(n: int, n_pairs: int) -> dict[str, Any]:
    """Time a step of a snake of n elements with damping and static friction, in both programs on one thread."""
    sys.path.insert(0, str(ROOT))
    from tests.engine import oracle
    from tests.engine.scenes import GRAVITY, LENGTH, TIME_STEP, WAVE, ground, snake

    dt, loads = TIME_STEP * 50 / n, {"gravity": GRAVITY, "planes": [ground()], "waves": [WAVE]}
    rod = snake(n, damping_rate=DAMPING)
    # PyElastica adds 1e-14 m to element lengths, which shows in the strains of short ones (docs/differences.md)
    agreement = require_agreement("the snake", rod, dt, 1e-11 + 2e-14 * n / LENGTH, **loads)
    pair = oracle.both([rod], dt, **loads)
    return {
        "scene": "snake",
        "elements": n,
        **race(*pair, STEPS_THEIRS, n_pairs),
        "target": TARGETS.get(n),
        "agreement": agreement,
    }


def measure_arms(n_pairs: int) -> dict[str, Any]:
    """Time a step of two arms on the ground around an object, with 42 active muscles and self contact.

    PyElastica runs the closest scene that it can: without friction between object and ground or in self
    contact, and with constant muscle couples, which cost it nothing. Its own contact is timed; for the
    comparison it is corrected (docs/differences.md), with the object slightly above the ground.
    """
    sys.path.insert(0, str(ROOT))
    import numpy as np

    from elastica_gym.bodies.muscles import couple_matrix
    from tests.engine import oracle
    from tests.engine.scenes import ARMS_CONTACT, ARMS_MUSCLES, ARMS_STEP, GRAVITY, arms, ground, held

    rod = arms()
    activations = np.random.default_rng(0).uniform(-1.0, 1.0, ARMS_MUSCLES.n_activations)
    couple = np.tensordot(activations, couple_matrix(ARMS_MUSCLES, rod), axes=1)
    loads = {"gravity": GRAVITY, "planes": [ground()], "rod_contact": ARMS_CONTACT, "couple": couple}
    agreement = require_agreement("the arms", rod, ARMS_STEP, 1e-11, cylinders=[held(0.1)], **loads)
    pair = oracle.both([rod], ARMS_STEP, corrected=False, cylinders=[held()], **loads)
    return {
        "scene": "arms and object",
        "elements": rod.n_elements,
        **race(*pair, STEPS_THEIRS_ARMS, n_pairs),
        "target": ARMS_TARGET,
        "agreement": agreement,
    }


def measure_rods(n_rods: int, n_pairs: int) -> dict[str, Any]:
    """Time a step of joined and touching rods of 20 elements, by the same script in both libraries.

    PyElastica's own contact is timed; for the comparison it is corrected (docs/differences.md).
    """
    sys.path.insert(0, str(ROOT))
    import elastica
    import many_rods

    import elastica_gym.cosserat as library

    agreement = require_same_rods(4)
    runs = []
    for lib, n_steps in ((library, LIBRARY_STEPS_OURS), (elastica, LIBRARY_STEPS_THEIRS)):
        simulator, rods = many_rods.rows(lib, n_rods)
        simulator.finalize()
        many_rods.shake(rods)
        runs.append(
            lambda lib=lib, simulator=simulator, n_steps=n_steps: lib.integrate(
                lib.PositionVerlet(), simulator, n_steps * many_rods.DT, n_steps, progress_bar=False
            )
        )
    for run in runs:
        run()
    ours, theirs = [], []
    for _ in range(n_pairs):
        best_ours, best_theirs = best_slices(runs)
        ours.append(best_ours / LIBRARY_STEPS_OURS)
        theirs.append(best_theirs / LIBRARY_STEPS_THEIRS)
    ratios = [b / a for a, b in zip(ours, theirs, strict=True)]
    return {
        "scene": "rods, joined and touching",
        "rods": n_rods,
        "elements": many_rods.N_ELEMENTS * n_rods,
        "dt": many_rods.DT,
        "ours_us": 1e6 * statistics.median(ours),
        "pyelastica_us": 1e6 * statistics.median(theirs),
        "ratio": statistics.median(ratios),
        "ratios": ratios,
        "target": None,
        "agreement": agreement,
        "simulated_seconds_per_second": many_rods.DT / statistics.median(ours),
    }


def require_same_rods(n_rods: int, n_steps: int = 100) -> dict[str, float]:
    """Exit unless both libraries agree on joined and touching rods."""
    import elastica
    import many_rods
    import numpy as np

    import elastica_gym.cosserat as library
    from tests.engine import oracle

    ends = []
    for lib, contact in ((library, None), (elastica, oracle.PairContact)):
        simulator, rods = many_rods.rows(lib, n_rods, contact)
        simulator.finalize()
        many_rods.shake(rods)
        lib.integrate(lib.PositionVerlet(), simulator, n_steps * many_rods.DT, n_steps, progress_bar=False)
        ends.append(np.stack([rod.position_collection for rod in rods]))
    distance = float(np.abs(ends[0] - ends[1]).max())
    if not distance < 1e-9:
        sys.exit(f"the programs do not agree on {n_rods} rods: {distance:.2g} m after {n_steps} steps (1e-9 allowed)")
    return {"metres_after_100_steps": distance}


def measure_own_force(n_pairs: int) -> dict[str, float]:
    """Time a step of the library with and without a user's own empty force."""
    import many_rods

    import elastica_gym.cosserat as library

    class Nothing(library.NoForces):
        def apply_forces(self, system: Any, time: float = 0.0) -> None:
            pass

    runs = []
    for has_force in (False, True):
        simulator, rods = many_rods.rows(library, 2)
        if has_force:
            simulator.add_forcing_to(rods[0]).using(Nothing)
        simulator.finalize()
        runs.append(
            lambda simulator=simulator: library.integrate(
                library.PositionVerlet(), simulator, STEPS_OURS * many_rods.DT, STEPS_OURS, progress_bar=False
            )
        )
    without, with_force = (1e6 * best / STEPS_OURS for best in best_slices(runs, SLICES * n_pairs))
    return {"without_us": without, "with_us": with_force, "added_us": with_force - without, "limit_us": OWN_FORCE_LIMIT}


def measure_stepper(n_pairs: int) -> dict[str, float]:
    """Time a step of a rod of 50 elements with a user's own force, stepped one step at a time, in both libraries."""
    import elastica
    import numpy as np

    import elastica_gym.cosserat as library

    n_steps, dt = 200, 1e-4

    def declared(lib: Any) -> Callable[[], None]:
        class Push(lib.NoForces):
            def apply_forces(self, system: Any, time: float = 0.0) -> None:
                system.external_forces[0, -1] += 1e-4

        class Simulator(lib.BaseSystemCollection, lib.Forcing, lib.Damping):
            pass

        simulator, stepper = Simulator(), lib.PositionVerlet()
        x, y = np.eye(3)[:2]
        material = {"youngs_modulus": 1e6, "shear_modulus": 1e6 / 1.5}
        rod = lib.CosseratRod.straight_rod(50, np.zeros(3), x, y, 0.35, 0.35 * 0.011, 1000.0, **material)
        simulator.append(rod)
        simulator.add_forcing_to(rod).using(lib.GravityForces, acc_gravity=-9.81 * y)
        simulator.add_forcing_to(rod).using(Push)
        simulator.dampen(rod).using(lib.AnalyticalLinearDamper, damping_constant=0.1, time_step=dt)
        simulator.finalize()
        time = 0.0

        def run() -> None:
            nonlocal time
            for _ in range(n_steps):
                time = stepper.step(simulator, time, dt)

        return run

    ways = [declared(lib) for lib in (elastica, library)]
    pairs = [best_slices(ways) for _ in range(n_pairs)]
    theirs, ours = (1e6 * statistics.median(column) / n_steps for column in zip(*pairs, strict=True))
    ratio = statistics.median(pair[0] / pair[1] for pair in pairs)
    return {"ours_us": ours, "pyelastica_us": theirs, "ratio": ratio, "target": STEPPER_RATIO}


def race(model: Any, state: Any, control: Any, twin: Any, steps_theirs: int, n_pairs: int) -> dict[str, Any]:
    """Time both programs in turn, from our state after the warm-up."""
    from elastica_gym.engine import advance
    from tests.engine import oracle

    dt = float(twin.dt)
    advance(model, state, control, 0, 1, dt, round(WARM_UP / dt))
    twin.set_state(oracle.motions(model, state), float(state.time[0]))
    twin.advance(steps_theirs)
    runs = [lambda: twin.advance(steps_theirs), lambda: advance(model, state, control, 0, 1, dt, STEPS_OURS)]
    ours, theirs = [], []
    for _ in range(n_pairs):
        best_theirs, best_ours = best_slices(runs)
        theirs.append(best_theirs / steps_theirs)
        ours.append(best_ours / STEPS_OURS)
    ratios = [b / a for a, b in zip(ours, theirs, strict=True)]
    return {
        "dt": dt,
        "ours_us": 1e6 * statistics.median(ours),
        "pyelastica_us": 1e6 * statistics.median(theirs),
        "ratio": statistics.median(ratios),
        "ratios": ratios,
        "simulated_seconds_per_second": dt / statistics.median(ours),
    }


def require_agreement(name: str, rod: Any, dt: float, allowed: float, **loads: Any) -> dict[str, float]:
    """Exit unless both programs agree on the timed scene."""
    from elastica_gym.engine import advance
    from tests.engine import oracle

    model, state, control, twin = oracle.both([rod], dt, **loads)
    advance(model, state, control, 0, 1, dt, 100)
    twin.advance(100)
    distance, (step, _) = oracle.distance(model, state, twin), oracle.worst_step([rod], dt, 50, **loads)
    if not (distance < 1e-9 and step < allowed):
        sys.exit(
            f"the programs do not agree on {name} of {rod.n_elements} elements: {distance:.2g} m after 100 steps "
            f"(1e-9 allowed), {step:.2g} in a step from a random state ({allowed:.2g} allowed)"
        )
    return {"metres_after_100_steps": distance, "relative_in_one_step": step}


def best_slices(runs: Sequence[Callable[[], object]], n_slices: int = SLICES) -> list[float]:
    """Return the minimum time of each run [s], over interleaved slices."""
    slices = [[timed(run) for run in runs] for _ in range(n_slices)]
    return [min(column) for column in zip(*slices, strict=True)]


def timed(call: Callable[[], object]) -> float:
    """Return the duration of a call [s]."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


# environments


def measure_environments(env_id: str, n_pairs: int, num_envs: int = 64, n_steps: int = 2) -> dict[str, Any]:
    """Time environment steps of a batch with random actions on one and on two threads, as pairs of the best slices.

    Also time half the batch in each of two independent processes, an upper bound for two threads: their shortfall
    from a factor of two is due to the machine, such as hyper-threads that share a core.
    """
    half = num_envs // 2
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as other:
        made = other.submit(begin, env_id, half)
        one_thread, two_threads = make_batch(env_id, num_envs), make_batch(env_id, num_envs, 2)
        mine = make_batch(env_id, half)
        made.result()

        def run_processes() -> None:
            theirs = other.submit(run_made, n_steps)
            run_batch(mine, n_steps)
            theirs.result()

        ways = [lambda: run_batch(one_thread, n_steps), lambda: run_batch(two_threads, n_steps), run_processes]
        for way in ways:
            way()
        times = [best_slices(ways) for _ in range(n_pairs)]
    one, two, _ = (num_envs * n_steps / statistics.median(column) for column in zip(*times, strict=True))
    return {
        "id": env_id,
        "environments": num_envs,
        "sim_dt": mine.sim_dt,
        "substeps": mine.n_substeps,
        "steps_per_second_one_thread": one,
        "steps_per_second_two_threads": two,
        "threads_ratio": statistics.median(t[0] / t[1] for t in times),
        "processes_ratio": statistics.median(t[0] / t[2] for t in times),
        "target": THREADS_TARGET,
    }


_made: list[Any] = []
"""The batch of a timed worker process"""


def begin(env_id: str, num_envs: int) -> None:
    """Make the batch that `run_made` steps."""
    _made[:] = [make_batch(env_id, num_envs)]


def make_batch(env_id: str, num_envs: int, n_threads: int = 1) -> Any:
    """Return a batch after reset."""
    import gymnasium
    from gymnasium.vector import AutoresetMode

    import elastica_gym  # noqa: F401

    envs = gymnasium.make_vec(env_id, num_envs=num_envs, n_threads=n_threads, autoreset_mode=AutoresetMode.SAME_STEP)
    envs.reset(seed=0)
    return envs.unwrapped


def run_batch(envs: Any, n_steps: int, step: Callable[[Any], object] | None = None) -> None:
    """Step a batch with random actions, by its own function or the given one."""
    import numpy as np

    step = step or envs.step
    for action in np.random.default_rng(0).uniform(-1.0, 1.0, (n_steps, *envs.action_space.shape)):
        step(action)


def run_made(n_steps: int) -> None:
    """Step the batch made by `begin`."""
    run_batch(_made[0], n_steps)


# RL libraries


def measure_engines(n_pairs: int) -> dict[str, Any]:
    """Time steps of a batch of snakes with random actions and the same through the adapter, and training.

    All step on as many threads as there are CPUs, but for the two processes, which step half the batch each on one.
    """
    from elastica_gym.engine.threads import available_cpus
    from elastica_gym.rl import BatchVecEnv

    env_id, num_envs, n_steps = ONE_OF_EACH[0], 64, 2
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as other:
        made = other.submit(begin, env_id, num_envs // 2)
        bare, inner = (make_batch(env_id, num_envs, available_cpus()) for _ in range(2))
        mine, adapted = make_batch(env_id, num_envs // 2), BatchVecEnv(inner)
        made.result()

        def run_processes() -> None:
            theirs = other.submit(run_made, n_steps)
            run_batch(mine, n_steps)
            theirs.result()

        ways = [lambda: run_batch(bare, n_steps), lambda: run_batch(inner, n_steps, adapted.step), run_processes]
        for way in ways:
            way()
        times = [best_slices(ways) for _ in range(n_pairs)]
    alone, through, halves = (statistics.median(column) for column in zip(*times, strict=True))
    return {
        "bare": num_envs * n_steps / alone,
        "adapter": num_envs * n_steps / through,
        "two processes": num_envs * n_steps / halves,
        "adapter_ratio": statistics.median(t[1] / t[0] for t in times),
        "adapter_fraction": measure_adapter(adapted) / (alone / n_steps),
        **{script: training_speed(script) for script in ENGINES},
    }


def measure_adapter(envs: Any) -> float:
    """Return the time that the adapter itself takes in a step [s]: with a batch that repeats its last results."""
    import numpy as np

    actions = np.zeros(envs.batch.action_space.shape, np.float32)
    results = envs.batch.step(actions)
    envs.batch.step = lambda _: results
    n = 500
    return min(best_slices([lambda: [envs.step(actions) for _ in range(n)]])) / n


def training_speed(script: str) -> float | None:
    """Return environment steps per second between the first and the last report of a script, None if it cannot run."""
    if find_spec(script.rpartition("_")[0]) is None:
        return None
    path = ROOT / "scripts" / "examples" / "engines" / f"{script}.py"
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    command = [sys.executable, str(path), "--env", ONE_OF_EACH[0], "--steps", str(ENGINE_STEPS)]
    with (
        tempfile.TemporaryDirectory() as folder,
        subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True) as process,
    ):
        assert process.stdout is not None
        lines = (line.split() for line in process.stdout if line.startswith("steps"))
        reports = [(time.perf_counter(), int(words[1].replace(",", ""))) for words in lines]
    (start, first), (end, last) = reports[0], reports[-1]
    return (last - first) / (end - start)


# the first step


def measure_start() -> dict[str, float]:
    """Return the time from import to the end of the first step, with an empty and a full cache [s]."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "ELASTICA_GYM_CACHE_DIR": folder}
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
        times = [
            subprocess.run(
                [sys.executable, "-c", FIRST_STEP], env=environment, stdout=subprocess.PIPE, text=True, check=True
            ).stdout
            for _ in range(2)
        ]
    cold, warm = (float(line) for line in times)
    return {"cold_s": cold, "warm_s": warm}


def describe_start(start: dict[str, float]) -> str:
    """Return a line with the times to the first step."""
    return (
        f"first step: {start['cold_s']:.1f} s cold (at most {COLD_LIMIT:g}), "
        f"{start['warm_s']:.1f} s warm (at most {WARM_LIMIT:g})"
    )


# output


def show_engines(results: dict[str, Any]) -> None:
    """Print the speeds with and without RL libraries."""
    print("environment steps per second, 64 snakes")
    for name in ("bare", "adapter", "two processes", *ENGINES):
        speed = results[name]
        print(
            f"{name:18}", "skipped, not installed" if speed is None else f"{speed:7,.0f}  {speed / results['bare']:.2f}"
        )
    print(
        f"through the adapter, a step takes {results['adapter_ratio']:.3f} times as long as without; its own time is "
        f"{100 * results['adapter_fraction']:.2f} % of a step (at most {100 * ADAPTER_LIMIT:g})"
    )


def show(results: dict[str, Any]) -> None:
    """Print the tables."""
    from rich.console import Console
    from rich.table import Table

    console = Console()
    physics = Table(title="One step on one thread [μs], against PyElastica 1.0.0")
    for column in ("scene", "elements", "PyElastica", "here", "ratio", "demanded", "simulated s per s"):
        physics.add_column(column, justify="left" if column == "scene" else "right")
    for row in [*results["physics"], *results["library"]]:
        demanded = "" if row["target"] is None else f"{row['target']:g}"
        physics.add_row(
            row["scene"],
            f"{row['elements']}",
            f"{row['pyelastica_us']:.1f}",
            f"{row['ours_us']:.2f}",
            f"{row['ratio']:.1f}",
            demanded,
            f"{row['simulated_seconds_per_second']:.1f}",
        )
    environments = Table(title="Environment steps per second, 64 environments, random actions")
    for column in ("id", "one thread", "two threads", "ratio", "demanded", "two processes"):
        environments.add_column(column, justify="left" if column == "id" else "right")
    for row in results["environments"]:
        environments.add_row(
            row["id"],
            f"{row['steps_per_second_one_thread']:,.0f}",
            f"{row['steps_per_second_two_threads']:,.0f}",
            f"{row['threads_ratio']:.2f}",
            f"{row['target']:g}",
            f"{row['processes_ratio']:.2f}",
        )
    own = results["own_force"]
    console.print(physics, environments)
    console.print(
        f"a user's own empty force adds {own['added_us']:.2f} us to a step of the library "
        f"(at most {own['limit_us']:g})",
        highlight=False,
    )
    stepper = results["stepper"]
    console.print(
        f"one step at a time, with a user's own force: {stepper['ours_us']:.1f} us, PyElastica "
        f"{stepper['pyelastica_us']:.1f} us, {stepper['ratio']:.1f} times (at least {stepper['target']:g})",
        highlight=False,
    )
    console.print(describe_start(results["start"]), highlight=False)


if __name__ == "__main__":
    main()
