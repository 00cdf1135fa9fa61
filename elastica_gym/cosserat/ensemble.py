"""Independent systems, simulated in parallel on the CPUs."""

import functools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..engine.scene import Scheme
from ..engine.stability import Limit
from ..engine.threads import available_cpus, side_by_side
from .declaration import Declaration
from .rigidbody.rigid_body import RigidBodyBase
from .rod.cosserat_rod import CosseratRod
from .simulation import Callbacks, Simulation, is_lowered

WORTHWHILE = 100_000
"""Elements times steps of a few milliseconds; below that, threads cost more time than they save"""


def simulate_systems(systems: Sequence[Any], declared: Mapping[str, Sequence[Declaration]]) -> "Simulation | Ensemble":
    """Return the simulation of systems, on several CPUs if they form independent groups and rarely call Python."""
    movers = [system for system in systems if isinstance(system, CosseratRod | RigidBodyBase)]
    callbacks = Callbacks(declared.get("callbacks", ()))
    names = {id(system): f"{type(system).__name__} {number}" for number, system in enumerate(systems)}
    features = {feature: each for feature, each in declared.items() if feature != "callbacks"}
    groups = _groups(movers, features, available_cpus())
    is_long = sum(map(_size, movers)) * callbacks.steps_to_next(0) >= WORTHWHILE
    if len(groups) > 1 and is_long and all(is_lowered(kind, one) for kind, each in features.items() for one in each):
        return Ensemble([Simulation(group, _of(group, features), names=names) for group in groups], callbacks)
    return Simulation(movers, features, callbacks, names)


class Ensemble:
    """Several simulations run as one, with bitwise identical results.

    Parameters
    ----------
    parts : sequence of Simulation
        Simulations that do not interact, without callbacks.
    callbacks : Callbacks
        Callbacks of all parts.
    """

    def __init__(self, parts: Sequence[Simulation], callbacks: Callbacks) -> None:
        self.parts = parts
        self.callbacks = callbacks
        self._size = sum(_size(system) for part in parts for system in (*part.rods, *part.bodies))

    def begin(self) -> None:
        """Apply constraints and call callbacks at time 0."""
        for part in self.parts:
            part.begin()
        self.callbacks.call(0.0, 0)

    def constrain_values(self, time: float) -> None:
        """Apply the constraints of positions and directors."""
        for part in self.parts:
            part.constrain_values(time)

    def constrain_rates(self, time: float) -> None:
        """Apply the constraints of velocities."""
        for part in self.parts:
            part.constrain_rates(time)

    @property
    def steps(self) -> int:
        """Number of steps taken."""
        return self.parts[0].steps

    @steps.setter
    def steps(self, count: int) -> None:
        for part in self.parts:
            part.steps = count

    def advance(self, scheme: Scheme, dt: float, n_steps: int, time: float) -> float:
        """Take steps from a time, without callbacks, and return the time afterwards [s]."""
        for part in self.parts:
            part.require_time_step(dt)
        calls = [functools.partial(part.advance, scheme, dt, n_steps, time) for part in self.parts]
        is_long = n_steps * self._size >= WORTHWHILE
        return (side_by_side(calls) if is_long else [call() for call in calls])[0]

    def limit(self) -> Limit:
        """Return the largest stable time step and what limits it."""
        return min(part.limit() for part in self.parts)

    def warn_of_divergence(self) -> None:
        """Warn once per part if motion is not finite, naming the system and the step."""
        for part in self.parts:
            part.warn_of_divergence()

    def clear_loads(self) -> None:
        """Clear the external loads."""
        for part in self.parts:
            part.clear_loads()


def _groups(movers: Sequence[Any], features: Mapping[str, Sequence[Declaration]], n_most: int) -> list[list[Any]]:
    """Divide systems into at most ``n_most`` independent groups of similar size."""
    place = {id(system): number for number, system in enumerate(movers)}
    joined = [
        [place[id(system)] for system in declaration.systems if id(system) in place]
        for each in features.values()
        for declaration in each
    ]
    pairs = np.array([pair for pair in joined if len(pair) == 2], dtype=np.int64).reshape(-1, 2)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(movers), len(movers)))
    count, label = connected_components(graph, directed=False)
    sizes = np.bincount(label, weights=[_size(system) for system in movers])
    # largest first, each into the smallest group so far
    load, group_of = np.zeros(min(count, n_most)), np.zeros(count, dtype=np.int64)
    for component in np.argsort(-sizes, kind="stable"):
        group_of[component] = np.argmin(load)
        load[group_of[component]] += sizes[component]
    groups: list[list[Any]] = [[] for _ in load]
    for system, component in zip(movers, label, strict=True):
        groups[group_of[component]].append(system)
    return groups


def _of(group: Sequence[Any], features: Mapping[str, Sequence[Declaration]]) -> dict[str, list[Declaration]]:
    """Return the features of a group's systems."""
    inside = {id(system) for system in group}
    return {
        feature: [one for one in each if any(id(system) in inside for system in one.systems)]
        for feature, each in features.items()
    }


def _size(system: Any) -> int:
    return int(system.n_elems)
