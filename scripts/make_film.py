"""Film an episode of a pretrained policy, as the README shows it: `python scripts/make_film.py --name NAME`."""

import dataclasses
from pathlib import Path

import numpy as np

import elastica_gym  # noqa: F401  (registers the environments)
from agents.checks import check_bounds, make_folder, require_extra, run_command
from agents.seeds import TEST

IMAGES = Path(__file__).parents[1] / "docs" / "images"
COLORS = 64
"""Of the film: more make it larger, and hardly better"""


@dataclasses.dataclass
class FilmArguments:
    """Run one unseen episode of a pretrained policy, and write it as an animated GIF."""

    name: str = "octopus_fetch_dagger"
    """Name of the policy, see agents/pretrained."""
    seed: int = TEST.start
    """Seed of the episode."""
    every: int = 2
    """Control steps from one frame to the next; the film is as fast as the animal."""
    size: tuple[int, int] = (480, 300)
    """Width and height [pixels]."""
    output: Path | None = None
    """The file; by default docs/images/<name>.gif."""


def main() -> None:
    """Run the command line."""
    for extra in ("train", "viz"):
        require_extra(extra)
    import tyro
    from PIL import Image

    from agents.cards import load_pretrained
    from elastica_gym.viz import render_frames, run_rollout

    arguments = tyro.cli(FilmArguments)
    check_bounds(dataclasses.asdict(arguments), {"every": 1, "seed": 0})
    policy, card = load_pretrained(arguments.name)
    rollout = run_rollout(card["environment"], policy, seed=arguments.seed, **card["env_kwargs"])
    moments = range(0, len(rollout.step), arguments.every)
    width, height = arguments.size
    frames = [Image.fromarray(frame) for frame in render_frames(rollout, moments, width=width, height=height)]
    # one palette for all, or colours flicker
    palette = Image.fromarray(np.concatenate([np.asarray(frame) for frame in frames[:: max(1, len(frames) // 8)]]))
    palette = palette.quantize(COLORS)
    film = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    output = arguments.output or IMAGES / f"{arguments.name}.gif"
    make_folder(output.parent)
    duration = 1000.0 * arguments.every * float(np.diff(rollout.sim_time).mean())
    film[0].save(output, save_all=True, append_images=film[1:], duration=duration, loop=0, optimize=True)
    print(f"wrote {output} ({output.stat().st_size / 1e6:.1f} MB, {rollout.duration:.1f} s)")


if __name__ == "__main__":
    run_command(main)
