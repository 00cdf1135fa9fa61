"""Surfaces that do not move."""

from .plane import Plane
from .surface_base import SurfaceBase

__all__ = ["Plane", "SurfaceBase"]
