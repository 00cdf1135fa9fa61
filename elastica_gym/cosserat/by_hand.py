"""Built-in features called by hand, from a script or a user's subclass, outside the compiled step."""

import copy
import weakref
from collections.abc import Callable
from typing import Any

from ..engine.kernels.simulate import load
from ..engine.scene import Hooks
from .lowering import SceneBuilder
from .rigidbody.rigid_body import RigidBodyBase
from .rod.rod_base import RodBase

SILENT = Hooks(0, 0, 0, 0)
UNLISTED = -1
"""Number of neighbours that marks a neighbour list as not built"""


class Twin:
    """Copies of systems in a separate simulation, used to compute the loads of one feature.

    Parameters
    ----------
    movers : sequence of CosseratRod or RigidBodyBase
    """

    def __init__(self, movers: list[Any]) -> None:
        self._movers = [weakref.ref(system) for system in movers]
        # imported here to avoid a circular import
        from .simulation import Simulation

        self._copies = [copy.deepcopy(system) for system in movers]
        self._simulation = Simulation(self._copies, {})

    def is_of(self, movers: list[Any]) -> bool:
        """Return whether this twin copies these systems."""
        return all(mine() is system for mine, system in zip(self._movers, movers, strict=True))

    def act(self, movers: list[Any], lower: Callable[..., None], systems: tuple[Any, ...]) -> None:
        """Add the loads of the rows that ``lower(builder, *systems)`` writes to those of the systems."""
        sim, copies = self._simulation, {id(one): two for one, two in zip(movers, self._copies, strict=True)}
        for system, twin in zip(movers, self._copies, strict=True):
            for name, values in twin._fields.items():
                values[...] = system._fields[name]
        sim.read_material()
        builder = SceneBuilder(sim.model, sim.rods, sim.bodies)
        lower(builder, *(copies.get(id(system), system) for system in systems))
        scene = builder.build()
        sim.state.n_neighbours[0] = UNLISTED
        dt = max((body._time_step for body in movers if isinstance(body, RigidBodyBase)), default=0.0)
        load(sim.model, scene, sim.state, sim.control, SILENT, dt, False)
        net = sim.state.force.copy(), sim.state.torque.copy()
        load(sim.model, scene, sim.state, sim.control, SILENT, dt, True)
        sim.control.force[:] += sim.state.force - net[0]
        sim.control.torque[:] += sim.state.torque - net[1]
        for system, twin in zip(movers, self._copies, strict=True):
            for name in ("external_forces", "external_torques", "plane_contact"):
                if name in twin._fields:
                    system._fields[name][...] = twin._fields[name]


_twins: "weakref.WeakKeyDictionary[Any, dict[tuple[int, ...], Twin]]" = weakref.WeakKeyDictionary()
"""By the first system and by the identities of all; cached, since a subclass calls at every step"""


def act(lower: Callable[..., None], *systems: Any) -> None:
    """Add the loads of a feature, given by its method ``lower``, to systems in their current state."""
    unique = {id(system): system for system in systems if isinstance(system, RodBase | RigidBodyBase)}
    movers = list(unique.values())
    known, key = _twins.setdefault(movers[0], {}), tuple(unique)
    if key not in known or not known[key].is_of(movers):
        known[key] = Twin(movers)
    known[key].act(movers, lower, systems)


def act_joint(joint: Any, one: Any, first: Any, two: Any, second: Any) -> None:
    """Add the loads of a joint, one for each pair of indices."""
    from .simulation import lower_joint

    act(lambda builder, *ends: lower_joint(joint, ends[0], first, ends[1], second, builder), one, two)
