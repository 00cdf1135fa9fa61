"""Twist, writhe and link of rods (Klenin and Langowski 2000, methods 2a and 1a).

The area spanned by a pair of segments on the unit sphere is computed from two triangles, by the formula of
Van Oosterom and Strackee 1983. Unlike a sum of arcsines, it is exact for collinear or coplanar segments.
"""

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from ...engine.model import Array
from ..not_offered import refuse_names

SEGMENTS = ("next_tangent", "end_to_end", "net_tangent")


class KnotTheoryCompatibleProtocol(Protocol):
    """Attributes that `KnotTheory` needs: nodes (3, n + 1), directors (3, 3, n), radii (n,), rest lengths (n,)."""

    @property
    def position_collection(self) -> Array: ...  # noqa: D102
    @property
    def director_collection(self) -> Array: ...  # noqa: D102
    @property
    def radius(self) -> Array: ...  # noqa: D102
    @property
    def rest_lengths(self) -> Array: ...  # noqa: D102


class KnotTheory:
    """Twist, writhe and link as methods.

    An open rod is closed at infinity: a segment as long as the rod is added to each of its ends.
    ``type_of_additional_segment`` sets its direction:

    - ``"next_tangent"``: along the tangents at the ends;
    - ``"end_to_end"``: along the line from the first node to the last;
    - ``"net_tangent"``: along the line between the mean nodes of the two halves, without the middle node
      if the number is odd.

    None adds no segments.
    """

    position_collection: Array
    director_collection: Array
    radius: Array
    rest_lengths: Array

    def compute_twist(self) -> np.float64:
        """Return the twist [turns]."""
        total, _ = compute_twist(self.position_collection[None], self.director_collection[None, 0])
        return total[0]

    def compute_writhe(self, type_of_additional_segment: str | None = "next_tangent") -> np.float64:
        """Return the writhe [turns]."""
        length = float(self.rest_lengths.sum())
        return compute_writhe(self.position_collection[None], length, type_of_additional_segment)[0]

    def compute_link(self, type_of_additional_segment: str | None = "next_tangent") -> np.float64:
        """Return the link, twist plus writhe [turns]."""
        length = float(self.rest_lengths.sum())
        return compute_link(
            self.position_collection[None],
            self.director_collection[None, 0],
            self.radius[None],
            length,
            type_of_additional_segment,
        )[0]


def compute_twist(center_line: ArrayLike, normal_collection: ArrayLike) -> tuple[Array, Array]:
    """Return the turns of the normals around the centre line (Klenin and Langowski 2000, method 2a).

    Parameters
    ----------
    center_line : array_like
        Nodes over time, (time, 3, n + 1).
    normal_collection : array_like
        Normals d1 of elements over time, (time, 3, n).

    Returns
    -------
    total, local : Array
        Twist [turns]: summed, (time,), and between neighbouring elements, (time, n - 1).
    """
    line, normals = _line_and_normals(center_line, normal_collection)
    tangents = _tangents(line)
    normals = _across(normals, tangents)
    before, after = tangents[..., :-1], tangents[..., 1:]
    carried = _turned(normals[..., :-1], before, after)
    sine = (after * np.cross(carried, normals[..., 1:], axis=1)).sum(axis=1)
    cosine = (carried * normals[..., 1:]).sum(axis=1)
    local = np.arctan2(sine, cosine) / (2.0 * np.pi)
    return local.sum(axis=1), local


def _turned(vectors: Array, before: Array, after: Array) -> Array:
    """Return vectors turned by the smallest rotation from unit tangents ``before`` to ``after``."""
    axis = np.cross(before, after, axis=1)
    cosine = (before * after).sum(axis=1, keepdims=True)
    # Rodrigues' formula, (1 - c)/s^2 = 1/(1 + c)
    along = axis * (axis * vectors).sum(axis=1, keepdims=True) / np.maximum(1.0 + cosine, 1e-12)
    return vectors * cosine + np.cross(axis, vectors, axis=1) + along


def compute_writhe(
    center_line: ArrayLike, segment_length: float, type_of_additional_segment: str | None = "next_tangent"
) -> Array:
    """Return the writhe of open curves (Klenin and Langowski 2000, method 1a).

    Parameters
    ----------
    center_line : array_like
        Nodes over time, (time, 3, n + 1).
    segment_length : float
        Length of the segments added at the ends [m].
    type_of_additional_segment : str or None
        As in `KnotTheory`.

    Returns
    -------
    Array
        Writhe [turns], (time,).
    """
    line = _lengthened(np.asarray(center_line, dtype=float), segment_length, type_of_additional_segment)
    return np.array([_gauss(nodes.T) for nodes in line])


