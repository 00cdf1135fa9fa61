"""Imitation: a network learns to act like the task's scripted policy before it learns from rewards.

Data are aggregated by DAgger (Ross, Gordon and Bagnell 2011, "A reduction of imitation learning and structured
prediction to no-regret online learning", algorithm 3.1): the script labels the states that the network visits.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import torch
from torch import Tensor

from ..scripted import scripted_policy
from .rhythm import Rhythms
from .seeds import training_seeds
from .vec_env import BatchVecEnv

ROUNDS = 40
"""Rounds of taking steps and fitting the network to all data so far"""
EPOCHS = 4
"""Passes over the data in each round"""
LAST_EPOCHS = 20
"""Passes over the data in the last round"""
BATCH_SIZE = 512
SCRIPTED = 4
"""The script acts in every `SCRIPTED`-th environment, so that the data include the states it reaches"""
CRITIC = ("value_net", "mlp_extractor.value_net")
"""Parameters that a policy does not need to act"""
CRITIC_UPDATES = 6
"""Number of updates after imitation in which only the critic learns"""
LEARNING_RATES = (1e-3, 1e-4)
"""Of Adam, at the beginning and end of each round's passes"""
GOING_ON = 0.1
"""Factor on these rates for networks already trained on the task, so that the first steps do not undo it"""


def imitate(
    model: Any,
    adapter: BatchVecEnv,
    *,
    steps: int,
    show: Callable[[float, dict[str, float]], None],
    after_round: Callable[[float], bool],
    goes_on: bool = False,
) -> None:
    """Fit the mean actions of a model to those of the scripted policy of its task.

    The script acts alone in the first round; in later rounds it acts in some environments and the model in the others.
    Normalisation statistics, if any, are updated with all observations. A model that continues (`goes_on`) acts from
    the first round, keeps its statistics, and learns more slowly.

    Parameters
    ----------
    model
        A PPO model; its exploration is unchanged.
    adapter
        The environments; they are reset at the start, but not at the end.
    steps
        Environment steps over all environments, rounded to whole batch steps in each round. The model counts them.
    show
        Called regularly with the fraction done and, once known, the mean square difference from the script.
    after_round
        Called with the fraction done; imitation ends if it returns False.
    goes_on
        Whether the model's networks were already trained on this task.
    """
    optimizer = torch.optim.Adam(model.policy.parameters())
    slowness = GOING_ON if goes_on else 1.0
    per_round = max(1, round(steps / (ROUNDS * adapter.num_envs)))
    seen, wanted = [], []
    numbers: dict[str, float] = {}
    adapter.seed(training_seeds(model.seed, 0, adapter.num_envs))
    observations = adapter.reset()
    for number in range(ROUNDS):
        for step in range(per_round):
            scripted = np.clip(scripted_policy(adapter.batch.task)(adapter.batch), -1.0, 1.0).astype(np.float32)
            seen.append(observations)
            wanted.append(scripted)
            adapter.step_async(_played(model, observations, scripted) if number or goes_on else scripted)
            observations, *_ = adapter.step_wait()
            model.num_timesteps += adapter.num_envs
            show((number + step / per_round) / ROUNDS, numbers)
        all_seen = np.concatenate(seen)
        if not goes_on:
            _learn_scale(model, all_seen, n_new=per_round * adapter.num_envs)
        data = [torch.as_tensor(each) for each in (_normalized(model, all_seen), np.concatenate(wanted))]
        for rate in np.geomspace(*LEARNING_RATES, EPOCHS if number < ROUNDS - 1 else LAST_EPOCHS):
            optimizer.param_groups[0]["lr"] = slowness * rate
            numbers = {"mean square difference": _fit(model.policy, optimizer, *data)}
            show((number + 1.0) / ROUNDS, numbers)
        if not after_round((number + 1.0) / ROUNDS):
            return


def _played(model: Any, observations: np.ndarray, scripted: np.ndarray) -> np.ndarray:
    """Return the actions taken: the script's in some environments, the model's in the others."""
    own, _ = model.predict(_normalized(model, observations), deterministic=True)
    return np.where(np.arange(len(own))[:, None] % SCRIPTED == 0, scripted, own)


def _learn_scale(model: Any, seen: np.ndarray, n_new: int) -> None:
    """Fit the scale of observations to all so far, or add the new ones to the existing statistics."""
    statistics, extractor = model.get_vec_normalize_env(), model.policy.features_extractor
    if isinstance(extractor, Rhythms):
        extractor.fit(torch.as_tensor(seen))
    elif statistics is not None and statistics.norm_obs:
        statistics.obs_rms.update(seen[-n_new:])


@contextmanager
def critic_alone(model: Any) -> Iterator[None]:
    """Freeze the actor, so that the untrained critic does not undo imitation, and let the critic learn fast."""
    actor = [p for name, p in model.policy.named_parameters() if not name.startswith(CRITIC)]
    schedule, model.lr_schedule = model.lr_schedule, lambda _: LEARNING_RATES[0]
    for parameter in actor:
        parameter.requires_grad_(False)
    try:
        yield
    finally:
        model.lr_schedule = schedule
        for parameter in actor:
            parameter.requires_grad_(True)


def _normalized(model: Any, observations: np.ndarray) -> np.ndarray:
    statistics = model.get_vec_normalize_env()
    return observations if statistics is None else statistics.normalize_obs(observations)


def _fit(policy: Any, optimizer: torch.optim.Optimizer, observations: Tensor, actions: Tensor) -> float:
    """Run one pass over the data in random order, and return the mean square difference."""
    policy.set_training_mode(True)
    total = 0.0
    for rows in torch.randperm(len(observations)).split(BATCH_SIZE):
        mean = policy.get_distribution(observations[rows]).distribution.mean
        loss = _difference(mean, actions[rows])
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        total += float(loss.detach()) * len(rows)
    return total / len(observations)


def _difference(mean: Tensor, actions: Tensor) -> Tensor:
    """Return the mean square difference, ignoring means beyond a saturated action of the same sign."""
    is_more = (actions.abs() >= 1.0) & (mean * actions > 1.0)
    return torch.mean(torch.where(is_more, 0.0, mean - actions) ** 2)
