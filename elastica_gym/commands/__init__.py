"""The commands of ``elastica-gym``: a module each, with a ``main`` that reads the command line.

``python -m agents.NAME`` in a clone runs the same functions.
"""

import importlib
import importlib.metadata
import inspect
import os
import sys
from typing import TypeVar

import tyro

from ..console.bad_input import BadInputError, choose, fail, run_command

Arguments = TypeVar("Arguments")
COMMANDS = {
    "list": "environments, shipped policies and baselines",
    "demo": "a shipped policy in the browser",
    "play": "one episode of any policy: in a window, a browser, a film or a recording",
    "train": "an agent with PPO or SAC, by imitation, or both",
    "sweep": "agents over seeds, environments and hyperparameters, on all cores or on a cluster (Ray)",
    "evaluate": "a policy on unseen episodes",
    "compare": "runs: learning curves with intervals over seeds, and final scores",
    "search": "a gait by CMA-ES",
    "score": "a policy on the goals of the 2020 hackathon",
    "replay": "a recording in the rerun viewer",
    "record": "episodes of a policy as a Minari dataset",
    "publish": "a run as a pretrained policy with a card",
    "plot_curves": "learning curves over seeds as one picture",
    "bench": "environment steps per second on this machine",
    "doctor": "versions, compiled kernels, drawing, threads",
}
"""Name of each command, and what it does with or shows"""
IN_AGENTS = ("train", "sweep", "evaluate", "search", "publish", "plot_curves", "record")
"""Commands that a clone has as modules of ``agents``"""


def run(name: str) -> None:
    """Run a command with the arguments in ``sys.argv``; what the user did wrong becomes one line and a status."""
    run_command(importlib.import_module(f".{name}", __name__).main)


def main() -> None:
    """Run the command line ``elastica-gym COMMAND ...``."""
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        print(_help())
        return
    if sys.argv[1] == "--version":
        print(f"elastica-gym {importlib.metadata.version('elastica-gym')}")
        return
    # as for ``python -m``: tasks and policies of the user's own are modules in the current folder
    sys.path.insert(0, os.getcwd())
    name = sys.argv[1]
    try:
        choose("command", name, COMMANDS)
    except BadInputError as error:
        fail(str(error))
    sys.argv = [f"elastica-gym {name}", *sys.argv[2:]]
    run(name)


def invocation(name: str) -> str:
    """Return how the user runs a command: with ``elastica-gym``, or in a clone as a module."""
    if sys.argv[0].startswith("elastica-gym "):
        return f"elastica-gym {name}"
    if name in ("score", "replay"):
        return f"python scripts/{name}.py"
    return f"python -m agents.{name}" if name in IN_AGENTS else f"elastica-gym {name}"


def parse(name: str, arguments: type[Arguments], *examples: str) -> Arguments:
    """Read the command line of a command; ``--help`` shows its examples, which are options and values."""
    lines = [f"  {invocation(name)} {example}".rstrip() for example in examples]
    description = [inspect.cleandoc(arguments.__doc__ or ""), "", "Examples:", *lines]
    return tyro.cli(arguments, description="\n".join(description))


def _help() -> str:
    width = max(map(len, COMMANDS))
    lines = [f"  {name:<{width}}  {what}" for name, what in COMMANDS.items()]
    return "\n".join(
        [
            "Elastica Gym: reinforcement learning on soft animals.",
            "",
            "usage: elastica-gym COMMAND [OPTIONS]",
            "",
            *lines,
            "",
            "elastica-gym COMMAND --help shows its options, with examples.",
        ]
    )
