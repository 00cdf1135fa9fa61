"""Runs side by side: learning curves by setting with intervals over seeds, and final scores."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter

from ..console.bad_input import BadInputError, choose
from ..engine.model import Array
from .curves import PANELS
from .policies import read_config
from .run_files import EVALUATIONS, read_table

POINTS = 60
"""Points of each mean curve"""
NOT_SETTINGS = {
    *("seed", "threads", "minutes", "recordings", "checkpoint_minutes", "config", "cpu", "kernels", "commit"),
    *("evaluations", "evaluation_episodes", "evaluation_seed", "n_timesteps", "env_runners"),
}
"""Keys of a run's configuration that are not compared unless they are asked for"""


class Setting(NamedTuple):
    """Runs that differ in nothing that is compared."""

    name: str
    """Such as ``gamma=0.98``"""
    runs: list[Path]
    tables: list[dict[str, Array]]
    """Evaluations of each run"""


class Curve(NamedTuple):
    """The mean over runs."""

    steps: Array
    """Environment steps, (P,)"""
    mean: Array
    """(P,)"""
    half: Array
    """Half width of its 95 % interval over runs, NaN for a single run, (P,)"""


def settings_of(runs: Sequence[Path], by: Sequence[str] = ()) -> list[Setting]:
    """Return the settings that runs have, in the order in which they appear.

    Parameters
    ----------
    runs : sequence of Path
        Folders of runs; others are named and left out.
    by : sequence of str
        Keys of their configurations or hyperparameters to tell settings apart; by default all in which the runs
        differ but for the seed.

    Raises
    ------
    BadInputError
        If no folder is that of a run with evaluations, or none has a key.
    """
    compared = _with_evaluations(runs)
    values = [_values(read_config(run)) for run, _ in compared]
    known = list(dict.fromkeys(key for each in values for key in each))
    keys = [choose("setting", key, known) for key in by] or [
        key for key in known if key not in NOT_SETTINGS and len({repr(each.get(key)) for each in values}) > 1
    ]
    found: dict[str, Setting] = {}
    for (run, table), each in zip(compared, values, strict=True):
        name = " ".join(f"{key}={each.get(key)}" for key in keys) or "all runs"
        setting = found.setdefault(name, Setting(name, [], []))
        setting.runs.append(run)
        setting.tables.append(table)
    return list(found.values())


def _with_evaluations(runs: Sequence[Path]) -> list[tuple[Path, dict[str, Array]]]:
    """Return the runs that can be compared, with their evaluations, and print the folders that are left out."""
    tables = [read_table(run / EVALUATIONS) if (run / "config.yml").is_file() else {} for run in runs]
    kept = [(run, table) for run, table in zip(runs, tables, strict=True) if table]
    left_out = ", ".join(str(run) for run, table in zip(runs, tables, strict=True) if not table)
    if not kept:
        raise BadInputError(f"None of {left_out} is the folder of a run with evaluations.")
    if left_out:
        print(f"Left out, as no run with evaluations: {left_out}")
    return kept


def _values(config: dict[str, Any]) -> dict[str, Any]:
    """Return a configuration with its hyperparameters, and ``env`` without its namespace."""
    # runs of earlier versions have no engine
    flat = {"engine": "sb3", **config, **config["hyperparameters"], "env": config["env"].rpartition("/")[2]}
    return {key: value for key, value in flat.items() if not isinstance(value, dict)}


def curve_of(tables: Sequence[dict[str, Array]], column: str) -> Curve | None:
    """Return the mean of a column over runs, as far as all of them have gone; None if a run lacks it."""
    if any(column not in table for table in tables):
        return None
    steps = np.linspace(0.0, min(table["steps"][-1] for table in tables), POINTS)
    values = np.stack([np.interp(steps, table["steps"], table[column]) for table in tables])
    return Curve(steps, values.mean(axis=0), interval(values))


def interval(values: Array) -> Array:
    """Return the half width of the 95 % interval (Student's t) of the mean over the first axis, NaN for one value."""
    from scipy import stats

    n = len(values)
    if n < 2:
        return np.full(values.shape[1:], np.nan)
    return stats.t.ppf(0.975, n - 1) * values.std(axis=0, ddof=1) / np.sqrt(n)


def terms_of(settings: Sequence[Setting]) -> list[str]:
    """Return the columns of reward terms that all runs have."""
    columns = [set(table) for setting in settings for table in setting.tables]
    first = settings[0].tables[0]
    return [name for name in first if name.startswith("reward_") and all(name in each for each in columns)]


def plot(settings: Sequence[Setting]) -> Figure:
    """Draw a line a setting: return, distance and success above, the terms of the reward below."""
    terms = terms_of(settings)
    panels = PANELS | {term: term.removeprefix("reward_") for term in terms}
    columns = max(len(PANELS), len(terms))
    figure = Figure(figsize=(3.6 * columns, 6.8), layout="constrained")
    axes = figure.subplots(2, columns, squeeze=False)
    places = [*axes[0, : len(PANELS)], *axes[1, : len(terms)]]
    for ax in set(axes.ravel()) - set(places):
        ax.remove()
    for ax, (column, label) in zip(places, panels.items(), strict=True):
        ax.set_title(label, fontsize=10)
        ax.set_xlabel("environment steps")
        ax.xaxis.set_major_formatter(EngFormatter(sep=""))
        ax.grid(alpha=0.3)
        for setting in settings:
            if (curve := curve_of(setting.tables, column)) is not None:
                (line,) = ax.plot(curve.steps, curve.mean, label=f"{setting.name} (n={len(setting.runs)})")
                low, high = curve.mean - curve.half, curve.mean + curve.half
                if column == "success":
                    low, high = np.clip(low, 0.0, 1.0), np.clip(high, 0.0, 1.0)
                ax.fill_between(curve.steps, low, high, alpha=0.2, lw=0, color=line.get_color())
    axes[0, 0].legend(fontsize=8)
    figure.suptitle("mean over seeds, with 95 % intervals where there are several")
    return figure


def scores(settings: Sequence[Setting]) -> list[dict[str, Any]]:
    """Return a row a setting: runs, steps, and mean and half interval of each column at the last evaluation."""
    rows = []
    for setting in settings:
        row: dict[str, Any] = {"setting": setting.name, "runs": len(setting.runs)}
        row["steps"] = int(np.mean([table["steps"][-1] for table in setting.tables]))
        for column in [*PANELS, *terms_of(settings)]:
            if all(column in table for table in setting.tables):
                last = np.array([table[column][-1] for table in setting.tables])
                row[column], row[f"{column}_ci95"] = float(last.mean()), float(interval(last[:, None])[0])
        row["best_return"] = float(np.mean([table["return"].max() for table in setting.tables]))
        rows.append(row)
    return rows


def curves_csv(settings: Sequence[Setting]) -> str:
    """Return the evaluations of all runs as CSV, a row an evaluation."""
    columns = list(dict.fromkeys(name for setting in settings for table in setting.tables for name in table))
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(["setting", "run", *columns])
    for setting in settings:
        for run, table in zip(setting.runs, setting.tables, strict=True):
            for i in range(len(table["steps"])):
                writer.writerow([setting.name, run, *(table[name][i] if name in table else "" for name in columns)])
    return text.getvalue()


def scores_csv(settings: Sequence[Setting]) -> str:
    """Return `scores` as CSV."""
    rows, text = scores(settings), io.StringIO()
    writer = csv.DictWriter(text, fieldnames=list(dict.fromkeys(key for row in rows for key in row)))
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()
