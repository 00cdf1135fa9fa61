"""Bad input, reported to the user in one line that says how to fix it."""

import difflib
import importlib
import importlib.metadata
import math
import os
import sys
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Any, NoReturn

from ..versions import lowest_of, parts


class BadInputError(Exception):
    """Invalid input of the user; the message says what is wrong and what is allowed."""


NEAR = 0.5
"""Similarity from which a name is suggested; 1 is equal"""


def choose(what: str, name: str, valid: Collection[str]) -> str:
    """Return `name` if it is one of `valid`, otherwise raise ``BadInputError`` listing them, the closest first."""
    if name in valid:
        return name
    near = difflib.get_close_matches(name, sorted(valid), n=max(1, len(valid)), cutoff=NEAR)
    hint = f"; did you mean {near[0]!r}?" if near else "."
    there = [*near, *sorted(set(valid) - set(near))]
    raise BadInputError(f"Unknown {what} {name!r}{hint} Valid: {', '.join(there)}.")


HIGHEST = {"threads": 4096}
"""Upper bounds of arguments, for all commands"""


def check_bounds(values: Mapping[str, Any], lowest: Mapping[str, float]) -> None:
    """Raise ``BadInputError`` for the first of `values` out of bounds; None is skipped."""
    for key, bound in lowest.items():
        # this form also rejects NaN
        if (value := values.get(key)) is not None and not value >= bound:
            raise BadInputError(f"{key} must be at least {bound}, got {value}")
        if value is not None and value > (most := HIGHEST.get(key, math.inf)):
            raise BadInputError(f"{key} must be at most {most}, got {value}")


def missing_extra(extra: str) -> str | None:
    """Return which packages of `extra` are missing and the command that installs them, or None if complete."""
    troubles = []
    for package, lowest in lowest_of(extra).items():
        try:
            installed = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            troubles.append(f"{package} is not installed")
            continue
        if parts(installed) < parts(lowest):
            troubles.append(f"{package} {installed} is older than {lowest}")
    return f"{', '.join(troubles)}: pip install 'elastica-gym[{extra}]'" if troubles else None


def require_extra(extra: str) -> None:
    """Raise ``BadInputError`` with the command that installs missing packages of `extra`."""
    if message := missing_extra(extra):
        raise BadInputError(message)


def choose_environment(env_id: str, *, goals: bool = False) -> str:
    """Return `env_id` if it is an environment of `elastica_gym.register`, otherwise raise ``BadInputError``.

    Parameters
    ----------
    env_id
        Optionally with a prefix ``my_module:``, a module that is imported first, as in Gymnasium.
    goals
        Whether goal-conditioned environments, whose observation is a dict, are allowed.
    """
    from ..envs import GoalTask, registered_ids, task_of

    module, _, name = env_id.rpartition(":")
    if module:
        try:
            importlib.import_module(module)
        except ImportError as error:
            raise BadInputError(f"Cannot import the module {module!r} of {env_id!r}: {error}") from error
    if not goals and name in registered_ids() and isinstance(task_of(name), GoalTask):
        raise BadInputError(
            f"{name} has dict observations with a goal, which this command does not support: train on it with "
            "hindsight experience replay, as the docstring of elastica_gym.envs.goal shows"
        )
    choose("environment", name, registered_ids() if goals else environment_ids())
    return env_id


def environment_ids() -> list[str]:
    """Return the ids of environments whose observation is a vector, which the commands can train on."""
    from ..envs import GoalTask, registered_ids, task_of

    return [env_id for env_id in registered_ids() if not isinstance(task_of(env_id), GoalTask)]


def make_folder(folder: Path) -> Path:
    """Create `folder` if necessary and check that it is writable."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / f".probe-{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise BadInputError(f"Cannot write into the folder {folder}: {error.strerror or error}") from error
    return folder


def fail(message: str, *, status: int = 2) -> NoReturn:
    """Print `message` to standard error and exit with `status`."""
    print(f"error: {message}", file=sys.stderr)
    raise SystemExit(status)


def run_command(command: Callable[[], None]) -> None:
    """Run a command-line program.

    Bad input, I/O errors and lack of memory end in one line and a non-zero status.
    """
    try:
        command()
    except BadInputError as error:
        fail(str(error))
    except OSError as error:
        place = f": {error.filename}" if error.filename else ""
        fail(f"{error.strerror or error}{place}", status=1)
    except MemoryError as error:
        fail(f"not enough memory: {error}", status=1)
    except KeyboardInterrupt:
        fail("interrupted", status=130)
