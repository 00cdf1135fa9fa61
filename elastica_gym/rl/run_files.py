"""The tables of a run: one row per update, per evaluation, or per generation of a search."""

import csv
import errno
import io
import os
from pathlib import Path
from typing import Any

import numpy as np

METRICS = "metrics.csv"
EVALUATIONS = "evaluations.csv"
BEST = "best"
"""Folder in a run with the model of the best evaluation; usable like a run"""
TENSORBOARD = "tensorboard"
"""Folder in a run with event files, if they were asked for"""
SEARCH = "search.csv"
GAIT = "gait.yml"
"""The best gait of a search"""


class Table:
    """A CSV file that grows by rows and can be truncated to its size at a checkpoint.

    Parameters
    ----------
    path
        The file.
    size
        Bytes to keep of an existing file; 0 starts a new one.
    """

    def __init__(self, path: Path, *, size: int = 0):
        self._columns: list[str] | None = None
        if size:
            with path.open(newline="") as file:
                self._columns = next(csv.reader(file))
        # unbuffered: on a full disk a row must fail here, and not again in close
        self._file = path.open("r+b" if size else "wb", buffering=0)
        self._file.truncate(size)
        self._file.seek(size)

    def append(self, row: dict[str, Any]) -> None:
        """Write a row; the first row's keys are the columns, later rows may omit some."""
        text = io.StringIO()
        writer = csv.writer(text)
        if self._columns is None:
            self._columns = list(row)
            writer.writerow(self._columns)
        writer.writerow([_text(row.get(column)) for column in self._columns])
        line = text.getvalue().encode()
        if self._file.write(line) != len(line):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), self._file.name)

    @property
    def size(self) -> int:
        """Bytes written so far."""
        return self._file.tell()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str("" if value is None else value)


def read_table(path: Path) -> dict[str, np.ndarray]:
    """Return the columns of a table, with empty cells as NaN; no columns if the file is missing or has no rows."""
    if not path.exists():
        return {}
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        return {}
    return {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}
