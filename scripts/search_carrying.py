"""Search the gait with which the scripted octopus carries its object home: ``python scripts/search_carrying.py``.

Trials start where the script has just grabbed its object. CMA-ES varies the homeward gait,
`elastica_gym.scripted.octopus_fetch.HOMEWARD`. The score is the time to reach home, or else the final distance
to it, with the object held and upright.
"""

import dataclasses
from itertools import islice
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

import elastica_gym  # noqa: F401  registers the environments
from elastica_gym.console.bad_input import BadInputError, check_bounds, make_folder, require_extra, run_command
from elastica_gym.scripted.octopus_fetch import HOMEWARD, Gait, carry, fetch, see

FETCH = "elastica_gym/OctopusFetch-v1"
LONGEST = 5.5
"""Duration of a trial [s]"""
LOWEST = {"generations": 1, "population": 4, "trials": 1, "grabs": 1, "sigma": 1e-6, "seed": 0, "threads": 1}
MOST = 4096
"""Environments in a batch"""


@dataclasses.dataclass
class Arguments:
    """Search the scripted octopus's homeward gait, starting from the current one."""

    generations: int = 40
    """Generations of CMA-ES."""
    population: int = 16
    """Gaits per generation."""
    trials: int = 3
    """Trials per gait, the same for all gaits of a generation."""
    grabs: int = 64
    """Octopuses that try to grab their object; trials start from those that succeed."""
    sigma: float = 0.2
    """Initial standard deviation."""
    seed: int = 5000
    """Seed of the first episode, and of the search."""
    threads: int = 2
    """Threads for the physics."""
    out: Path = Path("runs/carrying.yml")
    """File for the gait."""


def make(n: int, arguments: Arguments) -> Any:
    """Make a batch of octopuses with objects placed anywhere."""
    return gymnasium.make_vec(
        FETCH, num_envs=n, autoreset_mode=AutoresetMode.DISABLED, spread="anywhere", n_threads=arguments.threads
    ).unwrapped


def grabs(arguments: Arguments) -> list[Any]:
    """Return the states of octopuses that have just grabbed their object."""
    from elastica_gym.progress import track

    batch, found = make(arguments.grabs, arguments), []
    batch.reset(seed=arguments.seed)
    goes_on = np.ones(batch.num_envs, dtype=bool)
    for _ in track(range(batch.max_episode_steps), "grabbing"):
        _, _, terminated, truncated, _ = batch.step(fetch(batch))
        goes_on &= ~(terminated | truncated)
        has_grabbed = goes_on & (batch.situation().progress.grabbed == 1.0)
        if has_grabbed.any():
            saved = batch.get_state()
            found += [each_of(saved, i) for i in np.flatnonzero(has_grabbed)]
        goes_on &= ~has_grabbed
        if not goes_on.any():
            break
    return found


PARTS = ("physics", "control", "episodes", "poses")
"""Parts of a state that are kept: all per-environment data except generators"""


def each_of(saved: dict[str, Any], i: int) -> Any:
    """Return environment i's part of a batch's state, with the same nesting."""

    def take(part: Any) -> Any:
        if isinstance(part, dict):
            return {name: take(value) for name, value in part.items()}
        return [take(value) for value in part] if isinstance(part, (list, tuple)) else part[i]

    return {name: take(saved[name]) for name in PARTS}


def together(parts: list[Any]) -> Any:
    """Return the state of a batch from its environments' parts, see `each_of`."""
    first = parts[0]
    if isinstance(first, dict):
        return {name: together([part[name] for part in parts]) for name in first}
    if isinstance(first, list):
        return [together(list(values)) for values in zip(*parts, strict=True)]
    return np.stack(parts)


def gait_of(values: np.ndarray) -> Gait:
    """Return the gait with the searched parameters: 27 of the table, the period, 9 of the steering."""
    table = tuple(map(tuple, values[:27].reshape(3, 9)))
    return HOMEWARD._replace(table=table, period=float(np.clip(values[27], 0.15, 1.5)), steering=tuple(values[28:]))


def numbers_of(gait: Gait) -> np.ndarray:
    """Return the searched parameters of a gait."""
    return np.concatenate([np.ravel(gait.table), [gait.period], gait.steering])


