"""Files: those that ship with the package, and atomic writing."""

import os
from collections.abc import Callable
from pathlib import Path


def shipped(name: str) -> Path:
    """Return the folder of files that ship with the package: ``configs``, ``pretrained`` or ``searched``.

    A clone has them beside the package, a wheel inside of it.
    """
    package = Path(__file__).parent
    in_clone = package.parent / {"configs": "configs"}.get(name, f"agents/{name}")
    return in_clone if in_clone.is_dir() and (package.parent / "pyproject.toml").exists() else package / name


def write_atomically(path: Path, write: Callable[[Path], object]) -> None:
    """Write a file under a temporary name in the same folder, sync it to disk, and rename it to ``path``.

    Parameters
    ----------
    path : Path
        Output file, in an existing folder.
    write : callable
        Called with the path to write to.
    """
    temporary = path.with_name(f".writing-{path.name}")
    try:
        write(temporary)
        force_to_disk(temporary)
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def force_to_disk(path: Path) -> None:
    """Sync a file or folder to disk."""
    if os.name == "nt" and path.is_dir():
        # Windows syncs files only
        return
    descriptor = os.open(path, os.O_RDWR if os.name == "nt" else os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
