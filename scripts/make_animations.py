"""Draw an animation of every environment, as the documentation shows them: ``python scripts/make_animations.py``."""

import dataclasses
import tempfile
from pathlib import Path

from elastica_gym.console.bad_input import (
    BadInputError,
    check_bounds,
    choose_environment,
    make_folder,
    require_extra,
    run_command,
)
from elastica_gym.envs import GOAL_IDS, IDS, task_of
from elastica_gym.rl.seeds import TEST

IMAGES = Path(__file__).parents[1] / "docs" / "images"
LARGEST = 400_000
"""Bytes of an animation"""
SLOWEST = 8
"""Most control steps from one frame to the next"""
SHORTEST = 3.0
"""Shortest animation [s]; shorter episodes are followed by the next"""


@dataclasses.dataclass
class AnimationArguments:
    """Play an unseen episode of each environment's shipped policy, or else its script, into an animated GIF."""

    env: tuple[str, ...] = (*IDS, *GOAL_IDS)
    """Environment ids."""
    seed: int = TEST.start
    """Seed of the episode; short ones are followed by those of the next seeds."""
    every: int = 3
    """Control steps from one frame to the next; more where the file would be larger than 400 KB."""
    size: tuple[int, int] = (360, 220)
    """Width and height [pixels], even numbers."""
    out: Path = IMAGES
    """Folder of the files, which are named after the tasks."""


def main() -> None:
    """Run the command line."""
    for extra in ("train", "viz"):
        require_extra(extra)
    import tyro

    arguments = tyro.cli(AnimationArguments)
    check_bounds(dataclasses.asdict(arguments), {"every": 1, "seed": 0})
    for env_id in arguments.env:
        choose_environment(env_id, goals=True)
    make_folder(arguments.out)
    from elastica_gym.files import write_atomically

    for env_id in arguments.env:
        animation = draw(env_id, arguments)
        path = arguments.out / f"{task_of(env_id).name}.gif"
        write_atomically(path, lambda place, data=animation: place.write_bytes(data))
        print(f"wrote {path} ({len(animation) / 1000:.0f} kB)")


def draw(env_id: str, arguments: AnimationArguments) -> bytes:
    """Return an episode as an animated GIF, with as many frames as fit."""
    from elastica_gym.rl.films import check_film, film
    from elastica_gym.rl.policy_sources import find

    policy = find(shipped_policy(env_id), env_id).policy
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "animation.gif"
        check_film(path, arguments.size)
        for every in range(arguments.every, SLOWEST + 1):
            film(
                policy,
                env_id,
                path,
                seed=arguments.seed,
                every=every,
                size=arguments.size,
                shortest=SHORTEST,
                fine=True,
            )
            if path.stat().st_size <= LARGEST:
                return path.read_bytes()
    raise BadInputError(f"size must be smaller for {env_id}: {arguments.size} takes more than {LARGEST} bytes")


def shipped_policy(env_id: str) -> str:
    """Return the name of the policy that ships for an environment, or ``scripted``."""
    from elastica_gym.rl import cards

    return next((card["name"] for card in cards.cards_of(env_id)), "scripted")


if __name__ == "__main__":
    run_command(main)
