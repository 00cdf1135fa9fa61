"""Film an episode of a pretrained policy, as the README shows it: `python scripts/make_film.py --name NAME`."""

import dataclasses
from pathlib import Path

from elastica_gym.console.bad_input import check_bounds, require_extra, run_command
from elastica_gym.rl.seeds import TEST

IMAGES = Path(__file__).parents[1] / "docs" / "images"


@dataclasses.dataclass
class FilmArguments:
    """Run one unseen episode of a pretrained policy, and write it as an animated GIF or a video."""

    name: str = "octopus_fetch_dagger"
    """Name of the policy, see agents/pretrained."""
    seed: int = TEST.start
    """Seed of the episode."""
    every: int = 2
    """Control steps from one frame to the next; the film is as fast as the animal."""
    size: tuple[int, int] = (480, 300)
    """Width and height [pixels], even numbers."""
    output: Path | None = None
    """The file, which ends in .gif or .mp4; by default docs/images/<name>.gif."""


def main() -> None:
    """Run the command line."""
    for extra in ("train", "viz"):
        require_extra(extra)
    import tyro

    arguments = tyro.cli(FilmArguments)
    check_bounds(dataclasses.asdict(arguments), {"every": 1, "seed": 0})
    from elastica_gym.rl.cards import load_pretrained
    from elastica_gym.rl.films import check_film, film

    output = arguments.output or IMAGES / f"{arguments.name}.gif"
    check_film(output, arguments.size)
    policy, card = load_pretrained(arguments.name)
    film(
        policy,
        card["environment"],
        output,
        seed=arguments.seed,
        every=arguments.every,
        size=arguments.size,
        env_kwargs=card["env_kwargs"],
    )


if __name__ == "__main__":
    run_command(main)
