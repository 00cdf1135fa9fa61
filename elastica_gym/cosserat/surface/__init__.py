"""Surfaces that do not move."""

from .plane import Plane

__all__ = ["Plane"]
