"""Pictures and videos drawn offscreen by MuJoCo's renderer, which needs no window and no GPU.

MuJoCo draws through EGL or OSMesa, which on Linux are system packages, not Python packages:
``apt-get install libegl1 libgl1-mesa-dri``, or ``libosmesa6``. The environment variable MUJOCO_GL
(``egl`` or ``osmesa``) chooses one; if it is not set, the first one found is used.
"""

import ctypes.util
import os
import sys
import weakref
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType, TracebackType
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ..engine.model import Array
from .rollout import HOME_RADIUS, Rollout, element_at, first_nodes

Image = NDArray[np.uint8]
Color = tuple[float, float, float]
"""Red, green and blue from 0 to 1"""

BODY: Color = (0.13, 0.47, 0.44)
HEAD: Color = (0.92, 0.50, 0.15)
TARGET: Color = (0.84, 0.27, 0.25)
OBJECT: Color = (0.95, 0.86, 0.72)
HOME: Color = (0.29, 0.55, 0.87)


class Quality(NamedTuple):
    """How well pictures are drawn."""

    supersampling: int
    """Pictures are drawn this many times larger and averaged down"""
    shadow_size: int
    """Width of the map of shadows [pixels]"""
    slices: int
    """Number of a capsule's sides"""


FINE = Quality(supersampling=2, shadow_size=4096, slices=28)
"""For figures and animations"""
FAST = Quality(supersampling=1, shadow_size=1024, slices=12)
"""For films, and pictures of every step; a sixth of the time"""

FIELD_OF_VIEW = 32.0
"""Vertical field of view [deg]"""

MARGIN = 1.25
"""Size of a picture relative to its content"""

FIGURES = 12_000
"""Largest number of bodies, such as capsules, in one picture"""

REACH = 0.6
"""Expected reach of an animal from its middle, in body lengths"""

FAR = 2.5
"""Distance from the animal's middle that a following camera has to show, in body lengths"""

