"""Take a picture of rerun's viewer in headless Chromium: ``python scripts/screenshot_viewer.py FILE.rrd``.

Needs ``pip install playwright`` and Chromium (Debian: ``apt-get install chromium``). Without a GPU the viewer draws in
software, which takes up to a minute to start.
"""

import dataclasses
import shutil
import subprocess
import sys
import time
from pathlib import Path

import tyro

from elastica_gym.console.bad_input import BadInputError, make_folder, run_command

FLAGS = (
    *("--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync"),
    *("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"),
)
PROGRAMS = ("chromium", "chromium-browser", "google-chrome")


@dataclasses.dataclass
class ScreenshotArguments:
    """Open a recording in the browser's viewer and write what it shows."""

    file: tyro.conf.Positional[Path]
    """A recording, *.rrd."""
    out: Path = Path("viewer.png")
    """PNG file to write."""
    wait: float = 30.0
    """Time from opening the page to the picture [s]."""
    size: tuple[int, int] = (1280, 760)
    """Width and height of the page [pixels]."""
    port: int = 9191
    """Port of the page."""
    data_port: int = 9977
    """Port of its data."""


def main() -> None:
    """Run the command line."""
    arguments = tyro.cli(ScreenshotArguments)
    program = browser()
    make_folder(arguments.out.parent)
    ports = ["--port", str(arguments.port), "--data-port", str(arguments.data_port)]
    command = [sys.executable, "-m", "elastica_gym.commands", "replay", str(arguments.file), "--web", *ports]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        first = server.stdout.readline()
        if not first.startswith("Open http"):
            raise BadInputError(f"the viewer does not start: {first.strip()}")
        take(program, first.split()[1], arguments)
    finally:
        server.terminate()
        server.wait()
    print(f"wrote {arguments.out}")


def browser() -> str:
    """Return the path of a Chromium.

    Raises
    ------
    BadInputError
        If there is none, or no Playwright to drive it.
    """
    try:
        import playwright  # noqa: F401
    except ImportError as error:
        raise BadInputError("playwright is not installed: pip install playwright") from error
    for name in PROGRAMS:
        if found := shutil.which(name):
            return found
    raise BadInputError("there is no Chromium: on Debian, apt-get install chromium")


def take(program: str, url: str, arguments: ScreenshotArguments) -> None:
    """Open a page and write a picture of it."""
    from playwright.sync_api import sync_playwright

    width, height = arguments.size
    with sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=program, args=list(FLAGS))
        page = chromium.new_page(viewport={"width": width, "height": height})
        page.goto(url)
        time.sleep(arguments.wait)
        page.screenshot(path=arguments.out, timeout=300_000)
        chromium.close()


if __name__ == "__main__":
    run_command(main)
