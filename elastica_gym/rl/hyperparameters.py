"""Hyperparameters from ``configs/``, in rl_zoo3's format."""

import ast
import importlib
import inspect
from pathlib import Path
from typing import Any

import yaml

from ..console.bad_input import BadInputError, choose
from ..files import shipped
from .algorithms import ALGORITHMS
from .allowed_values import COMMON, NORMALIZE, policy_allowed, read_mapping, read_value

CONFIGS = shipped("configs")
OWN_KEYS = ("n_envs", "n_timesteps", "normalize", "env_kwargs")
"""Keys of rl_zoo3's format that are not arguments of the algorithm."""

NOT_CONFIGURABLE = {
    *("self", "env", "seed", "verbose", "tensorboard_log", "_init_setup_model"),
    *("action_noise", "device", "replay_buffer_class", "rollout_buffer_class"),
}
"""Arguments of the algorithms that training sets itself, or that are objects rather than values."""

LITERALS = ("normalize", "policy_kwargs", "replay_buffer_kwargs", "rollout_buffer_kwargs")
"""Keys whose value may be a string of Python, such as ``dict(norm_obs=True)``"""

SET_BY_POLICIES = {
    *("self", "args", "kwargs", "observation_space", "action_space", "lr_schedule"),
    *("features_extractor_class", "features_extractor_kwargs", "optimizer_class"),
}
"""Arguments of policies that the algorithm sets, or that are objects rather than values"""

SCHEDULES = ("learning_rate", "clip_range", "clip_range_vf")
"""Keys whose value may be ``lin_<start>``: linear decay from start to zero over the budget."""


def algorithm_class(algo: str) -> Any:
    """Return the Stable-Baselines3 class called `algo`."""
    import stable_baselines3

    return getattr(stable_baselines3, ALGORITHMS[choose("algorithm", algo, ALGORITHMS)].name)


def valid_keys(algo: str) -> set[str]:
    """Return the valid configuration keys of `algo`."""
    arguments = inspect.signature(algorithm_class(algo).__init__).parameters
    return set(arguments) - NOT_CONFIGURABLE | set(OWN_KEYS)


def load(algo: str, env_id: str, *, config: Path | None = None, overrides: dict[str, Any] | None = None) -> dict:
    """Return the hyperparameters of `algo` on `env_id` as written, updated with `overrides`.

    Parameters
    ----------
    algo, env_id
        Select the file and its entry.
    config
        Another file of the same format.
    overrides
        Values that take precedence over the file's.
    """
    path = config or CONFIGS / f"{choose('algorithm', algo, ALGORITHMS)}.yml"
    try:
        entries = yaml.safe_load(path.read_text())
    except OSError as error:
        raise BadInputError(f"Cannot read the configuration {path}: {error.strerror}") from error
    except yaml.YAMLError as error:
        raise BadInputError(f"The configuration {path} is not YAML: {error}") from error
    # an id may be prefixed with the module that registers it
    name = env_id.rpartition(":")[2]
    entry = entries.get(name, entries.get("default")) if isinstance(entries, dict) else None
    if not isinstance(entry, dict):
        raise BadInputError(f"The configuration {path} has no entry {env_id!r} and none called 'default'.")
    return checked(algo, {**entry, **(overrides or {})})


def checked(algo: str, values: dict[str, Any]) -> dict[str, Any]:
    """Return checked hyperparameters of `algo`, with strings such as YAML's 1e-3 converted to numbers.

    Raises
    ------
    BadInputError
        If a key is unknown or a value is not allowed; the message names both and the allowed values.
    """
    allowed = ALGORITHMS[choose("algorithm", algo, ALGORITHMS)].allowed
    kept = {}
    for key, value in values.items():
        rule = allowed[choose(f"key of the {algo} configuration", str(key), valid_keys(algo))]
        if key in LITERALS and isinstance(value, str):
            # kept as written
            read_value(key, literal(value, name=key), rule)
            kept[key] = value
        else:
            kept[key] = read_value(key, value, rule)
    _check_parts(algo, kept)
    return kept


def _check_parts(algo: str, values: dict[str, Any]) -> None:
    """Check the contents of mappings, and conditions on several keys."""
    if "policy" not in values:
        raise BadInputError(f"The {algo} configuration has no policy, such as MlpPolicy.")
    policy = policy_class(algo, values["policy"])
    read_mapping("normalize", _mapping(values, "normalize"), NORMALIZE)
    known = _arguments_of(policy) - SET_BY_POLICIES
    read_mapping("policy_kwargs", _mapping(values, "policy_kwargs"), policy_allowed(ALGORITHMS[algo].net_arch, known))
    frequency = values.get("train_freq")
    if isinstance(frequency, (list, tuple)) and frequency[1] == "episode" and values.get("n_envs", 1) != 1:
        raise BadInputError(f"train_freq must be in steps where n_envs is not 1, got {frequency!r}")


