"""`modules` under its name in 0.2.x."""

from ..modules import BaseSystemCollection, CallBacks, Connections, Constraints, Contact, Damping, Forcing

__all__ = ["BaseSystemCollection", "CallBacks", "Connections", "Constraints", "Contact", "Damping", "Forcing"]
