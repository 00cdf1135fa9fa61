"""Make the picture of the README: a snake at several moments of one episode, and its head's trail.

``python scripts/make_picture.py`` follows the scripted crawl, ``--run DIR`` a trained policy; either
way it writes docs/images/snake.png.
"""

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from scipy.interpolate import CubicSpline

import elastica_gym  # noqa: F401  (registers the environments)
from agents.checks import BadInputError
from elastica_gym.viz import Rollout, Stage, framing, run_rollout
from elastica_gym.viz.frames import HEAD, animal, line

ENV = "elastica_gym/SnakeForward-v0"
OUTPUT = Path(__file__).parents[1] / "docs" / "images" / "snake.png"


def main() -> int:
    """Run an episode, draw it and write the picture; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--run", type=Path, help="folder of a training run whose policy to follow")
    parser.add_argument("--seed", type=int, default=3, help="seed of the episode (default: %(default)s)")
    parser.add_argument("--moments", type=int, default=3, help="how many times to draw (default: %(default)s)")
    parser.add_argument("--size", type=int, nargs=2, default=(1400, 460), help="width and height [pixels]")
    parser.add_argument("--output", type=Path, default=OUTPUT, help="where to write it (default: %(default)s)")
    options = parser.parse_args()
    if options.moments < 1:
        parser.error(f"--moments must be at least 1, not {options.moments}")
    try:
        rollout = run_rollout(ENV, scripted if options.run is None else trained(options.run), seed=options.seed)
        picture = draw(rollout, n_moments=options.moments, width=options.size[0], height=options.size[1])
        options.output.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(picture).save(options.output, optimize=True)
    except (BadInputError, ImportError, OSError, RuntimeError) as error:
        print(f"make_picture: {error}", file=sys.stderr)
        return 1
    print(f"wrote {options.output}")
    return 0


def scripted(observations: np.ndarray, env: Any) -> np.ndarray:
    """Return the actions of the task's scripted policy, (B, 42)."""
    return env.task.scripted_policy(env)


def trained(run: Path) -> Any:
    """Return the policy of a training run."""
    from agents.policies import load_run

    return load_run(run)[0]


def draw(rollout: Rollout, *, n_moments: int, width: int, height: int) -> np.ndarray:
    """Draw the animal at moments evenly spread over the rollout, early ones fading, (height, width, 3) uint8."""
    nodes = along_x(rollout.nodes)
    moments = np.linspace(0, len(nodes) - 1, n_moments).round().astype(int)
    strengths = np.linspace(0.35, 1.0, n_moments) if n_moments > 1 else np.ones(1)
    # the trail lies on the ground, so that bodies are over it
    thin = 0.2 * rollout.radii.min()
    fine = np.linspace(0, len(nodes) - 1, 5 * len(nodes))
    trail = CubicSpline(np.arange(len(nodes)), nodes[:, -1])(fine) * [1.0, 0.0, 1.0] + [0.0, 0.3 * thin, 0.0]
    camera = framing(np.concatenate([nodes[moments].reshape(-1, 3), trail]), width / height, elevation=-42.0)
    with Stage(width=width, height=height, unit=rollout.body_length) as stage:
        ground = stage.draw([], camera).astype(float)
        picture = overlay(ground, ground, stage.draw([line(trail, thin, HEAD)], camera), strength=0.55)
        for moment, strength in zip(moments, strengths, strict=True):
            figure = animal(nodes[moment], rollout.radii[moment], rollout.elements_per_rod)
            picture = overlay(picture, ground, stage.draw([figure], camera), strength=strength)
    return np.round(picture).astype(np.uint8)


def overlay(picture: np.ndarray, ground: np.ndarray, drawn: np.ndarray, strength: float) -> np.ndarray:
    """Return the picture with what was drawn on the bare ground laid over it, all (height, width, 3)."""
    difference = np.abs(drawn - ground).max(axis=-1, keepdims=True)
    share = strength * np.clip(difference / 40.0, 0.0, 1.0)
    return picture + share * (drawn - picture)


def along_x(nodes: np.ndarray) -> np.ndarray:
    """Return positions (T, N, 3) turned about the vertical, so that the animal goes from left to right."""
    centre = nodes.mean(axis=1)
    way = centre[-1] - centre[0]
    cos, sin = np.array([way[0], way[2]]) / np.hypot(way[0], way[2])
    turn = np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])
    return (nodes - centre[0] * [1.0, 0.0, 1.0]) @ turn.T


if __name__ == "__main__":
    sys.exit(main())
