"""Draw the effect of each of an arm's 21 activations on an octopus.

``python scripts/draw_activations.py`` writes docs/images/activations.png.
"""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import gymnasium
import numpy as np

import elastica_gym  # noqa: F401  registers the environments
from elastica_gym.bodies.muscles import DIRECTIONS, LEVELS, N_FUNCTIONS, OCTOPUS
from elastica_gym.console.bad_input import make_folder, require_extra, run_command

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ENV = "elastica_gym/OctopusReach-v1"
SECONDS = 0.4
EFFECT = {"normal": "bends sideways", "binormal": "lifts", "tangent": "twists"}
COLORS = ("#eb7f26", "#2f7fb8", "#1f7a72")
ARM = "second"
"""The second arm, after the head"""


def main() -> None:
    """Draw the figure and write it."""
    require_extra("train")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = Path(__file__).parents[1] / "docs" / "images" / "activations.png"
    parser.add_argument("--output", type=Path, default=default, help="file of the picture")
    output: Path = parser.parse_args().output
    make_folder(output.parent)
    figure = draw()
    figure.savefig(output, dpi=110)
    print(f"wrote {output}")


def draw() -> "Figure":
    """Return a figure of an octopus at rest, and shortly after each activation of its second arm is set to 1."""
    from matplotlib.figure import Figure

    shapes, rolls = play()
    columns = [(level, i) for level, count in enumerate(LEVELS) for i in range(count)]
    figure = Figure(figsize=(13, 4.6), layout="constrained")
    axes = figure.subplots(len(DIRECTIONS), N_FUNCTIONS)
    for row, (direction, across) in enumerate(zip(DIRECTIONS, (2, 1, None), strict=True)):
        for column, (level, i) in enumerate(columns):
            ax, number = axes[row, column], OCTOPUS.columns(direction, ARM)[column]
            if across is None:
                for which, color in ((0, "0.7"), (1 + number, COLORS[level])):
                    ax.plot(np.degrees(rolls[which] - rolls[0]), color=color)
                ax.set_ylim(-200.0, 200.0)
            else:
                for which, color in ((0, "0.7"), (1 + number, COLORS[level])):
                    along, other = shapes[which, 0], shapes[which, across]
                    ax.plot(along, other, color=color, linewidth=2.5, solid_capstyle="round")
                ax.set_aspect("equal", adjustable="datalim")
            ax.set_xticks([])
            ax.set_yticks([])
            ax.set_title(f"{number}: level {level}.{i}", fontsize=8)
        view = ("from above", "from the side", "angle, tip to tip")[row]
        axes[row, 0].set_ylabel(f"{direction}:\n{EFFECT[direction]}\n({view})", fontsize=8)
    return figure


def play() -> tuple[np.ndarray, np.ndarray]:
    """Return nodes ahead, up and right of the head [m], and element rolls [rad], at rest and for each activation."""
    env = gymnasium.make_vec(ENV, num_envs=1 + OCTOPUS.n_activations, spread="arc")
    batch = env.unwrapped
    batch.reset(seed=[0] * batch.num_envs)  # type: ignore[attr-defined]
    actions = np.concatenate([np.zeros((1, OCTOPUS.n_activations)), np.eye(OCTOPUS.n_activations)])
    for _ in range(round(SECONDS / batch.control_dt)):  # type: ignore[attr-defined]
        batch.step(actions)
    state, pose, body = batch.state, batch.pose, batch.body  # type: ignore[attr-defined]
    first, n = int(body.model.first_slot[0]), int(body.model.n_elements[0])
    x, y, z = (state.x[:, c, first : first + n + 1] - pose.head[:, c, None] for c in range(3))
    hx, hz = pose.heading.T[..., None]
    shapes = np.stack([x * hx + z * hz, y, z * hx - x * hz], axis=1)
    # the roll of the crown's element is that of the head
    up = state.Q[:, :2, 1, first : first + n]
    rolls = np.unwrap(np.arctan2(up[:, 0], up[:, 1]), axis=1)
    env.close()
    return shapes, rolls


if __name__ == "__main__":
    run_command(main)
