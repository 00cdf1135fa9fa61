"""Bodies: geometry, material, muscles and surroundings of an animal, as a Model."""

from .body import Body, Senses, couples_of
from .grip import Grip, grip
from .octopus import octopus
from .snake import snake

__all__ = ["Body", "Grip", "Senses", "couples_of", "grip", "octopus", "snake"]
