"""Callbacks: what looks at systems while a simulation runs."""

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

    One with an integer attribute ``every``, ``step_skip`` or ``sample_every`` is called at the multiples
    of it, any other after every step; each at ``finalize`` too, with time 0 and step 0.
    """

    def make_callback(self, system: Any, time: float, current_step: int) -> None:
        """Look at a system: ``time`` is now [s], ``current_step`` the number of steps since time 0."""

    def on_close(self) -> None:
        """Finish; ``simulator.close()`` calls it."""


class MyCallBack(CallBackBaseClass):
    """Appends time, step, position, directors and velocity to lists.

    Parameters
    ----------
    step_skip : int
        Steps from one to the next.
    callback_params : dict
        Of lists, such as ``defaultdict(list)``.
    """

    def __init__(self, step_skip: int, callback_params: dict) -> None:
        if step_skip < 1:
            raise ValueError(f"step_skip must be at least 1, not {step_skip}")
        self.sample_every, self.callback_params = step_skip, callback_params

    def make_callback(self, system: Any, time: float, current_step: int) -> None:
        """Append copies of what is now."""
        if current_step % self.sample_every == 0:
            _append(self.callback_params, system, time, current_step)


class ExportCallBack(CallBackBaseClass):
    """Writes time, step, position, directors and velocity to numbered files.

    Each file is written beside its place and then moved there, so that a run that is killed loses at
    most what was collected since the last one. ``simulator.close()`` writes the rest. A file ends before
    the step that is a multiple of ``file_save_interval``, so that an interval of 100 steps gives samples
    of the steps 0 to 99, 100 to 199 and so on.

    Parameters
    ----------
    step_skip : int
        Steps from one to the next.
    filename : str
        Start of the files' names, ``<filename>_<number>.<extension>``.
    directory : str
        Where to write; made if it is not there. Without it, ``path`` (or ``filename``) holds both.
    method : str
        One of ``AVAILABLE_METHOD``: pickle, npz, or pickle to a temporary folder.
    initial_file_count : int
        Number of the first file.
    file_save_interval : int
        Steps after which a file is written; earlier if its arrays pass ``FILE_SIZE_CUTOFF`` bytes.
    path : str
        The seed's name for directory and name in one.
    save_every : int
        The seed's name for ``file_save_interval``.

    Attributes
    ----------
    save_path : str
        Path of the files, to be formatted with a number and the extension.
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
            # the seed's order of arguments: step_skip, path, method
            directory, method = None, directory
        place = path if path is not None else filename
        if place is None:
            raise TypeError("filename is missing: where to write")
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
        """Collect copies of what is now, and write a file when it is time."""
        if current_step % self.step_skip == 0:
            # called at samples only, and the file may have been due at a step since the last one
            since = max(0, current_step - self.step_skip)
            if self.buffer_size and current_step // self.file_save_interval > since // self.file_save_interval:
                self._dump()
            self.buffer_size += _append(self.buffer, system, time, current_step)
        is_due = (current_step + 1) % self.file_save_interval == 0
        if self.buffer_size > self.FILE_SIZE_CUTOFF or (self.buffer_size and is_due):
            self._dump()

    def get_last_saved_path(self) -> str | None:
        """Return the path of the file before the next one, None if that has the number 0."""
        return None if self.file_count == 0 else self._path(self.file_count - 1)

    def on_close(self) -> None:
        """Write what is left."""
        if self.buffer_size:
            self._dump()

    # by its names in 0.3
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

    ``simulator.collect_diagnostics(...)``, with dots, records all systems; a rod, or a list of some, these.
    The file is written by ``simulator.close()``, or else when Python ends.

    Parameters
    ----------
    step_skip : int
        Steps from one moment of the recording to the next.
    path : str or Path
        Where to write it; by custom it ends in ``.rrd``.

    Raises
    ------
    ImportError
        If rerun is not installed: says how.
    """

    def __init__(self, step_skip: int, path: str | Path) -> None:
        # imported here: the physics does without pictures
        from .recording import SystemRecorder

        if step_skip < 1:
            raise ValueError(f"step_skip must be at least 1, not {step_skip}")
        self.step_skip, self.path = step_skip, Path(path)
        self._recorder = SystemRecorder(self.path.stem)
        self._is_written = True

    def make_callback(self, system: Any, time: float, current_step: int) -> None:
        """Collect what is now."""
        if current_step % self.step_skip:
            return
        systems = tuple(system.values()) if isinstance(system, dict) else system
        self._recorder.capture(systems if isinstance(systems, list | tuple) else (systems,), time, current_step)
        if self._is_written:
            self._is_written = False
            atexit.register(self.on_close)

    def on_close(self) -> None:
        """Write what has been collected so far."""
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
