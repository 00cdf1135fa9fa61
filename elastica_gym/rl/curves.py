"""Learning curves as PNG files."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter

from .policies import read_config
from .run_files import EVALUATIONS, METRICS, read_table

PANELS = {"return": "return", "distance": "distance [m]", "success": "success rate"}
"""Label of each column of the tables."""


def plot_run(run: Path) -> Figure:
    """Plot a run's learning curve: training episodes as a line, evaluations as points with intervals."""
    metrics, evaluations = read_table(run / METRICS), read_table(run / EVALUATIONS)
    figure, axes = _panels(title_of([run]))
    for ax, column in zip(axes, PANELS, strict=True):
        if column in metrics:
            ax.plot(metrics["steps"], metrics[column], lw=1, label="training, with exploration")
        if column in evaluations:
            half = evaluations.get(f"{column}_ci95", np.zeros_like(evaluations["steps"]))
            ax.errorbar(
                evaluations["steps"],
                evaluations[column],
                np.nan_to_num(half),
                fmt="o",
                ms=4,
                capsize=2,
                label="evaluation",
            )
    axes[0].legend(fontsize=8)
    return figure


def title_of(runs: list[Path]) -> str:
    """Return a title for runs of one environment: how they were trained, and their seeds."""
    configs = [read_config(run) for run in runs]
    kinds = dict.fromkeys(_kind(config) for config in configs)
    seeds = sorted({config["seed"] for config in configs})
    return f"{' and '.join(kinds)}, {'seed' if len(seeds) == 1 else 'seeds'} {', '.join(map(str, seeds))}"


def _kind(config: dict[str, Any]) -> str:
    """Return environment, algorithm, imitation steps and starting networks of a run."""
    parts = [config["env"].rpartition("/")[2], config["algo"].upper()]
    if config.get("imitate"):
        taught = f"imitation over {config['imitate']:,} steps"
        # without steps, the run learned by imitation alone
        parts[1] = taught if config.get("steps") == 0 else f"{taught}, then {parts[1]}"
    if config.get("start_from"):
        parts.append(f"from {Path(config['start_from']).name}")
    return ", ".join(parts)


def curve_of(run: Path) -> dict[str, np.ndarray]:
    """Return the table of a run's learning curve: training metrics, or evaluations if it only imitated."""
    metrics = read_table(run / METRICS)
    return metrics if len(metrics.get("steps", ())) > 1 else read_table(run / EVALUATIONS)


def plot_runs(runs: list[Path]) -> Figure:
    """Plot mean and range over several runs of one task, usually seeds."""
    tables = [curve_of(run) for run in runs]
    figure, axes = _panels(title_of(runs))
    for ax, column in zip(axes, PANELS, strict=True):
        grid = np.linspace(max(t["steps"][0] for t in tables), min(t["steps"][-1] for t in tables), 200)
        curves = np.stack([_interpolate(grid, table, column) for table in tables])
        ax.fill_between(grid, curves.min(0), curves.max(0), alpha=0.25, lw=0, label="lowest to highest")
        ax.plot(grid, curves.mean(0), label="mean" if len(tables) > 1 else "one run")
    axes[0].legend(fontsize=8)
    return figure


def _interpolate(grid: np.ndarray, table: dict[str, np.ndarray], column: str) -> np.ndarray:
    known = np.isfinite(table[column])
    if not known.any():
        return np.full_like(grid, np.nan)
    # no values before the first episodes end
    return np.interp(grid, table["steps"][known], table[column][known], left=np.nan, right=np.nan)


def _panels(title: str) -> tuple[Figure, Any]:
    figure = Figure(figsize=(12, 3.6), layout="constrained")
    figure.suptitle(title)
    axes = figure.subplots(1, len(PANELS))
    for ax, label in zip(axes, PANELS.values(), strict=True):
        ax.set_xlabel("environment steps")
        ax.xaxis.set_major_formatter(EngFormatter(sep=""))
        ax.set_title(label, fontsize=10)
        ax.grid(alpha=0.3)
    return figure, axes


def save(figure: Figure, path: Path) -> None:
    """Write `figure` as a PNG file."""
    figure.savefig(path, dpi=120, format="png")
