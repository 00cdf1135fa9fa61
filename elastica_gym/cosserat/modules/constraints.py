"""Constraints of simulators."""

from typing import TYPE_CHECKING, Any

from ..boundary_conditions import ConstraintBase
from ..declaration import Declaration
from ..not_offered import refuse_names

if TYPE_CHECKING:
    from .base_system import BaseSystemCollection as _Collection
else:
    _Collection = object


class Constraints(_Collection):
    """Adds constraints to a simulator."""

    def constrain(self, system: Any) -> Declaration:
        """Declare a constraint of a system; set it by ``using(cls, *args, constrained_position_idx=..., ...)``."""
        return self._declare("constraints", "constraint", ConstraintBase, system)


__getattr__ = refuse_names(__name__)
