"""Muscles: from activations in [-1, 1] to couples along the body.

A body has *arms* (a snake's are its front and rear half). In each of three directions, about the normal, the
binormal and the tangent, an arm carries a hierarchy of Gaussian basis functions: level j has 2^j of them, so
1 + 2 + 4 = 7. Each arm is driven by 3 x 7 = 21 activations, two arms by 42, in the order direction, arm, function:
the top level first, and within a level from the arm's beginning to its end.

A couple acts equally and oppositely on the two elements it joins, so muscles never push or spin the
animal as a whole; they act on the ground only through its shape.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..engine import Rod
from ..engine.model import Array, Index

DIRECTIONS = ("normal", "binormal", "tangent")
LEVELS = (1, 2, 4)
N_FUNCTIONS = sum(LEVELS)
"""Basis functions of an arm in each direction"""
FIT_ITERATIONS = 1000
"""Iterations of the fit of activations to couples; the snake's converges to rounding in 600"""


class Arm(NamedTuple):
    """The place of an arm along a rod."""

    begin: float
    """As a fraction of the rod's length"""
    end: float
    """Likewise; an arm that begins beyond its end runs backwards"""
    rod: int = 0
    """Number of the rod among the body's"""


@dataclass(frozen=True, kw_only=True)
class Muscles:
    """The strength and speed of a body's muscles, and the places of its arms.

    Attributes
    ----------
    magnitudes : dict of str to tuple of float
        Couple at full activation of each level, by direction [N m].
    widths : dict of str to tuple of float
        Width of the Gaussians of each level, by direction, for an arm of length 1.
    arms : dict of str to Arm
        Each arm by its name. A Voronoi point at the end of one arm and the beginning of the next belongs to both.
    activation_time : float
        Time constant with which a muscle's activation follows the commanded one [s].
    """

    magnitudes: dict[str, tuple[float, float, float]]
    widths: dict[str, tuple[float, float, float]]
    arms: dict[str, Arm]
    activation_time: float

    @property
    def n_activations(self) -> int:
        """Number of activations A: 21 per arm."""
        return len(DIRECTIONS) * len(self.arms) * N_FUNCTIONS

    def columns(self, direction: str, arm: str) -> Index:
        """Return the indices in an action of an arm's activations in a direction, (7,); the next arm's follow."""
        first = (DIRECTIONS.index(direction) * len(self.arms) + list(self.arms).index(arm)) * N_FUNCTIONS
        return np.arange(first, first + N_FUNCTIONS)

    @property
    def activation_names(self) -> tuple[str, ...]:
        """Name of each activation, as ``normal/front/1.0``: direction, arm, level and place."""
        return tuple(
            f"{direction}/{arm}/{level}.{i}"
            for direction in DIRECTIONS
            for arm in self.arms
            for level, count in enumerate(LEVELS)
            for i in range(count)
        )


SNAKE = Muscles(
    magnitudes={
        "normal": (2.5e-3, 1.75e-3, 1.25e-3),
        "binormal": (7.5e-4, 5e-4, 2.5e-4),
        "tangent": (5e-4, 3.5e-4, 2e-4),
    },
    widths=dict.fromkeys(DIRECTIONS, (0.40, 0.25, 0.15)),
    arms={"front": Arm(1.0, 0.5), "rear": Arm(0.5, 0.0)},
    activation_time=0.06,
)
"""The snake's muscles: its arms are the front and the rear half, each beginning at the head's side.

Where all three levels act, bending reaches 5.5 mN m, enough to play the published travelling wave of 3.5 mN m along
most of the body. Lifting and twisting muscles are weaker: enough to shift weight from one part of the body to
another, not to throw it off the ground. With equal strength, exploration is mostly thrashing, and learning takes
twice as long."""

