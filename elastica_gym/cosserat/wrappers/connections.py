"""`modules.connections` by its name in 0.2.x."""

from ..modules.connections import Connections

__all__ = ["Connections"]
