"""A mirror-equivariant policy for a mirror-symmetric animal: what it learns on one side applies to the other."""

from typing import Any

import torch
from gymnasium import spaces
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from torch import Tensor, nn

from ..envs.spaces import NamedBox


def named(policy: Any, space: spaces.Space) -> NamedBox:
    """Return a space that names its components, which the policy needs.

    Raises
    ------
    ValueError
        If it has no names, as with a wrapper that changes observations or actions.
    """
    if not isinstance(space, NamedBox):
        raise ValueError(
            f"{type(policy).__name__} needs the spaces of an elastica_gym environment, not {space}: "
            "it does not work through wrappers that change observations or actions"
        )
    return space


class _Image(nn.Module):
    """Maps observations or actions to those of the mirror image."""

    index: Tensor
    sign: Tensor

    def __init__(self, space: NamedBox):
        super().__init__()
        if space.mirror is None:
            raise ValueError("SymmetricPolicy needs a mirror-symmetric animal; this one has no mirror")
        index, sign = space.mirror.image(space.names)
        self.register_buffer("index", torch.as_tensor(index), persistent=False)
        self.register_buffer("sign", torch.as_tensor(sign, dtype=torch.float32), persistent=False)

    def forward(self, values: Tensor) -> Tensor:
        return values[..., self.index] * self.sign


class _BothImages(BaseFeaturesExtractor):
    """Observations and their mirror images, (B, 2, d); later layers process both with the same weights."""

    def __init__(self, observation_space: spaces.Box, image: nn.Module):
        super().__init__(observation_space, features_dim=observation_space.shape[0])
        self.image = image

    def forward(self, observations: Tensor) -> Tensor:
        return torch.stack([observations, self.image(observations)], dim=1)


class _MeanOfImages(nn.Module):
    """The mean of a layer's output and of its mirrored output for the mirror image."""

    def __init__(self, layer: nn.Module, image: nn.Module):
        super().__init__()
        self.layer, self.image = layer, image

    def forward(self, latent: Tensor) -> Tensor:
        answer = self.layer(latent)
        return 0.5 * (answer[:, 0] + self.image(answer[:, 1]))


class SymmetricPolicy(ActorCriticPolicy):
    """Stable-Baselines3's ``MlpPolicy``, made mirror-equivariant: a mirrored observation gives the mirrored action.

    With networks f and v and the mirror M, its mean action is (f(o) + M f(M o)) / 2 and its value (v(o) + v(M o)) / 2:
    the symmetrised layers of van der Pol et al. 2020, "MDP homomorphic networks", for the group of one reflection.
    Names of components and the mirror come from the environment's spaces.
    """

    def __init__(self, observation_space: spaces.Space, action_space: spaces.Space, *args: Any, **kwargs: Any):
        seen, done = (_Image(named(self, space)) for space in (observation_space, action_space))
        kwargs |= {"features_extractor_class": _BothImages, "features_extractor_kwargs": {"image": seen}}
        super().__init__(observation_space, action_space, *args, **kwargs)
        # the optimiser already holds the layers' weights, which stay the same
        self.action_net = _MeanOfImages(self.action_net, done)
        self.value_net = _MeanOfImages(self.value_net, nn.Identity())  # type: ignore[assignment]
