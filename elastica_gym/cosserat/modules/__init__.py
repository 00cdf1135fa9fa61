"""Parts of a simulator: its class inherits `BaseSystemCollection` and the features it uses."""

from .base_system import BaseSystemCollection
from .callbacks import CallBacks
from .connections import Connections
from .constraints import Constraints
from .contact import Contact
from .damping import Damping
from .forcing import Forcing

__all__ = ["BaseSystemCollection", "CallBacks", "Connections", "Constraints", "Contact", "Damping", "Forcing"]
