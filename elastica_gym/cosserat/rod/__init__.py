"""Rods: descriptions used by environments, and the library's `CosseratRod`."""

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
