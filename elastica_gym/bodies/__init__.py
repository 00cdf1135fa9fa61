"""Bodies: geometry, material, muscles and surroundings of an animal, as a Model."""

from .body import Body, Senses
from .snake import snake

__all__ = ["Body", "Senses", "snake"]
