"""Bodies: geometry, material, muscles and surroundings of an animal, as a Model."""

from .body import Body, Sensors, couples_of
from .grip import Grip, grip
from .octopus import octopus
from .snake import snake

__all__ = ["Body", "Grip", "Sensors", "couples_of", "grip", "octopus", "snake"]
