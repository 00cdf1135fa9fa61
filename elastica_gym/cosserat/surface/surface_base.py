"""Base class of surfaces."""

from typing import ClassVar


class SurfaceBase:
    """Base class of surfaces, which do not move; name in 0.3."""

    REQUISITE_MODULES: ClassVar[list[type]] = []
