"""Where numbers come from: the machine, the versions and the commit that they were computed with.

The same policy and seeds give the same bits, whatever the batch and the number of threads, where the kernels are the
same: the physics is compiled for the CPU it runs on, with the instructions and vectors that this CPU has. On another
CPU sums are rounded otherwise, and contact with friction amplifies that within seconds to other episodes, as likely as
these. The networks, too, are computed by libraries that choose their instructions by the CPU.
"""

import importlib.metadata
import os
import platform
import subprocess
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
VERSIONS = ("elastica-gym", "stable-baselines3", "torch", "numpy", "numba", "gymnasium")


def describe() -> dict[str, Any]:
    """Return what decides the bits of a result, ready for JSON and YAML.

    Returns
    -------
    dict
        ``cpu``, its model and the one that the physics is compiled for; ``kernels``, a digest that is equal where the
        compiled physics is; ``commit`` of this repository, or None outside of one; and ``versions``.
    """
    from ..engine.jit.cache import cache_folder

    return {"cpu": cpu(), "kernels": cache_folder().name, "commit": commit(), "versions": versions()}


def cpu() -> str:
    """Return the model of this machine's CPU, and the name by which LLVM knows what it compiles for."""
    from llvmlite import binding

    # which Numba compiles for instead if it is set
    chosen = os.environ.get("NUMBA_CPU_NAME")
    return f"{_model()}, compiled for {chosen or binding.get_host_cpu_name()}"


def _model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:  # not Linux
        lines = []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()


def commit() -> str | None:
    """Return the commit of this repository, with "with changes" where files differ from it, or None outside of one."""
    # a package that is installed may lie inside of another repository
    if Path(_git("rev-parse", "--show-toplevel") or "/").resolve() != ROOT:
        return None
    found = _git("rev-parse", "HEAD")
    return f"{found} with changes" if found and _git("status", "--porcelain", "--untracked-files=no") else found or None


def _git(*command: str) -> str:
    try:
        done = subprocess.run(["git", "-C", str(ROOT), *command], capture_output=True, text=True)
    except OSError:  # there is no git
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that decide results."""
    found = {"python": platform.python_version()}
    for package in VERSIONS:
        try:
            found[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:  # a bare clone that was not installed
            continue
    return found