def _mapping(values: dict[str, Any], key: str) -> dict[Any, Any]:
    """Return a value that is a mapping, or a string of one; otherwise an empty mapping."""
    value = values.get(key)
    value = literal(value) if isinstance(value, str) else value
    return value if isinstance(value, dict) else {}


def _arguments_of(cls: type) -> set[str]:
    """Return the names of all constructor arguments of a class and its bases."""
    inits = (vars(base)["__init__"] for base in cls.__mro__ if "__init__" in vars(base) and base is not object)
    return {name for init in inits for name in inspect.signature(init).parameters}


def parse_overrides(assignments: list[str]) -> dict[str, Any]:
    """Turn ``["gamma=0.98", ...]`` into a dictionary; values are read as YAML."""
    overrides = {}
    for assignment in assignments:
        key, separator, value = assignment.partition("=")
        if not separator:
            raise BadInputError(f"Expected KEY=VALUE, got {assignment!r}.")
        try:
            overrides[key] = yaml.safe_load(value)
        except yaml.YAMLError:
            raise BadInputError(f"The value of {key} is not YAML: {value!r}") from None
    return overrides


def timesteps(values: dict[str, Any]) -> int:
    """Return the number of environment steps to train for."""
    return read_value("n_timesteps", values.get("n_timesteps"), COMMON["n_timesteps"])


def algorithm_arguments(values: dict[str, Any]) -> dict[str, Any]:
    """Return the keyword arguments of the algorithm's class, from `values` as written in a file."""
    arguments = {key: value for key, value in values.items() if key not in OWN_KEYS}
    for key in SCHEDULES:
        if isinstance(arguments.get(key), str):
            arguments[key] = _schedule(arguments[key])
    for key in LITERALS:
        if isinstance(arguments.get(key), str):
            arguments[key] = literal(arguments[key])
    if "." in str(arguments.get("policy")):
        arguments["policy"] = _imported(arguments["policy"])
    if isinstance(arguments.get("train_freq"), list):
        arguments["train_freq"] = tuple(arguments["train_freq"])
    return arguments


def policy_class(algo: str, name: str) -> Any:
    """Return the class of a policy: an alias of the algorithm, or ``module.Class``."""
    if "." not in name:
        aliases = algorithm_class(algo).policy_aliases
        return aliases[choose("policy", name, aliases)]
    found, base = _imported(name), _imported(ALGORITHMS[algo].policy_base)
    if not (isinstance(found, type) and issubclass(found, base)):
        raise BadInputError(f"policy must be a subclass of {base.__name__} for {algo}, got {name!r}")
    return found


def _imported(name: str) -> Any:
    """Import ``module.Class``, as rl_zoo3 does."""
    module, _, attribute = name.rpartition(".")
    try:
        return getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, TypeError, ValueError) as error:
        raise BadInputError(f"There is no policy {name!r}: {error}") from error


def normalize_arguments(values: dict[str, Any]) -> dict[str, Any] | None:
    """Return the keyword arguments of ``VecNormalize``, or None for no normalisation."""
    normalize = values.get("normalize", False)
    if isinstance(normalize, str):
        normalize = literal(normalize)
    if not normalize:
        return None
    return {**(normalize if isinstance(normalize, dict) else {}), "gamma": values.get("gamma", 0.99)}


def _schedule(text: str) -> Any:
    from stable_baselines3.common.utils import LinearSchedule

    return LinearSchedule(float(text.removeprefix("lin_")), 0.0, 1.0)


def literal(text: str, *, name: str = "value") -> Any:
    """Parse a Python literal that may contain ``dict(...)`` and names from ``torch.nn`` like ``nn.Tanh``.

    rl_zoo3 evaluates such strings; this does not execute code. Error messages refer to the value as `name`.
    """
    try:
        return _value(ast.parse(text.strip(), mode="eval").body)
    except (RecursionError, SyntaxError, TypeError, ValueError) as error:
        raise BadInputError(
            f"{name} cannot be read: only literals, dict(...) and nn.<Module> are allowed, got {text!r}"
        ) from error


def _value(node: ast.expr) -> Any:
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "dict" and not node.args:
        return {str(keyword.arg): _value(keyword.value) for keyword in node.keywords}
    if isinstance(node, ast.Dict):
        return {_value(key): _value(value) for key, value in zip(node.keys, node.values, strict=True) if key}
    if isinstance(node, ast.List):
        return [_value(item) for item in node.elts]
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "nn":
        from torch import nn

        return getattr(nn, choose("torch.nn module", node.attr, dir(nn)))
    return ast.literal_eval(node)
