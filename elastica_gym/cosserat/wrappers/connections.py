"""`modules.connections` under its name in 0.2.x."""

from ..modules.connections import Connections
from ..not_offered import refuse_names

__all__ = ["Connections"]

__getattr__ = refuse_names(__name__)
