"""Time stepping: run a simulator to a time."""

from typing import Any

from .integration import extend_stepper_interface, integrate
from .symplectic_steppers import PEFRL, PositionVerlet

__all__ = ["PEFRL", "PositionVerlet", "extend_stepper_interface", "integrate"]


def __getattr__(name: str) -> Any:
    # scripts import it from here, though this library shows progress by itself
    if name == "tqdm":
        try:
            from tqdm import tqdm
        except ImportError as error:
            raise ImportError("tqdm is not installed: pip install tqdm") from error
        return tqdm
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
