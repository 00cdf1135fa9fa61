"""Time stepping: run a simulator to a time."""

from .integration import extend_stepper_interface, integrate

__all__ = ["extend_stepper_interface", "integrate"]
