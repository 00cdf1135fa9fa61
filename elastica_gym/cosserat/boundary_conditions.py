"""Constraints: prescribed motion of rods and rigid bodies."""

import warnings
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..engine.model import Array
from .lowering import SceneBuilder
from .not_offered import refuse_methods

Indices = int | Sequence[int]


class ConstraintBase(ABC):
    """Base class of constraints; write your own by overriding both methods.

    ``simulator.constrain(system).using(cls, *args, constrained_position_idx=..., constrained_director_idx=...)``
    makes one at ``finalize`` from the positions and directors at these indices and the other arguments.

    Attributes
    ----------
    system
        The constrained system.
    constrained_position_idx, constrained_director_idx : NDArray
        Indices that were given to ``using``.
    """

    def __init__(
        self,
        *args: Any,
        _system: Any = None,
        constrained_position_idx: Indices = (),
        constrained_director_idx: Indices = (),
        **kwargs: Any,
    ) -> None:
        if _system is not None:
            self._set_up(_system, constrained_position_idx, constrained_director_idx)

    def _set_up(self, system: Any, positions: Indices, directors: Indices) -> None:
        self._system = system
        self._constrained_position_idx = np.atleast_1d(np.array(positions, dtype=np.int64))
        self._constrained_director_idx = np.atleast_1d(np.array(directors, dtype=np.int64))

    @property
    def system(self) -> Any:  # noqa: D102
        return self._system

    @property
    def constrained_position_idx(self) -> NDArray[np.int64]:  # noqa: D102
        return self._constrained_position_idx

    @property
    def constrained_director_idx(self) -> NDArray[np.int64]:  # noqa: D102
        return self._constrained_director_idx

    @abstractmethod
    def constrain_values(self, system: Any, time: float) -> None:
        """Set positions and directors. Called after each drift, with the time at its end [s]."""

    @abstractmethod
    def constrain_rates(self, system: Any, time: float) -> None:
        """Set velocities and angular velocities. Called after each kick, with its time [s]."""


class FreeBC(ConstraintBase):
    """No constraint."""

    def constrain_values(self, system: Any, time: float) -> None:
        """Do nothing."""

    def constrain_rates(self, system: Any, time: float) -> None:
        """Do nothing."""

    def lower(self, builder: SceneBuilder) -> None:
        """Write no rows."""


