"""`modules.damping` under its name in 0.2.x."""

from ..modules.damping import Damping

__all__ = ["Damping"]