# the lab's (x, y, z) with y up are (y, z, x) in a world with z up, a rotation; lengths are body lengths
# a lamp far away, since the shadows of a directional light leave a pattern on the ground
SCENE = """
<mujoco>
  <statistic extent="1" center="0 0 0"/>
  <visual>
    <global offwidth="{width}" offheight="{height}" fovy="{fov}"/>
    <quality shadowsize="{shadow_size}" offsamples="0" numslices="{slices}" numstacks="{stacks}"/>
    <headlight ambient="0.36 0.36 0.36" diffuse="0.17 0.17 0.17" specular="0 0 0"/>
    <map znear="0.02" zfar="60" fogstart="6" fogend="18"/>
    <rgba fog="0.96 0.965 0.955 1" haze="0.96 0.965 0.955 1"/>
  </visual>
  <asset>
    <texture type="skybox" builtin="flat" rgb1="0.96 0.965 0.955" width="8" height="48"/>
    <texture name="grid" type="2d" builtin="flat" rgb1="0.96 0.965 0.95" mark="edge" markrgb="0.76 0.79 0.76"
      width="512" height="512"/>
    <material name="ground" texture="grid" texrepeat="4 4" texuniform="true" specular="0" shininess="0"/>
  </asset>
  <worldbody>
    <light directional="false" pos="-7 -7 20" dir="0.35 0.35 -1" cutoff="18" exponent="0" diffuse="0.55 0.55 0.53"
      specular="0.25 0.25 0.25"/>
    <geom type="plane" size="0 0 0.1" material="ground"/>
  </worldbody>
</mujoco>
"""


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A body to draw.

    Attributes
    ----------
    begin, end : Array
        Ends of its elements [m], lab frame with y up, (M, 3) each; spheres if equal.
    radii : Array
        Radii of its elements [m], (M,) or a number.
    rgba : Array
        Colours from 0 to 1, (M, 4) or one for all.
    is_flat : bool
        Whether elements are cylinders with flat ends, rather than capsules.
    """

    begin: Array
    end: Array
    radii: Any
    rgba: Any
    is_flat: bool = False


@dataclass(frozen=True, kw_only=True)
class Camera:
    """The viewpoint of a picture.

    Attributes
    ----------
    look_at : Array
        The point in the middle of the picture [m], (3,).
    distance : float
        Distance of the camera from it [m].
    azimuth : float
        Direction of view about the vertical; 0 looks along -z and 90 along +x [deg].
    elevation : float
        Height of the view; -90 looks straight down [deg].
    """

    look_at: Any
    distance: float
    azimuth: float = 0.0
    elevation: float = -50.0


class Stage:
    """Ground, light and a renderer, for any number of pictures of one size.

    Use it in a ``with`` statement, or call `close`. It belongs to its process: a process forked from one that has drawn
    cannot draw, as the graphics library's threads do not survive a fork.

    Parameters
    ----------
    width, height : int
        Size of the pictures [pixels].
    unit : float
        Length of the animal [m]: the ground's grid has four lines for each.
    quality : Quality

    Raises
    ------
    ImportError
        If MuJoCo is not installed.
    RuntimeError
        If there is no graphics library, or this process was forked from one that has drawn.
    """

    def __init__(self, *, width: int = 960, height: int = 540, unit: float = 1.0, quality: Quality = FINE) -> None:
        global _drawing_process
        for name, value in (("width", width), ("height", height), ("unit", unit)):
            if not value > 0:
                raise ValueError(f"{name} must be positive, not {value}")
        _require_own_process()
        self._mujoco = _mujoco()
        self._supersampling = quality.supersampling
        large = {"width": self._supersampling * width, "height": self._supersampling * height}
        scene = SCENE.format(
            fov=FIELD_OF_VIEW,
            shadow_size=quality.shadow_size,
            slices=quality.slices,
            stacks=quality.slices // 2,
            **large,
        )
        self._model = self._mujoco.MjModel.from_xml_string(scene)
        self._data = self._mujoco.MjData(self._model)
        self._mujoco.mj_forward(self._model, self._data)
        self._unit = unit
        try:
            self._renderer = self._mujoco.Renderer(self._model, max_geom=FIGURES, **large)
        except Exception as error:
            raise RuntimeError(_no_gl(str(error))) from error
        _drawing_process = os.getpid()
        _renderers.add(self._renderer)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Free the renderer."""
        if _drawing_process == os.getpid():
            self._renderer.close()

    def draw(self, figures: list[Figure], camera: Camera) -> Image:
        """Return a picture of bodies on the ground, (height, width, 3) uint8."""
        _require_own_process()
        mujoco, scene = self._mujoco, self._renderer.scene
        view = mujoco.MjvCamera()
        view.type = mujoco.mjtCamera.mjCAMERA_FREE
        view.lookat[:] = self._world(np.asarray(camera.look_at))
        view.distance = camera.distance / self._unit
        view.azimuth, view.elevation = 180.0 - camera.azimuth, camera.elevation
        self._renderer.update_scene(self._data, view)
        for figure in figures:
            self._add(scene, figure)
        large = self._renderer.render()
        n = self._supersampling
        if n == 1:
            return large
        height, width = large.shape[0] // n, large.shape[1] // n
        small = large.reshape(height, n, width, n, 3).mean(axis=(1, 3))
        return np.round(small).astype(np.uint8)

    def _world(self, points: Array) -> Array:
        return np.asarray(points, dtype=float)[..., [2, 0, 1]] / self._unit

    def _add(self, scene: Any, figure: Figure) -> None:
        mujoco = self._mujoco
        begin, end = self._world(figure.begin), self._world(figure.end)
        radii = np.broadcast_to(np.asarray(figure.radii, dtype=float) / self._unit, len(begin))
        rgba = np.broadcast_to(np.asarray(figure.rgba, dtype=np.float32), (len(begin), 4))
        if scene.ngeom + len(begin) > scene.maxgeom:
            raise ValueError(f"figures must have at most {scene.maxgeom} elements together")
        long = mujoco.mjtGeom.mjGEOM_CYLINDER if figure.is_flat else mujoco.mjtGeom.mjGEOM_CAPSULE
        for k in range(len(begin)):
            geom = scene.geoms[scene.ngeom]
            is_sphere = np.array_equal(begin[k], end[k])
            kind = mujoco.mjtGeom.mjGEOM_SPHERE if is_sphere else long
            mujoco.mjv_initGeom(geom, kind, np.full(3, radii[k]), begin[k], np.eye(3).ravel(), rgba[k])
            geom.specular, geom.shininess = 0.3, 0.4
            if not is_sphere:
                mujoco.mjv_connector(geom, kind, radii[k], begin[k], end[k])
            scene.ngeom += 1


