"""`modules.contact` under its name in 0.2.x."""

from ..modules.contact import Contact

__all__ = ["Contact"]
