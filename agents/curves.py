"""Learning curves as PNG files."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter

from agents.run_files import EVALUATIONS, METRICS, read_table

PANELS = {"return": "return", "distance": "distance [m]", "success": "success rate"}
"""Column of the tables, and its label."""


def plot_run(run: Path) -> Figure:
    """Draw a run's learning curve: the training episodes as a line, the evaluations as points with intervals."""
    metrics, evaluations = read_table(run / METRICS), read_table(run / EVALUATIONS)
    figure, axes = _panels(run.name)
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


def plot_runs(runs: list[Path], title: str) -> Figure:
    """Draw the mean over several runs of one task, usually seeds, and the range between the lowest and highest."""
    tables = [table for table in (read_table(run / METRICS) for run in runs) if table]
    figure, axes = _panels(title)
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
    return np.interp(grid, table["steps"][known], table[column][known])


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
