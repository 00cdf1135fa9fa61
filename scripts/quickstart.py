"""Train a snake to crawl for a few minutes, then compare it with a gait, random and zero actions on unseen seeds."""

import dataclasses
import subprocess
import sys
import time
from pathlib import Path

import tyro
from rich.console import Console
from rich.table import Table

from elastica_gym.console.bad_input import check_bounds, run_command
from elastica_gym.progress import track
from elastica_gym.rl.seeds import TEST

ENV = "elastica_gym/SnakeForward-v1"
ROOT = Path(__file__).resolve().parents[1]


@dataclasses.dataclass
class Arguments:
    """Train a snake to crawl, and show the result."""

    minutes: float = 5.0
    """Training time."""
    seed: int = 0
    """Seed of the training."""
    episodes: int = 20
    """Episodes per policy in the comparison."""
    evaluation_seed: int = TEST.start
    """Seed of the first episode; training and its evaluations use others."""
    out: Path = Path("runs")
    """Folder of all runs."""


def main() -> None:
    """Run the command line."""
    arguments = tyro.cli(Arguments)
    # check before training, not after
    check_bounds(dataclasses.asdict(arguments), {"minutes": 0.001, "seed": 0, "episodes": 1, "evaluation_seed": 0})
    console = Console()
    folder = arguments.out / ENV.split("/")[1] / f"quickstart-{arguments.seed}-{time.strftime('%Y%m%d-%H%M%S')}"
    console.print(
        f"A snake of 50 elements learns to crawl: PPO for {arguments.minutes:g} minutes. "
        "Ctrl-C saves and prints how to resume.",
        highlight=False,
    )
    command = [
        sys.executable,
        "-m",
        "agents.train",
        "--env",
        ENV,
        "--algo",
        "ppo",
        "--seed",
        str(arguments.seed),
        "--minutes",
        str(arguments.minutes),
        "--evaluations",
        "8",
        "--folder",
        str(folder),
    ]
    status = subprocess.run(command, cwd=ROOT).returncode
    if status != 0:
        sys.exit(status)
    compare(console, folder, arguments)
    show_where(console, folder)


def compare(console: Console, folder: Path, arguments: Arguments) -> None:
    """Print a table of the best policy of training and the baselines, on the same unseen seeds."""
    from elastica_gym.rl.evaluation import confidence, evaluate
    from elastica_gym.rl.policies import baseline, load_run
    from elastica_gym.rl.run_files import BEST

    policies = {
        "trained": load_run(ROOT / folder / BEST)[0],
        "published gait": baseline("seed_gait"),
        "random": baseline("random"),
        "zero": baseline("zero"),
    }
    table = Table(title=f"{ENV}, {arguments.episodes} unseen seeds")
    for column in ("policy", "distance in 10 s (m)", "95 % interval", "return"):
        table.add_column(column, justify="left" if column == "policy" else "right")
    for name, policy in track(list(policies.items()), "comparing on unseen seeds"):
        result = evaluate(policy, ENV, episodes=arguments.episodes, seed=arguments.evaluation_seed)
        mean, half = float(result.distances.mean()), confidence(result.distances)
        table.add_row(name, f"{mean:.3f}", f"{mean - half:.3f} to {mean + half:.3f}", f"{result.returns.mean():.2f}")
    console.print(table)


def show_where(console: Console, folder: Path) -> None:
    """Print the paths of the results and the commands that open them."""
    curve = folder / "learning_curve.png"
    recordings = sorted((ROOT / folder).glob("recordings/*.rrd"))
    lines = [f"learning curve   {curve}"]
    for recording in recordings:
        shown = recording.relative_to(ROOT) if recording.is_relative_to(ROOT) else recording
        lines += [
            f"recording        {shown}",
            f"  look at it     .venv/bin/python scripts/replay.py {shown}",
            f"  in a browser   .venv/bin/python scripts/replay.py {shown} --web",
        ]
    lines.append(f"train on         .venv/bin/python -m agents.train --resume {folder} --minutes 20")
    console.print("\n".join(lines), soft_wrap=True, highlight=False)


if __name__ == "__main__":
    run_command(main)
