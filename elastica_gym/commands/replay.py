"""Open a recording of an episode in the rerun viewer."""

import dataclasses
import signal
import socket
import subprocess
import threading
from pathlib import Path

import tyro

from ..console.bad_input import BadInputError, require_extra
from ..viz.viewer import LOOPBACK, environment, has_display, page_url, stop, viewer_program
from . import invocation, parse

MAGIC = b"RRF"


@dataclasses.dataclass
class ReplayArguments:
    """Open a recording of an episode in the rerun viewer: in a window, or with --web in a browser on this machine."""

    file: tyro.conf.Positional[Path]
    """A recording, *.rrd."""
    web: bool = False
    """Serve it to browsers on this machine only: both ports are bound to 127.0.0.1."""
    port: int = 9090
    """Port of the web page."""
    data_port: int = 9876
    """Port of its data."""


def main() -> None:
    """Run the command line until the viewer is closed or Ctrl-C."""
    arguments = parse("replay", ReplayArguments, "SnakeForward-v1-seed0.rrd", "SnakeForward-v1-seed0.rrd --web")
    check_recording(arguments.file)
    if arguments.web:
        status = serve(arguments.file, page=arguments.port, data=arguments.data_port)
    else:
        status = open_window(arguments.file, arguments.data_port)
    raise SystemExit(status)


def check_recording(path: Path) -> None:
    """Raise a BadInputError unless the path holds a complete recording and rerun is installed."""
    require_extra("viz")
    if not path.exists():
        raise BadInputError(f"there is no file {path}")
    if not path.is_file():
        raise BadInputError(f"{path} is not a file; give the path of a recording, *.rrd")
    try:
        with path.open("rb") as file:
            begin = file.read(len(MAGIC))
    except OSError as error:
        raise BadInputError(f"cannot read {path}: {error.strerror}") from error
    if begin != MAGIC:
        raise BadInputError(f"{path} is not a rerun recording")
    # in a subprocess, since some damaged files make the reader abort
    command = [*viewer_program(), "rrd", "verify", str(path)]
    verdict = subprocess.run(command, env=environment(), capture_output=True, text=True)
    if verdict.returncode != 0:
        reasons = [line for line in verdict.stderr.splitlines() if line.strip()] or ["rerun cannot read it"]
        raise BadInputError(f"{path} is damaged or cut short: {reasons[0]}")


def open_window(path: Path, port: int) -> int:
    """Open the recording in a window or in an open viewer; return when it is closed."""
    if not has_display():
        raise BadInputError(f"there is no display to open a window on; try: {invocation('replay')} {path} --web")
    print(f"opening {path} in a window; the command exits when it is closed", flush=True)
    return run_viewer([str(path), "--bind", LOOPBACK, "--port", str(port)])


def serve(path: Path, *, page: int, data: int) -> int:
    """Serve the recording to browsers on this machine until Ctrl-C."""
    for name, port in (("--port", page), ("--data-port", data)):
        require_free(name, port)
    print(f"Open {page_url(page, data)}", flush=True)
    print(f"From another machine, first: ssh -L {page}:{LOOPBACK}:{page} -L {data}:{LOOPBACK}:{data} <this machine>")
    print("Ctrl-C stops.", flush=True)
    ports = ["--port", str(data), "--web-viewer-port", str(page)]
    return run_viewer([str(path), "--serve-web", "--bind", LOOPBACK, *ports])


def require_free(name: str, port: int) -> None:
    """Raise a BadInputError if a port is not available."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((LOOPBACK, port))
        except (OSError, OverflowError) as error:
            raise BadInputError(f"{name} {port} cannot be used ({error}); choose another") from error


def run_viewer(arguments: list[str]) -> int:
    """Run rerun's program until it exits or a signal such as Ctrl-C stops it.

    Signals only set a flag, from before the start: an exception during the start could leave the viewer behind.
    """
    interrupted = threading.Event()
    for name in {"SIGINT", "SIGTERM", "SIGHUP"} & set(dir(signal)):
        signal.signal(getattr(signal, name), lambda *_: interrupted.set())
    # a new session: Ctrl-C reaches only this script, which then stops the viewer
    viewer = subprocess.Popen([*viewer_program(), *arguments], env=environment(), start_new_session=True)
    while viewer.poll() is None and not interrupted.wait(timeout=0.2):
        pass
    if not interrupted.is_set():
        return viewer.returncode
    stop(viewer)
    print("\nstopped", flush=True)
    return 0
