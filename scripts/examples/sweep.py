"""A sweep over seeds and a hyperparameter, compared at the end: ``python scripts/examples/sweep.py --steps 100000``.

Every run is a process of its own, and finished runs are not repeated: started again, the sweep continues.
"""

import argparse
import itertools
import subprocess
import sys
from pathlib import Path


def main() -> None:
    """Run all combinations, one after the other, and compare them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--env", default="elastica_gym/SnakeForward-v1")
    parser.add_argument("--steps", type=int, default=100_000)
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    parser.add_argument("--gamma", type=float, nargs="+", default=[0.95, 0.98])
    parser.add_argument("--out", type=Path, default=Path("runs/sweep"))
    arguments, more = parser.parse_known_args()
    folders = []
    for gamma, seed in itertools.product(arguments.gamma, arguments.seeds):
        folder = arguments.out / f"gamma{gamma}-seed{seed}"
        folders.append(str(folder))
        if not (folder / "model.zip").exists():
            start = ["--resume", str(folder)] if (folder / "config.yml").exists() else [
                *("--env", arguments.env, "--steps", str(arguments.steps), "--seed", str(seed)),
                *("--folder", str(folder), "--set", f"gamma={gamma}", *more),
            ]  # fmt: skip
            subprocess.run([sys.executable, "-m", "elastica_gym.commands", "train", *start], check=True)
    compare = ["compare", *folders, "--by", "gamma", "--out", str(arguments.out / "comparison")]
    subprocess.run([sys.executable, "-m", "elastica_gym.commands", *compare], check=True)


if __name__ == "__main__":
    main()
