"""A shipped policy in the browser."""

import dataclasses

from ..files import shipped
from . import parse
from .play import PlayArguments, play

ENVIRONMENT = "elastica_gym/OctopusFetch-v1"


@dataclasses.dataclass
class DemoArguments:
    """Show in the browser how an octopus crawls to an object, wraps an arm around it and brings it home.

    The policy is the shipped script, which needs neither torch nor Stable-Baselines3.
    """

    to: str = "browser"
    """window, browser, a film (FILE.mp4 or FILE.gif) or a recording (FILE.rrd)."""
    seed: int = 2_000_000
    """Seed of the episode."""
    port: int = 9090
    """Port of the browser's page."""
    data_port: int = 9876
    """Port of its data."""


def main() -> None:
    """Run the command line."""
    arguments = parse("demo", DemoArguments, "", "--seed 3 --to fetch.mp4")
    policy = str(shipped("pretrained") / "octopus_fetch_script.py")
    play(PlayArguments(policy, ENVIRONMENT, **dataclasses.asdict(arguments)))
