"""The cache of entries' machine code: a folder keyed by everything that determines the code.

The key covers this package's version, the source of all physics, Numba's version and the CPU; within the folder, code
is stamped with the source of its entry's own file. Numba's own cache checks only that file, and would load a stale
entry after a change to a stage in another file.
"""

import functools
import hashlib
import importlib.metadata
import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import llvmlite.binding
import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache

CACHE_VARIABLE = "ELASTICA_GYM_CACHE_DIR"
ENGINE = Path(__file__).parents[1]
# everything that compiled code depends on
SOURCES = ("jit/*.py", "kernels/**/*.py", "model.py", "scene.py")


@functools.cache
def cache_folder() -> Path:
    """Return the folder of compiled kernels for this version, source, Numba and CPU.

    It lies in the folder named by the environment variable ``ELASTICA_GYM_CACHE_DIR``, if set; else
    in the user's cache folder or, if that is not writable, in the temporary folder.
    """
    key = hashlib.sha256()
    for part in (_package_version(), numba.__version__, llvmlite.__version__, sys.version, _cpu()):
        key.update(part.encode() + b"\0")
    for source in sorted(path for pattern in SOURCES for path in ENGINE.glob(pattern)):
        key.update(source.read_bytes())
    name = key.hexdigest()[:20]
    asked = os.environ.get(CACHE_VARIABLE)
    places = [Path(asked)] if asked else [_user_cache() / "elastica_gym", Path(tempfile.gettempdir()) / "elastica_gym"]
    for root in places:
        folder = root / name
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError as error:
            reason = error
        else:
            return folder
    raise OSError(f"cannot write compiled kernels to {folder}: {reason}; set {CACHE_VARIABLE} to a writable folder")


def _user_cache() -> Path:
    """Return the folder that the system has for caches of this user."""
    if chosen := os.environ.get("XDG_CACHE_HOME"):
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    return Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache")


def _package_version() -> str:
    try:
        return importlib.metadata.version("elastica-gym")
    except importlib.metadata.PackageNotFoundError:  # used from a source tree that is not installed
        return "source"


def _cpu() -> str:
    features = llvmlite.binding.get_host_cpu_features().flatten()
    # these two override the CPU that Numba compiles for
    chosen = (os.environ.get("NUMBA_CPU_NAME", ""), os.environ.get("NUMBA_CPU_FEATURES", ""))
    return "\0".join((llvmlite.binding.get_host_cpu_name(), features, *chosen))


class _EntryLocator:
    """Give Numba's cache the folder of an entry, and the source of its own file as its stamp."""

    def __init__(self, py_func: Callable, py_file: str) -> None:
        self._name = py_func.__qualname__
        self._file = Path(py_file)

    @classmethod
    def from_function(cls, py_func: Callable, py_file: str) -> "_EntryLocator":
        return cls(py_func, py_file)

    def ensure_cache_path(self) -> None:
        cache_folder()

    def get_cache_path(self) -> str:
        return str(cache_folder())

    def get_source_stamp(self) -> str:
        return hashlib.sha256(self._file.read_bytes()).hexdigest()

    def get_disambiguator(self) -> str:
        return self._name


class _CacheImpl(CompileResultCacheImpl):
    _locator_classes = [_EntryLocator]  # noqa: RUF012


class EntryCache(FunctionCache):
    """Numba's function cache in our folder, with compilation reported on stderr."""

    _impl_class = _CacheImpl
    _started = 0.0

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return cached code, or announce its compilation."""
        found = super().load_overload(sig, target_context)
        if found is None:
            self._started = time.perf_counter()
            print(
                f"elastica_gym: compiling {self._py_func.__name__} for this machine, once",
                end=" ... ",
                file=sys.stderr,
                flush=True,
            )
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Cache compiled code, and report where."""
        took = f"{time.perf_counter() - self._started:.0f} s"
        try:
            super().save_overload(sig, data)
        except OSError as error:
            print(f"{took}, not kept in {self.cache_path}: {error}", file=sys.stderr, flush=True)
        else:
            print(f"{took}, kept in {self.cache_path}", file=sys.stderr, flush=True)
