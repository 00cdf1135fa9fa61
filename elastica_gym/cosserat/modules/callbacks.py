"""Callbacks of simulators."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..callback_functions import CallBackBaseClass
from ..declaration import Declaration
from ..not_offered import refuse_names

if TYPE_CHECKING:
    from .base_system import BaseSystemCollection as _Collection
else:
    _Collection = object


class CallBacks(_Collection):
    """Adds callbacks to a simulator."""

    def collect_diagnostics(self, system: Any) -> Declaration:
        """Declare a callback; set its class by ``using(cls, *args, **kwargs)``.

        Parameters
        ----------
        system
            A system; a list, tuple or dict of systems; or ``...`` for all, as a tuple.
        """
        if system is Ellipsis:
            system = tuple(self.systems())
        observed: Any
        if isinstance(system, Mapping):
            each, observed = tuple(system.values()), dict(system)
        elif isinstance(system, list | tuple):
            each, observed = tuple(system), system
        else:
            each, observed = (system,), self[self.get_system_index(system)]
        declaration = self._declare("callbacks", "callback", CallBackBaseClass, *each)
        declaration.observed = observed
        return declaration


__getattr__ = refuse_names(__name__)
