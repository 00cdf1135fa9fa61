"""Networks of one task for another: the animal is the same, but the other task may have more to see."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.running_mean_std import RunningMeanStd

from .policies import Statistics

KNOWN = 10_000
"""How many observations the statistics stand for where some of them are of another task's, and some of none: few, so
that those of what was not seen before are soon its own"""


def places(before: Sequence[str], now: Sequence[str]) -> list[int]:
    """Return where each observation of one task is among those of another.

    Raises
    ------
    ValueError
        If the other task lacks one of them.
    """
    where = {name: i for i, name in enumerate(now)}
    if absent := [name for name in before if name not in where]:
        raise ValueError(f"observations that are not seen here: {', '.join(absent)}")
    return [where[name] for name in before]


def widened(
    weights: Mapping[str, torch.Tensor], shapes: Mapping[str, torch.Size], where: Sequence[int]
) -> dict[str, torch.Tensor]:
    """Return weights with inputs for more observations: what is new counts for nothing at first.

    Parameters
    ----------
    weights : mapping of str to Tensor
        By name, those of the first layers (m, d).
    shapes : mapping of str to Size
        The shapes that they should have: of the first layers (m, D).
    where : sequence of int
        Where the d observations are among the D.
    """
    wide = dict(weights)
    for name, value in weights.items():
        shape = shapes.get(name, value.shape)
        if value.ndim == 2 and value.shape[1] == len(where) < shape[1]:
            wide[name] = value.new_zeros((len(value), shape[1]))
            wide[name][:, list(where)] = value
    return wide


def statistics(known: Any, n: int, where: Sequence[int]) -> RunningMeanStd:
    """Return statistics of n observations, some of which are known: mean 0 and no variance yet for the others.

    Parameters
    ----------
    known : RunningMeanStd
        Those of d observations.
    n : int
        How many are to be normalised.
    where : sequence of int
        Where the d observations are among the n.
    """
    if len(where) == n:
        return known
    wide = RunningMeanStd(shape=(n,))
    # a variance of one would hide what varies little, such as a commanded speed, for a long time
    wide.var[:] = 0.0
    wide.mean[np.asarray(where)], wide.var[np.asarray(where)] = known.mean, known.var
    wide.count = min(known.count, KNOWN)
    return wide


def counted(known: Statistics, count: int) -> RunningMeanStd:
    """Return the statistics of a pretrained policy as those of so many observations.

    With fewer than there were, they would soon be those of the new task, and the networks see something else.
    """
    counted = RunningMeanStd(shape=known.mean.shape)
    counted.mean, counted.var, counted.count = known.mean.copy(), known.variance.copy(), count
    return counted
