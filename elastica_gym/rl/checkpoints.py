"""Checkpoints that survive a killed process: written atomically and verified before use.

A checkpoint is a folder ``<steps>`` with files and ``checksums.json``. It is written under a temporary name, synced to
disk and renamed, so that a process that dies in between leaves the previous checkpoint intact.
"""

import hashlib
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

from ..files import force_to_disk

CHECKSUMS = "checksums.json"
KEPT = 2
"""Checkpoints to keep: one more than needed, in case the last is damaged."""


def write_checkpoint(checkpoints: Path, steps: int, write_files: Callable[[Path], object]) -> Path:
    """Write a checkpoint and delete old ones.

    Parameters
    ----------
    checkpoints
        Folder of the checkpoints; created if missing.
    steps
        Environment steps so far; they name the checkpoint.
    write_files
        Called with a folder; writes the checkpoint's files there.

    Raises
    ------
    OSError
        If writing fails; earlier checkpoints are then left unchanged.
    """
    checkpoints.mkdir(parents=True, exist_ok=True)
    final, temporary = checkpoints / f"{steps:012d}", checkpoints / f".writing-{os.getpid()}"
    for abandoned in checkpoints.glob(".writing-*"):
        shutil.rmtree(abandoned)
    try:
        temporary.mkdir()
        write_files(temporary)
        sums = {path.name: _checksum(path) for path in sorted(temporary.iterdir())}
        (temporary / CHECKSUMS).write_text(json.dumps(sums, indent=2))
        for path in [*temporary.iterdir(), temporary]:
            force_to_disk(path)
        if final.exists():
            shutil.rmtree(final)
        temporary.rename(final)
        force_to_disk(checkpoints)
    except BaseException:
        shutil.rmtree(temporary, ignore_errors=True)
        raise
    for old in checkpoint_folders(checkpoints)[:-KEPT]:
        shutil.rmtree(old)
    return final


def checkpoint_folders(checkpoints: Path) -> list[Path]:
    """Return all checkpoints, including damaged ones, oldest first."""
    return sorted(path for path in checkpoints.glob("[0-9]*") if path.is_dir())


def last_whole_checkpoint(checkpoints: Path, *, tell: Callable[[str], None] = print) -> Path | None:
    """Return the newest checkpoint with valid checksums; report newer, damaged ones through `tell`."""
    for folder in reversed(checkpoint_folders(checkpoints)):
        damage = find_damage(folder)
        if damage is None:
            return folder
        tell(f"The checkpoint {folder} is damaged ({damage}); trying the one before.")
    return None


def find_damage(folder: Path) -> str | None:
    """Return how a checkpoint is damaged, or None if it is intact."""
    try:
        sums = json.loads((folder / CHECKSUMS).read_text())
        for name, checksum in sums.items():
            if _checksum(folder / name) != checksum:
                return f"{name} has another checksum"
    except OSError as error:
        return f"{error.strerror}: {error.filename}"
    except (ValueError, AttributeError):
        return f"{CHECKSUMS} is not readable"
    return None


def _checksum(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
