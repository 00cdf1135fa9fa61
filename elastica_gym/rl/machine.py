"""Provenance of results: the machine, package versions and commit they were computed with.

With equal kernels, the same policy and seeds give bit-identical results for any batch size and number of threads. The
physics is compiled for the CPU it runs on, with its instructions and vector width. On another CPU sums are rounded
differently, and contact with friction amplifies this within seconds into different, equally likely episodes. The
networks, too, are computed by libraries that choose instructions by CPU.
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
    """Return everything that determines the bits of a result; serialisable as JSON and YAML.

    Returns
    -------
    dict
        ``cpu``, its model and the physics' compilation target; ``kernels``, a digest of the compiled physics;
        ``commit`` of this repository, or None outside of one; and ``versions``.
    """
    from ..engine.jit.cache import cache_folder

    return {"cpu": cpu(), "kernels": cache_folder().name, "commit": commit(), "versions": versions()}


def cpu() -> str:
    """Return the model of this machine's CPU, and LLVM's name for the compilation target."""
    from llvmlite import binding

    # overrides Numba's target CPU
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
    """Return the commit of this repository, marked "with changes" if files differ, or None outside of one."""
    # an installed package may lie inside another repository
    if Path(_git("rev-parse", "--show-toplevel") or "/").resolve() != ROOT:
        return None
    found = _git("rev-parse", "HEAD")
    return f"{found} with changes" if found and _git("status", "--porcelain", "--untracked-files=no") else found or None


def _git(*command: str) -> str:
    try:
        done = subprocess.run(["git", "-C", str(ROOT), *command], capture_output=True, text=True)
    except OSError:  # git is not installed
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that affect results."""
    found = {"python": platform.python_version()}
    for package in VERSIONS:
        try:
            found[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:  # a clone that is not installed
            continue
    return found
