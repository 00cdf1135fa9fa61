"""Make the benchmark table: every environment with every kind of policy, each trained for the same time.

``python scripts/make_table.py`` evaluates zero, random and scripted actions, the gait that CMA-ES finds, PPO over three
seeds, SAC over three seeds on some ids, and the policies in agents/pretrained, all on the same unseen episodes. Each
cell is a JSON file in <out>/cells, written when done: if restarted, the command makes only missing cells. It then
writes <out>/table.md and table.png.
"""

import dataclasses
import json
import math
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import trim_mean

from elastica_gym.console.bad_input import BadInputError, check_bounds, choose, make_folder, require_extra, run_command
from elastica_gym.envs import IDS
from elastica_gym.files import write_atomically
from elastica_gym.rl import machine
from elastica_gym.rl.run_files import GAIT
from elastica_gym.rl.seeds import TEST

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROOT = Path(__file__).resolve().parents[1]
UNTRAINED = ("zero", "random", "scripted", "pretrained")
"""Policies without training here"""
LABELS = {
    "zero": "zero",
    "random": "random",
    "scripted": "scripted",
    "cma": "CMA-ES",
    "ppo": "PPO",
    "sac": "SAC",
    "pretrained": "pretrained",
}
"""Policies in the order of the table"""
METRICS = {"returns": "return", "distances": "distance [m]"}
RESAMPLES = 2000
LOWEST = {"minutes": 0.001, "seeds": 1, "episodes": 1, "evaluation_seed": 0, "threads": 1}


@dataclasses.dataclass
class Arguments:
    """Evaluate every environment with every kind of policy, and make a table and a plot."""

    minutes: float = 10.0
    """Wall-clock budget of each training and each search."""
    seeds: int = 3
    """Seeds of each learning algorithm: 0, 1, ..."""
    off_policy: tuple[str, ...] = ("SnakeForward-v1", "SnakeReach-v1", "OctopusReach-v1")
    """Environments on which SAC is also trained."""
    only: tuple[str, ...] = ()
    """Only these environments and policies (zero, random, scripted, cma, ppo, sac, pretrained); default all."""
    episodes: int = 100
    """Episodes per evaluation."""
    evaluation_seed: int = TEST.start
    """Seed of the first episode; training and search use others."""
    threads: int = 2
    """Threads for the physics."""
    out: Path = Path("runs/table")
    """Folder for cells, runs, table and plot."""


@dataclasses.dataclass(frozen=True)
class Cell:
    """One policy on one environment; for a learning algorithm, one seed of it."""

    env: str
    """Name without the namespace, such as SnakeForward-v1"""
    policy: str
    seed: int

    @property
    def name(self) -> str:
        """Name of the cell's file and folder."""
        return f"{self.env}-{self.policy}-{self.seed}"

    @property
    def env_id(self) -> str:
        """Id of the environment."""
        return f"elastica_gym/{self.env}"


def cells_of(arguments: Arguments) -> list[Cell]:
    """Return the cells, those without training first."""
    envs = [env_id.rpartition("/")[2] for env_id in IDS]
    for name in (*arguments.off_policy, *arguments.only):
        choose(
            "environment or policy" if name in arguments.only else "environment",
            name.rpartition("/")[2],
            (*envs, *LABELS) if name in arguments.only else envs,
        )
    wanted = {name.rpartition("/")[2] for name in arguments.only}
    is_there = {"sac": {name.rpartition("/")[2] for name in arguments.off_policy}, "pretrained": set(pretrained())}
    policies = [policy for policy in LABELS if policy in wanted or not wanted & set(LABELS)]
    return [
        Cell(env, policy, seed)
        for policy in policies
        for env in envs
        if env in wanted or not wanted & set(envs)
        if env in is_there.get(policy, envs)
        for seed in range(arguments.seeds if policy in ("ppo", "sac") else 1)
    ]


def pretrained() -> dict[str, str]:
    """Return the name of the pretrained policy of each environment that has one."""
    from elastica_gym.rl import cards

    return {cards.read_card(name)["environment"].rpartition("/")[2]: name for name in cards.names()}


