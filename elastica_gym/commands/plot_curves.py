"""Plot learning curves over seeds: ``python -m agents.plot_curves --env ID --runs runs/SnakeForward-v1/ppo-*``."""

import dataclasses
from pathlib import Path

from ..console.bad_input import BadInputError, choose_environment, make_folder, require_extra
from . import parse


@dataclasses.dataclass
class PlotArguments:
    """Plot mean and range over several runs of one environment."""

    env: str
    """Environment id of all runs."""
    runs: list[Path]
    """Folders of the runs."""
    out: Path = Path("learning_curves.png")
    """PNG file to write."""


def main() -> None:
    """Run the command line."""
    arguments = parse(
        "plot_curves", PlotArguments, "--env elastica_gym/SnakeForward-v1 --runs runs/SnakeForward-v1/ppo-*"
    )
    require_extra("train")
    choose_environment(arguments.env)
    from ..files import write_atomically
    from ..rl import curves
    from ..rl.policies import read_config
    from ..rl.run_files import EVALUATIONS, METRICS

    for run in arguments.runs:
        if (trained_on := read_config(run)["env"]) != arguments.env:
            raise BadInputError(f"The run {run} was trained on {trained_on}, not on {arguments.env}.")
        if len(curves.curve_of(run).get("steps", ())) < 2:
            raise BadInputError(
                f"The run {run} has no curve yet: its {METRICS} and {EVALUATIONS} have fewer than two rows."
            )
    make_folder(arguments.out.parent)
    figure = curves.plot_runs(arguments.runs)
    write_atomically(arguments.out, lambda path: curves.save(figure, path))
    print(f"Wrote {arguments.out}")
