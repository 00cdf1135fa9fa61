"""Rods: as the environments describe them, and as the documented library does."""

from .description import (
    Continuum,
    Rod,
    require_finite,
    require_not_negative,
    require_positive,
    require_stable,
    stable_time_step,
)

__all__ = [
    "Continuum", "Rod", "require_finite", "require_not_negative", "require_positive", "require_stable",
    "stable_time_step",
]  # fmt: skip