def compute_link(
    center_line: ArrayLike,
    normal_collection: ArrayLike,
    radius: ArrayLike,
    segment_length: float,
    type_of_additional_segment: str | None = "next_tangent",
) -> Array:
    """Return the link of a centre line and the line offset from it by a radius along the normals.

    Parameters
    ----------
    center_line : array_like
        Nodes over time, (time, 3, n + 1).
    normal_collection : array_like
        Normals d1 of elements over time, (time, 3, n).
    radius : array_like
        Radii of elements over time, (time, n).
    segment_length : float
        Length of the segments added at the ends [m].
    type_of_additional_segment : str or None
        As in `KnotTheory`.

    Returns
    -------
    Array
        Link [turns], (time,).
    """
    line, normals = _line_and_normals(center_line, normal_collection)
    offset = np.asarray(radius, dtype=float)[:, None, :] * _across(normals, _tangents(line))
    # a node takes the normal of the element before it, the first node that of the first element
    other = line + np.concatenate([offset[..., :1], offset], axis=2)
    ends = [_lengthened(line, segment_length, type_of_additional_segment)]
    ends.append(_lengthened_like(other, ends[0]) if ends[0].shape != line.shape else other)
    return np.array([_gauss(one.T, two.T) for one, two in zip(*ends, strict=True)])


def _line_and_normals(center_line: ArrayLike, normal_collection: ArrayLike) -> tuple[Array, Array]:
    line, normals = np.asarray(center_line, dtype=float), np.asarray(normal_collection, dtype=float)
    if line.ndim != 3 or normals.shape != (line.shape[0], 3, line.shape[2] - 1):
        raise ValueError(
            "center_line must be nodes of an open rod, (time, 3, n + 1), and normal_collection normals "
            f"of its elements, (time, 3, n), not {line.shape} and {normals.shape}"
        )
    return line, normals


def _tangents(line: Array) -> Array:
    edges = np.diff(line, axis=2)
    return edges / np.linalg.norm(edges, axis=1, keepdims=True)


def _across(normals: Array, tangents: Array) -> Array:
    """Return the components of normals perpendicular to tangents, normalised."""
    across = normals - tangents * (normals * tangents).sum(axis=1, keepdims=True)
    return across / np.linalg.norm(across, axis=1, keepdims=True)


def _lengthened(line: Array, length: float, kind: str | None) -> Array:
    """Return curves with a segment added at each end, (time, 3, n + 1) to (time, 3, n + 3)."""
    if kind is None:
        return line
    if kind not in SEGMENTS:
        raise ValueError(f"type_of_additional_segment must be one of {SEGMENTS} or None, not {kind!r}")
    if kind == "next_tangent":
        first, last = line[..., 0] - line[..., 1], line[..., -1] - line[..., -2]
    elif kind == "end_to_end":
        last = line[..., -1] - line[..., 0]
        first = -last
    else:
        half = line.shape[2] // 2
        last = line[..., -half:].mean(axis=2) - line[..., :half].mean(axis=2)
        first = -last
    first, last = (length * d / np.linalg.norm(d, axis=1, keepdims=True) for d in (first, last))
    return np.concatenate([(line[..., 0] + first)[..., None], line, (line[..., -1] + last)[..., None]], axis=2)


def _lengthened_like(line: Array, other: Array) -> Array:
    """Return curves with the end segments of ``other``, parallel to them."""
    first = line[..., 0] + other[..., 0] - other[..., 1]
    last = line[..., -1] + other[..., -1] - other[..., -2]
    return np.concatenate([first[..., None], line, last[..., None]], axis=2)


def _gauss(one: Array, two: Array | None = None) -> np.float64:
    """Return the Gauss integral over 4 pi of two polygons, or of one with itself, nodes (n, 3)."""
    other = one if two is None else two
    start, end = one[:-1, None], one[1:, None]
    r13, r14, r24, r23 = (_unit(r) for r in (other[:-1] - start, other[1:] - start, other[1:] - end, other[:-1] - end))
    area = _triangle(r13, r24, r14) + _triangle(r13, r23, r24)
    if two is None:
        # a segment and its neighbour are coplanar: the area is zero but for rounding
        i, j = np.indices(area.shape)
        area = np.where(np.abs(i - j) > 1, area, 0.0)
    return area.sum() / (4.0 * np.pi)


def _triangle(a: Array, b: Array, c: Array) -> Array:
    """Return the signed area of triangles on the unit sphere with corners (..., 3)."""
    volume = (a * np.cross(b, c)).sum(axis=-1)
    return 2.0 * np.arctan2(volume, 1.0 + (a * b).sum(axis=-1) + (b * c).sum(axis=-1) + (c * a).sum(axis=-1))


def _unit(vectors: Array) -> Array:
    size = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.divide(vectors, size, out=np.zeros_like(vectors), where=size > 1e-300)


__getattr__ = refuse_names(__name__)
