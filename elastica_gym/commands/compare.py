"""Compare runs: learning curves with intervals over seeds, reward terms, and final scores."""

import dataclasses
import math
from pathlib import Path
from typing import TYPE_CHECKING

import tyro

from ..console.bad_input import make_folder, missing_extra, require_extra
from . import parse

if TYPE_CHECKING:
    from ..rl.comparison import Setting


@dataclasses.dataclass
class CompareArguments:
    """Compare runs of agents.train by setting: one line a setting, with its mean and 95 % interval over seeds.

    Writes comparison.png, curves.csv, scores.csv and, with rerun, comparison.rrd.
    """

    runs: tyro.conf.Positional[list[Path]]
    """Folders of the runs."""
    by: list[str] = dataclasses.field(default_factory=list)
    """Keys of config.yml or hyperparameters to tell settings apart; by default all in which the runs differ but for
    the seed."""
    out: Path = Path("comparison")
    """Folder for the files."""


def main() -> None:
    """Run the command line."""
    arguments = parse(
        "compare", CompareArguments, "runs/SnakeForward-v1/*", "runs/SnakeForward-v1/* --by gamma learning_rate"
    )
    require_extra("train")
    compare(arguments.runs, arguments.by, arguments.out)


def compare(runs: list[Path], by: list[str], out: Path) -> None:
    """Compare runs by setting: print their scores and write the files into the folder `out`."""
    from ..files import write_atomically
    from ..rl import comparison, curves

    settings = comparison.settings_of(runs, by)
    make_folder(out)
    figure = comparison.plot(settings)
    written = {
        "comparison.png": lambda path: curves.save(figure, path),
        "curves.csv": lambda path: path.write_text(comparison.curves_csv(settings)),
        "scores.csv": lambda path: path.write_text(comparison.scores_csv(settings)),
    }
    if not missing_extra("viz"):
        from ..viz.curves import write_curves

        lines = {
            (column, setting.name): (curve.steps, curve.mean)
            for column in [*comparison.PANELS, *comparison.terms_of(settings)]
            for setting in settings
            if (curve := comparison.curve_of(setting.tables, column)) is not None
        }
        written["comparison.rrd"] = lambda path: write_curves(lines, path)
    print_scores(settings)
    for name, write in written.items():
        write_atomically(out / name, write)
        print(f"wrote {out / name}")


def print_scores(settings: "list[Setting]") -> None:
    """Print the score of each setting at its last evaluation."""
    from rich.console import Console
    from rich.table import Table

    from ..rl.comparison import PANELS, scores

    table = Table("setting", "runs", "steps", *PANELS.values(), "best return")
    for row in scores(settings):
        cells = [
            f"{row[column]:.3g}" + (f" ± {half:.2g}" if math.isfinite(half := row[f"{column}_ci95"]) else "")
            for column in PANELS
        ]
        table.add_row(row["setting"], str(row["runs"]), f"{row['steps']:,}", *cells, f"{row['best_return']:.3g}")
    Console().print(table)
