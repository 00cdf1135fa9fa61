"""A policy that observes clocks of given periods, for strokes that do not match the clock in the observation."""

from typing import Any

import torch
from gymnasium import spaces
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from torch import Tensor

from .symmetry import named

MOST = 10.0
"""Observations are clipped to this many standard deviations from the mean"""
LEAST_DEVIATION = 1e-3
"""Lower bound on the standard deviation of an observation"""


class Rhythms(BaseFeaturesExtractor):
    """Observations with mean 0 and standard deviation 1, and sine and cosine of clocks, (B, d + 2 p).

    Parameters
    ----------
    observation_space : spaces.Box
        Of d observations; not normalised, since the clocks are computed from one of them.
    time_left : int
        Index of the remaining fraction of the episode.
    duration : float
        Duration of episodes [s].
    periods : sequence of float
        Periods of p clocks, which start with the episode [s].
    """

    mean: Tensor
    deviation: Tensor
    rates: Tensor

    def __init__(self, observation_space: spaces.Box, time_left: int, duration: float, periods: tuple[float, ...]):
        width = observation_space.shape[0]
        super().__init__(observation_space, features_dim=width + 2 * len(periods))
        self.time_left = time_left
        self.register_buffer("mean", torch.zeros(width))
        self.register_buffer("deviation", torch.ones(width))
        # not saved: networks may be reused with another episode duration
        self.register_buffer("rates", 2.0 * torch.pi * duration / torch.as_tensor(periods), persistent=False)

    def fit(self, observations: Tensor) -> None:
        """Set mean and standard deviation from observations (n, d)."""
        self.mean.copy_(observations.mean(dim=0))
        self.deviation.copy_(observations.std(dim=0).clamp(min=LEAST_DEVIATION))

    def forward(self, observations: Tensor) -> Tensor:
        """Return the features of observations (B, d)."""
        phases = (1.0 - observations[:, self.time_left, None]) * self.rates
        scaled = ((observations - self.mean) / self.deviation).clamp(-MOST, MOST)
        return torch.cat([scaled, phases.sin(), phases.cos()], dim=1)


class RhythmicPolicy(ActorCriticPolicy):
    """Stable-Baselines3's ``MlpPolicy`` with additional clocks. Imitation fits the scale of its observations.

    Parameters
    ----------
    periods : sequence of float
        Periods of the clocks [s]; by default none.
    """

    def __init__(self, observation_space: spaces.Space, *args: Any, periods: tuple[float, ...] = (), **kwargs: Any):
        space = named(self, observation_space)
        told = {"time_left": space.names.index("time_left"), "duration": space.duration, "periods": periods}
        kwargs |= {"features_extractor_class": Rhythms, "features_extractor_kwargs": told}
        super().__init__(observation_space, *args, **kwargs)
        self.periods = periods

    def _get_constructor_parameters(self) -> dict[str, Any]:
        return {**super()._get_constructor_parameters(), "periods": self.periods}
