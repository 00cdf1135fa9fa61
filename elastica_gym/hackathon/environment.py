"""The interface of the 2020 hackathon's starter kit: an octopus, an object, and 40 microseconds per step.

Main loops written for it run unchanged, but on the octopus of the environments, whose muscles follow with a time
constant of 0.06 s. For learning, use the environments: they are batched, with 0.05 s per step.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..bodies import octopus
from ..bodies.muscles import DIRECTIONS, N_FUNCTIONS
from ..bodies.octopus import MIDDLE, N_ELEMENTS
from ..engine import advance, at_rest
from ..engine.model import Array
from ..engine.rod import require_positive

TIME_STEP = 4e-5
"""[s]"""
HEAD = (0.0, 0.5)
"""Initial position of the head's centre, (x, z) [m]; the published object stands at [-0.4, 0, 0.5]"""
CLEAR = 0.02
"""Minimum initial distance between the surfaces of animal and object [m]"""
FRAMES_PER_SECOND = 20


@dataclass(frozen=True, kw_only=True, eq=False)
class ShearableRod:
    """The current octopus, read-only. Nodes 0-49 are one arm, 50-70 the head, 71-120 the other arm.

    Attributes
    ----------
    position_collection, velocity_collection : Array
        Of nodes [m], [m/s], lab frame with y up, (3, 121).
    director_collection : Array
        Rows d1 (normal), d2 (binormal), d3 (tangent) of each element, (3, 3, 120).
    omega_collection : Array
        Angular velocity of elements [rad/s], material frame, (3, 120).
    kappa : Array
        Curvature and twist between elements [1/m], material frame, (3, 119).
    lengths, radius : Array
        Of elements [m], (120,).
    n_elems : int
    """

    position_collection: Array
    velocity_collection: Array
    director_collection: Array
    omega_collection: Array
    kappa: Array
    lengths: Array
    radius: Array
    n_elems: int = N_ELEMENTS


@dataclass(frozen=True, kw_only=True, eq=False)
class RigidBody:
    """The current object, a cylinder, read-only.

    Attributes
    ----------
    position_collection, velocity_collection : Array
        Of its centre [m], [m/s], lab frame, (3, 1).
    director_collection : Array
        Rows d1, d2 and d3, its axis, (3, 3, 1).
    omega_collection : Array
        Angular velocity [rad/s], material frame, (3, 1).
    length, radius : float
        [m]
    """

    position_collection: Array
    velocity_collection: Array
    director_collection: Array
    omega_collection: Array
    length: float
    radius: float


