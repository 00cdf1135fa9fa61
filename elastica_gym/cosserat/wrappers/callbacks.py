"""`modules.callbacks` by its name in 0.2.x."""

from ..modules.callbacks import CallBacks

__all__ = ["CallBacks"]
