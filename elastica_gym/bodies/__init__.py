"""Bodies: geometry, material, muscles and surroundings of an animal, as a Model."""

from .body import Body, Senses
from .octopus import octopus
from .snake import snake

__all__ = ["Body", "Senses", "octopus", "snake"]