OCTOPUS = Muscles(
    magnitudes={"normal": (5.2, 4.16, 3.12), "binormal": (5.2, 4.16, 3.12), "tangent": (3.12, 2.08, 1.04)},
    widths={"normal": (0.40, 0.16, 0.10), "binormal": (0.40, 0.16, 0.10), "tangent": (0.30, 0.24, 0.20)},
    arms={"first": Arm(50.0 / 120.0, 0.0), "second": Arm(70.0 / 120.0, 1.0)},
    activation_time=0.06,
)
"""The octopus's muscles: its arms begin at the head. They have the widths of the 2020 hackathon and 0.52 of its
couples: at full activation in one bending direction, an arm curls by 1.2 turns. Stronger couples would bend it so
tightly that the inside of the bend vanishes."""


def basis(s: Array, widths: tuple[float, float, float]) -> Array:
    """Return the seven Gaussians of an arm, exp(-((s - c)/width)^2), (7, m).

    Parameters
    ----------
    s : Array
        Places along the arm, 0 at its beginning and 1 at its end, (m,). Beyond, the functions are 0.
    widths : tuple of float
        Width of the Gaussians of each level.
    """
    rows = [
        np.exp(-(((s - (i + 0.5) / count) / width) ** 2))
        for count, width in zip(LEVELS, widths, strict=True)
        for i in range(count)
    ]
    # a joint at an arm's border belongs to the arm, despite rounding
    return np.array(rows) * ((s > -1e-9) & (s < 1.0 + 1e-9))


def couple_matrix(muscles: Muscles, rod: Rod, number: int = 0) -> Array:
    """Return the couple at each Voronoi point of a rod for each activation at 1 [N m], (A, 3, n - 1).

    The couples about normal, binormal and tangent are the components along d1, d2 and d3.

    Parameters
    ----------
    muscles : Muscles
    rod : Rod
    number : int
        Its number among the body's rods; arms of other rods cause no couple in it.
    """
    ends = np.cumsum(rod.rest_length)[:-1] / rod.rest_length.sum()
    matrix = np.zeros((len(DIRECTIONS), len(muscles.arms), N_FUNCTIONS, 3, rod.n_elements - 1))
    for d, direction in enumerate(DIRECTIONS):
        strength = np.repeat(muscles.magnitudes[direction], LEVELS)
        for a, arm in enumerate(muscles.arms.values()):
            if arm.rod == number:
                places = (ends - arm.begin) / (arm.end - arm.begin)
                matrix[d, a, :, d] = strength[:, None] * basis(places, muscles.widths[direction])
    return matrix.reshape(muscles.n_activations, 3, rod.n_elements - 1)


def activations_for(couple: Array, matrix: Array, direction: str = "normal") -> Array:
    """Return the activations in [-1, 1] whose couples are closest to wanted profiles.

    Parameters
    ----------
    couple : Array
        Wanted couples about one direction at Voronoi points [N m], (m, n - 1).
    matrix : Array
        The result of `couple_matrix`, (A, 3, n - 1).
    direction : str
        One of `DIRECTIONS`; the activations of the others are zero.

    Returns
    -------
    Array
        (m, A), the least-squares fit within the bounds, by Nesterov's accelerated projected gradient
        (Introductory Lectures on Convex Optimization, 2004, section 2.2.4), for all profiles at once.
    """
    d = DIRECTIONS.index(direction)
    chosen = np.arange(len(matrix)).reshape(len(DIRECTIONS), -1)[d]
    functions = matrix[chosen, d]
    gram, wanted = functions @ functions.T, couple @ functions.T
    least, *_, largest = np.linalg.eigvalsh(gram)
    root = np.sqrt(max(least / largest, 1e-6))
    momentum = (1.0 - root) / (1.0 + root)
    fitted = ahead = np.zeros_like(wanted)
    for _ in range(FIT_ITERATIONS):
        nearer = np.clip(ahead - (ahead @ gram - wanted) / largest, -1.0, 1.0)
        fitted, ahead = nearer, nearer + momentum * (nearer - fitted)
    activations = np.zeros((len(couple), len(matrix)))
    activations[:, chosen] = fitted
    return activations
