"""Save a simulation and resume it later, bit for bit."""

import json
import os
from collections.abc import Iterable
from itertools import groupby, islice
from pathlib import Path
from typing import Any

import numpy as np

META = "meta.json"


def all_equal(iterable: Iterable[Any]) -> bool:
    """Return whether all elements of an iterable are equal."""
    return len(list(islice(groupby(iterable), 2))) < 2


def save_state(
    simulator: Any, directory: str | os.PathLike = "saved", time: float = 0.0, verbose: bool = False
) -> None:
    """Write motion and material of all systems to a folder, one file each.

    Parameters
    ----------
    simulator : BaseSystemCollection
        Finalized.
    directory : path
        Created if missing.
    time : float
        Time to store [s].
    verbose : bool
        Whether to print a message.
    """
    folder = Path(directory)
    folder.mkdir(parents=True, exist_ok=True)
    for path, system in _files(simulator, folder):
        np.savez(path, **system._fields)
    steps = simulator.simulation.steps
    (folder / META).write_text(json.dumps({"time": float(time), "steps": steps}))
    if verbose:
        print(f"saved {len(list(_files(simulator, folder)))} systems at {time} s to {folder}")


def load_state(simulator: Any, directory: str | os.PathLike = "saved", verbose: bool = False) -> float:
    """Load files of `save_state` into a finalized simulator with the same systems, and return the time [s].

    Raises
    ------
    FileNotFoundError
        If a system has no file.
    ValueError
        If a file belongs to a system of another size.
    """
    folder = Path(directory)
    meta = json.loads((folder / META).read_text())
    for path, system in _files(simulator, folder):
        with np.load(path) as data:
            for name in system._fields:
                if data[name].shape != system._fields[name].shape:
                    raise ValueError(
                        f"{path} holds {name} of shape {data[name].shape}, "
                        f"the simulator's is {system._fields[name].shape}"
                    )
                system._fields[name][...] = data[name]
    # part of the state: directors are corrected every so many steps
    simulator.simulation.steps = meta["steps"]
    if verbose:
        print(f"loaded {folder} at {meta['time']} s")
    return float(meta["time"])


def _files(simulator: Any, folder: Path) -> list[tuple[Path, Any]]:
    return [
        (folder / f"{type(system).__name__}_{number}.npz", system)
        for number, system in enumerate(simulator.systems())
        if hasattr(system, "_fields")
    ]
