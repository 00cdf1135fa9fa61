"""Loads, as a part of simulators."""

from typing import TYPE_CHECKING, Any

from ..declaration import Declaration
from ..external_forces import NoForces
from ..not_offered import refuse_names

if TYPE_CHECKING:
    from .base_system import BaseSystemCollection as _Collection
else:
    _Collection = object


class Forcing(_Collection):
    """Lets a simulator load systems from outside."""

    def add_forcing_to(self, system: Any) -> Declaration:
        """Announce a load on a system; say which by ``using(cls, *args, **kwargs)``."""
        return self._declare("forcing", "load", NoForces, system)


__getattr__ = refuse_names(__name__)
