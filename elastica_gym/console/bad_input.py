"""Bad input: what a user may get wrong, told in one line that says how to mend it."""

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
    """Something that the user gave cannot be used; the message says what and what would do."""


def choose(what: str, name: str, valid: Collection[str]) -> str:
    """Return `name` if it is one of `valid`, otherwise raise ``BadInputError`` naming them, the nearest first."""
    if name in valid:
        return name
    near = difflib.get_close_matches(name, valid, n=max(1, len(valid)), cutoff=0.3)
    hint = f"; did you mean {near[0]!r}?" if near else "."
    there = [*near, *sorted(set(valid) - set(near))]
    raise BadInputError(f"Unknown {what} {name!r}{hint} Valid: {', '.join(there)}.")


HIGHEST = {"threads": 4096}
"""Of arguments that must not be more wherever they are taken"""


def check_bounds(values: Mapping[str, Any], lowest: Mapping[str, float]) -> None:
    """Raise ``BadInputError`` for the first of `values` out of its bounds; those that are None are not looked at."""
    for key, bound in lowest.items():
        # so written, a NaN is refused
        if (value := values.get(key)) is not None and not value >= bound:
            raise BadInputError(f"{key} must be at least {bound}, got {value}")
        if value is not None and value > (most := HIGHEST.get(key, math.inf)):
            raise BadInputError(f"{key} must be at most {most}, got {value}")


def missing_extra(extra: str) -> str | None:
    """Return what is missing of the group `extra` and which command installs it, or None if it is complete."""
    troubles = []
    for package, lowest in lowest_of(extra).items():
        try:
            installed = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            troubles.append(f"{package} is not installed")
            continue
        if parts(installed) < parts(lowest):
            troubles.append(f"{package} {installed} is older than {lowest}")
    return f"{', '.join(troubles)}: pip install --upgrade 'elastica-gym[{extra}]'" if troubles else None


def require_extra(extra: str) -> None:
    """Raise ``BadInputError`` naming the command that installs what is missing of the group `extra`."""
    if message := missing_extra(extra):
        raise BadInputError(message)


def choose_environment(env_id: str, *, goals: bool = False) -> str:
    """Return `env_id` if it is registered with this package's environments, otherwise raise ``BadInputError``.

    Parameters
    ----------
    env_id
        Before it may stand ``my_module:``, a module that is imported first, as Gymnasium does.
    goals
        Whether it may be one whose observation is a dict with the goal.
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
            f"{name} has observations that are a dict with the goal, which this command does not take: train on it by "
            "hindsight experience replay, as the docstring of elastica_gym.envs.goal shows"
        )
    choose("environment", name, registered_ids() if goals else environment_ids())
    return env_id


def environment_ids() -> list[str]:
    """Return the ids that agents are trained on here: those whose observation is one vector."""
    from ..envs import GoalTask, registered_ids, task_of

    return [env_id for env_id in registered_ids() if not isinstance(task_of(env_id), GoalTask)]


def make_folder(folder: Path) -> Path:
    """Create `folder` if need be and make sure that files can be written into it."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / f".probe-{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise BadInputError(f"Cannot write into the folder {folder}: {error.strerror or error}") from error
    return folder


def fail(message: str, *, status: int = 2) -> NoReturn:
    """Print `message` to standard error and leave with `status`."""
    print(f"error: {message}", file=sys.stderr)
    raise SystemExit(status)


def run_command(command: Callable[[], None]) -> None:
    """Run a command-line program.

    Bad input, failing disks and too little memory become one line and a status that is not 0.
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
