"""What all surfaces have in common."""

from typing import ClassVar


class SurfaceBase:
    """Base class of surfaces, which do not move; by its name in 0.3."""

    REQUISITE_MODULES: ClassVar[list[type]] = []
