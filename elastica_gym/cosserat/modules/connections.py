"""Joints of simulators."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...engine.rod import as_indices
from ..declaration import Declaration
from ..joint import ConnectionBase
from ..not_offered import refuse_names

if TYPE_CHECKING:
    from .base_system import BaseSystemCollection as _Collection
else:
    _Collection = object


class Connections(_Collection):
    """Adds joints to a simulator."""

    def connect(
        self, first_rod: Any, second_rod: Any, first_connect_idx: Any = None, second_connect_idx: Any = None
    ) -> Declaration:
        """Declare a joint between two systems at two indices; set its class by ``using(cls, *args, **kwargs)``.

        Parameters
        ----------
        first_rod, second_rod
            Rods or rigid bodies.
        first_connect_idx, second_connect_idx : int or sequence of int
            Connected node and element of each, counted from the end if negative. Several indices make as
            many built-in joints; your own class gets them unchanged. Omit both to connect whole systems.

        Raises
        ------
        TypeError
            If the two indices are not of the same kind.
        IndexError
            If there is no such node.
        """
        first_connect_idx, second_connect_idx = (
            () if index is None else index for index in (first_connect_idx, second_connect_idx)
        )
        kinds = [isinstance(each, int | np.integer) for each in (first_connect_idx, second_connect_idx)]
        if kinds[0] != kinds[1]:
            raise TypeError(
                "first_connect_idx and second_connect_idx must be of the same kind, "
                f"not {first_connect_idx!r} and {second_connect_idx!r}"
            )
        for name, system, index in (
            ("first_connect_idx", first_rod, first_connect_idx),
            ("second_connect_idx", second_rod, second_connect_idx),
        ):
            for each in as_indices(name, index):
                if not -system.n_nodes <= each < system.n_nodes:
                    raise IndexError(f"{name} must be from {-system.n_nodes} to {system.n_nodes - 1}, not {each}")
        declaration = self._declare("connections", "joint", ConnectionBase, first_rod, second_rod)
        declaration.indices = (first_connect_idx, second_connect_idx)
        return declaration


__getattr__ = refuse_names(__name__)
