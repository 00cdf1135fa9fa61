"""Symplectic time steppers: alternating drifts of positions and kicks of velocities."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...engine.scene import Scheme
from ..not_offered import refuse_methods, refuse_names

if TYPE_CHECKING:
    from ..modules.base_system import BaseSystemCollection


@refuse_methods
class SymplecticStepper:
    """Base class of time steppers.

    Attributes
    ----------
    scheme : Scheme
        The fractions of a time step for drifts and kicks.
    """

    scheme: Scheme

    @property
    def n_stages(self) -> int:
        """Number of drifts in a step."""
        return int(self.scheme.drifts.size)

    def step(self, systems: "BaseSystemCollection", time: float, dt: float) -> float:
        """Take one step from a time, call the callbacks due, and return the time afterwards [s]."""
        simulation = systems.simulation
        after = simulation.advance(self.scheme, float(dt), 1, float(time))
        simulation.warn_of_divergence()
        simulation.callbacks.call(after, round(after / float(dt)))
        simulation.clear_loads()
        return after

    @staticmethod
    def do_step(
        stepper: "SymplecticStepper", stages: Any, systems: "BaseSystemCollection", time: float, dt: float
    ) -> float:
        """Take one step; ``stages`` is what `extend_stepper_interface` returned."""
        return stepper.step(systems, time, dt)

    @property
    def steps_and_prefactors(self) -> Scheme:
        """The scheme, under the name that scripts pass to `do_step`."""
        return self.scheme


class PositionVerlet(SymplecticStepper):
    """Position Verlet, second order: half a drift, a kick, half a drift."""

    def __init__(self) -> None:
        self.scheme = Scheme(drifts=np.array([0.5, 0.5]), kicks=np.array([1.0]))


class PEFRL(SymplecticStepper):
    """Position extended Forest-Ruth-like algorithm, fourth order (Omelyan et al. 2002): four kicks per step."""

    XI = 0.1786178958448091
    LAMBDA = -0.2123418310626054
    CHI = -0.06626458266981849

    def __init__(self) -> None:
        xi, lam, chi = self.XI, self.LAMBDA, self.CHI
        outer = 0.5 * (1.0 - 2.0 * lam)
        self.scheme = Scheme(
            drifts=np.array([xi, chi, 1.0 - 2.0 * (xi + chi), chi, xi]), kicks=np.array([outer, lam, lam, outer])
        )


__getattr__ = refuse_names(__name__)