def make_cell(cell: Cell, arguments: Arguments, cells: Path) -> None:
    """Train the policy if needed, evaluate it, and write the cell's file."""
    from elastica_gym.progress import Bar
    from elastica_gym.rl import cards
    from elastica_gym.rl.evaluation import evaluate
    from elastica_gym.rl.policies import Policy, baseline, load_run
    from elastica_gym.scripted.families import load_gait

    folder = cells / cell.name
    seconds = 0.0 if cell.policy in UNTRAINED else train(cell, arguments, folder)
    policy: Policy
    if cell.policy == "pretrained":
        policy, _ = cards.load_pretrained(pretrained()[cell.env])
    elif cell.policy in UNTRAINED:
        policy = baseline(cell.policy)
    elif cell.policy == "cma":
        policy, _ = load_gait(folder / GAIT)
    else:
        policy, _ = load_run(folder)
    # the registered environment, not that of training, so that returns are comparable
    with Bar(f"evaluating {cell.name}") as bar:
        result = evaluate(
            policy,
            cell.env_id,
            episodes=arguments.episodes,
            seed=arguments.evaluation_seed,
            n_threads=arguments.threads,
            show=bar.show,
        )
    found = {
        **dataclasses.asdict(cell),
        "seconds": round(seconds, 1),
        "returns": result.returns.tolist(),
        "distances": result.distances.tolist(),
        "successes": result.successes.tolist(),
        **machine.describe(),
    }
    text = json.dumps(found)
    write_atomically(cells / f"{cell.name}.json", lambda path: path.write_text(text))


def train(cell: Cell, arguments: Arguments, folder: Path) -> float:
    """Run the training or search command in its own folder, and return its duration [s]."""
    shutil.rmtree(folder, ignore_errors=True)
    command = [
        sys.executable,
        "-m",
        "agents.search" if cell.policy == "cma" else "agents.train",
        "--env",
        cell.env_id,
        "--seed",
        str(cell.seed),
        "--minutes",
        str(arguments.minutes),
        "--threads",
        str(arguments.threads),
        "--folder",
        str(folder.resolve()),
    ]
    if cell.policy != "cma":
        command += ["--algo", cell.policy, "--evaluations", "0", "--recordings", "0"]
    started = time.monotonic()
    status = subprocess.run(command, cwd=ROOT).returncode
    if status == 130:
        raise KeyboardInterrupt
    if status:
        raise BadInputError(f"{' '.join(command)} exited with status {status}.")
    return time.monotonic() - started


def check_settings(arguments: Arguments, folder: Path) -> None:
    """Raise BadInputError if the settings differ from those of the folder's other cells."""
    names = ("minutes", "episodes", "evaluation_seed", "threads")
    path, mine = folder / "settings.json", {name: getattr(arguments, name) for name in names}
    if not path.exists():
        write_atomically(path, lambda file: file.write_text(json.dumps(mine)))
        return
    for name, value in read_json(path, set(names)).items():
        if name in mine and mine[name] != value:
            raise BadInputError(f"The cells in {folder} have {name} {value}, not {mine[name]}: use another --out.")


def read_json(path: Path, keys: set[str]) -> dict[str, Any]:
    """Return the contents of a JSON file, which must have the given keys."""
    try:
        told = json.loads(path.read_text())
    except ValueError as error:
        raise BadInputError(f"{path} is damaged, delete it: {error}") from error
    if not isinstance(told, dict) or not keys <= set(told):
        raise BadInputError(f"{path} is damaged, delete it: it must have {', '.join(sorted(keys))}.")
    return told


def read_cells(cells: Path) -> dict[tuple[str, str], list[dict[str, Any]]]:
    """Return the existing cells of each environment and policy, one dictionary per seed."""
    found: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for path in sorted(cells.glob("*.json")):
        cell = read_json(path, {"env", "policy", "seed", "seconds", "successes", *METRICS})
        found.setdefault((cell["env"], cell["policy"]), []).append(cell)
    envs = [env_id.rpartition("/")[2] for env_id in IDS]
    places = {(env, policy): place for place, (env, policy) in enumerate((e, p) for e in envs for p in LABELS)}
    return dict(sorted(found.items(), key=lambda item: places.get(item[0], len(places))))


def interquartile_mean(values: np.ndarray) -> np.ndarray:
    """Return the mean of the middle half of values along the last axis (Agarwal et al. 2021, section 4.3)."""
    return trim_mean(values, 0.25, axis=-1)


def bootstrap_interval(values: np.ndarray) -> tuple[float, float]:
    """Return the 95 % percentile interval of the interquartile mean of all values.

    Parameters
    ----------
    values : np.ndarray
        One row per training seed, one column per episode, (R, N). Seeds are drawn with replacement, then episodes
        within each of them.
    """
    runs, episodes = values.shape
    rng = np.random.default_rng(0)
    run = rng.integers(runs, size=(RESAMPLES, runs, 1))
    drawn = values[run, rng.integers(episodes, size=(RESAMPLES, runs, episodes))].reshape(RESAMPLES, -1)
    low, high = np.percentile(interquartile_mean(drawn), [2.5, 97.5])
    return float(low), float(high)


