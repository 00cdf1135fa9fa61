"""`modules.base_system` under its name in 0.2.x."""

from ..modules.base_system import BaseSystemCollection

__all__ = ["BaseSystemCollection"]
