"""Names for annotations, as scripts import them."""

from typing import Any

from .modules.base_system import BaseSystemCollection
from .rigidbody.rigid_body import RigidBodyBase
from .rod.rod_base import RodBase
from .surface.plane import Plane

RodType = RodBase
RigidBodyType = RigidBodyBase
StaticSystemType = Plane
SystemType = RodBase | RigidBodyBase
AllowedContactType = RodBase | RigidBodyBase | Plane
SystemCollectionType = BaseSystemCollection
SystemIdxType = int
ConstrainingIndex = tuple[int, ...]
ConnectionIndex = Any
