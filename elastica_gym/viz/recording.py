"""Recordings of rollouts for the rerun viewer.

A recording holds, on the timelines ``step`` and ``sim_time``:

| entity | content |
|---|---|
| ``/ground`` | the ground, a solid slab whose upper side is slightly below the grid at y = 0 |
| ``/animal/body`` | a solid capsule for each element, darker with ground load, red in contact with an object |
| ``/animal/nodes`` | the nodes, inside the capsules |
| ``/animal/head`` | a ball around the head, if it is a rod's end |
| ``/animal/trail`` | the path of the head |
| ``/animal/direction`` | an arrow over the head in the direction to go, if the goal has one |
| ``/animal/normal_force`` | the normal force of the ground, by element [N] |
| ``/animal/object_force`` | the normal force between objects and body, by element [N], if there are objects |
| ``/objects`` | a solid cylinder for each object |
| ``/home`` | a disc on the ground to which the head has to return, if the task has a home |
| ``/target`` | a sphere that the head has to enter, if the task has a target |
| ``/reward/<term>``, ``/return`` | weighted reward of each term, and the return so far |
| ``/activations/<direction>/<arm>`` | activations of an arm's muscles |

It is written a column at a time, and opens with the layout that `_blueprint` describes.
"""

import importlib
import warnings
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from ..engine.model import Array
from ..files import write_atomically
from .rollout import HOME_RADIUS, Policy, Rollout, run_rollout

if TYPE_CHECKING:
    import rerun as rr

APPLICATION_ID = "elastica_gym"

SCENE = (
    "ground",
    "home",
    "target",
    "objects",
    "animal/body",
    "animal/nodes",
    "animal/head",
    "animal/trail",
    "animal/direction",
)
"""Entities shown in the view of the scene"""

GROUND = (226, 229, 225)
GRID = (120, 130, 125, 90)
BACKGROUND = (247, 248, 246)
TARGET = (214, 69, 65, 150)
HEAD = (235, 127, 38)
UNLOADED = np.array((178, 208, 196))
LOADED = np.array((10, 88, 84))
TOUCHED = np.array((214, 69, 65))
OBJECT = (196, 174, 140)
HOME = (74, 140, 222)
DIRECTION = (74, 163, 223)
SERIES = ((74, 163, 223), (235, 127, 38), (126, 196, 150), (214, 69, 65), (178, 132, 207), (222, 198, 82))
"""Colours of reward terms"""
LEVELS = ((235, 127, 38), (74, 163, 223), (126, 196, 150))
"""Colours of the three levels of activations"""


