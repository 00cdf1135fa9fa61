"""Make the picture of the README: both animals at several times of one episode, and the trails of their heads.

Above, a snake crawls along its initial heading; below, an octopus crawls away from its object, both from left to
right. ``python scripts/make_picture.py`` uses the scripted crawls, ``--snake-run DIR`` and ``--octopus-run DIR``
trained policies; it writes docs/images/animals.png.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

import elastica_gym  # noqa: F401  (registers the environments)
from elastica_gym.console.bad_input import BadInputError
from elastica_gym.progress import track
from elastica_gym.scripted import scripted_policy
from elastica_gym.viz import Policy, Rollout, Stage, framing, run_rollout
from elastica_gym.viz.frames import animal_of, home, objects, outline, trail

ENVS = {"snake": "elastica_gym/SnakeForward-v1", "octopus": "elastica_gym/OctopusCrawl-v1"}
OUTPUT = Path(__file__).parents[1] / "docs" / "images" / "animals.png"
GAP = 10
"""Height of the white gap between the animals [pixels]"""


def main() -> int:
    """Run an episode of each animal, draw them and write the picture; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    for animal in ENVS:
        parser.add_argument(f"--{animal}-run", type=Path, help=f"folder of the training run whose {animal} to draw")
    parser.add_argument("--seed", type=int, default=1, help="seed of the episodes (default: %(default)s)")
    parser.add_argument("--duration", type=float, default=10.0, help="episode duration [s] (default: %(default)s)")
    parser.add_argument("--moments", type=int, default=3, help="number of times drawn (default: %(default)s)")
    parser.add_argument("--size", type=int, nargs=2, default=(1400, 400), help="width and height of each [pixels]")
    parser.add_argument("--output", type=Path, default=OUTPUT, help="output file (default: %(default)s)")
    options = parser.parse_args()
    if options.moments < 1:
        parser.error(f"--moments must be at least 1, not {options.moments}")
    try:
        strips = []
        for animal, env in track(list(ENVS.items()), "drawing"):
            policy = policy_of(getattr(options, f"{animal}_run"))
            rollout = run_rollout(env, policy, seed=options.seed, duration=options.duration)
            strips.append(draw(rollout, n_moments=options.moments, width=options.size[0], height=options.size[1]))
        options.output.parent.mkdir(parents=True, exist_ok=True)
        between = np.full((GAP, options.size[0], 3), 255, dtype=np.uint8)
        Image.fromarray(np.concatenate([strips[0], between, strips[1]])).save(options.output, optimize=True)
    except (BadInputError, ImportError, OSError, RuntimeError, ValueError) as error:
        print(f"make_picture: {error}", file=sys.stderr)
        return 1
    print(f"wrote {options.output}")
    return 0


def policy_of(run: Path | None) -> Policy:
    """Return the policy of a training run, or the task's scripted one if no run is given."""
    if run is None:
        return lambda observations, env: scripted_policy(env.task)(env)
    from elastica_gym.rl.policies import load_run

    return load_run(run)[0]


def draw(rollout: Rollout, *, n_moments: int, width: int, height: int) -> np.ndarray:
    """Draw the animal at evenly spaced times of the rollout, early ones faded, (height, width, 3) uint8.

    Objects are drawn at their final positions.
    """
    rollout, last = along_x(rollout), len(rollout.step) - 1
    moments = np.linspace(0, last, n_moments).round().astype(int).tolist()
    strengths = np.linspace(0.35, 1.0, n_moments) if n_moments > 1 else np.ones(1)
    camera = framing(np.concatenate([outline(rollout, moments), rollout.head]), width / height, elevation=-42.0)
    things = [objects(rollout, last), *home(rollout, last)]
    with Stage(width=width, height=height, unit=rollout.body_length) as stage:
        empty = stage.draw(things, camera).astype(float)
        picture = overlay(empty, empty, stage.draw([*things, trail(rollout, last)], camera), strength=0.55)
        for moment, strength in zip(moments, strengths, strict=True):
            drawn = stage.draw([*things, animal_of(rollout, moment)], camera)
            picture = overlay(picture, empty, drawn, strength=strength)
    return np.round(picture).astype(np.uint8)


def overlay(picture: np.ndarray, empty: np.ndarray, drawn: np.ndarray, strength: float) -> np.ndarray:
    """Return the picture overlaid with the difference of ``drawn`` from ``empty``, all (height, width, 3)."""
    difference = np.abs(drawn - empty).max(axis=-1, keepdims=True)
    share = strength * np.clip(difference / 40.0, 0.0, 1.0)
    return picture + share * (drawn - picture)


def along_x(rollout: Rollout) -> Rollout:
    """Return a rollout rotated about the vertical so that the animal moves from left to right."""
    centre = rollout.nodes.mean(axis=1)
    way = centre[-1] - centre[0]
    cos, sin = np.array([way[0], way[2]]) / np.hypot(way[0], way[2])
    turn = np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
    origin = centre[0] * [1.0, 0.0, 1.0]
    return replace(
        rollout,
        nodes=(rollout.nodes - origin) @ turn,
        object_centre=(rollout.object_centre - origin) @ turn,
        object_axis=rollout.object_axis @ turn,
        home=None if rollout.home is None else (rollout.home - origin) @ turn,
    )


if __name__ == "__main__":
    sys.exit(main())
