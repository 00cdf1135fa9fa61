"""Callbacks, which record systems while a simulation runs."""

import atexit
import os
import pickle
import sys
import tempfile
from collections import defaultdict
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ..files import write_atomically


class CallBackBaseClass:
    """Base class of callbacks; write your own by overriding `make_callback`.

    One with an integer attribute ``every``, ``step_skip`` or ``sample_every`` is called at multiples
    of it, any other after every step; all are also called at ``finalize``, with time 0 and step 0.
    """

    def make_callback(self, system: Any, time: float, current_step: int) -> None:
        """Record a system at ``time`` [s]; ``current_step`` is the number of steps since time 0."""

    def on_close(self) -> None:
        """Finish; ``simulator.close()`` calls it."""


class MyCallBack(CallBackBaseClass):
    """Appends time, step, position, directors and velocity to lists.

    Parameters
    ----------
    step_skip : int
        Steps between samples.
    callback_params : dict
        Dict of lists, such as ``defaultdict(list)``.
    """

    def __init__(self, step_skip: int, callback_params: dict) -> None:
        if step_skip < 1:
            raise ValueError(f"step_skip must be at least 1, not {step_skip}")
        self.sample_every, self.callback_params = step_skip, callback_params

    def make_callback(self, system: Any, time: float, current_step: int) -> None:
        """Append copies of the current state."""
        if current_step % self.sample_every == 0:
            _append(self.callback_params, system, time, current_step)


class ExportCallBack(CallBackBaseClass):
    """Writes time, step, position, directors and velocity to numbered files.

    Each file is written under a temporary name and then moved, so a killed run loses at most the samples
    since the last file. ``simulator.close()`` writes the rest. A file ends before the next multiple of
    ``file_save_interval``: an interval of 100 steps gives files of steps 0 to 99, 100 to 199 and so on.

    Parameters
    ----------
    step_skip : int
        Steps between samples.
    filename : str
        Start of the file names, ``<filename>_<number>.<extension>``.
    directory : str
        Folder, created if missing. If omitted, ``path`` (or ``filename``) includes it.
    method : str
        One of ``AVAILABLE_METHOD``: pickle, npz, or pickle in a temporary folder.
    initial_file_count : int
        Number of the first file.
    file_save_interval : int
        Steps per file; a file is written earlier if its arrays exceed ``FILE_SIZE_CUTOFF`` bytes.
    path : str
        Older alternative to ``directory`` and ``filename``: both in one.
    save_every : int
        Older name of ``file_save_interval``.

    Attributes
    ----------
    save_path : str
        Path of the files, a format string for number and extension.
    file_count : int
        Number of the next file.
    """

    AVAILABLE_METHOD: ClassVar[list[str]] = ["pickle", "npz", "tempfile"]
    FILE_SIZE_CUTOFF = 32_000_000

    def __init__(
        self,
        step_skip: int,
        filename: str | None = None,
        directory: str | None = None,
        method: str | None = None,
        initial_file_count: int = 0,
        file_save_interval: int = 100_000_000,
        *,
        path: str | None = None,
        save_every: float | None = None,
    ) -> None:
        if method is None and directory in self.AVAILABLE_METHOD:
            # older order of arguments: step_skip, path, method
            directory, method = None, directory
        place = path if path is not None else filename
        if place is None:
            raise TypeError("filename is missing")
        if method not in self.AVAILABLE_METHOD:
            raise ValueError(f"method must be one of {self.AVAILABLE_METHOD}, not {method!r}")
        interval = int(file_save_interval if save_every is None else save_every)
        for name, value in (("step_skip", step_skip), ("file_save_interval", interval)):
            if value < 1:
                raise ValueError(f"{name} must be at least 1, not {value}")
        self.step_skip, self.file_save_interval, self.method = step_skip, interval, method
        self.file_count = initial_file_count
        if method == "tempfile":
            directory, place = tempfile.mkdtemp(), Path(place).name
        self.save_path = os.path.join(directory or "", place) + "_{:02d}.{}"
        Path(self.save_path).parent.mkdir(parents=True, exist_ok=True)
        self._extension = "npz" if method == "npz" else "pkl"
        self.buffer: dict[str, list] = defaultdict(list)
        self.buffer_size = 0

    def make_callback(self, system: Any, time: float, current_step: int) -> None:
        """Collect copies of the current state, and write a file when due."""
        if current_step % self.step_skip == 0:
            # called at samples only: the file may have become due since the last one
            since = max(0, current_step - self.step_skip)
            if self.buffer_size and current_step // self.file_save_interval > since // self.file_save_interval:
                self._dump()
            self.buffer_size += _append(self.buffer, system, time, current_step)
        is_due = (current_step + 1) % self.file_save_interval == 0
        if self.buffer_size > self.FILE_SIZE_CUTOFF or (self.buffer_size and is_due):
            self._dump()

    def get_last_saved_path(self) -> str | None:
        """Return the path of the file before the next one, or None if the next has number 0."""
        return None if self.file_count == 0 else self._path(self.file_count - 1)

    def on_close(self) -> None:
        """Write the remaining samples."""
        if self.buffer_size:
            self._dump()

    # names in 0.3
    close = clear = on_close

    def _path(self, number: int) -> str:
        return self.save_path.format(number, self._extension)

    def _dump(self) -> None:
        path = Path(self._path(self.file_count))
        data = {name: np.array(values) for name, values in self.buffer.items()}

        def write(part: Path) -> None:
            with part.open("wb") as file:
                if self.method == "npz":
                    np.savez(file, **data)  # type: ignore[arg-type]
                else:
                    pickle.dump(data, file)

        write_atomically(path, write)
        self.file_count += 1
        self.buffer_size = 0
        self.buffer.clear()


