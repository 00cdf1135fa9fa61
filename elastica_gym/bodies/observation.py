"""Observations, declared once as named blocks of numbers that define layout, names, bounds and documentation."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np


class Block(NamedTuple):
    """Numbers of an observation that belong together."""

    name: str
    """Name of the block, such as ``position``"""
    parts: tuple[str, ...]
    """Name of each number within the block, such as ``0/forward``; one empty name for a block of a single number"""
    low: float
    """Least value, to which lower ones are clipped"""
    high: float
    """Largest value"""
    unit: str
    """Unit of the numbers, 1 if dimensionless"""
    meaning: str
    """Description of the numbers"""

    @property
    def names(self) -> tuple[str, ...]:
        """Full name of each number, such as ``position/0/forward``."""
        return tuple(f"{self.name}/{part}" if part else self.name for part in self.parts)


AXES = ("forward", "up", "right")
"""Axes of the heading's frame"""


def single(name: str, low: float, high: float, unit: str, meaning: str) -> Block:
    """Return a block of one number."""
    return Block(name, ("",), low, high, unit, meaning)


class Layout:
    """The layout of an observation in blocks.

    Parameters
    ----------
    blocks : sequence of Block
        In the order of the observation.

    Attributes
    ----------
    names : tuple of str
        Name of each number.
    low, high : NDArray
        Least and largest value of each number, (d,) float32.
    """

    def __init__(self, blocks: Sequence[Block]) -> None:
        self.blocks = tuple(blocks)
        self.names = tuple(name for block in self.blocks for name in block.names)
        sizes = [len(block.parts) for block in self.blocks]
        self.low = np.repeat(np.array([block.low for block in self.blocks], dtype=np.float32), sizes)
        self.high = np.repeat(np.array([block.high for block in self.blocks], dtype=np.float32), sizes)
        ends = np.cumsum([0, *sizes]).tolist()
        self._columns = {block.name: slice(*ends[k : k + 2]) for k, block in enumerate(self.blocks)}

    def __getitem__(self, name: str) -> slice:
        """Return the columns of a block.

        Raises
        ------
        KeyError
            If there is no block of that name.
        """
        if name not in self._columns:
            raise KeyError(f"there is no block {name!r}; there are {', '.join(self._columns)}")
        return self._columns[name]

    def __contains__(self, name: str) -> bool:
        return name in self._columns
