"""Score the policies without training on every environment: ``python scripts/score_baselines.py``.

Zero, random and scripted actions, and the searched gaits in agents/searched, each play the same unseen episodes.
Scores go into docs/results/baselines.json, an environment at a time; `document_environments.py` puts them on the pages.
"""

import dataclasses
import json
from pathlib import Path
from typing import Any

import tyro

from elastica_gym.console.bad_input import check_bounds, run_command
from elastica_gym.envs import GOAL_IDS, IDS
from elastica_gym.files import shipped, write_atomically

BASELINES = ("zero", "random", "scripted")
RESULTS = Path(__file__).parents[1] / "docs" / "results" / "baselines.json"


@dataclasses.dataclass
class Arguments:
    """Score zero, random and scripted actions and searched gaits on every environment."""

    only: tuple[str, ...] = ()
    """Environment ids to score; all if none is given. Scores of others are kept."""
    episodes: int = 100
    """Number of episodes of each."""
    threads: int = 2
    """Threads for the physics."""
    out: Path = RESULTS
    """File for the scores."""


def main() -> None:
    """Run the command line."""
    arguments = tyro.cli(Arguments)
    check_bounds({"episodes": arguments.episodes, "threads": arguments.threads}, {"episodes": 1, "threads": 1})
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    scores: dict[str, Any] = json.loads(arguments.out.read_text()) if arguments.out.exists() else {}
    for env_id in arguments.only or (*IDS, *GOAL_IDS):
        scores[env_id] = score(env_id, arguments.episodes, arguments.threads)
        text = json.dumps(scores, indent=1) + "\n"
        write_atomically(arguments.out, lambda path, text=text: path.write_text(text))
    print(f"wrote {arguments.out}")


def score(env_id: str, episodes: int, threads: int) -> dict[str, Any]:
    """Return the summary of each baseline's episodes by its name, and the machine they were played on."""
    from elastica_gym.progress import Bar
    from elastica_gym.rl import machine, policy_sources
    from elastica_gym.rl.evaluation import evaluate
    from elastica_gym.rl.seeds import TEST

    names = [*BASELINES, *map(str, sorted(shipped("searched").glob("*.yml")))]
    found: dict[str, Any] = {}
    for name in names:
        source = policy_sources.find(name, None if name.endswith(".yml") else env_id)
        if source.env_id != env_id:
            continue
        with Bar(f"{Path(name).stem} on {env_id}") as bar:
            result = evaluate(
                source.policy, env_id, episodes=episodes, seed=TEST.start, n_threads=threads, show=bar.show
            )
        found[Path(name).stem] = result.summary()
    return {"scores": found, **machine.describe()}


if __name__ == "__main__":
    run_command(main)
