"""`modules.callbacks` under its name in 0.2.x."""

from ..modules.callbacks import CallBacks
from ..not_offered import refuse_names

__all__ = ["CallBacks"]

__getattr__ = refuse_names(__name__)
