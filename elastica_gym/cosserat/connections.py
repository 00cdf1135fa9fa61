"""Joints, under their module name of 0.2.x."""

from .joint import (
    ConnectionBase as ConnectionBase,
)
from .joint import (
    ExternalContact as ExternalContact,
)
from .joint import (
    FixedJoint as FixedJoint,
)
from .joint import (
    FreeJoint as FreeJoint,
)
from .joint import (
    HingeJoint as HingeJoint,
)
from .joint import (
    SelfContact as SelfContact,
)
