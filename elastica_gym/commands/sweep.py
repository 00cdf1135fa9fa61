"""Train over seeds, environments and hyperparameters, on all cores of a machine or on a cluster."""

import dataclasses
import math
from pathlib import Path
from typing import Any

from ..console.bad_input import BadInputError, check_bounds, require_extra
from ..rl.seeds import RUNS, VALIDATION, check_seeds
from . import parse
from .train import TrainArguments, config_of

SHOWN = 10
"""Trials that are printed, and settings of a search that are compared"""


@dataclasses.dataclass
class SweepArguments:
    """Train every combination of seeds, environments and hyperparameters, or search hyperparameters with Optuna.

    Trials run on all cores of this machine, or on a Ray cluster; those whose worker died continue from their last
    checkpoint. Each is an ordinary run; trials.csv has a row for each. Started again with the same folder, a sweep does
    not repeat finished trials, continues interrupted ones, and tries failed ones again.
    """

    env: list[str] = dataclasses.field(default_factory=lambda: ["elastica_gym/SnakeForward-v1"])
    """Environment ids, optionally with the module that registers them, as in my_module:my_lab/SnakeTurn-v0."""
    algo: str = "ppo"
    """Algorithm: ppo or sac."""
    seeds: list[int] = dataclasses.field(default_factory=lambda: [0, 1, 2])
    """Seeds; each setting is trained once with each."""
    set: list[str] = dataclasses.field(default_factory=list)
    """Hyperparameters that override the configuration's, as KEY=VALUE or, to try several, KEY=A,B, such as
    gamma=0.95,0.98 n_envs=32."""
    search: list[str] = dataclasses.field(default_factory=list)
    """Hyperparameters to search for the highest score, as KEY=uniform(LOW,HIGH), log(LOW,HIGH), int(LOW,HIGH) or
    choice(A,B,...); lin_uniform and lin_log are linear decays from such a value."""
    trials: int = 20
    """Settings to try in a search, in total over all starts."""
    steps: int | None = None
    """Environment steps of each trial; by default n_timesteps of the configuration, or none if minutes are given."""
    minutes: float | None = None
    """Wall-clock budget of each trial."""
    config: Path | None = None
    """Another configuration file of the same format."""
    start_from: str | None = None
    """Folder of a run, or name of a pretrained policy, whose networks to start from."""
    imitate: int = 0
    """Environment steps of imitating the task's scripted policy first."""
    threads: int = 1
    """Cores of a trial, all for its physics; results do not depend on them."""
    evaluations: int = 10
    """Number of evaluations after the one at the start; the best is the score of a trial."""
    evaluation_episodes: int = 20
    """Episodes per evaluation."""
    evaluation_seed: int = VALIDATION.start
    """Seed of an evaluation's first episode (`elastica_gym.rl.seeds`)."""
    checkpoint_minutes: float = 1.0
    """Time between checkpoints of a trial; 0 writes one after every update."""
    retries: int = 5
    """How often a trial is started again after its worker died."""
    address: str | None = None
    """Ray cluster as host:port of its head node, or auto on one of its nodes; by default the cores of this machine."""
    out: Path = Path("runs/sweep")
    """Folder of the sweep; on a cluster, one that all nodes see under the same path."""


def main() -> None:
    """Run the command line."""
    arguments = parse(
        "sweep",
        SweepArguments,
        "--seeds 0 1 2 --set gamma=0.95,0.98 --steps 100000",
        '--search "learning_rate=lin_log(1e-4,1e-3)" "n_epochs=int(4,12)" --trials 20 --steps 100000',
        "--env elastica_gym/SnakeReach-v1 elastica_gym/OctopusReach-v1 --address auto --out /shared/sweep",
    )
    require_extra("train")
    from ..rl import sweep
    from ..rl.cluster import prepare, require_ray

    values, ranges = sweep.parse_values(arguments.set), sweep.parse_ranges(arguments.search)
    _check(arguments, values, ranges)
    several = {key: found for key, found in values.items() if len(found) > 1}
    fixed = {key: found[0] for key, found in values.items() if len(found) == 1}
    configs = {env: _config(arguments, env, fixed) for env in arguments.env}
    for config in configs.values():
        sweep.check_settings(config["algo"], config["hyperparameters"], values, ranges)
    require_extra("ray")
    require_ray("ray", "optuna")
    sweep.open_sweep(arguments.out, configs)
    prepare(arguments.address)
    from ..rl import tuning

    where: dict[str, Any] = {
        "out": arguments.out.resolve(),
        "configs": configs,
        "cores_each": arguments.threads,
        "retries": arguments.retries,
        "address": arguments.address,
    }
    if ranges:
        tuning.run_search(ranges, env=arguments.env[0], seeds=arguments.seeds, n_settings=arguments.trials, **where)
    else:
        tuning.run_grid(sweep.grid(arguments.env, arguments.seeds, several), **where)
    _conclude(arguments, [*several, *(each.key for each in ranges)])