def record_rollout(env: Any, policy: Policy, path: str | Path, *, seed: int = 0, **kwargs: Any) -> Path:
    """Run one episode and write it as a recording that rerun opens.

    Parameters
    ----------
    env : str or Batch
        Id of a registered environment or a batch, as in `run_rollout`.
    policy : callable
        ``policy(observations (B, d), env) -> actions (B, 42)``.
    path : str or Path
        Path of the file, which by convention ends in ``.rrd``.
    seed : int
        Seed of the episode.
    **kwargs
        Passed to `run_rollout`: ``index`` and the environment's arguments.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    import_rerun()
    return write_recording(run_rollout(env, policy, seed=seed, **kwargs), path)


def write_recording(rollout: Rollout, path: str | Path) -> Path:
    """Write a rollout as a recording, atomically.

    Raises
    ------
    OSError
        If the file cannot be written: the folder is not writable or the disk full.
    """
    return write_stream(lambda stream: log_rollout(stream, rollout, rollout.name), Path(path))


def log_rollout(stream: "rr.RecordingStream", rollout: Rollout, name: str) -> None:
    """Send a rollout with its layout to a stream, as a recording with a name."""
    stream.send_blueprint(_blueprint(rollout))
    stream.send_recording_name(name)
    _log_scene(stream, rollout)
    _log_animal(stream, rollout)
    _log_head(stream, rollout)
    _log_objects(stream, rollout)
    _log_series(stream, rollout)


def write_stream(log: Callable[["rr.RecordingStream"], None], path: Path) -> Path:
    """Write what ``log`` sends to a stream as a recording, whole or not at all."""
    stream = import_rerun().RecordingStream(APPLICATION_ID)
    # rerun's own file sink reports a full disk only in the log, so the bytes go through memory
    memory = stream.binary_stream()
    log(stream)
    data = memory.read()
    if not data:
        raise RuntimeError("rerun recorded nothing; is the environment variable RERUN set to off?")
    return write_whole(path, data)


def read_positions(path: str | Path) -> tuple[Array, Array]:
    """Return the simulated times [s], (T,), and the nodes [m], (T, N, 3), of a recording.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is not a complete recording of an animal.
    """
    rr, path = import_rerun(), Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"no recording at {path}")
    try:
        with warnings.catch_warnings():
            # for a truncated file, rerun also warns that it may be an old one
            warnings.simplefilter("ignore")
            stream = rr.chunk.RrdReader(path).stream()
        parts = stream.filter(content="/animal/nodes", components="Points3D:positions").to_chunks()
    except Exception as error:
        raise ValueError(f"{path} is not a complete rerun recording: {error}") from error
    times, nodes = [], []
    for batch in (part.to_record_batch() for part in parts):
        column = batch.column("Points3D:positions")
        times.append(batch.column("sim_time").cast("int64").to_numpy() / 1e9)
        nodes.append(column.flatten().flatten().to_numpy().reshape(batch.num_rows, -1, 3))
    if not nodes:
        raise ValueError(f"{path} is not a recording of an animal: it has no /animal/nodes")
    order = np.argsort(np.concatenate(times), kind="stable")
    return np.concatenate(times)[order], np.concatenate(nodes)[order]


def import_rerun() -> ModuleType:
    """Return the module rerun, or raise ImportError with installation instructions."""
    try:
        import rerun
    except ImportError as error:
        raise ImportError("recordings need rerun: pip install 'elastica-gym[viz]'") from error
    return rerun


def write_whole(path: Path, data: bytes) -> Path:
    """Write a recording atomically, so that an error leaves no partial file."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, lambda part: part.write_bytes(data))
    except OSError as error:
        raise OSError(
            error.errno, f"cannot write the recording of {len(data)} bytes: {error.strerror}", str(path)
        ) from error
    return path


def send_columns(stream: "rr.RecordingStream", rollout: Rollout, entity: str, columns: Any) -> None:
    """Send the columns of an entity over both timelines."""
    rr = import_rerun()
    indexes = [rr.TimeColumn("step", sequence=rollout.step), rr.TimeColumn("sim_time", duration=rollout.sim_time)]
    stream.send_columns(entity, indexes=indexes, columns=columns, strict=True)


def _view_box(rollout: Rollout) -> tuple[Array, float]:
    """Return centre and width of the scene, (3,) and a length [m]."""
    seen = [points.reshape(-1, 3) for points in (rollout.nodes, *rollout.objects())]
    seen += [place for place in (rollout.home, rollout.target) if place is not None]
    seen = [points for points in seen if points.size]
    low = np.min([points.min(axis=0) for points in seen], axis=0)
    high = np.max([points.max(axis=0) for points in seen], axis=0)
    return 0.5 * (low + high), float(max(*(high - low), rollout.body_length))


def _log_scene(stream: "rr.RecordingStream", rollout: Rollout) -> None:
    """Log the static scene: axes, ground, home and target."""
    rr = import_rerun()
    centre, width = _view_box(rollout)
    half, depth = 4.0 * width, 0.01 * rollout.body_length
    stream.log("/", rr.ViewCoordinates.RIGHT_HAND_Y_UP, static=True)
    stream.log(
        "ground",
        rr.Boxes3D(
            centers=[[centre[0], -depth, centre[2]]],
            half_sizes=[[half, 0.9 * depth, half]],
            colors=[GROUND],
            fill_mode="solid",
        ),
        static=True,
    )
    if rollout.home is not None:
        disc = rr.Cylinders3D(
            centers=rollout.home[:1],
            quaternions=rotations_from_z(np.array([[0.0, 1.0, 0.0]])),
            radii=[HOME_RADIUS],
            lengths=[0.004 * rollout.body_length],
            colors=[HOME],
            fill_mode="solid",
        )
        stream.log("home", disc, static=True)
    if rollout.target is not None:
        send_columns(
            stream,
            rollout,
            "target",
            rr.Ellipsoids3D.columns(
                centers=rollout.target,
                half_sizes=np.full_like(rollout.target, rollout.target_radius),
            ),
        )
        stream.log("target", rr.Ellipsoids3D.from_fields(colors=[TARGET], fill_mode="solid"), static=True)


