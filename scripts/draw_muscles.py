"""Draw the Gaussian basis functions of an animal's 42 muscle activations.

``python scripts/draw_muscles.py`` writes docs/images/muscles.png.
"""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from elastica_gym.bodies import snake
from elastica_gym.bodies.body import Body
from elastica_gym.bodies.muscles import DIRECTIONS, LEVELS, basis
from elastica_gym.console.bad_input import make_folder, require_extra, run_command

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLORS = ("#eb7f26", "#2f7fb8", "#1f7a72")
ABOUT = {"normal": "bends sideways", "binormal": "bends up and down", "tangent": "twists"}


def main() -> None:
    """Draw the figure and write it."""
    require_extra("train")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = Path(__file__).parents[1] / "docs" / "images" / "muscles.png"
    parser.add_argument("--output", type=Path, default=default, help="file of the picture")
    output: Path = parser.parse_args().output
    make_folder(output.parent)
    figure = draw(snake())
    figure.savefig(output, dpi=160)
    print(f"wrote {output}")


def draw(body: Body) -> "Figure":
    """Return a figure of the couple along the body for every activation at 1."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    muscles = body.muscles
    figure = Figure(figsize=(9, 6.2), layout="constrained")
    axes = figure.subplots(len(DIRECTIONS), 1, sharex=True)
    for direction, ax in zip(DIRECTIONS, axes, strict=True):
        strength = 1e3 * np.repeat(muscles.magnitudes[direction], LEVELS)
        for name, (begin, end, _) in muscles.arms.items():
            along = np.linspace(0.0, 1.0, 400)
            draw_arm(ax, begin + along * (end - begin), strength[:, None] * basis(along, muscles.widths[direction]))
            ax.text(
                0.5 * (begin + end),
                0.97,
                f"{name} half",
                transform=ax.get_xaxis_transform(),
                ha="center",
                va="top",
                fontsize=8,
                color="0.45",
            )
        ax.set_title(f"{direction}: {ABOUT[direction]}", loc="left", fontsize=10)
        ax.set_ylabel("couple [mN m]")
        ax.set_ylim(0.0, 1.2 * strength.max())
        ax.axvline(0.5, color="0.75", linewidth=0.8, linestyle=":")
        ax.spines[["top", "right"]].set_visible(False)
    axes[-1].set_xlim(0.0, 1.0)
    axes[-1].set_xlabel("position along the body, from tail (0) to head (1)")
    labels = [f"level {level}: {count} per half" for level, count in enumerate(LEVELS)]
    lines = [Line2D([], [], color=color) for color in COLORS]
    figure.legend(lines, labels, loc="outside upper right", ncols=len(LEVELS), frameon=False, fontsize=9)
    return figure


def draw_arm(ax: "Axes", along: np.ndarray, functions: np.ndarray) -> None:
    """Draw the seven functions (7, m) of an arm at positions (m,) along the body, one colour per level."""
    for color, row in zip(np.repeat(COLORS, LEVELS), functions, strict=True):
        ax.plot(along, row, color=color, linewidth=1.4)
        ax.fill_between(along, row, color=color, alpha=0.10, linewidth=0)


if __name__ == "__main__":
    run_command(main)
