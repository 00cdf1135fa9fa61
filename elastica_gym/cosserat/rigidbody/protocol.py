"""Rigid bodies under their name for annotations in 0.3."""

from .rigid_body import RigidBodyBase

RigidBodyProtocol = RigidBodyBase
