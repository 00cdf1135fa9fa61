"""Allowed values of hyperparameters, checked before they reach Stable-Baselines3, NumPy or torch."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from ..console.bad_input import BadInputError, choose

MOST = 1_000_000_000
"""Largest integer allowed"""


class Allowed(NamedTuple):
    """The allowed values of a hyperparameter."""

    text: str
    """Completes "must be ..." in error messages"""
    read: Callable[[Any], Any]
    """Converts a value for the algorithm; raises ValueError or TypeError if it is not allowed"""


def read_value(name: str, value: Any, allowed: Allowed) -> Any:
    """Convert a value for the algorithm.

    Raises
    ------
    BadInputError
        If the value is not allowed; the message gives the name, the value, and the allowed values.
    """
    try:
        return allowed.read(value)
    except (OverflowError, TypeError, ValueError):
        raise BadInputError(f"{name} must be {allowed.text}, got {value!r}") from None


def read_mapping(name: str, values: Mapping[Any, Any], allowed: Mapping[str, Allowed]) -> None:
    """Check the keys and values of a hyperparameter that is itself a mapping.

    Raises
    ------
    BadInputError
        If a key is unknown or a value is not allowed.
    """
    for key, value in values.items():
        read_value(f"{key} of {name}", value, allowed[choose(f"key of {name}", str(key), allowed)])


def _as_number(value: Any) -> int | float:
    # YAML reads 1e-3 as a string; to Python, a bool is a number
    number = float(value) if isinstance(value, str) else value
    if isinstance(number, bool) or not isinstance(number, (int, float)):
        raise TypeError
    if not math.isfinite(number):
        raise ValueError
    return number


def number(text: str, holds: Callable[[float], bool]) -> Allowed:
    """Allow numbers for which `holds` is true."""

    def read(value: Any) -> int | float:
        number = _as_number(value)
        if not holds(number):
            raise ValueError
        return number

    return Allowed(text, read)


def whole(lowest: int, *, highest: int = MOST) -> Allowed:
    """Allow integers from `lowest` to `highest`."""

    def read(value: Any) -> int:
        number = _as_number(value)
        if number != int(number) or not lowest <= number <= highest:
            raise ValueError
        return int(number)

    return Allowed(f"a whole number from {lowest} to {highest:,}", read)


def either(*choices: Allowed) -> Allowed:
    """Allow what any of several choices allows."""

    def read(value: Any) -> Any:
        for choice in choices:
            try:
                return choice.read(value)
            except (OverflowError, TypeError, ValueError):
                continue
        raise ValueError

    return Allowed(", or ".join(choice.text for choice in choices), read)


def constant(*values: Any) -> Allowed:
    """Allow a few given values."""

    def read(value: Any) -> Any:
        if not any(value is one or (isinstance(one, str) and value == one) for one in values):
            raise ValueError
        return value

    return Allowed(" or ".join("none (null)" if one is None else repr(one) for one in values), read)


def prefixed(prefix: str, allowed: Allowed) -> Allowed:
    """Allow a string of a prefix and a number, such as ``lin_0.001``."""

    def read(value: Any) -> str:
        if not isinstance(value, str) or not value.startswith(prefix):
            raise ValueError
        allowed.read(value.removeprefix(prefix))
        return value

    return Allowed(f"'{prefix}<number>'", read)


def instance(text: str, *kinds: type) -> Allowed:
    """Allow instances of several types."""

    def read(value: Any) -> Any:
        if not isinstance(value, kinds):
            raise TypeError
        return value

    return Allowed(text, read)


def subclass(text: str, base: type) -> Allowed:
    """Allow subclasses of `base`."""

    def read(value: Any) -> Any:
        if not (isinstance(value, type) and issubclass(value, base)):
            raise TypeError
        return value

    return Allowed(text, read)


def list_of(text: str, item: Allowed) -> Allowed:
    """Allow lists of allowed items."""

    def read(value: Any) -> Any:
        if not isinstance(value, (list, tuple)):
            raise TypeError
        for each in value:
            item.read(each)
        return value

    return Allowed(text, read)


def layers(heads: Sequence[str], *, all_needed: bool) -> Allowed:
    """Allow layer sizes, either one list for all networks or one for each network by name."""
    sizes = list_of("", whole(1, highest=100_000))

    def read(value: Any) -> Any:
        if not isinstance(value, dict):
            return sizes.read(value)
        if not set(value) <= set(heads) or (all_needed and set(value) != set(heads)):
            raise ValueError
        for each in value.values():
            sizes.read(each)
        return value

    return Allowed(f"a list of sizes of layers, or dict({', '.join(f'{head}=[...]' for head in heads)})", read)


NONE = constant(None)
TRUTH = instance("true or false", bool)
FRACTION = number("a number from 0 to 1", lambda x: 0.0 <= x <= 1.0)
POSITIVE = number("a number above 0", lambda x: x > 0.0)
NOT_NEGATIVE = number("a number, 0 or more", lambda x: x >= 0.0)
ANY_NUMBER = number("a finite number", lambda x: True)
MAPPING = either(instance("a mapping such as {key: value}", dict), NONE)
"""A mapping written as a string is parsed first"""


COMMON: dict[str, Allowed] = {
    "policy": instance("a name such as MlpPolicy, or module.Class", str),
    "n_envs": whole(1, highest=4096),
    "n_timesteps": Allowed(f"a number of environment steps from 1 to {MOST:,}", whole(1).read),
    "normalize": either(TRUTH, instance("a mapping such as dict(norm_obs=True)", dict)),
    "env_kwargs": MAPPING,
    "policy_kwargs": MAPPING,
    "learning_rate": either(NOT_NEGATIVE, prefixed("lin_", NOT_NEGATIVE)),
    "n_steps": whole(1),
    "batch_size": whole(1),
    "gamma": FRACTION,
    "use_sde": TRUTH,
    "sde_sample_freq": whole(-1),
    "stats_window_size": whole(1),
}
NORMALIZE: dict[str, Allowed] = {
    "norm_obs": TRUTH,
    "norm_reward": TRUTH,
    "clip_obs": POSITIVE,
    "clip_reward": POSITIVE,
    "epsilon": POSITIVE,
}
"""Keys of ``normalize``, the arguments of ``VecNormalize``"""


def policy_allowed(net_arch: Allowed, known: set[str]) -> dict[str, Allowed]:
    """Return the allowed values of ``policy_kwargs``, for those arguments that are `known` to the policy."""
    from torch import nn

    anything = Allowed("anything", lambda value: value)
    rules = {
        "net_arch": net_arch,
        "activation_fn": subclass("a module of torch such as nn.Tanh", nn.Module),
        "log_std_init": ANY_NUMBER,
        "clip_mean": NOT_NEGATIVE,
        "n_critics": whole(1, highest=100),
        "optimizer_kwargs": MAPPING,
        "periods": list_of("a list of times above 0 [s]", POSITIVE),
        **dict.fromkeys(("ortho_init", "full_std", "use_sde", "use_expln", "squash_output"), TRUTH),
        **dict.fromkeys(("share_features_extractor", "normalize_images"), TRUTH),
    }
    return {name: rules.get(name, anything) for name in known}
