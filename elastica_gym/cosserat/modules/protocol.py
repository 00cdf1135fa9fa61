"""Simulators and declarations under PyElastica's names for annotations."""

from ..declaration import Declaration
from .base_system import BaseSystemCollection
from .callbacks import CallBacks
from .connections import Connections
from .constraints import Constraints
from .contact import Contact
from .damping import Damping
from .forcing import Forcing

ModuleProtocol = MixinProtocol = Declaration
SystemCollectionProtocol = BaseSystemCollection
SystemCollectionWithCallbackProtocol = CallBacks
ConnectedSystemCollectionProtocol = Connections
ConstrainedSystemCollectionProtocol = Constraints
ContactedSystemCollectionProtocol = Contact
DampenedSystemCollectionProtocol = Damping
ForcedSystemCollectionProtocol = Forcing
