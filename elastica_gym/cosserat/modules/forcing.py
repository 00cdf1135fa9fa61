"""Loads of simulators."""

from typing import TYPE_CHECKING, Any

from ..declaration import Declaration
from ..external_forces import NoForces
from ..not_offered import refuse_names

if TYPE_CHECKING:
    from .base_system import BaseSystemCollection as _Collection
else:
    _Collection = object


class Forcing(_Collection):
    """Adds external loads to a simulator."""

    def add_forcing_to(self, system: Any) -> Declaration:
        """Declare a load on a system; set its class by ``using(cls, *args, **kwargs)``."""
        return self._declare("forcing", "load", NoForces, system)


__getattr__ = refuse_names(__name__)
