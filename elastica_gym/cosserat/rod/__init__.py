"""Rods: as the environments describe them, and as the documented library does."""

from ...engine.rod import (
    Continuum,
    Rod,
    require_finite,
    require_not_negative,
    require_positive,
    require_stable,
    stable_time_step,
)
from .rod_base import RodBase

__all__ = [
    "Continuum",
    "Rod",
    "RodBase",
    "require_finite",
    "require_not_negative",
    "require_positive",
    "require_stable",
    "stable_time_step",
]
