"""Time steppers and integration of a simulator."""

from tqdm import tqdm

from .integration import extend_stepper_interface, integrate
from .symplectic_steppers import PEFRL, PositionVerlet

__all__ = ["PEFRL", "PositionVerlet", "extend_stepper_interface", "integrate", "tqdm"]
