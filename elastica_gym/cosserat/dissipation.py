"""Dampers, which remove energy from a system at the end of each step."""

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from ..engine.model import Array
from ..engine.rod import require_not_negative
from .lowering import SceneBuilder
from .not_offered import refuse_names
from .rod.rod_base import RodBase


class DamperBase(ABC):
    """Base class of dampers; write your own by overriding ``dampen_rates``.

    ``simulator.dampen(system).using(cls, *args, **kwargs)`` makes one at ``finalize``.

    Attributes
    ----------
    system
        The damped system.
    """

    def __init__(self, *args: Any, _system: Any = None, **kwargs: Any) -> None:
        if _system is not None:
            self._system = _system

    @property
    def system(self) -> Any:  # noqa: D102
        return self._system

    @abstractmethod
    def dampen_rates(self, system: Any, time: float) -> None:
        """Change velocities and angular velocities. Called once per step, after the last kick."""


class AnalyticalLinearDamper(DamperBase):
    """Exponential decay of velocities, exact for any time step.

    Parameters
    ----------
    uniform_damping_constant : float
        Rate for both velocities and angular velocities [1/s].
    translational_damping_constant, rotational_damping_constant : float
        Given together: gamma_t [kg/s] and gamma_r [kg m^2/s], for rates gamma_t/m and e gamma_r/J.
    damping_constant : float
        Deprecated: rate of velocities [1/s]; that of angular velocities is e m/J times it.
    time_step : float
        Optional time step [s]; must be positive. The step of the run is used instead.
    """

    def __init__(
        self,
        time_step: float | None = None,
        *,
        damping_constant: float | None = None,
        uniform_damping_constant: float | None = None,
        translational_damping_constant: float | None = None,
        rotational_damping_constant: float | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        if time_step is not None and not time_step > 0.0:
            raise ValueError(f"time_step must be a positive number, not {time_step}")
        self.time_step = time_step
        given = {
            "damping_constant": damping_constant,
            "uniform_damping_constant": uniform_damping_constant,
            "translational_damping_constant": translational_damping_constant,
            "rotational_damping_constant": rotational_damping_constant,
        }
        chosen = {name: float(value) for name, value in given.items() if value is not None}
        if set(chosen) not in (
            {"damping_constant"},
            {"uniform_damping_constant"},
            {"translational_damping_constant", "rotational_damping_constant"},
        ):
            raise ValueError(
                "give uniform_damping_constant, or translational_damping_constant and "
                f"rotational_damping_constant, or damping_constant; not {sorted(chosen) or 'none'}"
            )
        for name, value in chosen.items():
            require_not_negative(name, value)
        self._constants = chosen

    def _rates(self) -> tuple[Any, Any, Any]:
        """Return the decay rates of nodes, of elements, and of elements per dilatation [1/s]."""
        rod, c = self.system, self._constants
        if "uniform_damping_constant" in c:
            rate = c["uniform_damping_constant"]
            return rate, rate, 0.0
        inverse = np.einsum("iik->ik", rod.inv_mass_second_moment_of_inertia)
        if "damping_constant" in c:
            return c["damping_constant"], 0.0, c["damping_constant"] * _element_mass(rod) * inverse
        return c["translational_damping_constant"] / rod.mass, 0.0, c["rotational_damping_constant"] * inverse

    def dampen_rates(self, system: Any, time: float) -> None:
        """Multiply velocities by their factors."""
        if self.time_step is None:
            raise ValueError("time_step is missing; AnalyticalLinearDamper needs it when a subclass calls it")
        node, element, dilating = self._rates()
        system.velocity_collection *= np.exp(-node * self.time_step)
        dilatation = system.dilatation if isinstance(system, RodBase) else 1.0
        system.omega_collection *= np.exp(-(element + dilating * dilatation) * self.time_step)

    def lower(self, builder: SceneBuilder) -> None:
        """Write rates."""
        node, element, dilating = self._rates()
        builder.add_decay(self.system, node_rate=node, element_rate=element, dilating_rate=dilating)


# name in 0.3.0
ExponentialDamper = AnalyticalLinearDamper


class LaplaceDissipationFilter(DamperBase):
    """Removes the shortest waves from velocities and angular velocities, and keeps long ones.

    It subtracts (-Laplacian/4)^order of them, with zero at the ends of an open rod (Jeanmart and
    Winckelmans 2007).

    Parameters
    ----------
    filter_order : int
        Power of the Laplacian; higher orders damp less.
    """

    def __init__(self, filter_order: int, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        if not (isinstance(filter_order, int | np.integer) and filter_order > 0):
            raise ValueError(f"filter_order must be a positive integer, not {filter_order}")
        self.filter_order = int(filter_order)

    def dampen_rates(self, system: Any, time: float) -> None:
        """Subtract the filter's term."""
        for rates in (system.velocity_collection, system.omega_collection):
            term = rates.copy()
            for _ in range(self.filter_order):
                term = 0.25 * (2.0 * term - np.roll(term, 1, axis=1) - np.roll(term, -1, axis=1))
                if not system.ring_rod_flag:
                    term[:, 0] = term[:, -1] = 0.0
            rates -= term

    def lower(self, builder: SceneBuilder) -> None:
        """Write a filter."""
        builder.add_filter(self.system, self.filter_order)


class RayleighDissipation(DamperBase):
    """Drag on nodes, nu l v, and elements, nu l w, with l the mean element length; half at the end nodes.

    Parameters
    ----------
    damping_constant : float
        nu [kg/(m s)], and for torques [kg m/s].
    """

    def __init__(self, damping_constant: float, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        require_not_negative("damping_constant", damping_constant)
        self.damping_constant = float(damping_constant)

    def _drag(self) -> tuple[Array, float]:
        rod = self.system
        size = self.damping_constant * float(np.mean(rod.rest_lengths))
        nodes = np.full(rod.n_nodes, size)
        if not rod.ring_rod_flag:
            nodes[[0, -1]] *= 0.5
        return nodes, size

    def dampen_rates(self, system: Any, time: float) -> None:
        """Add the drag to the loads of the next step."""
        nodes, element = self._drag()
        system.external_forces -= nodes * system.velocity_collection
        system.external_torques -= element * system.omega_collection

    def lower(self, builder: SceneBuilder) -> None:
        """Write drag."""
        if not isinstance(self.system, RodBase):
            raise TypeError(f"RayleighDissipation acts along a rod, not on a {type(self.system).__name__}")
        builder.add_drag(self.system, *self._drag())


def _element_mass(rod: Any) -> Array:
    """Return element masses: half of each inner node's mass and all of the end nodes' [kg], (n,)."""
    if not isinstance(rod, RodBase):
        return np.array(rod.mass)
    if rod.ring_rod_flag:
        return 0.5 * (rod.mass + np.roll(rod.mass, -1))
    mass = 0.5 * (rod.mass[1:] + rod.mass[:-1])
    mass[0] += 0.5 * rod.mass[0]
    mass[-1] += 0.5 * rod.mass[-1]
    return mass


__getattr__ = refuse_names(__name__)