class RerunCallBack(CallBackBaseClass):
    """Records rods and rigid bodies for the rerun viewer: ``rerun <path>`` shows them.

    ``simulator.collect_diagnostics(...)``, with a literal ellipsis, records all systems; a rod or a list of
    rods records only these. The file is written by ``simulator.close()``, or when Python exits.

    Parameters
    ----------
    step_skip : int
        Steps between frames.
    path : str or Path
        Output file, by convention ``*.rrd``.

    Raises
    ------
    ImportError
        If rerun is not installed; the message says how to install it.
    """

    def __init__(self, step_skip: int, path: str | Path) -> None:
        # imported here: optional dependency
        from .recording import SystemRecorder

        if step_skip < 1:
            raise ValueError(f"step_skip must be at least 1, not {step_skip}")
        self.step_skip, self.path = step_skip, Path(path)
        self._recorder = SystemRecorder(self.path.stem)
        self._is_written = True

    def make_callback(self, system: Any, time: float, current_step: int) -> None:
        """Collect the current state."""
        if current_step % self.step_skip:
            return
        systems = tuple(system.values()) if isinstance(system, dict) else system
        self._recorder.capture(systems if isinstance(systems, list | tuple) else (systems,), time, current_step)
        if self._is_written:
            self._is_written = False
            atexit.register(self.on_close)

    def on_close(self) -> None:
        """Write the states collected so far."""
        if not self._is_written:
            self._is_written = True
            atexit.unregister(self.on_close)
            print(f"recorded {self._recorder.write(self.path)}")


def _append(lists: dict, system: Any, time: float, step: int) -> int:
    """Append copies of a system's motion to lists, and return their size in memory in bytes."""
    lists["time"].append(time)
    lists["step"].append(step)
    size = 0
    for name, attribute in (
        ("position", "position_collection"),
        ("directors", "director_collection"),
        ("velocity", "velocity_collection"),
    ):
        values = getattr(system, attribute).copy()
        lists[name].append(values)
        size += sys.getsizeof(values)
    return size
