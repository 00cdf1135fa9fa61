"""`modules.constraints` under its name in 0.2.x."""

from ..modules.constraints import Constraints
from ..not_offered import refuse_names

__all__ = ["Constraints"]

__getattr__ = refuse_names(__name__)
