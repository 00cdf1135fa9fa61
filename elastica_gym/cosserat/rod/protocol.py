"""Rods under their name for annotations in 0.3."""

from ..not_offered import refuse_names
from .rod_base import RodBase

CosseratRodProtocol = RodBase

__getattr__ = refuse_names(__name__)
