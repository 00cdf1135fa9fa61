"""Rigid bodies."""

from .cylinder import Cylinder
from .rigid_body import RigidBodyBase
from .sphere import Sphere

__all__ = ["Cylinder", "RigidBodyBase", "Sphere"]
