"""Checks that installed packages have the versions required by `pyproject.toml`."""

import re
import warnings
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError, requires, version

CHECKED = ("numpy", "numba", "gymnasium")
Version = tuple[int, ...]


def require_versions() -> None:
    """Raise ImportError if a package is older than the supported range, and warn if it is newer.

    Raises
    ------
    ImportError
        Gives the package, its version, the range, and the command that fixes it.
    """
    try:
        ranges = _ranges(requires("elastica-gym") or [])
    except PackageNotFoundError:
        # not installed, run from its folder: requirements unknown
        return
    require_within(ranges, {name: version(name) for name in ranges})


def lowest_of(extra: str) -> dict[str, str]:
    """Return the lowest allowed version of each package of an optional group, such as ``train``.

    Empty if this package is not installed but run from its folder, where requirements are unknown.
    """
    try:
        lines = requires("elastica-gym") or []
    except PackageNotFoundError:
        return {}
    bounds = {name: re.search(r">=\s*([\d.]+)", range_) for name, range_, group in _split(lines) if group == extra}
    return {name: lowest[1] if lowest else "0" for name, lowest in bounds.items()}


def require_within(ranges: Mapping[str, str], installed: Mapping[str, str]) -> None:
    """Raise ImportError or warn about installed versions outside of ranges such as ``>=2.0,<3``."""
    for name, range_ in ranges.items():
        found = parts(installed[name])
        lowest, bound = (re.search(sign + r"\s*([\d.]+)", range_) for sign in (">=", "<"))
        allowed = f"{name}{range_}"
        message = f"elastica_gym works with {allowed}, not {installed[name]}; fix it with: pip install '{allowed}'"
        if lowest and found < parts(lowest[1]):
            raise ImportError(message)
        if bound and found >= parts(bound[1]):
            warnings.warn(f"{message} (or continue untested)", RuntimeWarning, stacklevel=4)


def _ranges(requirements: list[str]) -> dict[str, str]:
    """Return the ranges of the checked packages, from lines such as ``numba<0.69,>=0.62``."""
    return {name: range_ for name, range_, group in _split(requirements) if group is None and name in CHECKED}


def _split(requirements: list[str]) -> Iterator[tuple[str, str, str | None]]:
    """Yield name, range and optional group from lines such as ``torch>=2.3; extra == 'train'``."""
    for line in requirements:
        match = re.fullmatch(r"([\w.-]+)\s*([^;]*)(?:;\s*extra == ['\"](\w+)['\"])?", line)
        if match:
            yield match[1], match[2].strip(), match[3]


def parts(text: str) -> Version:
    """Return 2.4.0rc1 as (2, 4), without trailing zeros, so that 2.0 and 2.0.0 are equal."""
    numbers = [int(part) for part in re.match(r"[\d.]*", text)[0].strip(".").split(".") if part]  # type: ignore[index]
    while numbers and numbers[-1] == 0:
        numbers.pop()
    return tuple(numbers)
