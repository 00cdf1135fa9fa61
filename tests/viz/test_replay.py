import os
import re
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

from elastica_gym.viz import write_recording

pytest.importorskip("rerun")

SCRIPT = Path(__file__).parents[2] / "scripts" / "replay.py"


@pytest.fixture(scope="module")
def recording(forward, tmp_path_factory):
    return write_recording(forward, tmp_path_factory.mktemp("replay") / "forward.rrd")


def replay(*arguments):
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    command = [sys.executable, str(SCRIPT), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, env=environment, timeout=120)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def answers(host, port):
    try:
        socket.create_connection((host, port), timeout=1.0).close()
    except OSError:
        return False
    return True


def other_address():
    """This machine's address in the network; the route lookup sends nothing."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("203.0.113.1", 9))
        except OSError:
            return None
        address = probe.getsockname()[0]
    return None if address.startswith("127.") else address


def test_web_serves_only_this_machine_until_interrupted(recording):
    page, data = free_port(), free_port()
    command = [sys.executable, SCRIPT, recording, "--web", "--port", str(page), "--data-port", str(data)]
    script = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        while not (answers("127.0.0.1", page) and answers("127.0.0.1", data)):
            assert script.poll() is None
            time.sleep(0.1)
        with urllib.request.urlopen(f"http://127.0.0.1:{page}/", timeout=60) as answer:
            assert b"<html" in answer.read()
        if other := other_address():
            assert not answers(other, page)
            assert not answers(other, data)
        script.send_signal(signal.SIGINT)
        output, _ = script.communicate()
    finally:
        script.terminate()
    assert script.returncode == 0
    assert re.search(rf"http://127\.0\.0\.1:{page}/\?url=rerun%2Bhttp%3A%2F%2F127\.0\.0\.1%3A{data}%2Fproxy", output)
    assert "Traceback" not in output
    assert not answers("127.0.0.1", page)
    assert not answers("127.0.0.1", data)


STARTING = """
import os, signal, subprocess, sys
from elastica_gym.commands import replay

class Interrupted(subprocess.Popen):
    def _execute_child(self, *args):
        super()._execute_child(*args)
        if "--serve-web" in args[0]:
            print("viewer", self.pid, flush=True)
            os.kill(os.getpid(), signal.SIGINT)

subprocess.Popen = Interrupted
sys.argv = ["replay", {recording!r}, "--web", "--port", "{page}", "--data-port", "{data}"]
replay.main()
"""


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
def test_an_interrupt_while_the_viewer_starts_leaves_no_process_behind(recording):
    """At the worst time: the viewer runs, but the script does not know it yet."""
    code = STARTING.format(recording=str(recording), page=free_port(), data=free_port())
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    viewer = int(re.search(r"viewer (\d+)", done.stdout)[1])
    with pytest.raises(ProcessLookupError):
        os.kill(viewer, 0)
    assert done.stderr == ""


def test_bad_files(recording, tmp_path):
    cut, text = tmp_path / "cut.rrd", tmp_path / "text.rrd"
    cut.write_bytes(recording.read_bytes()[:30_000])
    text.write_text("hello")
    for path, message in (
        (tmp_path / "none.rrd", "there is no file"),
        (tmp_path, "is not a file"),
        (text, "is not a rerun recording"),
        (cut, "is damaged or cut short"),
    ):
        done = replay(path)
        assert done.returncode == 2
        assert message in done.stderr
        assert str(path) in done.stderr
        assert "Traceback" not in done.stderr


def test_a_port_in_use(recording):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        done = replay(recording, "--web", "--port", port)
    assert done.returncode == 2
    assert f"--port {port} cannot be used" in done.stderr


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems have a display")
def test_without_a_display_the_error_suggests_the_browser(recording):
    done = replay(recording)
    assert done.returncode == 2
    assert "--web" in done.stderr