def figures(rollout: Rollout, moment: int) -> list[Figure]:
    """Return the figures of the animal, the objects, its home and the target at one moment of a rollout."""
    shown = [animal_of(rollout, moment), objects(rollout, moment), *home(rollout, moment)]
    if rollout.target is not None:
        shown.append(ball(rollout.target[moment], rollout.target_radius))
    return shown


def animal_of(rollout: Rollout, moment: int) -> Figure:
    """Return the figure of the animal at one moment of a rollout, with a ball around the head if it is a rod's end."""
    return animal(
        rollout.nodes[moment],
        rollout.radii[moment],
        rollout.elements_per_rod,
        head_node=rollout.head_node,
        head=HEAD if rollout.head_is_an_end else None,
    )


def objects(rollout: Rollout, moment: int) -> Figure:
    """Return the figure of the objects at one moment of a rollout."""
    begin, end = rollout.objects()
    return Figure(begin=begin[moment], end=end[moment], radii=rollout.object_radius, rgba=(*OBJECT, 1.0), is_flat=True)


def home(rollout: Rollout, moment: int) -> list[Figure]:
    """Return the figure of the disc to which the head has to return, or none if there is no home."""
    if rollout.home is None:
        return []
    begin = rollout.home[[moment]]
    thick = np.array([0.0, 0.004 * rollout.body_length, 0.0])
    return [Figure(begin=begin, end=begin + thick, radii=HOME_RADIUS, rgba=(*HOME, 1.0), is_flat=True)]


def animal(
    nodes: Array,
    radii: Array,
    elements_per_rod: tuple[int, ...] | None = None,
    *,
    head_node: int = -1,
    color: Color = BODY,
    head: Color | None = HEAD,
) -> Figure:
    """Return the figure of an animal at one moment.

    Parameters
    ----------
    nodes : Array
        Positions of its nodes, rod after rod [m], (N, 3).
    radii : Array
        Radii of its elements [m], (M,).
    elements_per_rod : tuple of int, optional
        Number of elements of each rod; if omitted, a single rod.
    head_node : int
        Index of the head's node.
    color : tuple of float
        Red, green and blue from 0 to 1, full at the head and fading along the body.
    head : tuple of float, optional
        Colour of a ball around the head; None for no ball.
    """
    counts = elements_per_rod or (len(nodes) - 1,)
    if sum(counts) != len(radii) or sum(counts) + len(counts) != len(nodes):
        raise ValueError(f"{len(nodes)} nodes and {len(radii)} radii do not make rods of {counts} elements")
    first, at = first_nodes(counts), range(len(nodes))[head_node]
    away = np.abs(first + 0.5 - at)
    tint = 0.35 * (away / away.max())[:, None]
    rgba = np.ones((len(radii), 4))
    rgba[:, :3] = np.asarray(color) * (1.0 - tint) + tint
    begin, end, thick = nodes[first], nodes[first + 1], radii
    if head is not None:
        begin, end = np.concatenate([begin, nodes[[at]]]), np.concatenate([end, nodes[[at]]])
        thick, rgba = np.append(radii, 1.25 * radii[element_at(at, counts)]), np.vstack([rgba, (*head, 1.0)])
    return Figure(begin=begin, end=end, radii=thick, rgba=rgba)


