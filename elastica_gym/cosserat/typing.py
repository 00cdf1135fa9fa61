"""Names for annotations, as scripts import them."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .modules.base_system import BaseSystemCollection
from .modules.protocol import SystemCollectionProtocol
from .not_offered import refuse_names
from .rigidbody.protocol import RigidBodyProtocol
from .rigidbody.rigid_body import RigidBodyBase
from .rod.protocol import CosseratRodProtocol
from .rod.rod_base import RodBase
from .surface.plane import Plane
from .surface.surface_base import SurfaceBase
from .systems.protocol import StaticSystemProtocol, SymplecticSystemProtocol, SystemProtocol
from .timestepper.protocol import StepperProtocol, SymplecticStepperProtocol

__all__ = [
    "AllowedContactType",
    "BaseSystemCollection",
    "ConnectionIndex",
    "ConstrainingIndex",
    "CosseratRodProtocol",
    "OperatorCallbackType",
    "OperatorFinalizeType",
    "OperatorType",
    "RigidBodyProtocol",
    "RigidBodyType",
    "RodType",
    "StaticSystemProtocol",
    "StaticSystemType",
    "StepType",
    "StepperProtocol",
    "SteppersOperatorsType",
    "SurfaceBase",
    "SurfaceType",
    "SymplecticStepperProtocol",
    "SymplecticSystemProtocol",
    "SystemCollectionProtocol",
    "SystemCollectionType",
    "SystemIdxType",
    "SystemProtocol",
    "SystemType",
]

RodType = RodBase
RigidBodyType = RigidBodyBase
SurfaceType = SurfaceBase
StaticSystemType = Plane
SystemType = RodBase | RigidBodyBase
AllowedContactType = RodBase | RigidBodyBase | SurfaceBase
SystemCollectionType = BaseSystemCollection
SystemIdxType = int
ConstrainingIndex = tuple[int, ...]
ConnectionIndex = int | np.int32 | list[int] | tuple[int, ...] | NDArray[np.int32]

StepType = Callable[..., Any]
SteppersOperatorsType = tuple[tuple[StepType, ...], ...]
OperatorType = Callable[[float], None]
OperatorCallbackType = Callable[[float, int], None]
OperatorFinalizeType = Callable[[], None]

__getattr__ = refuse_names(__name__)