def as_markdown(found: dict[tuple[str, str], list[dict[str, Any]]], settings: dict[str, Any]) -> str:
    """Return the table."""
    lines = [
        f"Interquartile means over {settings['episodes']} unseen episodes of each seed, with bootstrapped 95 % "
        f"intervals; {settings['minutes']:g} min of training or search each, threads: {settings['threads']}.",
        "Intervals are over seeds of training and episodes. On another CPU, where equal seeds give other episodes, "
        f"figures are within {math.sqrt(2.0):.1f} times the interval.",
        f"CPU: {'; '.join(sorted({c.get('cpu', 'not recorded') for cells in found.values() for c in cells}))}.",
        "",
        "| environment | policy | return | distance [m] | success | wall time [min] |",
        "|---|---|---|---|---|---|",
    ]
    for (env, policy), cells in found.items():
        columns = [env, LABELS[policy] + (f", {len(cells)} seeds" if len(cells) > 1 else "")]
        for metric, digits in (("returns", 2), ("distances", 3)):
            values = np.array([cell[metric] for cell in cells])
            low, high = bootstrap_interval(values)
            columns.append(f"{interquartile_mean(values.ravel()):.{digits}f} ({low:.{digits}f} to {high:.{digits}f})")
        columns.append(f"{np.mean([cell['successes'] for cell in cells]):.0%}")
        minutes = [cell["seconds"] / 60.0 for cell in cells]
        columns.append(", ".join(f"{m:.1f}" for m in minutes) if any(minutes) else "")
        lines.append(f"| {' | '.join(columns)} |")
    return "\n".join(lines) + "\n"


def plot(found: dict[tuple[str, str], list[dict[str, Any]]]) -> "Figure":
    """Draw the interquartile mean and interval of each policy, one row per environment, one column per metric."""
    from matplotlib.figure import Figure

    envs = list(dict.fromkeys(env for env, _ in found))
    figure = Figure(figsize=(10, 0.6 + 1.7 * len(envs)), layout="constrained")
    axes = figure.subplots(len(envs), len(METRICS), squeeze=False)
    for row, env in zip(axes, envs, strict=True):
        policies = [policy for e, policy in found if e == env]
        for ax, (metric, label) in zip(row, METRICS.items(), strict=True):
            for place, policy in enumerate(policies):
                values = np.array([cell[metric] for cell in found[env, policy]])
                low, high = bootstrap_interval(values)
                colour = f"C{list(LABELS).index(policy)}"
                ax.barh(place, high - low, left=low, height=0.7, color=colour, alpha=0.4)
                ax.plot([interquartile_mean(values.ravel())] * 2, [place - 0.35, place + 0.35], color=colour, lw=2)
            ax.set_yticks(range(len(policies)), [LABELS[policy] for policy in policies], fontsize=8)
            ax.invert_yaxis()
            ax.grid(alpha=0.3, axis="x")
            ax.set_title(f"{env}: {label}", fontsize=9)
    return figure


def main() -> None:
    """Run the command line."""
    require_extra("train")
    import tyro

    arguments = tyro.cli(Arguments, description=__doc__)
    check_bounds(dataclasses.asdict(arguments), LOWEST)
    wanted = cells_of(arguments)
    cells = make_folder(arguments.out / "cells")
    check_settings(arguments, arguments.out)
    missing = [cell for cell in wanted if not (cells / f"{cell.name}.json").exists()]
    print(f"{len(wanted) - len(missing)} of {len(wanted)} cells are there already.")
    failures = []
    for i, cell in enumerate(missing, start=1):
        print(f"[{i}/{len(missing)}] {cell.name}", flush=True)
        try:
            make_cell(cell, arguments, cells)
        except Exception as error:  # a failed cell must not stop the others
            failures.append(f"{cell.name}: {type(error).__name__}: {error}")
    write_results(arguments.out, cells)
    if failures:
        raise BadInputError("These cells failed, and are missing:\n" + "\n".join(failures))


def write_results(out: Path, cells: Path) -> None:
    """Write the table and the plot of all existing cells."""
    from elastica_gym.rl import curves

    found = read_cells(cells)
    if not found:
        return
    text = as_markdown(found, read_json(out / "settings.json", {"episodes", "minutes", "threads"}))
    figure = plot(found)
    write_atomically(out / "table.md", lambda path: path.write_text(text))
    write_atomically(out / "table.png", lambda path: curves.save(figure, path))
    print(text + f"\nWrote {out / 'table.md'} and {out / 'table.png'}")


if __name__ == "__main__":
    run_command(main)
