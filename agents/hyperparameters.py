"""Hyperparameters from the files in ``configs/``, which rl_zoo3 reads as well."""

import ast
import importlib
import inspect
from pathlib import Path
from typing import Any

import yaml

from agents.checks import BadInputError, choose

CONFIGS = Path(__file__).parent.parent / "configs"
ALGORITHMS = ("ppo", "sac")
OWN_KEYS = ("n_envs", "n_timesteps", "normalize", "env_kwargs")
"""Keys of rl_zoo3's format that are not arguments of the algorithm."""

NOT_CONFIGURABLE = {
    *("self", "env", "seed", "verbose", "tensorboard_log", "_init_setup_model"),
    *("action_noise", "device", "replay_buffer_class", "rollout_buffer_class"),
}
"""Arguments of the algorithms that training sets itself, or that are objects and not values."""

SCHEDULES = ("learning_rate", "clip_range", "clip_range_vf")
"""Keys whose value may be ``lin_<start>``: falling linearly from start to zero over the budget."""


def algorithm_class(algo: str) -> Any:
    """Return the class of Stable-Baselines3 called `algo`."""
    import stable_baselines3

    return getattr(stable_baselines3, choose("algorithm", algo, ALGORITHMS).upper())


def valid_keys(algo: str) -> set[str]:
    """Return the keys that a configuration of `algo` may have."""
    arguments = inspect.signature(algorithm_class(algo).__init__).parameters
    return set(arguments) - NOT_CONFIGURABLE | set(OWN_KEYS)


def load(algo: str, env_id: str, *, config: Path | None = None, overrides: dict[str, Any] | None = None) -> dict:
    """Return the hyperparameters of `algo` on `env_id` as they are written, with `overrides` put over them.

    Parameters
    ----------
    algo, env_id
        Which file and which of its keys.
    config
        Another file of the same format.
    overrides
        Values that go before the file's.
    """
    path = config or CONFIGS / f"{choose('algorithm', algo, ALGORITHMS)}.yml"
    try:
        entries = yaml.safe_load(path.read_text())
    except OSError as error:
        raise BadInputError(f"Cannot read the configuration {path}: {error.strerror}") from error
    except yaml.YAMLError as error:
        raise BadInputError(f"The configuration {path} is not YAML: {error}") from error
    # an id may have the module before it that registers it
    name = env_id.rpartition(":")[2]
    entry = entries.get(name, entries.get("default")) if isinstance(entries, dict) else None
    if not isinstance(entry, dict):
        raise BadInputError(f"The configuration {path} has no entry {env_id!r} and none called 'default'.")
    values = {**entry, **(overrides or {})}
    for key in values:
        choose(f"key of the {algo} configuration", key, valid_keys(algo))
    return values


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
    """Return the environment steps to train for that `values` ask for."""
    try:
        # YAML reads 1e6 as a text
        return int(float(values["n_timesteps"]))
    except (KeyError, OverflowError, TypeError, ValueError):
        wrong = values.get("n_timesteps")
        raise BadInputError(f"n_timesteps must be a number of environment steps, got {wrong!r}") from None


def algorithm_arguments(values: dict[str, Any]) -> dict[str, Any]:
    """Return the keyword arguments of the algorithm's class that `values`, as written in a file, stand for."""
    arguments = {key: value for key, value in values.items() if key not in OWN_KEYS}
    for key in SCHEDULES:
        if isinstance(arguments.get(key), str):
            arguments[key] = _schedule(key, arguments[key])
    for key in ("policy_kwargs", "replay_buffer_kwargs", "rollout_buffer_kwargs"):
        if isinstance(arguments.get(key), str):
            arguments[key] = literal(arguments[key])
    if "." in str(arguments.get("policy")):
        arguments["policy"] = policy_class(arguments["policy"])
    if isinstance(arguments.get("train_freq"), list):
        arguments["train_freq"] = tuple(arguments["train_freq"])
    return arguments


def policy_class(name: str) -> Any:
    """Return the class of a policy that is written with its module, as rl_zoo3 has it."""
    module, _, attribute = name.rpartition(".")
    try:
        return getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError) as error:
        raise BadInputError(f"There is no policy {name!r}: {error}") from error


def normalize_arguments(values: dict[str, Any]) -> dict[str, Any] | None:
    """Return the keyword arguments of ``VecNormalize`` that `values` ask for, or None for no normalisation."""
    normalize = values.get("normalize", False)
    if isinstance(normalize, str):
        normalize = literal(normalize)
    if not normalize:
        return None
    return {**(normalize if isinstance(normalize, dict) else {}), "gamma": values.get("gamma", 0.99)}


def _schedule(key: str, text: str) -> Any:
    from stable_baselines3.common.utils import LinearSchedule

    kind, _, number = text.rpartition("_")
    try:
        return LinearSchedule(float(number), 0.0, 1.0) if kind == "lin" else float(text)
    except ValueError:
        raise BadInputError(f"{key} must be a number or 'lin_<number>', got {text!r}") from None


def literal(text: str) -> Any:
    """Read a Python literal that may also have ``dict(...)`` and names from ``torch.nn`` like ``nn.Tanh``.

    rl_zoo3 evaluates such strings; here nothing is run.
    """
    try:
        return _value(ast.parse(text.strip(), mode="eval").body)
    except (SyntaxError, ValueError) as error:
        raise BadInputError(f"Cannot read {text!r}: only literals, dict(...) and nn.<Module> are allowed.") from error


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
