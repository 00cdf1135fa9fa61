"""Dampers, as a part of simulators."""

from typing import TYPE_CHECKING, Any

from ..declaration import Declaration
from ..dissipation import DamperBase
from ..not_offered import refuse_names

if TYPE_CHECKING:
    from .base_system import BaseSystemCollection as _Collection
else:
    _Collection = object


class Damping(_Collection):
    """Lets a simulator damp systems."""

    def dampen(self, system: Any) -> Declaration:
        """Announce a damper of a system; say which by ``using(cls, *args, **kwargs)``."""
        return self._declare("damping", "damper", DamperBase, system)


__getattr__ = refuse_names(__name__)
