"""Open a recording of a rollout in the rerun viewer.

``python scripts/replay.py FILE`` opens a window. ``python scripts/replay.py FILE --web`` serves it to a
browser on this machine instead, and to no other: both of its ports are bound to 127.0.0.1.
"""

import argparse
import importlib.util
import os
import signal
import socket
import subprocess
import sys
import threading
import urllib.parse
from pathlib import Path

LOOPBACK = "127.0.0.1"
MAGIC = b"RRF"
ENVIRONMENT = {"RUST_LOG": "warn", "RERUN_APP_ONLY": "true", "NO_COLOR": "1", **os.environ}


def main(arguments: list[str] | None = None) -> int:
    """Open or serve the recording; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("file", type=Path, help="a recording that ends in .rrd")
    parser.add_argument("--web", action="store_true", help="serve it to a browser on this machine")
    parser.add_argument("--port", type=int, default=9090, help="port of the web page (default: %(default)s)")
    parser.add_argument("--data-port", type=int, default=9876, help="port of its data (default: %(default)s)")
    options = parser.parse_args(arguments)
    try:
        check_recording(options.file)
        if options.web:
            return serve(options.file, page=options.port, data=options.data_port)
        return open_window(options.file, options.data_port)
    except ReplayError as error:
        print(f"replay: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("replay: interrupted", file=sys.stderr)
        return 130


class ReplayError(Exception):
    """Something that the user can mend."""


def check_recording(path: Path) -> None:
    """Raise a ReplayError unless there is a whole recording at the path and rerun to open it with."""
    if not path.exists():
        raise ReplayError(f"there is no file {path}")
    if not path.is_file():
        raise ReplayError(f"{path} is not a file; give a recording in it, which ends in .rrd")
    try:
        with path.open("rb") as file:
            begin = file.read(len(MAGIC))
    except OSError as error:
        raise ReplayError(f"cannot read {path}: {error.strerror}") from error
    if begin != MAGIC:
        raise ReplayError(f"{path} is not a rerun recording")
    # in a process of its own, since some damage makes the reader abort
    command = [*viewer_program(), "rrd", "verify", str(path)]
    verdict = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True)
    if verdict.returncode != 0:
        reasons = [line for line in verdict.stderr.splitlines() if line.strip()] or ["rerun cannot read it"]
        raise ReplayError(f"{path} is damaged or cut short: {reasons[0]}")


def open_window(path: Path, port: int) -> int:
    """Open the recording in a window, or in a viewer that is already open; return when it is closed."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise ReplayError(f"there is no display to open a window on; try: python scripts/replay.py {path} --web")
    print(f"opening {path} in a window; the command ends when that is closed", flush=True)
    return run_viewer([str(path), "--bind", LOOPBACK, "--port", str(port)])


def serve(path: Path, *, page: int, data: int) -> int:
    """Serve the recording to browsers on this machine until Ctrl-C."""
    for name, port in (("--port", page), ("--data-port", data)):
        require_free(name, port)
    source = urllib.parse.quote(f"rerun+http://{LOOPBACK}:{data}/proxy", safe="")
    print(f"Open http://{LOOPBACK}:{page}/?url={source}", flush=True)
    print(f"From another machine, first: ssh -L {page}:{LOOPBACK}:{page} -L {data}:{LOOPBACK}:{data} <this machine>")
    print("Ctrl-C stops.", flush=True)
    ports = ["--port", str(data), "--web-viewer-port", str(page)]
    return run_viewer([str(path), "--serve-web", "--bind", LOOPBACK, *ports])


def require_free(name: str, port: int) -> None:
    """Raise a ReplayError if a port cannot be used."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((LOOPBACK, port))
        except (OSError, OverflowError) as error:
            raise ReplayError(f"{name} {port} cannot be used ({error}); choose another") from error


def run_viewer(arguments: list[str]) -> int:
    """Run rerun's program until it ends, or Ctrl-C or another signal ends it.

    From before it starts, signals only set a flag: an exception could arise while the viewer is being started, and
    leave it behind.
    """
    interrupted = threading.Event()
    for name in {"SIGINT", "SIGTERM", "SIGHUP"} & set(dir(signal)):
        signal.signal(getattr(signal, name), lambda *_: interrupted.set())
    # a session of its own: Ctrl-C reaches this script only, which then stops the viewer
    viewer = subprocess.Popen([*viewer_program(), *arguments], env=ENVIRONMENT, start_new_session=True)
    while viewer.poll() is None and not interrupted.wait(timeout=0.2):
        pass
    if not interrupted.is_set():
        return viewer.returncode
    viewer.terminate()
    try:
        viewer.wait(timeout=5)
    except subprocess.TimeoutExpired:
        viewer.kill()
        viewer.wait()
    print("\nstopped", flush=True)
    return 0


def viewer_program() -> list[str]:
    """Return the command that runs rerun's program, of the rerun that this Python has."""
    spec = importlib.util.find_spec("rerun_cli")
    if spec is None or spec.origin is None:
        raise ReplayError("recordings need rerun: pip install 'elastica-gym[viz]'")
    program = Path(spec.origin).with_name("rerun.exe" if sys.platform == "win32" else "rerun")
    return [str(program)] if program.is_file() else [sys.executable, "-m", "rerun_cli"]


if __name__ == "__main__":
    sys.exit(main())
