"""Score a policy on the hackathon's goals: ``python scripts/score.py --policy PATH``."""

import dataclasses
import json
from pathlib import Path

from ..console.bad_input import make_folder, require_extra
from ..rl import machine
from . import parse


@dataclasses.dataclass
class ScoreArguments:
    """Score a policy on the hackathon's six goals, out of 100 points.

    Points depend on the positions of animal and object, sampled every 10 ms or finer. The policy runs in a separate
    process and receives only observations.
    """

    policy: Path
    """A Python file with a function policy(observation), the folder of a run, its model.zip, or a pretrained policy's
    zip."""
    targets: int = 100
    """Number of targets on the arc, and also of those anywhere."""
    target_seed: int = 2020
    """Seed of all targets and initial states."""
    json: Path | None = None
    """File for the points and the settings as JSON."""
    record: Path | None = None
    """Folder for rerun recordings of the first episode on each kind of target."""
    env: str = "elastica_gym/OctopusFetch-v1"
    """Environment id."""
    threads: int = 2
    """Threads for the physics."""


def main() -> None:
    """Run the command line; a policy that failed ends it with status 1."""
    require_extra("train")

    arguments = parse(
        "score",
        ScoreArguments,
        "--policy scripts/starter_kit.py --targets 20",
        "--policy runs/OctopusFetch-v1/RUN --json score.json",
    )
    from ..hackathon.judge import judge, print_score

    for folder in (arguments.record, arguments.json and arguments.json.parent):
        if folder is not None:
            make_folder(folder)
    result = judge(
        arguments.policy,
        arguments.env,
        targets=arguments.targets,
        target_seed=arguments.target_seed,
        record=arguments.record,
        n_threads=arguments.threads,
    )
    print_score(result)
    if arguments.json is not None:
        arguments.json.write_text(json.dumps({**result, **machine.describe()}, indent=2) + "\n")
        print(f"wrote {arguments.json}")
    if result["error"]:
        raise SystemExit(1)