def trail(rollout: Rollout, moment: int) -> Figure:
    """Return the figure of the head's path up to a moment, a line on the ground."""
    thin = 0.2 * float(np.median(rollout.radii))
    if moment < 1:
        return line(np.zeros((1, 3)), thin)
    # imported here: it takes longer than the rest of `import elastica_gym`
    from scipy.interpolate import CubicSpline

    # a smooth line through its places at the ends of control steps, half sunk so that bodies are above it
    fine = np.linspace(0, moment, 5 * moment + 1)
    path = CubicSpline(np.arange(moment + 1), rollout.head[: moment + 1])(fine)
    return line(path * [1.0, 0.0, 1.0] + [0.0, 0.3 * thin, 0.0], thin)


def line(points: Array, radius: float, color: Color = HEAD) -> Figure:
    """Return the figure of a line through points (K, 3) with a radius [m]."""
    return Figure(begin=points[:-1], end=points[1:], radii=radius, rgba=(*color, 1.0))


def ball(centre: Array, radius: float, color: Color = TARGET, alpha: float = 0.6) -> Figure:
    """Return the figure of a ball around a point (3,) with a radius [m]."""
    points = np.asarray(centre, dtype=float)[None]
    return Figure(begin=points, end=points, radii=radius, rgba=(*color, alpha))


def render_frames(
    rollout: Rollout,
    moments: Sequence[int] | None = None,
    *,
    has_trail: bool = True,
    camera: Camera | None = None,
    follows: bool = False,
    width: int = 960,
    height: int = 540,
    quality: Quality = FINE,
    show: Callable[[float], object] | None = None,
) -> Image:
    """Draw moments of a rollout: the animal on the ground, objects and target, a frame for each moment.

    Parameters
    ----------
    rollout : Rollout
    moments : sequence of int, optional
        Indices of the moments; all if omitted.
    has_trail : bool
        Whether to draw the head's path.
    camera : Camera, optional
        By default one that shows everything from the first to the last frame.
    follows : bool
        Whether the camera moves with the animal instead.
    width, height : int
        Size of the frames [pixels].
    quality : Quality
    show : callable, optional
        Called after each frame with the fraction of frames drawn.

    Returns
    -------
    Image
        The frames, (T, height, width, 3) uint8.
    """
    picked = list(range(len(rollout.step)) if moments is None else moments)
    if not picked or not set(picked) <= set(range(len(rollout.step))):
        raise ValueError(f"moments must be indices from 0 to {len(rollout.step) - 1}, not {picked}")
    if camera is None and not follows:
        camera = framing(outline(rollout, picked), width / height)
    frames = np.empty((len(picked), height, width, 3), dtype=np.uint8)
    with Stage(width=width, height=height, unit=rollout.body_length, quality=quality) as stage:
        for number, (frame, moment) in enumerate(zip(frames, picked, strict=True), start=1):
            shown = figures(rollout, moment)
            here = camera or following(rollout, moment, width / height)
            frame[:] = stage.draw([*shown, trail(rollout, moment)] if has_trail else shown, here)
            if show is not None:
                show(number / len(picked))
    return frames


def outline(rollout: Rollout, moments: Sequence[int]) -> Array:
    """Return points (K, 3) that a picture of some moments of a rollout has to show [m]."""
    picked = list(moments)
    return np.concatenate([rollout.nodes[picked].reshape(-1, 3), *(_around(rollout, moment) for moment in picked)])


def _around(rollout: Rollout, moment: int) -> Array:
    """Return the ends of the objects, home and the target at one moment of a rollout [m], (K, 3)."""
    begin, end = rollout.objects()
    places = [place[[moment]] for place in (rollout.home, rollout.target) if place is not None]
    return np.concatenate([begin[moment], end[moment], *places])


def following(rollout: Rollout, moment: int, aspect: float) -> Camera:
    """Return a camera that follows the animal, and keeps objects and target in view while they are near.

    It leaves room for any posture of the animal, not only the current one, so it keeps its distance while the animal
    moves its limbs. It moves continuously, as everything that it shows does.
    """
    middle = rollout.nodes[moment].mean(axis=0) * [1.0, 0.0, 1.0]
    angles = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    room = np.stack([np.cos(angles), np.zeros(16), np.sin(angles)], axis=1)
    away = (_around(rollout, moment) - middle) / rollout.body_length
    away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True) / FAR, 1.0)
    return framing(middle + rollout.body_length * np.concatenate([REACH * room, away]), aspect)


