"""Recordings of the library's simulations, for the rerun viewer.

A recording holds, on the timelines ``step`` and ``sim_time``:

| entity | content |
|---|---|
| ``/rods/<number>/body`` | a solid capsule for each element |
| ``/rods/<number>/nodes`` | the nodes, inside the capsules |
| ``/bodies/<number>`` | a solid cylinder or ball |
| ``/energy/<kind>`` | translational, rotational, bending and shear energy of all recorded systems [J] |

Rods and bodies are numbered separately from 0, in the order given.
"""

import importlib
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..engine.model import Array
from ..viz.recording import (
    APPLICATION_ID,
    BACKGROUND,
    HEAD,
    OBJECT,
    SERIES,
    import_rerun,
    rotations_from_z,
    send_columns,
    write_whole,
)
from .rigidbody import RigidBodyBase, Sphere
from .rod.rod_base import RodBase

if TYPE_CHECKING:
    import rerun as rr

ENERGIES = ("translational", "rotational", "bending", "shear")


class SystemRecorder:
    """Collects the motion of rods and rigid bodies, and writes it as a recording.

    Parameters
    ----------
    name : str
        Name in the viewer.
    """

    def __init__(self, name: str) -> None:
        # if rerun is missing, raise before the run rather than after it
        import_rerun()
        self._name = name
        self._step: list[int] = []
        self._sim_time: list[float] = []
        self._rods: list[RodBase] = []
        self._bodies: list[RigidBodyBase] = []
        self._moments: list[dict[str, list[Array]]] = []
        self._energies: list[list[float]] = []

    def capture(self, systems: Sequence[Any], time: float, step: int) -> None:
        """Append the current state; the systems are the same at each call."""
        self._rods = [each for each in systems if isinstance(each, RodBase)]
        self._bodies = [each for each in systems if isinstance(each, RigidBodyBase)]
        self._step.append(step)
        self._sim_time.append(float(time))
        self._moments.append(
            {
                "nodes": [rod.position_collection.T.copy() for rod in self._rods],
                "radii": [np.array(rod.radius) for rod in self._rods],
                "centre": [body.position_collection[:, 0].copy() for body in self._bodies],
                "axis": [body.director_collection[2, :, 0].copy() for body in self._bodies],
            }
        )
        self._energies.append([sum(_energy(each, kind) for each in (*self._rods, *self._bodies)) for kind in ENERGIES])

    def write(self, path: str | Path) -> Path:
        """Write the recording atomically.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        rr = import_rerun()
        stream = rr.RecordingStream(APPLICATION_ID)
        memory = stream.binary_stream()
        stream.send_blueprint(_blueprint(self._name))
        stream.send_recording_name(self._name)
        stream.log("/", rr.ViewCoordinates.RIGHT_HAND_Y_UP, static=True)
        times: Any = SimpleNamespace(step=np.array(self._step, dtype=np.int64), sim_time=np.array(self._sim_time))
        for number, rod in enumerate(self._rods):
            _log_rod(
                stream, times, number, self._series("nodes", number), self._series("radii", number), rod.ring_rod_flag
            )
        for number, body in enumerate(self._bodies):
            _log_body(stream, times, number, self._series("centre", number), self._series("axis", number), body)
        for kind, values in zip(ENERGIES, np.array(self._energies).T, strict=True):
            send_columns(stream, times, f"energy/{kind}", rr.Scalars.columns(scalars=values))
        return write_whole(Path(path), memory.read())

    def _series(self, what: str, number: int) -> Array:
        return np.array([moment[what][number] for moment in self._moments])


def _energy(system: Any, kind: str) -> float:
    """Return an energy of a system [J]; rigid bodies have only two kinds."""
    compute = getattr(system, f"compute_{kind}_energy", None)
    # a body's energy is an array of shape (1,), as in PyElastica
    return 0.0 if compute is None else float(np.sum(compute()))


def _log_rod(stream: "rr.RecordingStream", times: Any, number: int, nodes: Array, radii: Array, is_ring: bool) -> None:
    """Log a rod: nodes [m], (T, N, 3), and radii of elements [m], (T, M)."""
    rr = import_rerun()
    ends = np.concatenate([nodes, nodes[:, :1]], axis=1) if is_ring else nodes
    edges, color = np.diff(ends, axis=1), SERIES[number % len(SERIES)]
    n_steps, n_elements = radii.shape
    body = rr.Capsules3D.columns(
        translations=ends[:, :-1].reshape(-1, 3),
        quaternions=rotations_from_z(edges).reshape(-1, 4),
        lengths=np.linalg.norm(edges, axis=-1).ravel(),
        radii=radii.ravel(),
    )
    send_columns(stream, times, f"rods/{number}/body", body.partition([n_elements] * n_steps))
    stream.log(f"rods/{number}/body", rr.Capsules3D.from_fields(fill_mode="solid", colors=[color]), static=True)
    points = rr.Points3D.columns(positions=nodes.reshape(-1, 3)).partition([nodes.shape[1]] * n_steps)
    send_columns(stream, times, f"rods/{number}/nodes", points)
    style = rr.Points3D.from_fields(radii=0.2 * float(np.median(radii)), colors=[HEAD])
    stream.log(f"rods/{number}/nodes", style, static=True)


def _log_body(
    stream: "rr.RecordingStream", times: Any, number: int, centre: Array, axis: Array, body: RigidBodyBase
) -> None:
    """Log a rigid body: its centre [m] and the unit vector along its axis, (T, 3) each."""
    rr = import_rerun()
    entity = f"bodies/{number}"
    shape: Any
    if isinstance(body, Sphere):
        send_columns(stream, times, entity, rr.Ellipsoids3D.columns(centers=centre))
        shape = rr.Ellipsoids3D.from_fields(half_sizes=[[body.radius] * 3], colors=[OBJECT], fill_mode="solid")
    else:
        send_columns(stream, times, entity, rr.Cylinders3D.columns(centers=centre, quaternions=rotations_from_z(axis)))
        shape = rr.Cylinders3D.from_fields(
            lengths=[body.length], radii=[body.radius], colors=[OBJECT], fill_mode="solid"
        )
    stream.log(entity, shape, static=True)


def _blueprint(name: str) -> Any:
    """Describe the layout: the scene next to the energies, played in real time."""
    rrb = importlib.import_module("rerun.blueprint")
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Spatial3DView(name=name, contents=["/rods/**", "/bodies/**"], background=BACKGROUND),
            rrb.TimeSeriesView(name="Energy [J]", origin="/energy"),
            column_shares=[3, 2],
        ),
        rrb.TimePanel(timeline="sim_time", play_state="playing", loop_mode="all", state="collapsed"),
        collapse_panels=True,
    )
