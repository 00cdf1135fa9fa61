"""The collection of systems that make up a simulation."""

from collections.abc import Iterator, MutableSequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..declaration import Declaration
from ..not_offered import refuse_methods
from ..rigidbody.rigid_body import RigidBodyBase
from ..rod.cosserat_rod import CosseratRod
from ..surface.surface_base import SurfaceBase

if TYPE_CHECKING:
    from ..ensemble import Ensemble
    from ..simulation import Simulation


FEATURES = {
    "constrain": "Constraints",
    "add_forcing_to": "Forcing",
    "connect": "Connections",
    "dampen": "Damping",
    "collect_diagnostics": "CallBacks",
    "detect_contact_between": "Contact",
}
"""Base class that provides each method of a simulator"""


@refuse_methods
class BaseSystemCollection(MutableSequence):
    """A list of rods, rigid bodies and surfaces; derive your simulator from it and from the features you use.

    Attributes
    ----------
    allowed_sys_types : tuple of type
        Types that may be appended.
    """

    def __init__(self) -> None:
        self.allowed_sys_types: tuple[type, ...] = (CosseratRod, RigidBodyBase, SurfaceBase)
        self._systems: list[Any] = []
        # by identity: a linear search would make declaring many rods slow
        self._places: dict[int, int] = {}
        self._declared: dict[str, list[Declaration]] = {}
        self._simulation: Simulation | Ensemble | None = None
        super().__init__()

    # list interface

    def __len__(self) -> int:
        return len(self._systems)

    def __getitem__(self, index: Any) -> Any:
        return self._systems[index]

    def __delitem__(self, index: Any) -> None:
        self._require_open("remove a system")
        del self._systems[index]
        self._find_places()

    def __setitem__(self, index: Any, system: Any) -> None:
        self._require_open("replace a system")
        self._require_allowed(system)
        if self._places.get(id(system), self.get_system_index(index)) != self.get_system_index(index):
            raise ValueError(f"this {type(system).__name__} is already in the simulator")
        self._systems[index] = system
        self._find_places()

    def insert(self, index: int, system: Any) -> None:
        """Insert a system before ``index``.

        Raises
        ------
        TypeError
            If it is not a rod, a rigid body or a surface.
        ValueError
            If it is already in the simulator.
        """
        self._require_open("add a system")
        self._require_allowed(system)
        if id(system) in self._places:
            raise ValueError(f"this {type(system).__name__} is already in the simulator")
        is_last = index >= len(self)
        self._systems.insert(index, system)
        if is_last:
            self._places[id(system)] = len(self) - 1
        else:
            self._find_places()

    def _find_places(self) -> None:
        self._places = {id(system): place for place, system in enumerate(self._systems)}

    def __str__(self) -> str:
        return str(self._systems)

    def extend_allowed_types(self, additional_types: tuple[type, ...]) -> None:
        """Allow more types of systems; the step does not move types unknown to it."""
        self.allowed_sys_types += tuple(additional_types)

    def append_allowed_types(self, additional_types: type) -> None:
        """Allow one more type of system."""
        self.extend_allowed_types((additional_types,))

    def override_allowed_types(self, allowed_types: tuple[type, ...]) -> None:
        """Allow only these types of systems."""
        self.allowed_sys_types = tuple(allowed_types)

    # name in 1.0
    _override_allowed_types = override_allowed_types

    def systems(self) -> Iterator[Any]:
        """Return an iterator over all systems."""
        return iter(self._systems)

    def final_systems(self) -> Iterator[Any]:
        """Return an iterator over the systems that move."""
        return (system for system in self._systems if isinstance(system, CosseratRod | RigidBodyBase))

    def get_system_index(self, system: Any) -> int:
        """Return the index of a system; an index is returned as it is.

        Raises
        ------
        ValueError
            If it is not in the simulator.
        IndexError
            If the index is out of range.
        """
        if isinstance(system, int | np.integer):
            if not -len(self) <= system < len(self):
                raise IndexError(f"there is no system {system}; the simulator has {len(self)}")
            return int(system) % len(self)
        if id(system) in self._places:
            return self._places[id(system)]
        raise ValueError(f"this {type(system).__name__} is not in the simulator; append it first")

    # features

    def __getattr__(self, name: str) -> Any:
        # reached only if no base class has the attribute: name the missing one
        if name in FEATURES:
            raise AttributeError(f"to call {name}, derive {type(self).__name__} from {FEATURES[name]} too")
        raise AttributeError(f"{type(self).__name__} has no attribute {name!r}")

    def _declare(self, feature: str, what: str, base: type, *systems: Any) -> Declaration:
        """Register a feature of systems, to be made at ``finalize``."""
        self._require_open(f"add a {what}")
        found = tuple(self._systems[self.get_system_index(system)] for system in systems)
        declaration = Declaration(what, base, *found)
        self._declared.setdefault(feature, []).append(declaration)
        return declaration

    def finalize(self) -> None:
        """Make all features and lower them to tables; nothing can be added afterwards.

        Constraints are applied at time 0, and callbacks are called once, with time 0 and step 0.

        Raises
        ------
        RuntimeError
            If called twice, if there is no rod or rigid body, or if a feature was declared without a class.
        """
        from ..ensemble import simulate_systems

        self._require_open("finalize again")
        if not any(isinstance(system, CosseratRod | RigidBodyBase) for system in self._systems):
            raise RuntimeError("there is nothing to simulate: append a rod or a rigid body before finalize")
        self._simulation = simulate_systems(self._systems, self._declared)
        self._simulation.begin()

    @property
    def simulation(self) -> "Simulation | Ensemble":
        """The simulation behind this collection.

        Raises
        ------
        RuntimeError
            Before ``finalize``.
        """
        if self._simulation is None:
            raise RuntimeError("the simulator is not finalized; call finalize() before it is run")
        return self._simulation

    def stable_time_step(self) -> float:
        """Return the largest stable time step of position Verlet for all rods and declared features [s].

        Raises
        ------
        RuntimeError
            Before ``finalize``.
        """
        return self.simulation.limit().time_step

    def constrain_values(self, time: float) -> None:
        """Apply the constraints of positions and directors."""
        self.simulation.constrain_values(time)

    def constrain_rates(self, time: float) -> None:
        """Apply the constraints of velocities."""
        self.simulation.constrain_rates(time)

    def apply_callbacks(self, time: float, current_step: int) -> None:
        """Call all callbacks."""
        self.simulation.callbacks.call(time, current_step)

    def close(self) -> None:
        """Close all callbacks; before ``finalize`` there are none."""
        if self._simulation is not None:
            self._simulation.callbacks.close()

    def __getstate__(self) -> dict[str, Any]:
        if self._simulation is not None:
            raise TypeError(
                "a finalized simulator cannot be copied or pickled, since its systems share memory with "
                "compiled code; use save_state, and load_state on a new simulator"
            )
        return vars(self)

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._find_places()

    def _require_open(self, action: str) -> None:
        if self._simulation is not None:
            raise RuntimeError(f"cannot {action}: the simulator is finalized")

    def _require_allowed(self, system: Any) -> None:
        if not isinstance(system, self.allowed_sys_types):
            allowed = ", ".join(each.__name__ for each in self.allowed_sys_types)
            raise TypeError(f"a simulator holds {allowed}; not {type(system).__name__}")
        for required in getattr(system, "REQUISITE_MODULES", ()):
            if not isinstance(self, required):
                raise RuntimeError(f"{type(system).__name__} needs a simulator derived from {required.__name__}")
