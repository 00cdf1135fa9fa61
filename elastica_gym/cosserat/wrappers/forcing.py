"""`modules.forcing` under its name in 0.2.x."""

from ..modules.forcing import Forcing
from ..not_offered import refuse_names

__all__ = ["Forcing"]

__getattr__ = refuse_names(__name__)
