"""Score a policy on the hackathon's goals: ``python scripts/score.py --policy PATH``."""

import dataclasses
import json
import sys
from pathlib import Path

from elastica_gym.console.bad_input import make_folder, require_extra, run_command
from elastica_gym.rl import machine


@dataclasses.dataclass
class Arguments:
    """Score a policy on the hackathon's six goals, out of 100 points.

    What counts is where animal and object are, every 10 ms or finer. The policy runs in a process of its own and sees
    nothing but observations.
    """

    policy: Path
    """A Python file with a function policy(observation), the folder of a run, its model.zip, or the zip of a pretrained
    policy."""
    targets: int = 100
    """Targets on the arc, and again anywhere."""
    target_seed: int = 2020
    """Seed of all targets and initial states."""
    json: Path | None = None
    """File for the points as JSON, and what they were computed with."""
    record: Path | None = None
    """Folder for rerun recordings: of the first episode on each kind of target."""
    env: str = "elastica_gym/OctopusFetch-v1"
    """Environment id."""
    threads: int = 2
    """Threads for the physics."""


def main() -> int:
    """Run the command line; return the exit status."""
    require_extra("train")
    import tyro

    arguments = tyro.cli(Arguments)
    from elastica_gym.hackathon.judge import judge, print_score

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
    return 1 if result["error"] else 0


if __name__ == "__main__":
    run_command(lambda: sys.exit(main()))
