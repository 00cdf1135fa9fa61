"""Make a pretrained policy from a run: ``python -m agents.publish --run DIR --name snake_forward_ppo``."""

import dataclasses
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import elastica_gym
from agents.checks import BadInputError, make_folder, require_extra, run_command
from agents.seeds import TEST

if TYPE_CHECKING:
    from agents.evaluate import Evaluation


@dataclasses.dataclass
class PublishArguments:
    """Evaluate a run of agents.train on unseen episodes, and keep its policy with a card that says what it is."""

    run: Path
    """Folder of the run."""
    name: str
    """Name of the policy: lower case, with snake or octopus in it."""
    episodes: int = 100
    """Episodes of the score."""
    seed: int = TEST.start
    """Seed of the first of them; training and its evaluations use others."""
    threads: int = 2
    """Threads for the physics."""
    out: Path = Path(__file__).parent / "pretrained"
    """Folder of the pretrained policies."""


def main() -> None:
    """Run the command line."""
    require_extra("train")
    import tyro

    arguments = tyro.cli(PublishArguments)
    if not re.fullmatch(r"[a-z0-9_]*(snake|octopus)[a-z0-9_]*", arguments.name):
        raise BadInputError(
            f"name must be of lower-case letters, digits and _, with snake or octopus in it, got {arguments.name!r}"
        )
    from agents.cards import write_pretrained
    from agents.evaluate import evaluate, print_table
    from agents.policies import load_run

    policy, config = load_run(arguments.run)
    make_folder(arguments.out)
    result = evaluate(
        policy,
        config["env"],
        episodes=arguments.episodes,
        seed=arguments.seed,
        n_threads=arguments.threads,
        env_kwargs=config["hyperparameters"].get("env_kwargs"),
    )
    print_table(f"{arguments.name}, {arguments.episodes} episodes from seed {arguments.seed}", result)
    card = card_of(arguments.name, arguments.run, config, policy.model.num_timesteps, result)
    for path in write_pretrained(arguments.out, arguments.name, policy, card):
        print(f"wrote {path} ({path.stat().st_size / 1000:.0f} kB)")


def card_of(name: str, run: Path, config: dict[str, Any], steps: int, result: "Evaluation") -> dict[str, Any]:
    """Return what the card says."""
    from agents.cards import command_of
    from agents.run_files import BEST, EVALUATIONS, METRICS, read_table

    folder = run.parent if run.name == BEST else run
    seconds = [read_table(folder / name).get("seconds", [0.0])[-1] for name in (METRICS, EVALUATIONS)]
    summary = result.summary()
    scores = ("episodes", "first_seed", "success_rate", "distance_mean", "distance_ci95", "return_mean", "return_ci95")
    return {
        "name": name,
        "environment": config["env"],
        "package": f"elastica-gym {elastica_gym.__version__}",
        "env_kwargs": config["hyperparameters"].get("env_kwargs") or {},
        "algorithm": config["algo"],
        "seed": config["seed"],
        "command": command_of(config),
        "steps": int(steps),
        "wall_time_minutes": round(float(max(seconds)) / 60.0, 1),
        "score": {key: round(value, 4) if isinstance(value := summary[key], float) else value for key in scores},
        "scored_with": f"python -m agents.evaluate --pretrained {name} --episodes {summary['episodes']} "
        f"--seed {summary['first_seed']}",
        "hyperparameters": config["hyperparameters"],
        "versions": config.get("versions", {}),
    }


if __name__ == "__main__":
    run_command(main)
