"""Protocols of systems, under their module name in PyElastica."""

from typing import Any

from ..not_offered import refuse_names

__all__ = ["is_system_a_collection"]


def is_system_a_collection(system: Any) -> bool:
    """Return whether it is a simulator or another indexable collection."""
    return callable(getattr(system, "__getitem__", None))


__getattr__ = refuse_names(__name__)