def _log_animal(stream: "rr.RecordingStream", rollout: Rollout) -> None:
    """Log the body."""
    rr = import_rerun()
    begin, end = rollout.segments()
    n_steps, n_elements = rollout.radii.shape
    body = rr.Capsules3D.columns(
        translations=begin.reshape(-1, 3),
        quaternions=rotations_from_z(end - begin).reshape(-1, 4),
        lengths=np.linalg.norm(end - begin, axis=-1).ravel(),
        radii=rollout.radii.ravel(),
        colors=contact_colors(rollout.normal_force, rollout.object_force).reshape(-1, 3),
    )
    send_columns(stream, rollout, "animal/body", body.partition([n_elements] * n_steps))
    stream.log("animal/body", rr.Capsules3D.from_fields(fill_mode="solid"), static=True)
    nodes = rr.Points3D.columns(positions=rollout.nodes.reshape(-1, 3)).partition([rollout.nodes.shape[1]] * n_steps)
    send_columns(stream, rollout, "animal/nodes", nodes)
    stream.log("animal/nodes", rr.Points3D.from_fields(radii=0.2 * _thickness(rollout), colors=[HEAD]), static=True)


def _log_head(stream: "rr.RecordingStream", rollout: Rollout) -> None:
    """Log the head, its trail, and the direction to go."""
    rr = import_rerun()
    thick, above = _thickness(rollout), 1.1 * rollout.head_radius.max()
    if rollout.head_is_an_end:
        ball = 1.5 * thick
        above = ball + 0.1 * thick
        send_columns(
            stream,
            rollout,
            "animal/head",
            rr.Ellipsoids3D.columns(
                centers=rollout.head,
                half_sizes=np.full_like(rollout.head, ball),
            ),
        )
        stream.log("animal/head", rr.Ellipsoids3D.from_fields(colors=[HEAD], fill_mode="solid"), static=True)

    # a piece of the trail for each step; the blueprint shows all pieces up to now
    path = rollout.head + np.array([0.0, above, 0.0])
    pieces = np.stack([np.concatenate([path[:1], path[:-1]]), path], axis=1)
    send_columns(stream, rollout, "animal/trail", rr.LineStrips3D.columns(strips=pieces))
    stream.log("animal/trail", rr.LineStrips3D.from_fields(radii=0.25 * thick, colors=[HEAD]), static=True)

    if rollout.direction is not None:
        arrows = rr.Arrows3D.columns(
            origins=path + np.array([0.0, thick, 0.0]), vectors=0.2 * rollout.body_length * rollout.direction
        )
        send_columns(stream, rollout, "animal/direction", arrows)
        stream.log("animal/direction", rr.Arrows3D.from_fields(radii=0.25 * thick, colors=[DIRECTION]), static=True)


def _log_objects(stream: "rr.RecordingStream", rollout: Rollout) -> None:
    """Log the objects."""
    rr = import_rerun()
    n_steps, n_objects = rollout.object_centre.shape[:2]
    if not n_objects:
        return
    poses = rr.Cylinders3D.columns(
        centers=rollout.object_centre.reshape(-1, 3),
        quaternions=rotations_from_z(rollout.object_axis).reshape(-1, 4),
    )
    send_columns(stream, rollout, "objects", poses.partition([n_objects] * n_steps))
    shapes = rr.Cylinders3D.from_fields(
        lengths=rollout.object_length, radii=rollout.object_radius, colors=[OBJECT], fill_mode="solid"
    )
    stream.log("objects", shapes, static=True)


def _thickness(rollout: Rollout) -> float:
    """Return the typical radius of the body, the scale of lines and points [m]."""
    return float(np.median(rollout.radii))


def _log_series(stream: "rr.RecordingStream", rollout: Rollout) -> None:
    """Log the time series."""
    rr = import_rerun()

    def log(entity: str, values: Array, names: list[str], **style: Any) -> None:
        columns = rr.Scalars.columns(scalars=values.ravel())
        send_columns(stream, rollout, entity, columns.partition([values.shape[1]] * len(values)))
        stream.log(entity, rr.SeriesLines(names=names, **style), static=True)

    for k, (term, values) in enumerate(rollout.rewards.items()):
        log(f"reward/{term}", values[:, None], [term], colors=[SERIES[k % len(SERIES)]])
    log("return", rollout.episode_return[:, None], ["return"], colors=[SERIES[0]])
    elements = [f"element {k}" for k in range(rollout.normal_force.shape[1])]
    log("animal/normal_force", rollout.normal_force, elements)
    if rollout.object_length.size:
        log("animal/object_force", rollout.object_force, elements)
    for group in activation_groups(rollout):
        members = [k for k, name in enumerate(rollout.activation_names) if name.startswith(f"{group}/")]
        names = [rollout.activation_names[k].rpartition("/")[2] for k in members]
        levels = [int(name.partition(".")[0]) for name in names]
        style = {"colors": [LEVELS[level] for level in levels], "widths": [2.5 - 0.7 * level for level in levels]}
        log(f"activations/{group}", rollout.activations[:, members], names, **style)


