"""Contact of simulators."""

from typing import TYPE_CHECKING, Any

from ..contact_forces import NoContact
from ..declaration import Declaration
from ..not_offered import refuse_names

if TYPE_CHECKING:
    from .base_system import BaseSystemCollection as _Collection
else:
    _Collection = object


class Contact(_Collection):
    """Adds contact to a simulator."""

    def detect_contact_between(self, first_system: Any, second_system: Any) -> Declaration:
        """Declare contact of two systems, or of one with itself; set its class by ``using(cls, *args, **kwargs)``."""
        return self._declare("contacts", "contact", NoContact, first_system, second_system)


__getattr__ = refuse_names(__name__)
