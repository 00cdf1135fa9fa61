"""Constraints, as a part of simulators."""

from typing import TYPE_CHECKING, Any

from ..boundary_conditions import ConstraintBase
from ..declaration import Declaration
from ..not_offered import refuse_names

if TYPE_CHECKING:
    from .base_system import BaseSystemCollection as _Collection
else:
    _Collection = object


class Constraints(_Collection):
    """Lets a simulator prescribe motion."""

    def constrain(self, system: Any) -> Declaration:
        """Announce a constraint of a system; say which by ``using(cls, *args, constrained_position_idx=..., ...)``."""
        return self._declare("constraints", "constraint", ConstraintBase, system)


__getattr__ = refuse_names(__name__)
