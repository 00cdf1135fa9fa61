"""Protocols of systems in a simulator, for annotations and `isinstance`."""

from typing import ClassVar, Protocol, runtime_checkable

from ...engine.model import Array


@runtime_checkable
class StaticSystemProtocol(Protocol):
    """Systems that may be appended to a simulator, including surfaces."""

    REQUISITE_MODULES: ClassVar[list[type]]


@runtime_checkable
class SystemProtocol(StaticSystemProtocol, Protocol):
    """Moving systems: rods and rigid bodies."""

    def compute_internal_forces_and_torques(self, time: float) -> None:
        """Compute internal loads."""

    def update_accelerations(self, time: float, dt: float) -> None:
        """Compute accelerations."""

    def zeroed_out_external_forces_and_torques(self, time: float) -> None:
        """Clear loads."""


class SlenderBodyGeometryProtocol(Protocol):
    """Moving systems with a centre line."""

    position_collection: Array
    director_collection: Array
    radius: Array


SymplecticSystemProtocol = SystemProtocol
