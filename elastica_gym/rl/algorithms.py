"""The algorithms of Stable-Baselines3 that can be trained: everything that differs from one to another.

Nothing here imports torch, so that arguments are checked at once.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from .allowed_values import (
    ANY_NUMBER,
    COMMON,
    FRACTION,
    MAPPING,
    NONE,
    NOT_NEGATIVE,
    POSITIVE,
    TRUTH,
    Allowed,
    constant,
    either,
    layers,
    prefixed,
    whole,
)
from .budget import Budget

if TYPE_CHECKING:
    from stable_baselines3.common.callbacks import BaseCallback

SAC_STEPS_PER_ITERATION = 512
"""Environment steps per iteration of SAC, which updates its networks every few steps."""


class Algorithm(NamedTuple):
    """An algorithm."""

    name: str
    """Name of its class in Stable-Baselines3"""
    allowed: dict[str, Allowed]
    """Allowed values of each key of its configuration: every argument of its class, and the keys of this package"""
    net_arch: Allowed
    """Allowed sizes of networks"""
    policy_base: str
    """Base class of its policies, as ``module.Class``"""
    iterate: Callable[[Any, "BaseCallback", Budget], None]
    """Collects experience and updates the networks once or a few times; between two calls nothing is half done"""
    update_columns: tuple[str, ...] = ()
    """Columns of metrics.csv that the first iterations, which may be without an update, do not have"""


def iterate_ppo(model: Any, callback: "BaseCallback", budget: Budget) -> None:
    """Collect ``n_steps`` steps of every environment and update the networks from them."""
    model.collect_rollouts(model.env, callback, model.rollout_buffer, n_rollout_steps=model.n_steps)
    model._current_progress_remaining = 1.0 - budget.fraction(model.num_timesteps)
    model.train()


def iterate_sac(model: Any, callback: "BaseCallback", budget: Budget) -> None:
    """Alternate ``train_freq`` steps and network updates, for `SAC_STEPS_PER_ITERATION` steps."""
    end = model.num_timesteps + SAC_STEPS_PER_ITERATION
    while model.num_timesteps < end:
        collected = model.collect_rollouts(
            model.env,
            callback,
            train_freq=model.train_freq,
            replay_buffer=model.replay_buffer,
            action_noise=model.action_noise,
            learning_starts=model.learning_starts,
            log_interval=None,
        )
        model._current_progress_remaining = 1.0 - budget.fraction(model.num_timesteps)
        updates = model.gradient_steps if model.gradient_steps >= 0 else collected.episode_timesteps
        if model.num_timesteps > model.learning_starts and updates > 0:
            model.train(gradient_steps=updates, batch_size=model.batch_size)


def _train_freq(value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        count, unit = value
        whole(1).read(count)
        constant("step", "episode").read(unit)
        return value
    return whole(1).read(value)


ALGORITHMS = {
    "ppo": Algorithm(
        name="PPO",
        allowed=COMMON
        | {
            "n_epochs": whole(1),
            "gae_lambda": FRACTION,
            "clip_range": either(POSITIVE, prefixed("lin_", POSITIVE)),
            "clip_range_vf": either(POSITIVE, prefixed("lin_", POSITIVE), NONE),
            "normalize_advantage": TRUTH,
            "ent_coef": NOT_NEGATIVE,
            "vf_coef": NOT_NEGATIVE,
            "max_grad_norm": POSITIVE,
            "target_kl": either(POSITIVE, NONE),
            "rollout_buffer_kwargs": MAPPING,
        },
        net_arch=layers(("pi", "vf"), all_needed=False),
        policy_base="stable_baselines3.common.policies.ActorCriticPolicy",
        iterate=iterate_ppo,
    ),
    "sac": Algorithm(
        name="SAC",
        allowed=COMMON
        | {
            "buffer_size": whole(1),
            "learning_starts": whole(0),
            "tau": FRACTION,
            "train_freq": Allowed("a whole number of steps, or [number, step] or [number, episode]", _train_freq),
            "gradient_steps": whole(-1),
            "optimize_memory_usage": TRUTH,
            "ent_coef": either(NOT_NEGATIVE, constant("auto"), prefixed("auto_", POSITIVE)),
            "target_update_interval": whole(1),
            "target_entropy": either(ANY_NUMBER, constant("auto")),
            "use_sde_at_warmup": TRUTH,
            "replay_buffer_kwargs": MAPPING,
        },
        net_arch=layers(("pi", "qf"), all_needed=True),
        policy_base="stable_baselines3.sac.policies.SACPolicy",
        iterate=iterate_sac,
        update_columns=("learning_rate", "n_updates", "ent_coef", "actor_loss", "critic_loss", "ent_coef_loss"),
    ),
}
"""The algorithms by the names that commands and configurations use"""
