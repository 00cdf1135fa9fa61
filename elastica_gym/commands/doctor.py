"""What this installation has, and what is missing."""

import dataclasses
import importlib.metadata
import os
import platform

from ..console.bad_input import missing_extra
from . import parse

EXTRAS = {"train": "training with Stable-Baselines3", "viz": "recordings, films and pictures"}


@dataclasses.dataclass
class DoctorArguments:
    """Show versions, compiled kernels, drawing and threads, and how to install what is missing."""


def main() -> None:
    """Run the command line."""
    parse("doctor", DoctorArguments, "")
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    table = Table(show_header=False)
    for name, finding in findings().items():
        table.add_row(name, escape(finding))
    Console().print(table)


def findings() -> dict[str, str]:
    """Return what there is to say, by subject."""
    from ..engine.jit.cache import CACHE_VARIABLE, cache_folder
    from ..engine.threads import available_cpus
    from ..rl import machine
    from ..viz.viewer import has_display

    folder = cache_folder()
    kernels = [path for path in folder.glob("*") if path.is_file()]
    kept = f"{len(kernels)} files, {sum(path.stat().st_size for path in kernels) / 1e6:.1f} MB"
    found = {
        "elastica-gym": importlib.metadata.version("elastica-gym"),
        "commit": machine.commit() or "not a clone",
        "Python": f"{platform.python_version()} on {platform.platform()}",
        **{name: version for name, version in machine.versions().items() if name not in ("python", "elastica-gym")},
        "CPU": machine.cpu(),
        "threads": f"{available_cpus()} of {os.cpu_count()} CPUs",
        "compiled kernels": f"{kept} in {folder}" if kernels else f"none yet; the first step compiles into {folder}",
        "cache folder": f"{CACHE_VARIABLE} {'is' if CACHE_VARIABLE in os.environ else 'is not'} set",
    }
    for extra, purpose in EXTRAS.items():
        found[purpose] = missing_extra(extra) or "installed"
    found["display"] = "yes" if has_display() else "none: play and replay serve a browser"
    found["offscreen drawing"] = _drawing()
    return found


def _drawing() -> str:
    """Return how pictures are drawn, or why they are not."""
    if missing_extra("viz"):
        return "needs what is missing above"
    from ..viz import Stage

    try:
        Stage(width=16, height=16).close()
    except RuntimeError as error:
        return str(error).splitlines()[0]
    return f"works (MUJOCO_GL={os.environ.get('MUJOCO_GL', 'not set')})"
