"""The physics of Cosserat rods on arrays, independent of PyElastica and of reinforcement learning.

`Rod`, `Plane`, `Cylinder`, `Contact`, `Joint` and `Wave` describe rods and what acts on them. `build_model` lays them
out in a `Model`, `at_rest` creates a batch of states, and `advance` steps it.
"""

from .builder import at_rest, build_model
from .kernels.step import advance
from .model import Control, Model, State, make_control, make_state
from .rod import Rod, stable_time_step
from .surroundings import Contact, Cylinder, Joint, Plane, Wave

__all__ = [
    "Contact",
    "Control",
    "Cylinder",
    "Joint",
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