@refuse_methods
class GeneralConstraint(ConstraintBase):
    """Holds nodes along some axes of the lab, and keeps elements from turning about some.

    Parameters
    ----------
    *fixed_data : Array
        Positions, (3,), and directors, (3, 3), at the constrained indices; ``using`` passes them.
    translational_constraint_selector, rotational_constraint_selector : array_like of bool, optional
        True for axes of the lab without motion along or about them, (3,); default all.
    """

    def __init__(
        self,
        *fixed_data: Array,
        translational_constraint_selector: ArrayLike | None = None,
        rotational_constraint_selector: ArrayLike | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self.fixed_positions = [np.array(each) for each in fixed_data if np.shape(each) == (3,)]
        self.fixed_directors = [np.array(each) for each in fixed_data if np.shape(each) == (3, 3)]
        if len(self.fixed_positions) + len(self.fixed_directors) != len(fixed_data):
            raise ValueError(
                "fixed_data must be positions of shape (3,) and directors of shape (3, 3), "
                f"not of {[np.shape(each) for each in fixed_data]}"
            )
        self.translational_constraint_selector = _selector(
            "translational_constraint_selector", translational_constraint_selector
        )
        self.rotational_constraint_selector = _selector(
            "rotational_constraint_selector", rotational_constraint_selector
        )

    def constrain_values(self, system: Any, time: float) -> None:
        """Put nodes back along the held axes."""
        held = self.translational_constraint_selector
        for index, position in zip(self.constrained_position_idx, self.fixed_positions, strict=True):
            system.position_collection[held, index] = position[held]

    def constrain_rates(self, system: Any, time: float) -> None:
        """Stop motion along and about the held axes."""
        for index in self.constrained_position_idx:
            system.velocity_collection[self.translational_constraint_selector, index] = 0.0
        for index in self.constrained_director_idx:
            Q = system.director_collection[..., index]
            lab = Q.T @ system.omega_collection[..., index]
            lab[self.rotational_constraint_selector] = 0.0
            system.omega_collection[..., index] = Q @ lab

    def lower(self, builder: SceneBuilder) -> None:
        """Write a row for each node and element."""
        for index, position in zip(self.constrained_position_idx, self.fixed_positions, strict=True):
            builder.add_pin(self.system, index, position=position, axes=list(self.translational_constraint_selector))
        for index in self.constrained_director_idx:
            builder.add_clamp(self.system, index, directors=None, axes=list(self.rotational_constraint_selector))


class FixedConstraint(GeneralConstraint):
    """Holds nodes and elements at their positions and directors of ``finalize``.

    Parameters
    ----------
    *fixed_data : Array
        Positions, (3,), and directors, (3, 3), at the constrained indices; ``using`` passes them.
    """

    def __init__(self, *fixed_data: Array, **kwargs: Any) -> None:
        super().__init__(*fixed_data, **kwargs)

    def constrain_values(self, system: Any, time: float) -> None:
        """Put nodes and directors back."""
        super().constrain_values(system, time)
        for index, directors in zip(self.constrained_director_idx, self.fixed_directors, strict=True):
            system.director_collection[..., index] = directors

    def constrain_rates(self, system: Any, time: float) -> None:
        """Stop nodes and elements."""
        system.velocity_collection[..., self.constrained_position_idx] = 0.0
        system.omega_collection[..., self.constrained_director_idx] = 0.0

    def lower(self, builder: SceneBuilder) -> None:
        """Write a row for each node and element."""
        for index, position in zip(self.constrained_position_idx, self.fixed_positions, strict=True):
            builder.add_pin(self.system, index, position=position)
        for index, directors in zip(self.constrained_director_idx, self.fixed_directors, strict=True):
            builder.add_clamp(self.system, index, directors=directors)


class OneEndFixedBC(FixedConstraint):
    """Holds one node and one element.

    Parameters
    ----------
    fixed_position, fixed_directors : Array
        Position, (3,), and directors, (3, 3), at the constrained indices; ``using`` passes them.
    """

    def __init__(self, fixed_position: Array, fixed_directors: Array, **kwargs: Any) -> None:
        super().__init__(fixed_position, fixed_directors, **kwargs)
        self.fixed_position_collection = self.fixed_positions[0]
        self.fixed_directors_collection = self.fixed_directors[0]

    @staticmethod
    def compute_constrain_values(
        position_collection: Array,
        fixed_position_collection: Array,
        director_collection: Array,
        fixed_directors_collection: Array,
    ) -> None:
        """Put the first node and the first directors back."""
        position_collection[..., 0] = fixed_position_collection
        director_collection[..., 0] = fixed_directors_collection

    @staticmethod
    def compute_constrain_rates(velocity_collection: Array, omega_collection: Array) -> None:
        """Stop the first node and the first element."""
        velocity_collection[..., 0] = 0.0
        omega_collection[..., 0] = 0.0


class HelicalBucklingBC(ConstraintBase):
    """Twists a rod by its ends and gives it slack, then holds them (Gazzola et al. 2018, section 3.4.1).

    Until ``twisting_time``, the ends approach each other by ``slack`` and counter-rotate by
    ``number_of_rotations`` turns, both at a constant rate.

    Parameters
    ----------
    position_start, position_end, director_start, director_end : Array
        Positions and directors of the ends; ``using`` passes them.
    twisting_time : float
        [s]
    slack : float
        [m]
    number_of_rotations : float
        Turns of one end relative to the other.
    """

    def __init__(
        self,
        position_start: Array,
        position_end: Array,
        director_start: Array,
        director_end: Array,
        twisting_time: float,
        slack: float,
        number_of_rotations: float,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        if not twisting_time > 0.0:
            raise ValueError(f"twisting_time must be a positive number, not {twisting_time}")
        self.twisting_time = float(twisting_time)
        direction = (position_end - position_start) / np.linalg.norm(position_end - position_start)
        angle = np.pi * number_of_rotations
        self.ang_vel = angle / self.twisting_time * direction
        self.shrink_vel = 0.5 * slack / self.twisting_time * direction
        self.final_start_position = position_start + 0.5 * slack * direction
        self.final_end_position = position_end - 0.5 * slack * direction
        self.final_start_directors = _turned(director_start, angle, direction)
        self.final_end_directors = _turned(director_end, -angle, direction)

    def constrain_values(self, system: Any, time: float) -> None:
        """Hold the ends after twisting."""
        if time > self.twisting_time:
            system.position_collection[..., 0] = self.final_start_position
            system.position_collection[..., -1] = self.final_end_position
            system.director_collection[..., 0] = self.final_start_directors
            system.director_collection[..., -1] = self.final_end_directors

    def constrain_rates(self, system: Any, time: float) -> None:
        """Move and turn the ends, then stop them."""
        moves = 0.0 if time > self.twisting_time else 1.0
        for index, sign in ((0, moves), (-1, -moves)):
            system.velocity_collection[..., index] = sign * self.shrink_vel
            system.omega_collection[..., index] = sign * (system.director_collection[..., index] @ self.ang_vel)

    def lower(self, builder: SceneBuilder) -> None:
        """Write a row for each end's node and element."""
        ends = (
            (0, 1.0, self.final_start_position, self.final_start_directors),
            (-1, -1.0, self.final_end_position, self.final_end_directors),
        )
        for index, sign, position, directors in ends:
            # rotation about an element's own axis is the same in both frames
            omega = sign * (self.system.director_collection[..., index] @ self.ang_vel)
            builder.add_pin(
                self.system, index, position=position, start_time=self.twisting_time, velocity=sign * self.shrink_vel
            )
            builder.add_clamp(self.system, index, directors=directors, start_time=self.twisting_time, omega=omega)


class FreeRod(FreeBC):
    """`FreeBC` under its name before 0.2.1."""

    def __init__(self, **kwargs: Any) -> None:
        warnings.warn("FreeRod is now called FreeBC", DeprecationWarning, stacklevel=2)
        super().__init__(**kwargs)


class OneEndFixedRod(OneEndFixedBC):
    """`OneEndFixedBC` under its name before 0.2.1."""

    def __init__(self, fixed_position: Array, fixed_directors: Array, **kwargs: Any) -> None:
        warnings.warn("OneEndFixedRod is now called OneEndFixedBC", DeprecationWarning, stacklevel=2)
        super().__init__(fixed_position, fixed_directors, **kwargs)


def _selector(name: str, value: ArrayLike | None) -> NDArray[np.bool_]:
    chosen = np.ones(3, dtype=bool) if value is None else np.array(value)
    if chosen.shape != (3,) or chosen.dtype != bool:
        raise ValueError(f"{name} must be three booleans, not {value!r}")
    return chosen


def _turned(directors: Array, angle: float, axis: Array) -> Array:
    """Return directors in a frame turned by an angle about a unit axis of the lab."""
    K = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    R = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K
    return directors @ R.T
