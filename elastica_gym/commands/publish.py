"""Make a pretrained policy from a run: ``python -m agents.publish --name snake_forward_ppo --run DIR``."""

import dataclasses
import importlib.metadata
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..console.bad_input import BadInputError, make_folder, require_extra
from ..rl import machine
from ..rl.cards import PRETRAINED
from ..rl.seeds import TEST
from . import parse

if TYPE_CHECKING:
    from ..rl.evaluation import Evaluation
    from ..rl.policies import TrainedPolicy

MACHINE = ("cpu", "kernels", "commit")
"""Fields of the machine on a card"""
INTERVALS = (
    "Intervals are of 95 %, over episodes, of this one policy. With equal kernels, equal seeds give equal bits. On"
    " another CPU sums are rounded otherwise, and contact amplifies that: the means over these seeds are then within "
    "elsewhere95, which is sqrt(2) times as wide. No interval covers other seeds of training."
)
"""Explanation of the intervals on a card"""


@dataclasses.dataclass
class PublishArguments:
    """Evaluate a run of agents.train on unseen episodes, and save its policy with a card."""

    name: str
    """Name of the policy: lower case, with snake or octopus in it."""
    run: Path | None = None
    """Folder of the run; if omitted, a published policy is scored again, for example after environments changed."""
    episodes: int = 100
    """Number of episodes of the score."""
    seed: int = TEST.start
    """Seed of the first episode; training and its evaluations use other seeds."""
    threads: int = 2
    """Threads for the physics."""
    out: Path = PRETRAINED
    """Folder of the pretrained policies."""


def main() -> None:
    """Run the command line."""
    arguments = parse("publish", PublishArguments, "--name snake_forward_ppo --run runs/SnakeForward-v1/RUN")
    require_extra("train")
    if not re.fullmatch(r"[a-z0-9_]*(snake|octopus)[a-z0-9_]*", arguments.name):
        raise BadInputError(
            f"name must be lower-case letters, digits and _, with snake or octopus in it, got {arguments.name!r}"
        )
    make_folder(arguments.out)
    for path in _score_again(arguments) if arguments.run is None else _publish(arguments, arguments.run):
        print(f"wrote {path} ({path.stat().st_size / 1000:.0f} kB)")


def _publish(arguments: PublishArguments, run: Path) -> list[Path]:
    """Score the policy of a run, write it with its card, and return the files."""
    from ..rl.cards import write_pretrained
    from ..rl.policies import load_run

    policy, config = load_run(run)
    result = _evaluate(arguments, policy, config["env"], config["hyperparameters"].get("env_kwargs"))
    card = card_of(arguments.name, run, config, policy.model.num_timesteps, result)
    return write_pretrained(arguments.out, arguments.name, policy, card)


def _score_again(arguments: PublishArguments) -> list[Path]:
    """Score a published policy again, update its card, and return the card's path."""
    from ..rl.cards import load_pretrained, write_card

    policy, card = load_pretrained(arguments.name, arguments.out)
    result = _evaluate(arguments, policy, card["environment"], card["env_kwargs"])
    return [write_card(arguments.out, arguments.name, {**card, **score_of(arguments.name, result)})]


def _evaluate(
    arguments: PublishArguments, policy: "TrainedPolicy", env_id: str, env_kwargs: dict[str, Any] | None
) -> "Evaluation":
    from ..progress import Bar
    from ..rl.evaluation import evaluate, print_table

    with Bar(f"evaluating {arguments.episodes} episodes") as bar:
        result = evaluate(
            policy,
            env_id,
            episodes=arguments.episodes,
            seed=arguments.seed,
            n_threads=arguments.threads,
            env_kwargs=env_kwargs,
            show=bar.show,
        )
    print_table(f"{arguments.name}, {arguments.episodes} episodes from seed {arguments.seed}", result)
    return result


def card_of(name: str, run: Path, config: dict[str, Any], steps: int, result: "Evaluation") -> dict[str, Any]:
    """Return the contents of the card."""
    from ..rl.cards import command_of
    from ..rl.run_files import BEST, EVALUATIONS, METRICS, read_table

    folder = run.parent if run.name == BEST else run
    seconds = [read_table(folder / name).get("seconds", [0.0])[-1] for name in (METRICS, EVALUATIONS)]
    return {
        "name": name,
        "environment": config["env"],
        "package": f"elastica-gym {importlib.metadata.version('elastica-gym')}",
        "env_kwargs": config["hyperparameters"].get("env_kwargs") or {},
        "algorithm": config["algo"],
        "seed": config["seed"],
        "command": command_of(config),
        "steps": int(steps),
        "wall_time_minutes": round(float(max(seconds)) / 60.0, 1),
        **score_of(name, result),
        "trained_on": {key: config.get(key, "not recorded") for key in MACHINE},
        "hyperparameters": config["hyperparameters"],
        "versions": config.get("versions", {}),
    }


def score_of(name: str, result: "Evaluation") -> dict[str, Any]:
    """Return the fields of the card about an evaluation."""
    summary, scored = result.summary(), machine.describe()
    scores = (
        "episodes",
        "first_seed",
        "success_rate",
        "success_interval95",
        "distance_mean",
        "distance_ci95",
        "return_mean",
        "return_ci95",
        "elsewhere95",
    )
    return {
        "score": {key: _rounded(summary[key]) for key in scores},
        "intervals": INTERVALS,
        "scored_with": f"python -m agents.evaluate --pretrained {name} --episodes {summary['episodes']} "
        f"--seed {summary['first_seed']}",
        "scored_on": {key: scored[key] for key in MACHINE},
    }


def _rounded(value: Any) -> Any:
    """Round a score to four decimals."""
    if isinstance(value, dict):
        return {key: _rounded(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    return round(value, 4) if isinstance(value, float) else value
