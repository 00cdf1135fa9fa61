"""Play an episode of any policy and look at it."""

import dataclasses
import tempfile
from pathlib import Path

import tyro

from ..console.bad_input import BadInputError, choose_environment, require_extra
from ..rl.seeds import TEST
from ..viz.viewer import has_display
from . import parse
from .replay import open_window, serve

FILMS = (".mp4", ".gif")
SHORTEST = 3.0
"""Shortest film [s]: episodes that end sooner are followed by those of the next seeds"""


@dataclasses.dataclass
class PlayArguments:
    """Play an episode of a policy: in rerun's window or in a browser, or into a film or a recording."""

    policy: tyro.conf.Positional[str]
    """zero, random, scripted or seed_gait; a shipped policy; the folder of a run; a gait (.yml) or a policy (.py)."""
    env: str | None = None
    """Environment id; by default the one that the policy was trained on."""
    to: str = "auto"
    """window, browser, a film (FILE.mp4 or FILE.gif) or a recording (FILE.rrd); auto is a window where there is a
    display, else the browser."""
    seed: int = TEST.start
    """Seed of the episode; in a film, an episode of less than 3 s is followed by those of the next seeds."""
    spread: str | None = None
    """How initial states are drawn, for tasks that know several ways."""
    port: int = 9090
    """Port of the browser's page."""
    data_port: int = 9876
    """Port of its data."""


def main() -> None:
    """Run the command line."""
    play(
        parse(
            "play",
            PlayArguments,
            "snake_reach_ppo",
            "octopus_fetch_dagger --to browser",
            "scripted --env elastica_gym/OctopusGrab-v1 --to grab.mp4",
            "runs/SnakeForward-v1/RUN --to forward.rrd",
        )
    )


def play(arguments: PlayArguments) -> None:
    """Play an episode and show it.

    Raises
    ------
    BadInputError
        If policy, environment or destination cannot be used.
    """
    where = _destination(arguments.to)
    require_extra("viz")
    if arguments.env is not None:
        choose_environment(arguments.env)
    from ..rl import films, policy_sources

    source = policy_sources.find(arguments.policy, arguments.env)
    policy, env_id, env_kwargs = policy_sources.with_spread(source, arguments.spread)
    if isinstance(where, Path) and where.suffix in FILMS:
        films.film(policy, env_id, where, seed=arguments.seed, shortest=SHORTEST, env_kwargs=env_kwargs)
    elif isinstance(where, Path):
        films.record(policy, env_id, seed=arguments.seed, path=where, env_kwargs=env_kwargs)
    else:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / films.recording_name(env_id, arguments.seed)
            films.record(policy, env_id, seed=arguments.seed, path=path, env_kwargs=env_kwargs)
            if where == "browser":
                serve(path, page=arguments.port, data=arguments.data_port)
            else:
                open_window(path, arguments.data_port)


def _destination(to: str) -> str | Path:
    """Return ``window``, ``browser``, or the path of a film or recording."""
    if to == "auto":
        return "window" if has_display() else "browser"
    if to in ("window", "browser"):
        return to
    if Path(to).suffix not in (*FILMS, ".rrd"):
        raise BadInputError(f"to must be window, browser, or a file that ends in .mp4, .gif or .rrd, got {to!r}")
    return Path(to)
