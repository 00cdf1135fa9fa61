"""Ray: a cluster to connect to, or one of this machine's cores. Nothing is imported from Ray unless asked for."""

import contextlib
import importlib.util
import os
from collections.abc import Iterator

from ..console.bad_input import BadInputError

NEEDS = {
    "ray": "pip install 'elastica-gym[ray]'",
    "optuna": "pip install 'elastica-gym[ray]'",
    "ray.rllib": "RLlib needs Gymnasium 1.2.2, so install it in an environment of its own, as docs/how_to/ray.md shows",
}
"""How to install each package that distributed training needs"""


def require_ray(*packages: str) -> None:
    """Raise ``BadInputError`` with the command that installs the first of `packages` that is missing."""
    for package in packages:
        # of RLlib, only the dependencies can be missing
        probes = ["gymnasium", "tree", "lz4"] if package == "ray.rllib" else [package]
        if any(importlib.util.find_spec(probe) is None for probe in probes):
            raise BadInputError(f"{package} is not installed: {NEEDS[package]}")


def prepare(address: str | None) -> None:
    """Set the environment variables that Ray reads when it is first imported; the argument is that of `connected`."""
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    if address is None:
        # as on Windows and macOS: Ray's servers listen on the loopback interface only
        os.environ["RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER"] = "0"


@contextlib.contextmanager
def connected(address: str | None, *, cores: int | None = None) -> Iterator[None]:
    """Connect to the cluster at `address`; without one, start Ray on this machine, and stop it at the end.

    If the process is connected already, that connection is used and kept.

    Parameters
    ----------
    address : str, optional
        ``host:port`` of a cluster's head node, or ``auto`` on one of its nodes.
    cores : int, optional
        Cores that a local Ray may use; by default those that this process may use.

    Raises
    ------
    BadInputError
        If there is no cluster at `address`.
    """
    prepare(address)
    import ray

    from ..engine.threads import available_cpus

    if ray.is_initialized():
        yield
        return
    # a worker's output is in its run's folder
    quiet = {"log_to_driver": False, "logging_level": "ERROR"}
    try:
        if address is None:
            cpus = available_cpus() if cores is None else cores
            ray.init("local", num_cpus=cpus, include_dashboard=False, **quiet)
        else:
            ray.init(address, **quiet)
    except (ConnectionError, ValueError, RuntimeError) as error:
        raise BadInputError(f"Cannot connect to Ray at {address}: {str(error).partition(chr(10))[0]}") from error
    try:
        yield
    finally:
        ray.shutdown()
