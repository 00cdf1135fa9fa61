"""Rank the submissions of a hackathon: ``python scripts/rank.py FOLDER``.

Every Python file, zip and folder of a run in the folder is scored on the same targets, one after the other.
"""

import csv
import dataclasses
import io
from pathlib import Path
from typing import Any

import tyro

from elastica_gym.console.bad_input import BadInputError, check_bounds, make_folder, require_extra, run_command


@dataclasses.dataclass
class RankArguments:
    """Score all submissions in a folder and rank them.

    A submission is a Python file with a function policy(observation), a model.zip, or the folder of a run.
    """

    folder: tyro.conf.Positional[Path]
    """Folder of the submissions."""
    targets: int = 100
    """Targets on the arc, and again anywhere."""
    target_seed: int = 2020
    """Seed of all targets and initial states; the teams should not know it."""
    out: Path = Path("ranking.csv")
    """File for the ranking."""
    env: str = "elastica_gym/OctopusFetch-v1"
    """Environment id."""
    threads: int = 2
    """Threads for the physics."""


def main() -> None:
    """Run the command line."""
    require_extra("train")
    arguments = tyro.cli(RankArguments)
    check_bounds(dataclasses.asdict(arguments), {"targets": 1, "target_seed": 0, "threads": 1})
    found = submissions(arguments.folder)
    make_folder(arguments.out.parent)
    from elastica_gym.files import write_atomically

    rows = []
    for number, path in enumerate(found, start=1):
        print(f"[{number}/{len(found)}] {path.name}")
        rows.append({"submission": path.name, **points_of(path, arguments)})
    rows = rank(rows)
    text = io.StringIO()
    writer = csv.DictWriter(text, fieldnames=list(dict.fromkeys(key for row in rows for key in row)))
    writer.writeheader()
    writer.writerows(rows)
    write_atomically(arguments.out, lambda path: path.write_text(text.getvalue()))
    print_ranking(rows)
    print(f"wrote {arguments.out}")


def submissions(folder: Path) -> list[Path]:
    """Return the submissions in a folder, by name.

    Raises
    ------
    BadInputError
        If there are none.
    """
    paths = sorted(folder.iterdir()) if folder.is_dir() else []
    found = [path for path in paths if path.suffix in (".py", ".zip") or (path / "config.yml").exists()]
    if not found:
        raise BadInputError(f"folder must hold submissions (*.py, *.zip or runs), got {folder}")
    return found


def points_of(path: Path, arguments: RankArguments) -> dict[str, Any]:
    """Score a submission; one that cannot be scored has no points, and the reason as its error."""
    from elastica_gym.hackathon.judge import judge
    from elastica_gym.hackathon.scoring import GOALS

    try:
        result = judge(
            path,
            arguments.env,
            targets=arguments.targets,
            target_seed=arguments.target_seed,
            n_threads=arguments.threads,
        )
    except BadInputError as error:
        return {"points": 0.0, "error": str(error)}
    goals = {goal: result[goal] for goal in (*GOALS, "general")}
    return {"points": result["total"], **goals, "error": result["error"]}


def rank(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return rows by descending points, each with its rank; equal points share one, and failed ones have none."""
    ordered = sorted(rows, key=lambda row: (bool(row["error"]), -row["points"], row["submission"]))
    points = [row["points"] for row in ordered]
    return [{"rank": "" if row["error"] else 1 + points.index(row["points"]), **row} for row in ordered]


def print_ranking(rows: list[dict[str, Any]]) -> None:
    """Print rank, submission, points and error."""
    from rich.console import Console
    from rich.table import Table

    table = Table("rank", "submission", "points", "error")
    for row in rows:
        table.add_row(str(row["rank"]), row["submission"], f"{row['points']:g}", row["error"])
    Console().print(table)


if __name__ == "__main__":
    run_command(main)
