"""`modules.forcing` by its name in 0.2.x."""

from ..modules.forcing import Forcing

__all__ = ["Forcing"]
