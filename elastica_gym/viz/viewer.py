"""Rerun's viewer as a process: the program, and a view that a running training sends to."""

import importlib.util
import os
import subprocess
import sys
import urllib.parse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .recording import APPLICATION_ID, import_rerun, log_rollout
from .rollout import Rollout

LOOPBACK = "127.0.0.1"
QUIET = {"RUST_LOG": "warn", "RERUN_APP_ONLY": "true", "NO_COLOR": "1"}
"""Variables that keep the viewer quiet"""
PATIENCE = 5.0
"""Time that the viewer has to take data or to stop [s]"""


def viewer_program() -> list[str]:
    """Return the command of the rerun installation in this Python environment.

    Raises
    ------
    ImportError
        If rerun is not installed.
    """
    spec = importlib.util.find_spec("rerun_cli")
    if spec is None or spec.origin is None:
        raise ImportError("recordings need rerun: pip install 'elastica-gym[viz]'")
    program = Path(spec.origin).with_name("rerun.exe" if sys.platform == "win32" else "rerun")
    return [str(program)] if program.is_file() else [sys.executable, "-m", "rerun_cli"]


def environment() -> dict[str, str]:
    """Return the environment variables for rerun's program; those that the user has set take precedence."""
    return {**QUIET, **os.environ}


def has_display() -> bool:
    """Return whether there is a display to open a window on."""
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def stop(viewer: subprocess.Popen) -> None:
    """Stop a viewer, by force if it takes too long."""
    viewer.terminate()
    try:
        viewer.wait(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        viewer.kill()
        viewer.wait()


def data_url(port: int) -> str:
    """Return the address that data is sent to."""
    return f"rerun+http://{LOOPBACK}:{port}/proxy"


def page_url(page: int, data: int) -> str:
    """Return the address of the page that shows the data of a port."""
    return f"http://{LOOPBACK}:{page}/?url={urllib.parse.quote(data_url(data), safe='')}"


class LiveView:
    """A viewer that shows curves and episodes while they are made.

    What is sent to a viewer that has been closed is lost; nothing waits for it.

    Parameters
    ----------
    name : str
        Name of the recording with the curves.
    web : bool
        Whether to serve a browser on this machine instead of opening a window.
    page, data : int
        Ports of the page and its data.

    Raises
    ------
    ImportError
        If rerun is not installed.
    """

    def __init__(self, name: str, *, web: bool, page: int = 9090, data: int = 9876) -> None:
        rr = import_rerun()
        ports = ["--bind", LOOPBACK, "--port", str(data)]
        ports += ["--serve-web", "--web-viewer-port", str(page)] if web else []
        self._viewer = subprocess.Popen(
            [*viewer_program(), *ports],
            env=environment(),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        self._data = data
        self.address = page_url(page, data) if web else "a window"
        self._curves = rr.RecordingStream(APPLICATION_ID)
        self._curves.connect_grpc(data_url(data))
        self._curves.send_recording_name(name)

    @property
    def is_open(self) -> bool:
        """Whether the viewer still runs."""
        return self._viewer.poll() is None

    def log_numbers(self, steps: int, numbers: Mapping[str, float]) -> None:
        """Append a point to each curve, by its entity such as ``evaluation/return``."""
        if self.is_open:
            rr = import_rerun()
            self._curves.set_time("training_steps", sequence=steps)
            for entity, value in numbers.items():
                self._curves.log(entity, rr.Scalars(value))

    def log_episode(self, rollout: Rollout, name: str) -> None:
        """Show an episode as a recording of its own."""
        if self.is_open:
            stream: Any = import_rerun().RecordingStream(APPLICATION_ID)
            stream.connect_grpc(data_url(self._data))
            log_rollout(stream, rollout, name)
            stream.flush(timeout_sec=PATIENCE)
            stream.disconnect()

    def close(self) -> None:
        """Send what is left, and stop the viewer."""
        if self.is_open:
            self._curves.flush(timeout_sec=PATIENCE)
        self._curves.disconnect()
        stop(self._viewer)
