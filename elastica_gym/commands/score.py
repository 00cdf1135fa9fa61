"""Score a policy on the hackathon's goals: ``python scripts/score.py --policy PATH``."""

import dataclasses
import json
from pathlib import Path

from ..console.bad_input import make_folder, require_extra
from ..files import shipped
from ..rl import machine
from ..rl.cards import names
from . import parse


@dataclasses.dataclass
class ScoreArguments:
    """Score a policy on the hackathon's six goals, out of 100 points.

    Points depend on the positions of animal and object, sampled every 10 ms or finer. The policy runs in a separate
    process and receives only observations.
    """

    policy: str
    """A Python file with a function policy(observation), the folder of a run, its model.zip, or the name or zip of a
    shipped policy."""
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
    arguments = parse(
        "score",
        ScoreArguments,
        "--policy my_policy.py --targets 20",
        "--policy octopus_fetch_dagger",
        "--policy runs/OctopusFetch-v1/RUN --json score.json",
    )
    require_extra("train")
    from ..hackathon.judge import judge, print_score

    for folder in (arguments.record, arguments.json and arguments.json.parent):
        if folder is not None:
            make_folder(folder)
    result = judge(
        _path(arguments.policy),
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


def _path(policy: str) -> Path:
    """Return the path of a policy, which may be the name of a shipped one."""
    return shipped("pretrained") / f"{policy}.zip" if policy in names() else Path(policy)
