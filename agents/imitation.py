"""Imitation: before it learns from rewards, a network learns to do what the task's scripted policy does.

The data grow by DAgger (Ross, Gordon and Bagnell 2011, "A reduction of imitation learning and structured prediction to
no-regret online learning", algorithm 3.1): the script says what it would do wherever the network has come by itself.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import torch
from torch import Tensor

from agents.vec_env import BatchVecEnv

ROUNDS = 8
"""Rounds in which steps are taken and the network is fitted to all of them so far"""
EPOCHS = 10
"""Passes over the data in each round"""
LAST_EPOCHS = 40
"""Passes over all of them in the end"""
BATCH_SIZE = 512
CRITIC = ("value_net", "mlp_extractor.value_net")
"""Parameters that a policy does not need to act"""
CRITIC_UPDATES = 6
"""First updates after imitation that leave the actor as it is"""
LEARNING_RATES = (1e-3, 1e-4)
"""Of Adam, at the beginning of each round's passes and at their end"""
SATURATED = 1.5
"""What is learned where the script asks for all that a muscle can do: so much that exploring about it still does it"""


def imitate(
    model: Any, adapter: BatchVecEnv, *, steps: int, show: Callable[[float, dict[str, float]], None]
) -> None:
    """Fit the mean actions of a model to those of the scripted policy of its task.

    In the first round the script acts, later it does in every other environment and the model in the rest. The model's
    statistics of observations, if it normalises them, become those of all that has been seen.

    Parameters
    ----------
    model
        A PPO model, which explores as always.
    adapter
        The environments, which are reset and left where they are.
    steps
        Environment steps to take, over all of them.
    show
        Called with the part that is done and, once there is one, the mean square difference from the script.
    """
    optimizer = torch.optim.Adam(model.policy.parameters())
    per_round = max(1, round(steps / (ROUNDS * adapter.num_envs)))
    seen, wanted = [], []
    adapter.seed(model.seed)
    observations = adapter.reset()
    for number in range(ROUNDS):
        for step in range(per_round):
            seen.append(observations)
            scripted = np.clip(adapter.batch.task.scripted_policy(adapter.batch), -1.0, 1.0).astype(np.float32)
            wanted.append(np.where(np.abs(scripted) < 1.0, scripted, SATURATED * scripted))
            adapter.step_async(_played(model, observations, scripted) if number else scripted)
            observations, *_ = adapter.step_wait()
            show((number + step / per_round) / ROUNDS, {})
        if (statistics := model.get_vec_normalize_env()) is not None:
            statistics.obs_rms.update(np.concatenate(seen[-per_round:]))
        data = [torch.as_tensor(each) for each in (_normalized(model, np.concatenate(seen)), np.concatenate(wanted))]
        for rate in np.geomspace(*LEARNING_RATES, EPOCHS if number < ROUNDS - 1 else LAST_EPOCHS):
            optimizer.param_groups[0]["lr"] = rate
            difference = _fit(model.policy, optimizer, *data)
            show((number + 1.0) / ROUNDS, {"mean square difference": difference})


def _played(model: Any, observations: np.ndarray, scripted: np.ndarray) -> np.ndarray:
    """Return what is done: by the script, and in every other environment by the model as it will explore."""
    own, _ = model.predict(_normalized(model, observations))
    return np.where(np.arange(len(own))[:, None] % 2 == 1, own, scripted)


@contextmanager
def critic_alone(policy: Any, first: bool) -> Iterator[None]:
    """Keep the actor as it is, if asked to: what it can do already would be lost to a critic that knows nothing yet."""
    actor = [p for name, p in policy.named_parameters() if not name.startswith(CRITIC)] if first else []
    for parameter in actor:
        parameter.requires_grad_(False)
    try:
        yield
    finally:
        for parameter in actor:
            parameter.requires_grad_(True)


def _normalized(model: Any, observations: np.ndarray) -> np.ndarray:
    statistics = model.get_vec_normalize_env()
    return observations if statistics is None else statistics.normalize_obs(observations)


def _fit(policy: Any, optimizer: torch.optim.Optimizer, observations: Tensor, actions: Tensor) -> float:
    """Pass once over the data, in random order, and return the mean square difference."""
    policy.set_training_mode(True)
    total = 0.0
    for rows in torch.randperm(len(observations)).split(BATCH_SIZE):
        mean = policy.get_distribution(observations[rows]).distribution.mean
        loss = torch.mean((mean - actions[rows]) ** 2)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        total += float(loss.detach()) * len(rows)
    return total / len(observations)