def framing(points: Array, aspect: float, *, azimuth: float = 0.0, elevation: float = -50.0) -> Camera:
    """Return a camera that shows all points (K, 3), in a picture ``aspect`` times as wide as high."""
    az, el = np.deg2rad((azimuth, elevation))
    away = np.array([np.sin(az) * np.cos(el), np.sin(el), -np.cos(az) * np.cos(el)])
    right = np.array([np.cos(az), 0.0, np.sin(az)])
    up = np.cross(right, away)
    high = np.tan(np.deg2rad(0.5 * FIELD_OF_VIEW)) / MARGIN
    look_at = 0.5 * (points.min(axis=0) + points.max(axis=0))
    # near points look larger, so the middle of the picture is found iteratively
    for _ in range(8):
        across, along, deep = (points - look_at) @ right, (points - look_at) @ up, (points - look_at) @ away
        distance = float(np.max(np.maximum(np.abs(across) / (aspect * high), np.abs(along) / high) - deep))
        seen_across, seen_along = across / (distance + deep), along / (distance + deep)
        look_at = look_at + 0.5 * distance * (
            (seen_across.min() + seen_across.max()) * right + (seen_along.min() + seen_along.max()) * up
        )
    return Camera(look_at=look_at, distance=1.02 * distance, azimuth=azimuth, elevation=elevation)


def write_video(frames: Image, path: str | Path, fps: float = 20.0) -> Path:
    """Write frames (T, height, width, 3) as an H.264 video, which needs imageio-ffmpeg.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    try:
        import imageio_ffmpeg
    except ImportError as error:
        raise ImportError("videos need imageio-ffmpeg: pip install 'elastica-gym[viz]'") from error
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()
    height, width = frames.shape[1:3]
    writer = imageio_ffmpeg.write_frames(str(path), (width, height), fps=fps, macro_block_size=2, quality=8)
    try:
        writer.send(None)
        for frame in frames:
            writer.send(np.ascontiguousarray(frame))
    except OSError as error:
        raise OSError(f"cannot write the video {path}: {str(error).splitlines()[0]}") from error
    finally:
        writer.close()
    if not path.is_file() or path.stat().st_size == 0:
        raise OSError(f"cannot write the video {path}")
    return path


_drawing_process: int | None = None
"""Process that created the first renderer: this one, or one from which it was forked"""

_renderers: weakref.WeakSet[Any] = weakref.WeakSet()
"""Renderers in use"""

_inherited: list[Any] = []
"""Renderers inherited in a fork, kept since freeing them would wait for threads that did not survive it"""

if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=lambda: _inherited.extend(_renderers))


def _require_own_process() -> None:
    if _drawing_process not in (None, os.getpid()):
        raise RuntimeError(
            "this process was forked from one that has drawn, and cannot draw: start it with the method 'spawn', as "
            "AsyncVectorEnv does with context='spawn'"
        )


def _mujoco() -> ModuleType:
    """Import MuJoCo, choosing a graphics library unless the user has."""
    is_linux = sys.platform.startswith("linux")
    if is_linux and "mujoco" not in sys.modules and "MUJOCO_GL" not in os.environ:
        for name, library in (("egl", "EGL"), ("osmesa", "OSMesa")):
            if ctypes.util.find_library(library):
                os.environ["MUJOCO_GL"] = name
                break
        else:
            raise RuntimeError(_no_gl("neither EGL nor OSMesa is installed"))
    try:
        import mujoco
    except ImportError as error:
        raise ImportError("pictures need MuJoCo: pip install 'elastica-gym[viz]'") from error
    except Exception as error:
        raise RuntimeError(_no_gl(str(error))) from error
    return mujoco


def _no_gl(why: str) -> str:
    return (
        f"MuJoCo cannot draw offscreen (MUJOCO_GL={os.environ.get('MUJOCO_GL', '')}): {why}\n"
        "On Debian or Ubuntu: apt-get install libegl1 libgl1-mesa-dri, or apt-get install libosmesa6. If MuJoCo was "
        "imported before, set MUJOCO_GL=egl (or osmesa) before Python starts."
    )
