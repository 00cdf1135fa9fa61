"""Progress of long tasks: a bar on a terminal, or a few lines in a log."""

import math
import sys
import time
from collections.abc import Iterator, Sequence
from types import TracebackType
from typing import Self, TextIO, TypeVar

from tqdm import tqdm

PARTS = 10
"""Lines per task in a log, besides the first"""
LONGEST_SILENCE = 300.0
"""Maximum time between lines in a log [s]"""
QUIET = 2.0
"""Time after the first line without further lines in a log [s]"""

Item = TypeVar("Item")


class LogLines:
    """Decides when a log gets a line: at every tenth of the task, and after five minutes without one."""

    def __init__(self) -> None:
        self._begun = self._last = time.monotonic()
        self._passed = 0

    def is_due(self, done: float) -> bool:
        """Return whether the log gets a line at the fraction `done`."""
        now, part = time.monotonic(), math.floor(done * PARTS + 1e-9)
        if now - self._begun < QUIET or (part <= self._passed and now - self._last < LONGEST_SILENCE):
            return False
        self._last, self._passed = now, part
        return True


class Bar:
    """Progress of one task; a context manager.

    On a terminal it is a bar that disappears at the end. Elsewhere it is a line at the beginning and one at every
    tenth, except in the first two seconds.

    Parameters
    ----------
    name
        Name of the task.
    file
        Output stream, by default standard error.
    """

    def __init__(self, name: str, *, file: TextIO | None = None):
        self._name, self._file = name, file or sys.stderr
        self._lines = LogLines()
        self._bar: tqdm | None = None

    def __enter__(self) -> Self:
        if self._file.isatty():
            form = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}{postfix}"
            self._bar = tqdm(total=1.0, desc=self._name, file=self._file, bar_format=form, leave=False)
        else:
            print(f"{self._name} ...", file=self._file, flush=True)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.close()

    def show(self, done: float, numbers: dict[str, float] | None = None) -> None:
        """Show the fraction done and the latest numbers."""
        text = _text(numbers or {})
        if self._bar is not None:
            self._bar.set_postfix_str(text, refresh=False)
            self._bar.update(min(done, 1.0) - self._bar.n)
        elif self._lines.is_due(done):
            print(f"{self._name}: {done:.0%}  {text}".rstrip(), file=self._file, flush=True)

    def say(self, text: str) -> None:
        """Print a line above the bar."""
        tqdm.write(text, file=self._file)
        self._file.flush()


def track(items: Sequence[Item], name: str) -> Iterator[Item]:
    """Yield items and show progress."""
    with Bar(name) as bar:
        for i, item in enumerate(items):
            yield item
            bar.show((i + 1) / len(items))


def _text(numbers: dict[str, float]) -> str:
    return "  ".join(f"{name} {_short(value)}" for name, value in numbers.items() if math.isfinite(value))


def _short(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"
