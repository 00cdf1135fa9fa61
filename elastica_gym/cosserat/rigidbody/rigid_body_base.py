"""`rigid_body` under its name in 1.0."""

from .rigid_body import RigidBodyBase

__all__ = ["RigidBodyBase"]