class Environment:
    """The octopus of the hackathon and its object, step by step.

    Parameters
    ----------
    final_time : float
        Simulated time of ``total_steps`` [s].
    target_position : ArrayLike
        Position of the object's base [m], (3,), with y = 0; y is up.
    COLLECT_DATA_FOR_POSTPROCESSING : bool
        Whether to collect data for `post_processing`.

    Attributes
    ----------
    time_step : float
        [s]
    total_steps : int

    Examples
    --------
    >>> env = Environment(0.001, np.array([-0.4, 0.0, 0.5]))
    >>> total_steps, systems = env.reset()
    >>> shearable_rod, rigid_body = systems
    >>> rest, time = [[np.zeros(7), np.zeros(7)] for _ in range(3)], 0.0
    >>> for _ in range(total_steps):
    ...     time, systems, done = env.step(rest, time)
    """

    def __init__(
        self,
        final_time: float,
        target_position: ArrayLike,
        COLLECT_DATA_FOR_POSTPROCESSING: bool = False,
    ) -> None:
        require_positive("final_time", final_time)
        self.target_position = np.array(target_position, dtype=np.float64)
        place = self.target_position
        if place.shape != (3,) or place[1] != 0.0 or not np.isfinite(place).all():
            raise ValueError(f"target_position must be a point (x, 0, z) on the ground, not {target_position!r}")
        self.time_step = TIME_STEP
        self.total_steps = max(1, round(final_time / TIME_STEP))
        self._keeps = COLLECT_DATA_FOR_POSTPROCESSING
        self._body = octopus()
        self._first = int(self._body.model.first_slot[0])
        self._moments: list[dict[str, Array]] = []
        self._started = False

    def reset(self) -> tuple[int, list[Any]]:
        """Place animal and object at rest; return the number of steps and ``[octopus, object]``.

        Raises
        ------
        ValueError
            If the object would intersect the animal.
        """
        body = self._body
        self._state, self._control = at_rest(body.model, body.rods, cylinders=body.cylinders)
        for field, resting in zip(self._state, body.rest, strict=True):
            field[...] = resting
        nodes, elements = self._slices()
        x = self._state.x[0]
        x[[0, 2], nodes] += (np.array(HEAD) - x[[0, 2], self._first + MIDDLE])[:, None]
        self._state.body_x[0, 0, [0, 2]] = self.target_position[[0, 2]]
        middles = 0.5 * (x[:, nodes][:, 1:] + x[:, nodes][:, :-1])[[0, 2]]
        gaps = np.linalg.norm(middles - self.target_position[[0, 2], None], axis=0) - self._state.radius[0, elements]
        if gaps.min() - body.cylinders[0].radius < CLEAR:
            raise ValueError(f"target_position {self.target_position} is in the animal or within {CLEAR} m of it")
        # rebuild the neighbour lists, since everything has moved
        self._state.n_neighbours[:] = -1
        self._activations = np.zeros((len(DIRECTIONS), len(self._body.muscles.arms), N_FUNCTIONS))
        self._moments, self._steps, self._started = [], 0, True
        self._keep()
        self._systems = [self._rod(), self._object()]
        return self.total_steps, self._systems

    def step(self, activation_array_list: Sequence[Sequence[ArrayLike]], time: float) -> tuple[float, list[Any], bool]:
        """Advance by 40 microseconds.

        Parameters
        ----------
        activation_array_list : sequence
            ``[[normal_1, normal_2], [binormal_1, binormal_2], [tangent_1, tangent_2]]``: seven activations in
            [-1, 1] per direction and arm, top level first, and within a level from head to tip.
        time : float
            Simulated time before the step [s].

        Returns
        -------
        tuple
            Time after the step [s], ``[octopus, object]``, and whether the simulation has diverged.
        """
        if not self._started:
            raise RuntimeError("call reset before step")
        self._activate(activation_array_list)
        advance(self._body.model, self._state, self._control, 0, 1, TIME_STEP, 1)
        self._steps += 1
        if self._steps % round(1.0 / (FRAMES_PER_SECOND * TIME_STEP)) == 0:
            self._keep()
        # also false for NaN
        is_sound = float(np.abs(self._state.v).max()) < self._body.sensors.fastest
        return time + TIME_STEP, self._systems, not is_sound

    def post_processing(self, filename_video: str | Path) -> Path:
        """Write a video of the time since `reset`; requires ``pip install 'elastica-gym[viz]'``.

        Raises
        ------
        RuntimeError
            If no data were collected.
        """
        if not self._moments:
            raise RuntimeError(
                "no data to show: create the Environment with COLLECT_DATA_FOR_POSTPROCESSING=True, and call reset"
            )
        from ..viz import render_frames, write_video

        return write_video(render_frames(self.rollout()), filename_video, fps=FRAMES_PER_SECOND)

    def rollout(self) -> Any:
        """Return the collected data as an `elastica_gym.viz.Rollout` with 20 frames per second."""
        from ..viz import Rollout

        body = self._body
        series = {name: np.stack([moment[name] for moment in self._moments]) for name in self._moments[0]}
        thing = body.cylinders[0]
        return Rollout(
            name="hackathon",
            body_length=body.sensors.length,
            elements_per_rod=(N_ELEMENTS,),
            head_node=MIDDLE,
            step=np.arange(len(self._moments)),
            sim_time=np.arange(len(self._moments)) / FRAMES_PER_SECOND,
            object_length=np.array([thing.length]),
            object_radius=np.array([thing.radius]),
            direction=None,
            target=None,
            target_radius=0.0,
            rewards={},
            activation_names=body.activation_names,
            **series,
        )

    def _activate(self, given: Sequence[Sequence[ArrayLike]]) -> None:
        """Command muscle activations, clipped to [-1, 1]."""
        try:
            activations = np.array(given, dtype=np.float64)
        except ValueError:
            activations = np.empty(0)
        if activations.shape != self._activations.shape or np.isnan(activations).any():
            raise ValueError("activation_array_list must be [[n1, n2], [b1, b2], [t1, t2]] with seven numbers each")
        # usually unchanged since the last step
        if (activations != self._activations).any():
            self._activations = activations
            levels = np.clip(activations, -1.0, 1.0).ravel()
            self._control.couple[0] = np.tensordot(levels, self._body.couples, axes=1)

    def _keep(self) -> None:
        if self._keeps:
            state, (nodes, elements) = self._state, self._slices()
            self._moments.append(
                {
                    "nodes": state.x[0, :, nodes].T.copy(),
                    "radii": state.radius[0, elements].copy(),
                    "normal_force": state.normal_force[0, elements].copy(),
                    "object_force": state.body_touch[0, elements].copy(),
                    "object_centre": state.body_x[0].copy(),
                    "object_axis": state.body_Q[0, :, 2].copy(),
                    "activations": self._activations.ravel().copy(),
                }
            )

    def _slices(self) -> tuple[slice, slice]:
        """Return the slots of nodes and of elements."""
        return slice(self._first, self._first + N_ELEMENTS + 1), slice(self._first, self._first + N_ELEMENTS)

    def _rod(self) -> ShearableRod:
        state, (nodes, elements) = self._state, self._slices()
        return ShearableRod(
            position_collection=state.x[0, :, nodes],
            velocity_collection=state.v[0, :, nodes],
            director_collection=state.Q[0, :, :, elements],
            omega_collection=state.w[0, :, elements],
            kappa=state.kappa[0, :, self._first : self._first + N_ELEMENTS - 1],
            lengths=state.length[0, elements],
            radius=state.radius[0, elements],
        )

    def _object(self) -> RigidBody:
        state, thing = self._state, self._body.cylinders[0]
        return RigidBody(
            position_collection=state.body_x[0].T,
            velocity_collection=state.body_v[0].T,
            director_collection=state.body_Q[0].transpose(1, 2, 0),
            omega_collection=state.body_w[0].T,
            length=thing.length,
            radius=thing.radius,
        )
