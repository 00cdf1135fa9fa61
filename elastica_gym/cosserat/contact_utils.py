"""Contact functions that PyElastica scripts import for their own compiled functions.

The library's own contact does not use them; see `kernels`.
"""

from math import sqrt

import numpy as np
from numba import njit

from ._linalg import _batch_norm

PARALLEL = 1e-6
"""Squared sine below which segments count as parallel"""


@njit(cache=True)
def _dot_product(a, b):
    """Return a . b of two vectors (3,)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def _norm(a):
    """Return the length of a vector (3,)."""
    return sqrt(_dot_product(a, a))


@njit(cache=True)
def _clip(x, low, high):
    """Return x clipped to two bounds."""
    return max(low, min(x, high))


@njit(cache=True)
def _out_of_bounds(x, low, high):
    """Return whether x is outside two bounds."""
    return x < low or x > high


@njit(cache=True)
def _nearest(point, x, e):
    """Return the parameter, 0 to 1, of the point nearest to a given one on the segment from x along e."""
    return _clip(_dot_product(point - x, e) / _dot_product(e, e), 0.0, 1.0)


@njit(cache=True)
def _find_min_dist(x1, e1, x2, e2):
    """Return the shortest vector from one segment to another, its end point, and x1 - t e1.

    The segments start at x1 and x2 and run along e1 and e2, (3,). The nearest point of the first is x1 + t e1;
    the sign of t in the last value is PyElastica's.
    """
    between = x1 - x2
    a, b, c = _dot_product(e1, e1), _dot_product(e1, e2), _dot_product(e2, e2)
    d1, d2 = _dot_product(between, e1), _dot_product(between, e2)
    if abs(1.0 - b * b / (a * c)) < PARALLEL:
        t = _nearest(x2, x1, e1)
        s = _nearest(x1 + t * e1, x2, e2)
        return x2 + s * e2 - x1 - t * e1, x2 + s * e2, x1 - t * e1
    # closest points of the infinite lines
    s = (a * d2 - b * d1) / (a * c - b * b)
    t = (b * s - d1) / a
    if _out_of_bounds(s, 0.0, 1.0) or _out_of_bounds(t, 0.0, 1.0):
        # end of one segment and the nearest point of the other
        least = np.inf
        for case in range(4):
            end = float(case % 2)
            if case < 2:
                new_s, new_t = end, _nearest(x2 + end * e2, x1, e1)
            else:
                new_s, new_t = _nearest(x1 + end * e1, x2, e2), end
            distance = _norm(x2 + new_s * e2 - x1 - new_t * e1)
            if distance < least:
                least, s, t = distance, new_s, new_t
    return x2 + s * e2 - x1 - t * e1, x2 + s * e2, x1 - t * e1


@njit(cache=True)
def _find_min_dist_cylinder_sphere(x1, e1, x2):
    """Return the shortest vector from a segment to a point, the point, and x1 - t e1 as in `_find_min_dist`."""
    t = _nearest(x2, x1, e1)
    return x2 - x1 - t * e1, x2, x1 - t * e1


@njit(cache=True)
def _aabbs_not_intersecting(aabb_one, aabb_two):
    """Return 1 if two axis-aligned boxes, (3, 2), are apart, 0 if not."""
    for i in range(3):
        if aabb_one[i, 1] < aabb_two[i, 0] or aabb_one[i, 0] > aabb_two[i, 1]:
            return 1
    return 0


@njit(cache=True)
def _box(points, margin):
    """Return the bounding box, (3, 2), of points, (3, n), with a margin for each axis."""
    box = np.empty((3, 2))
    for i in range(3):
        box[i, 0], box[i, 1] = np.min(points[i]) - margin[i], np.max(points[i]) + margin[i]
    return box


@njit(cache=True)
def _prune_using_aabbs_rod_rod(
    rod_one_position_collection,
    rod_one_radius_collection,
    rod_one_length_collection,
    rod_two_position_collection,
    rod_two_radius_collection,
    rod_two_length_collection,
):
    """Return 1 if the bounding boxes of two rods are apart, 0 if not."""
    one = np.full(3, np.max(rod_one_radius_collection) + np.max(rod_one_length_collection))
    two = np.full(3, np.max(rod_two_radius_collection) + np.max(rod_two_length_collection))
    return _aabbs_not_intersecting(_box(rod_two_position_collection, two), _box(rod_one_position_collection, one))


@njit(cache=True)
def _prune_using_aabbs_rod_cylinder(
    rod_one_position_collection,
    rod_one_radius_collection,
    rod_one_length_collection,
    cylinder_position,
    cylinder_director,
    cylinder_radius,
    cylinder_length,
):
    """Return 1 if the bounding boxes of a rod and a cylinder are apart, 0 if not.

    Unlike PyElastica's, the box of an oblique cylinder contains all of it.
    """
    rod = np.full(3, np.max(rod_one_radius_collection) + np.max(rod_one_length_collection))
    cylinder = np.zeros(3)
    for i in range(3):
        cylinder[i] = cylinder_radius * (abs(cylinder_director[0, i, 0]) + abs(cylinder_director[1, i, 0]))
        cylinder[i] += 0.5 * cylinder_length * abs(cylinder_director[2, i, 0])
    return _aabbs_not_intersecting(_box(cylinder_position, cylinder), _box(rod_one_position_collection, rod))


@njit(cache=True)
def _prune_using_aabbs_rod_sphere(
    rod_one_position_collection,
    rod_one_radius_collection,
    rod_one_length_collection,
    sphere_position,
    sphere_director,
    sphere_radius,
):
    """Return 1 if the bounding boxes of a rod and a sphere are apart, 0 if not."""
    rod, sphere = np.full(3, np.max(rod_one_radius_collection)), np.full(3, sphere_radius)
    return _aabbs_not_intersecting(_box(sphere_position, sphere), _box(rod_one_position_collection, rod))


@njit(cache=True)
def _find_slipping_elements(velocity_slip, velocity_threshold):
    """Return the static fraction of friction: 1 up to the threshold, 0 above twice it, (3, n) to (n,)."""
    slip = _batch_norm(velocity_slip)
    for k in range(slip.size):
        slip[k] = 1.0 - _clip(slip[k] / velocity_threshold - 1.0, 0.0, 1.0)
    return slip


@njit(cache=True)
def _node_to_element_mass_or_force(input):
    """Return sums over elements: half of each inner node, all of the end nodes, (3, n + 1) to (3, n)."""
    result = 0.5 * (input[:, 1:] + input[:, :-1])
    result[:, 0] += 0.5 * input[:, 0]
    result[:, -1] += 0.5 * input[:, -1]
    return result


@njit(cache=True)
def _elements_to_nodes_inplace(vector_in_element_frame, vector_in_node_frame):
    """Add half of each element's value to each of its nodes, (3, n) and (3, n + 1)."""
    vector_in_node_frame[:, :-1] += 0.5 * vector_in_element_frame
    vector_in_node_frame[:, 1:] += 0.5 * vector_in_element_frame


@njit(cache=True)
def _node_to_element_position(node_position_collection):
    """Return the midpoints of elements, (3, n + 1) to (3, n)."""
    return 0.5 * (node_position_collection[:, 1:] + node_position_collection[:, :-1])


@njit(cache=True)
def _node_to_element_velocity(mass, node_velocity_collection):
    """Return the velocities of the centres of mass of elements, (n + 1,) and (3, n + 1) to (3, n)."""
    momentum = mass * node_velocity_collection
    return (momentum[:, 1:] + momentum[:, :-1]) / (mass[1:] + mass[:-1])