def _check(arguments: SweepArguments, values: dict[str, list[Any]], ranges: list[Any]) -> None:
    lowest = {"trials": 1, "threads": 1, "retries": 0, "evaluations": 1}
    check_bounds(dataclasses.asdict(arguments), lowest)
    for name in ("env", "seeds"):
        given = getattr(arguments, name)
        if not given or len(set(given)) < len(given):
            raise BadInputError(f"{name} must be one or several different values, got {given}")
    for seed in arguments.seeds:
        check_seeds("seeds", seed, 1, RUNS)
    if ranges and len(arguments.env) > 1:
        raise BadInputError(f"--search needs a single environment, got {', '.join(arguments.env)}")
    for key, found in values.items():
        if ranges and len(found) > 1:
            text = ",".join(map(str, found))
            raise BadInputError(f"With --search, search the values of {key} as well: --search '{key}=choice({text})'")


def _config(arguments: SweepArguments, env: str, fixed: dict[str, Any]) -> dict[str, Any]:
    """Return the contents of config.yml of all trials on an environment, but for seed, settings and machine."""
    shared = {field.name for field in dataclasses.fields(TrainArguments)} & set(vars(arguments))
    given = {name: getattr(arguments, name) for name in shared - {"env", "set", "out"}}
    config = config_of(TrainArguments(env=env, recordings=0, **given), overrides=fixed)
    return {key: value for key, value in config.items() if key not in MACHINE}


MACHINE = ("seed", "cpu", "kernels", "commit", "versions")


def _conclude(arguments: SweepArguments, keys: list[str]) -> None:
    """Write and print the table, and compare the settings of the trials that have finished."""
    from ..rl import sweep
    from .compare import compare

    sweep.write_table(arguments.out)
    rows = sweep.rows_of(arguments.out)
    _print(rows, keys)
    print(f"wrote {arguments.out / sweep.TRIALS}")
    finished = [row for row in rows if row["status"] == sweep.FINISHED]
    if not finished:
        raise BadInputError(f"No trial has finished; {arguments.out / sweep.TRIALS} says why.")
    if arguments.search:
        best = list(dict.fromkeys(tuple(row.get(key) for key in keys) for row in finished))[:SHOWN]
        finished = [row for row in finished if tuple(row.get(key) for key in keys) in best]
    by = [*(["env"] if len({row["env"] for row in finished}) > 1 else []), *keys]
    compare([arguments.out / row["trial"] for row in finished], by, arguments.out / "comparison")
    if unfinished := len(rows) - sum(row["status"] == sweep.FINISHED for row in rows):
        raise BadInputError(f"{unfinished} of {len(rows)} trials have not finished; the same command continues them.")


def _print(rows: list[dict[str, Any]], keys: list[str]) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table("environment", "seed", *keys, "score", "distance", "success", "status", "retries")
    for row in rows[:SHOWN]:
        results = [
            "" if math.isnan(value := row.get(key, math.nan)) else f"{value:.3g}"
            for key in ("score", "distance", "success")
        ]
        settings = [str(row.get(key, "")) for key in keys]
        name = row["env"].rpartition("/")[2]
        table.add_row(name, str(row["seed"]), *settings, *results, row["status"], str(row["retries"]))
    if len(rows) > SHOWN:
        table.caption = f"the best {SHOWN} of {len(rows)} trials"
    Console().print(table)
