"""`modules.constraints` by its name in 0.2.x."""

from ..modules.constraints import Constraints

__all__ = ["Constraints"]
