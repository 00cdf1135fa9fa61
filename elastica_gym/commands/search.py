"""Search a gait by CMA-ES: ``python -m agents.search --env elastica_gym/SnakeForward-v1``."""

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
    """Search the parameters of a gait by the covariance matrix adaptation evolution strategy (CMA-ES).

    On SnakeForward these are the seven of the snake's published gait: six coefficients of a spline and the wave length.
    Every candidate is an environment of one batch, and all of a generation have the same starts. What the search leaves
    behind is in runs/<id>/search-<seed>-<time>/.
    """

    env: str = "elastica_gym/SnakeForward-v1"
    """Environment id."""
    gait: Literal["wave", "steered_wave", "stroke"] | None = None
    """The family of gaits: the snake's published wave; one that also has a period and bends towards the goal; or the
    octopus's stroke. By default the wave on SnakeForward, and on the others what can reach a goal."""
    seed: int = 0
    """Seed of the search, below 2**32; the seeds of its starts are derived from it (`elastica_gym.rl.seeds`)."""
    evaluations: int | None = None
    """Candidates to evaluate, over all restarts; by default 6,000, or no limit if minutes are given."""
    minutes: float | None = None
    """Wall-clock budget."""
    restarts: int = 3
    """How often the search begins anew, from other gaits; each has an equal part of the budget."""
    population: int = 20
    """Candidates in a generation."""
    threads: int = 2
    """Threads for the physics; results do not depend on them."""
    evaluation_episodes: int = 20
    """Episodes on which the best of the candidates, and the best in the end, are chosen."""
    evaluation_seed: int = VALIDATION.start
    """Seed of the first of them."""
    out: Path = Path("runs")
    """Folder of all runs."""
    folder: Path | None = None
    """Folder of this search, instead of one in `out` named by id, seed and time."""


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
    require_extra("train")

    arguments = parse("search", SearchArguments, "--env elastica_gym/SnakeForward-v1 --evaluations 3000")
    folder, config = _started(arguments)
    from ..progress import Bar

    with Bar("starting"):
        # Stable-Baselines3 takes seconds to import: not before the arguments are known to be good
        import yaml

        from ..rl.cmaes import Search

        search = Search(folder, config)
    (folder / "search.yml").write_text(yaml.safe_dump(config, sort_keys=False))
    print(f"Searching {search.gait.name}, {len(search.gait.parameters)} numbers, on {config['env']}, into {folder}")
    try:
        search.run()
    except KeyboardInterrupt:
        kept = folder / GAIT
        fail(f"interrupted. The best gait so far is in {kept}" if kept.exists() else "interrupted", status=130)
    print(f"Finished. gait.yml, search.csv and search.png are in {folder}")
    print(f"Evaluate it with: {invocation('evaluate')} --policy {folder / GAIT}")


def _started(arguments: SearchArguments) -> tuple[Path, dict[str, Any]]:
    """Check the arguments and make the folder; return that and what goes into its search.yml."""
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
        raise BadInputError(f"The folder {folder} has a search already: use another.")
    return make_folder(folder), config
