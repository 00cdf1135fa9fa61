"""The physics of Cosserat rods on arrays, which knows neither PyElastica nor reinforcement learning.

Rods and what surrounds them are described by `Rod`, `Plane`, `Cylinder`, `Contact` and `Wave`. `build_model` lays them
out in a `Model`, `at_rest` gives a batch of states, and `advance` steps it.
"""

from .builder import at_rest, build_model
from .kernels.step import advance
from .model import Control, Model, State, make_control, make_state
from .rod import Rod, stable_time_step
from .surroundings import Contact, Cylinder, Plane, Wave

__all__ = [
    "Contact",
    "Control",
    "Cylinder",
    "Model",
    "Plane",
    "Rod",
    "State",
    "Wave",
    "advance",
    "at_rest",
    "build_model",
    "make_control",
    "make_state",
    "stable_time_step",
]