def worth(batch: Any, gaits: list[Gait], begin: list[Any]) -> tuple[np.ndarray, np.ndarray]:
    """Return the score of each gait in each trial, and whether it reaches home, (P, K) each."""
    batch.set_state({**batch.get_state(), **together(begin * len(gaits))})
    shape, last = (len(gaits), len(begin)), round(LONGEST / batch.control_dt)
    values, goes_on = np.zeros(batch.num_envs), np.ones(batch.num_envs, dtype=bool)
    comes_home = ~goes_on
    # episodes near their end also get the full time of a trial
    batch.elapsed[:] = np.minimum(batch.elapsed, batch.max_episode_steps - last)
    for step in range(last):
        observations, _, terminated, _, info = batch.step(actions_of(batch, gaits))
        away = np.linalg.norm(observations[:, batch.layout["home"]].astype(np.float64), axis=1)
        done = goes_on & info["is_success"]
        failed = goes_on & ~done & (terminated | (batch.situation().progress.grabbed == 0.0))
        values = np.where(goes_on, 0.1 - away, values)
        values[done] = 0.3 + 0.2 * (1.0 - step / last)
        values[failed] = -0.5 - away[failed] + 0.2 * step / last
        comes_home, goes_on = comes_home | done, goes_on & ~done & ~failed
        if not goes_on.any():
            break
    return values.reshape(shape), comes_home.reshape(shape)


def actions_of(batch: Any, gaits: list[Gait]) -> np.ndarray:
    """Return the actions of octopuses that carry their objects, an equal share with each gait."""
    sight, time = see(batch.observations), batch.elapsed * batch.control_dt
    arm = np.where(sight.ahead >= 0.0, 1, 0)
    parts = np.split(np.arange(batch.num_envs), len(gaits))
    return np.concatenate(
        [carry(sight.goal[part], time[part], arm[part], gait) for gait, part in zip(gaits, parts, strict=True)]
    )


def main() -> None:
    """Run the command line."""
    require_extra("train")
    import tyro
    import yaml

    from elastica_gym.progress import Bar
    from elastica_gym.rl.cmaes import generations, strategy_about

    arguments = tyro.cli(Arguments, description=__doc__)
    check_bounds(dataclasses.asdict(arguments), LOWEST)
    if max(arguments.grabs, arguments.population * arguments.trials) > MOST:
        raise BadInputError(
            f"grabs, and population times trials, must be at most {MOST}, got {arguments.grabs}, and "
            f"{arguments.population * arguments.trials}"
        )
    make_folder(arguments.out.parent)
    begin = grabs(arguments)
    if len(begin) < arguments.trials:
        raise BadInputError(
            f"trials must be at most the number of successful grabs, {len(begin)} of "
            f"{arguments.grabs}, got {arguments.trials}: increase grabs"
        )
    batch = make(arguments.population * arguments.trials, arguments)
    batch.reset(seed=arguments.seed)
    rng, start = np.random.default_rng(arguments.seed), numbers_of(HOMEWARD)
    # the period varies less than the other parameters
    spread = np.where(np.arange(len(start)) == 27, 0.05, 1.0)
    strategy = strategy_about(start, arguments.sigma * spread, arguments.population, arguments.seed)
    homes: list[float] = []

    def mean_worth(candidates: np.ndarray) -> np.ndarray:
        trials = [begin[i] for i in rng.choice(len(begin), arguments.trials, replace=False)]
        values, comes_home = worth(batch, [gait_of(each) for each in candidates], trials)
        homes.append(float(comes_home.mean()))
        return values.mean(axis=1)

    with Bar("searching") as bar:
        for generation, (_, values) in enumerate(islice(generations(strategy, mean_worth), arguments.generations), 1):
            numbers = {"home": homes[-1], "mean": float(values.mean())}
            bar.show(generation / arguments.generations, numbers)
    found = gait_of(np.array(strategy.result.xfavorite))
    table = [np.round(row, 2).tolist() for row in found.table]
    text = {"period": round(found.period, 3), "table": table, "steering": np.round(found.steering, 2).tolist()}
    arguments.out.write_text(yaml.safe_dump(text, sort_keys=False))
    print(f"wrote {arguments.out}: the mean of the last generation's distribution")


if __name__ == "__main__":
    run_command(main)
