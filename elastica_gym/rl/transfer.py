"""Transfer of networks to another task of the same animal, which may have more observations."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.running_mean_std import RunningMeanStd

from .policies import Statistics

KNOWN = 10_000
"""Maximum sample count of statistics extended with new observations: few, so that those of the new ones adapt soon"""


def places(before: Sequence[str], now: Sequence[str]) -> list[int]:
    """Return the index of each observation of one task among those of another.

    Raises
    ------
    ValueError
        If the other task lacks one.
    """
    where = {name: i for i, name in enumerate(now)}
    if absent := [name for name in before if name not in where]:
        raise ValueError(f"observations missing here: {', '.join(absent)}")
    return [where[name] for name in before]


def widened(
    weights: Mapping[str, torch.Tensor], shapes: Mapping[str, torch.Size], where: Sequence[int]
) -> dict[str, torch.Tensor]:
    """Return weights with inputs for more observations; weights of new inputs are zero.

    Parameters
    ----------
    weights : mapping of str to Tensor
        Weights by name, (m, d) in the first layers.
    shapes : mapping of str to Size
        Target shapes, (m, D) in the first layers.
    where : sequence of int
        Indices of the d observations among the D.
    """
    wide = dict(weights)
    for name, value in weights.items():
        shape = shapes.get(name, value.shape)
        if value.ndim == 2 and value.shape[1] == len(where) < shape[1]:
            wide[name] = value.new_zeros((len(value), shape[1]))
            wide[name][:, list(where)] = value
    return wide


def statistics(known: Any, n: int, where: Sequence[int]) -> RunningMeanStd:
    """Return statistics of n observations, some of them known; the others start with mean 0 and variance 0.

    Parameters
    ----------
    known : RunningMeanStd
        Statistics of d observations.
    n : int
        Number of observations to normalise.
    where : sequence of int
        Indices of the d observations among the n.
    """
    if len(where) == n:
        return known
    wide = RunningMeanStd(shape=(n,))
    # a variance of one would long hide observations that vary little, such as a commanded speed
    wide.var[:] = 0.0
    wide.mean[np.asarray(where)], wide.var[np.asarray(where)] = known.mean, known.var
    wide.count = min(known.count, KNOWN)
    return wide


def counted(known: Statistics, count: int) -> RunningMeanStd:
    """Return the statistics of a pretrained policy with a sample count.

    With a smaller count than in training, they would drift to the new task and change the inputs of the networks.
    """
    counted = RunningMeanStd(shape=known.mean.shape)
    counted.mean, counted.var, counted.count = known.mean.copy(), known.variance.copy(), count
    return counted
