"""Dampers of simulators."""

from typing import TYPE_CHECKING, Any

from ..declaration import Declaration
from ..dissipation import DamperBase
from ..not_offered import refuse_names

if TYPE_CHECKING:
    from .base_system import BaseSystemCollection as _Collection
else:
    _Collection = object


class Damping(_Collection):
    """Adds dampers to a simulator."""

    def dampen(self, system: Any) -> Declaration:
        """Declare a damper of a system; set its class by ``using(cls, *args, **kwargs)``."""
        return self._declare("damping", "damper", DamperBase, system)


__getattr__ = refuse_names(__name__)
