"""Cosserat rods: the physics, which knows nothing of reinforcement learning."""

from .assembly import at_rest, build_model
from .kernels.step import advance
from .model import Control, Model, State, make_control, make_state
from .rod import Rod, stable_time_step
from .surroundings import Contact, Cylinder, Plane, Wave

__all__ = [
    "Contact", "Control", "Cylinder", "Model", "Plane", "Rod", "State", "Wave",
    "advance", "at_rest", "build_model", "make_control", "make_state", "stable_time_step",
]  # fmt: skip
