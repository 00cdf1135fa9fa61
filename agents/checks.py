"""Bad input: what a user may get wrong, told in one line that says how to mend it."""

import difflib
import importlib.util
import os
import sys
from collections.abc import Callable, Collection
from pathlib import Path
from typing import NoReturn

EXTRAS = {
    "train": ("torch", "stable_baselines3", "rich", "tyro", "matplotlib", "yaml"),
    "viz": ("rerun",),
}
"""Modules that each optional dependency group of the package brings."""


class BadInputError(Exception):
    """Something that the user gave cannot be used; the message says what and what would do."""


def choose(what: str, name: str, valid: Collection[str]) -> str:
    """Return `name` if it is one of `valid`, otherwise raise ``BadInputError`` naming the nearest."""
    if name in valid:
        return name
    near = difflib.get_close_matches(name, valid, n=1, cutoff=0.3)
    hint = f"; did you mean {near[0]!r}?" if near else "."
    raise BadInputError(f"Unknown {what} {name!r}{hint} Valid: {', '.join(sorted(valid))}.")


def missing_extra(extra: str) -> str | None:
    """Return what to install for the group `extra`, or None if it is complete."""
    missing = [module for module in EXTRAS[extra] if importlib.util.find_spec(module) is None]
    if not missing:
        return None
    return f"{', '.join(missing)} not installed: pip install 'elastica-gym[{extra}]'"


def require_extra(extra: str) -> None:
    """Raise ``BadInputError`` naming the command that installs what is missing of the group `extra`."""
    if message := missing_extra(extra):
        raise BadInputError(message)


def environment_ids() -> list[str]:
    """Return the ids that elastica_gym registers."""
    import gymnasium

    import elastica_gym  # noqa: F401  registers the environments

    return [env_id for env_id in gymnasium.registry if env_id.startswith("elastica_gym/")]


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
    """Run a command-line program: bad input and failing disks become one line and a status that is not 0."""
    try:
        command()
    except BadInputError as error:
        fail(str(error))
    except OSError as error:
        place = f": {error.filename}" if error.filename else ""
        fail(f"{error.strerror or error}{place}", status=1)
    except KeyboardInterrupt:
        fail("interrupted", status=130)