def activation_groups(rollout: Rollout) -> list[str]:
    """Return the names of the groups of activations, ``direction/arm``, in order."""
    return list(dict.fromkeys(name.rpartition("/")[0] for name in rollout.activation_names))


def contact_colors(normal_force: Array, object_force: Array) -> Array:
    """Return a colour for each element: pale without load, dark at twice the mean load, red in contact with objects.

    Parameters
    ----------
    normal_force : Array
        Normal force of the ground on each element [N], (T, M).
    object_force : Array
        Normal force between each element and the objects [N], (T, M).

    Returns
    -------
    Array
        (T, M, 3) uint8.
    """
    mean = float(normal_force.mean())
    load = np.clip(normal_force / (2.0 * mean), 0.0, 1.0) if mean > 0.0 else np.zeros_like(normal_force)
    colors = UNLOADED + load[..., None] * (LOADED - UNLOADED)
    return np.round(np.where(object_force[..., None] > 0.0, TOUCHED, colors)).astype(np.uint8)


def rotations_from_z(vectors: Array) -> Array:
    """Return the quaternions (x, y, z, w) of the shortest rotations from +z to vectors (..., 3), (..., 4)."""
    t = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    q = np.stack([-t[..., 1], t[..., 0], np.zeros_like(t[..., 0]), 1.0 + t[..., 2]], axis=-1)
    size = np.linalg.norm(q, axis=-1, keepdims=True)
    return np.where(size > 1e-9, q / np.maximum(size, 1e-9), [1.0, 0.0, 0.0, 0.0])


def _blueprint(rollout: Rollout) -> Any:
    """Describe the layout: the scene, with rewards, return and activations beside it, playing in real time."""
    rr, rrb = import_rerun(), importlib.import_module("rerun.blueprint")

    from_start = rrb.VisibleTimeRange(
        "sim_time", start=rrb.TimeRangeBoundary.infinite(), end=rrb.TimeRangeBoundary.cursor_relative()
    )
    from_first = rrb.VisibleTimeRange(
        "step", start=rrb.TimeRangeBoundary.infinite(), end=rrb.TimeRangeBoundary.cursor_relative()
    )
    centre, width = _view_box(rollout)
    scene = rrb.Spatial3DView(
        name=rollout.name,
        contents=[f"/{name}" for name in SCENE],
        overrides={"/animal/trail": [rrb.VisibleTimeRanges([from_start, from_first])]},
        background=BACKGROUND,
        line_grid=rrb.LineGrid3D(
            visible=True,
            spacing=0.5 * rollout.body_length,
            plane=rr.components.Plane3D((0.0, 1.0, 0.0)),
            stroke_width=1.0,
            color=GRID,
        ),
        eye_controls=rrb.EyeControls3D(
            kind="Orbital",
            look_target=centre,
            position=centre + width * np.array([0.0, 0.8, 0.7]),
            eye_up=(0.0, 1.0, 0.0),
        ),
    )
    rewards = rrb.Horizontal(
        rrb.TimeSeriesView(name="Reward by term", origin="/reward"),
        rrb.TimeSeriesView(name="Return", origin="/return", plot_legend=rrb.PlotLegend(visible=False)),
    )
    activations = rrb.Grid(
        *(
            rrb.TimeSeriesView(
                name=f"Activations: {group.replace('/', ', ')}",
                origin=f"/activations/{group}",
                axis_y=rrb.ScalarAxis(range=(-1.05, 1.05)),
                plot_legend=rrb.PlotLegend(visible=False),
            )
            for group in activation_groups(rollout)
        ),
        grid_columns=2,
    )
    return rrb.Blueprint(
        rrb.Horizontal(scene, rrb.Vertical(rewards, activations, row_shares=[1, 3]), column_shares=[3, 2]),
        rrb.TimePanel(timeline="sim_time", play_state="playing", loop_mode="all", state="collapsed"),
        collapse_panels=True,
    )
