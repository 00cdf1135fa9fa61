"""Search for a gait by CMA-ES: ``python -m agents.search --env elastica_gym/SnakeForward-v1``."""

import dataclasses
import time
from pathlib import Path
from typing import Any, Literal

from ..console.bad_input import (
    BadInputError,
    check_bounds,
    choose_environment,
    fail,
    make_folder,
    require_extra,
)
from ..rl import machine
from ..rl.run_files import GAIT, SEARCH
from ..rl.seeds import RUNS, VALIDATION, check_seeds
from . import invocation, parse


@dataclasses.dataclass
class SearchArguments:
    """Optimise the parameters of a gait by the covariance matrix adaptation evolution strategy (CMA-ES).

    On SnakeForward these are the seven of the snake's published gait: six spline coefficients and the wave length.
    Candidates of a generation run in one batch from the same initial states. Results are written to
    runs/<id>/search-<seed>-<time>/.
    """

    env: str = "elastica_gym/SnakeForward-v1"
    """Environment id."""
    gait: Literal["wave", "steered_wave", "stroke"] | None = None
    """The family of gaits: the snake's published wave; a wave that also has a period and bends towards the goal; or the
    octopus's stroke. By default the wave on SnakeForward, and elsewhere the one that can reach a goal."""
    seed: int = 0
    """Seed of the search, below 2**32; the seeds of initial states are derived from it (`elastica_gym.rl.seeds`)."""
    evaluations: int | None = None
    """Candidates to evaluate over all restarts; by default 6,000, or no limit if minutes are given."""
    minutes: float | None = None
    """Wall-clock budget."""
    restarts: int = 3
    """Number of restarts from other gaits; the budget is divided equally."""
    population: int = 20
    """Candidates per generation."""
    threads: int = 2
    """Threads for the physics; results do not depend on them."""
    evaluation_episodes: int = 20
    """Number of episodes for choosing the best gait, during and at the end of the search."""
    evaluation_seed: int = VALIDATION.start
    """Seed of the first of these episodes."""
    out: Path = Path("runs")
    """Folder of all runs."""
    folder: Path | None = None
    """Folder of this search, instead of one in `out` named after id, seed and time."""


LOWEST = {
    "seed": 0,
    "evaluations": 1,
    "minutes": 0.001,
    "restarts": 0,
    "population": 4,
    "threads": 1,
    "evaluation_episodes": 1,
    "evaluation_seed": 0,
}
DEFAULT_EVALUATIONS = 6000


def main() -> None:
    """Run the command line."""
    arguments = parse("search", SearchArguments, "--env elastica_gym/SnakeForward-v1 --evaluations 3000")
    require_extra("train")
    folder, config = _started(arguments)
    from ..progress import Bar

    with Bar("starting"):
        # Stable-Baselines3 takes seconds to import: check the arguments first
        import yaml

        from ..rl.cmaes import Search

        search = Search(folder, config)
    (folder / "search.yml").write_text(yaml.safe_dump(config, sort_keys=False))
    print(f"Searching {search.gait.name}, {len(search.gait.parameters)} parameters, on {config['env']}, into {folder}")
    try:
        search.run()
    except KeyboardInterrupt:
        kept = folder / GAIT
        fail(f"interrupted. The best gait so far is in {kept}" if kept.exists() else "interrupted", status=130)
    print(f"Finished. gait.yml, search.csv and search.png are in {folder}")
    print(f"Evaluate it with: {invocation('evaluate')} --policy {folder / GAIT}")


def _started(arguments: SearchArguments) -> tuple[Path, dict[str, Any]]:
    """Check the arguments, create the folder, and return it with the contents of its search.yml."""
    choose_environment(arguments.env)
    config = {key: value for key, value in dataclasses.asdict(arguments).items() if key not in ("out", "folder")}
    if arguments.evaluations is arguments.minutes is None:
        config["evaluations"] = DEFAULT_EVALUATIONS
    config |= machine.describe()
    check_bounds(config, LOWEST)
    check_seeds("seed", config["seed"], 1, RUNS)
    check_seeds("evaluation_seed", config["evaluation_seed"], config["evaluation_episodes"], VALIDATION)
    name = f"search-{arguments.seed}-{time.strftime('%Y%m%d-%H%M%S')}"
    folder = arguments.folder or arguments.out / arguments.env.rpartition("/")[2] / name
    if (folder / SEARCH).exists():
        raise BadInputError(f"The folder {folder} already has a search: use another.")
    return make_folder(folder), config
