"""Small products, rotations and knot theory, against PyElastica 1.0.0."""

import copy
import importlib
import inspect

import numpy as np
import pytest

import elastica_gym.cosserat as ours
from elastica_gym.cosserat import _calculus, _linalg, _rotations, transformations
from elastica_gym.cosserat import utils as our_utils
from elastica_gym.cosserat.rod import cosserat_rod as our_rods

pytest.importorskip("elastica", reason="pip install 'elastica-gym[bench]'")

from elastica import _calculus as their_calculus
from elastica import _linalg as their_linalg
from elastica import _rotations as their_rotations
from elastica import transformations as their_transformations
from elastica import utils as their_utils
from elastica.rod import cosserat_rod as their_rods
from elastica.rod import knot_theory as their_knots

N = 7
RNG = np.random.default_rng(0)
A, B = RNG.standard_normal((2, 3, N))
M, L = RNG.standard_normal((2, 3, 3, N))
S, V = RNG.standard_normal(N), RNG.standard_normal(3)
GHOSTS = np.array([2, 4])

CALLS = [
    (_calculus, their_calculus, "position_difference_kernel", (A,)),
    (_calculus, their_calculus, "position_average", (S,)),
    (_calculus, their_calculus, "quadrature_kernel", (A,)),
    (_calculus, their_calculus, "difference_kernel", (A,)),
    (_calculus, their_calculus, "quadrature_kernel_for_block_structure", (A, GHOSTS)),
    (_calculus, their_calculus, "difference_kernel_for_block_structure", (A, GHOSTS)),
    (_calculus, their_calculus, "_clip_array", (S, -0.2, 0.3)),
    (_linalg, their_linalg, "levi_civita_tensor", (3,)),
    (_linalg, their_linalg, "_batch_matvec", (M, A)),
    (_linalg, their_linalg, "_batch_matmul", (M, L)),
    (_linalg, their_linalg, "_batch_cross", (A, B)),
    (_linalg, their_linalg, "_batch_vec_oneD_vec_cross", (A, V)),
    (_linalg, their_linalg, "_batch_dot", (A, B)),
    (_linalg, their_linalg, "_batch_norm", (A,)),
    (_linalg, their_linalg, "_batch_product_i_k_to_ik", (V, S)),
    (_linalg, their_linalg, "_batch_product_i_ik_to_k", (V, A)),
    (_linalg, their_linalg, "_batch_product_k_ik_to_ik", (S, A)),
    (_linalg, their_linalg, "_batch_vector_sum", (A, B)),
    (_linalg, their_linalg, "_batch_matrix_transpose", (M,)),
    (_rotations, their_rotations, "_get_rotation_matrix", (0.7, A)),
    (_rotations, their_rotations, "_rotate", (M, 0.7, A)),
    (_rotations, their_rotations, "_skew_symmetrize", (A,)),
    (transformations, their_transformations, "rotate", (np.eye(3), 0.4, V)),
    (transformations, their_transformations, "skew_symmetrize", (V,)),
]


@pytest.mark.parametrize(("mine", "theirs", "name", "given"), CALLS, ids=[name for _, _, name, _ in CALLS])
def test_same_numbers(mine, theirs, name, given):
    expected, found = (
        getattr(each, name)(*(np.array(a) if isinstance(a, np.ndarray) else a for a in given))
        for each in (theirs, mine)
    )
    assert np.shape(found) == np.shape(expected)
    assert np.allclose(found, expected, atol=1e-12)


# parts of contact, fluids and loads, and small functions

RADIUS, LENGTHS = np.abs(RNG.standard_normal((2, N - 1))) + 0.1
MASS = np.abs(RNG.standard_normal(N)) + 0.1
ROD_ONE, ROD_TWO = (A, RADIUS, LENGTHS), (B + 3.0, RADIUS, LENGTHS)
TURN = np.ascontiguousarray(np.linalg.qr(M[..., 0])[0])[:, :, None]
SEGMENT_PAIRS = np.random.default_rng(5).standard_normal((60, 4, 3))
# some that are parallel, cross, or are closest at their ends
SEGMENT_PAIRS[:10, 3] = -0.7 * SEGMENT_PAIRS[:10, 1]
SEGMENT_PAIRS[10:20, 2] += 5.0
HELPERS = {
    "contact_utils": [
        ("_dot_product", (A[:, 0], B[:, 0])),
        ("_norm", (A[:, 0],)),
        ("_clip", (0.3, 0.5, 1.0)),
        ("_clip", (1.3, 0.5, 1.0)),
        ("_out_of_bounds", (0.3, 0.5, 1.0)),
        ("_out_of_bounds", (0.7, 0.5, 1.0)),
        ("_node_to_element_mass_or_force", (A,)),
        ("_node_to_element_position", (A,)),
        ("_node_to_element_velocity", (MASS, A)),
        ("_find_slipping_elements", (A, 0.8)),
        ("_aabbs_not_intersecting", (np.array([[0.0, 1.0]] * 3), np.array([[0.5, 1.0], [0.9, 2.0], [1.0, 3.0]]))),
        ("_aabbs_not_intersecting", (np.array([[0.0, 1.0]] * 3), np.array([[0.5, 1.0], [0.9, 2.0], [1.1, 3.0]]))),
        ("_prune_using_aabbs_rod_rod", (*ROD_ONE, *ROD_TWO)),
        ("_prune_using_aabbs_rod_rod", (*ROD_ONE, B + 30.0, RADIUS, LENGTHS)),
        ("_prune_using_aabbs_rod_cylinder", (*ROD_ONE, np.full((3, 1), 1.0), TURN, 0.1, 0.5)),
        ("_prune_using_aabbs_rod_cylinder", (*ROD_ONE, np.full((3, 1), 30.0), TURN, 0.1, 0.5)),
        ("_prune_using_aabbs_rod_sphere", (*ROD_ONE, np.full((3, 1), 1.0), TURN, 0.1)),
        ("_prune_using_aabbs_rod_sphere", (*ROD_ONE, np.full((3, 1), 30.0), TURN, 0.1)),
        *(("_find_min_dist", tuple(pair)) for pair in SEGMENT_PAIRS),
        *(("_find_min_dist_cylinder_sphere", tuple(pair[:3])) for pair in SEGMENT_PAIRS[:5]),
    ],
    "interaction": [
        ("sum_over_elements", (S,)),
        (
            "slender_body_forces",
            (np.diff(A) / np.linalg.norm(np.diff(A), axis=0), B, 0.3, LENGTHS, 0.01 * RADIUS, MASS),
        ),
    ],
    "restart": [("all_equal", ([1, 1, 1],)), ("all_equal", ([1, 2],)), ("all_equal", ([],)), ("all_equal", ([0],))],
    "utils": [
        ("perm_parity", ([0, 1, 2],)),
        ("perm_parity", ([1, 0, 2],)),
        ("perm_parity", ([3, 0, 1, 2],)),
        ("perm_parity", ([2, 0, 1, 4, 3],)),
    ],
}


@pytest.mark.parametrize(
    ("module", "name", "given"), [(module, *call) for module, calls in HELPERS.items() for call in calls]
)
def test_helpers(module, name, given):
    expected, found = (
        getattr(importlib.import_module(f"{lib}.{module}"), name)(*copy.deepcopy(given))
        for lib in ("elastica", "elastica_gym.cosserat")
    )
    expected, found = (each if isinstance(each, tuple) else (each,) for each in (expected, found))
    for one, other in zip(expected, found, strict=True):
        assert np.shape(one) == np.shape(other) and np.allclose(one, other, atol=1e-12)


def test_small_functions():
    for utils in (their_utils, our_utils):
        spline, points, coefficients = utils._bspline(np.array([0.0, 1.0, -2.0, 3.0, 0.5, 0.0]), 2.0)
        assert np.allclose(points, [0.0, 2.0 / 3.0, 4.0 / 3.0, 2.0]) and coefficients.size == 6
        assert spline(1.1) == pytest.approx(0.917390625)
        assert list(utils.grouper("ABCDEFG", 3)) == [("A", "B", "C"), ("D", "E", "F"), ("G",)]
        thing = type("Thing", (), {})()
        utils.extend_instance(thing, type("Mixin", (), {"answer": lambda self: 42}))
        assert thing.answer() == 42 and type(thing).__name__ == "Thing"
    for name in ("atol", "rtol"):
        assert getattr(our_utils.Tolerance, name)() == getattr(their_utils.Tolerance, name)()


def test_half_of_an_element_on_each_node():
    nodes = {}
    for lib in ("elastica", "elastica_gym.cosserat"):
        nodes[lib] = B.copy()
        importlib.import_module(f"{lib}.contact_utils")._elements_to_nodes_inplace(A[:, 1:].copy(), nodes[lib])
    assert np.allclose(*nodes.values(), atol=1e-15)


def test_stages_of_a_rod_in_place():
    """All results of PyElastica's step, by the functions that scripts import from `rod.cosserat_rod`."""
    rod = their_rods.CosseratRod.straight_rod(
        N, np.zeros(3), np.eye(3)[2], np.eye(3)[1], 0.3, 0.01, 1000.0, youngs_modulus=1e5
    )
    rng = np.random.default_rng(3)
    rod.position_collection += 0.01 * rng.standard_normal((3, N + 1))
    turn = 0.3 * rng.standard_normal((3, N))
    rod.director_collection[:] = their_rotations._rotate(rod.director_collection, 1.0, turn)
    for name in ("velocity_collection", "omega_collection", "external_forces", "external_torques", "rest_kappa"):
        getattr(rod, name)[:] = rng.standard_normal(getattr(rod, name).shape)
    functions = (
        "_compute_internal_forces",
        "_compute_internal_torques",
        "_update_accelerations",
        "_zeroed_out_external_forces_and_torques",
    )
    results = []
    for module in (their_rods, our_rods):
        fields = {name: value.copy() for name, value in vars(rod).items() if isinstance(value, np.ndarray)}
        written = {name: np.full_like(value, np.nan) for name, value in fields.items() if name in WRITTEN}
        fields |= written
        for name in functions:
            parameters = inspect.signature(getattr(their_rods, name).py_func).parameters
            getattr(module, name)(*(fields[parameter] for parameter in parameters))
        results.append(fields)
    for name, expected in results[0].items():
        assert np.allclose(results[1][name], expected, rtol=1e-9, atol=1e-9), name
        assert np.isfinite(results[1][name]).all(), name
    assert np.array_equal(our_rods._get_z_vector(), their_rods._get_z_vector())


WRITTEN = (
    "lengths",
    "tangents",
    "radius",
    "dilatation",
    "voronoi_dilatation",
    "dilatation_rate",
    "sigma",
    "kappa",
    "internal_stress",
    "internal_couple",
    "internal_forces",
    "internal_torques",
    "acceleration_collection",
)


def test_loads_and_constraints_as_functions():
    calls = {
        ("external_forces", "GravityForces", "compute_gravity_forces"): (V, MASS, A),
        ("external_forces", "EndpointForces", "compute_end_point_forces"): (A, V, -2.0 * V, 0.3, 1.0),
        ("external_forces", "MuscleTorques", "compute_muscle_torques"): (
            0.3,
            S,
            np.linspace(0.1, 1.0, N),
            2.0,
            3.0,
            0.2,
            1.0,
            V,
            M,
            A,
        ),
        ("boundary_conditions", "OneEndFixedBC", "compute_constrain_values"): (A, V, M, L[..., 0]),
        ("boundary_conditions", "OneEndFixedBC", "compute_constrain_rates"): (A, B),
    }
    for (module, cls, name), given in calls.items():
        results = []
        for lib in ("elastica", "elastica_gym.cosserat"):
            arguments = copy.deepcopy(given)
            getattr(getattr(importlib.import_module(f"{lib}.{module}"), cls), name)(*arguments)
            results.append(arguments)
        for one, other in zip(*results, strict=True):
            assert np.allclose(one, other, atol=1e-12), name
        assert any(not np.array_equal(after, before) for after, before in zip(results[1], given, strict=True)), name


def test_inverse_rotation_and_skew():
    frames = _rotations._rotate(np.repeat(np.eye(3)[:, :, None], N, axis=2), 1.0, 0.5 * A)
    turned = _rotations._inv_rotate(np.ascontiguousarray(frames))
    assert np.allclose(_rotations._rotate(frames[..., :-1], 1.0, turned), frames[..., 1:], atol=1e-13)
    assert np.allclose(ours.inv_skew_symmetrize(transformations.skew_symmetrize(A)), A)
    with pytest.raises(ValueError, match="skew-symmetric"):
        ours.inv_skew_symmetrize(M)


def test_isqrt():
    assert [ours.isqrt(n) for n in (0, 15, 16, 10**20)] == [0, 3, 4, 10**10]


@pytest.mark.parametrize("shape", [(9,), (3, 3), (9, N), (N, 9), (12, 9), (3, 3, N), (3, 3, 3), (N, 3, 3)])
def test_shapes_of_frames(shape):
    frames = np.random.default_rng(1).standard_normal(shape)
    if shape == (N, 9):
        # PyElastica reads fewer than ten rows differently
        expected = frames.T.reshape(3, 3, N)
    else:
        expected = their_transformations.format_matrix_shape(frames.copy())
    found = transformations.format_matrix_shape(frames)
    assert np.array_equal(found, expected)
    axis = np.random.default_rng(2).standard_normal((3, expected.shape[2]))
    turned = their_rotations._rotate(np.ascontiguousarray(expected), 0.3, axis)
    assert np.allclose(transformations.rotate(frames, 0.3, axis), turned, atol=1e-12)


# knot theory: polygons that stay away from themselves, so that quadrature converges

SEGMENTS = ["next_tangent", "end_to_end", "net_tangent"]
TIMES = np.linspace(0.0, 0.93 * 2.0 * np.pi, 33)
LINES = {
    "trefoil": np.array(
        [np.sin(TIMES) + 2.0 * np.sin(2.0 * TIMES), np.cos(TIMES) - 2.0 * np.cos(2.0 * TIMES), -np.sin(3.0 * TIMES)]
    ),
    "even trefoil": np.array(
        [np.sin(TIMES) + 2.0 * np.sin(2.0 * TIMES), np.cos(TIMES) - 2.0 * np.cos(2.0 * TIMES), -np.sin(3.0 * TIMES)]
    )[:, :-1],
    "coil": np.array([np.cos(2.0 * TIMES), np.sin(2.0 * TIMES), 0.3 * TIMES + 0.1 * np.sin(3.0 * TIMES)]),
    "walk": np.cumsum(np.random.default_rng(0).standard_normal((3, 16)), axis=1),
    "another walk": np.cumsum(np.random.default_rng(1).standard_normal((3, 15)), axis=1),
}
LENGTH = 5.0


def lengthened(line, kind, other=None):
    """Return a curve, or an offset one, with segments added at its ends in the curve's end directions."""
    half = line.shape[1] // 2
    last = {
        "next_tangent": line[:, -1] - line[:, -2],
        "end_to_end": line[:, -1] - line[:, 0],
        "net_tangent": line[:, -half:].mean(axis=1) - line[:, :half].mean(axis=1),
    }[kind]
    first = line[:, 0] - line[:, 1] if kind == "next_tangent" else -last
    first, last = (LENGTH * d / np.linalg.norm(d) for d in (first, last))
    given = line if other is None else other
    return np.column_stack([given[:, 0] + first, given, given[:, -1] + last])


def gauss_integral(one, two):
    """Return the Gauss integral over 4 pi by quadrature; for a curve with itself, without neighbouring segments."""
    points, weights = np.polynomial.legendre.leggauss(60)
    points, weights = 0.5 * (points + 1.0), 0.5 * weights
    total = 0.0
    for i in range(one.shape[1] - 1):
        for j in range(two.shape[1] - 1):
            if one is two and abs(i - j) < 2:
                continue
            u, w = one[:, i + 1] - one[:, i], two[:, j + 1] - two[:, j]
            r = (one[:, i] + points[:, None, None] * u) - (two[:, j] + points[None, :, None] * w)
            total += weights @ (r @ np.cross(u, w) / np.linalg.norm(r, axis=2) ** 3) @ weights
    return total / (4.0 * np.pi)


def normals_of(line):
    """Return normals that rotate along a line, neither unit vectors nor perpendicular to it."""
    return np.random.default_rng(2).standard_normal(line.shape)[:, 1:]


@pytest.mark.parametrize("kind", SEGMENTS)
@pytest.mark.parametrize("line", LINES.values(), ids=LINES.keys())
def test_writhe_is_the_gauss_integral(line, kind):
    curve = lengthened(line, kind)
    found = ours.compute_writhe(line[None], LENGTH, kind)
    assert found == pytest.approx(gauss_integral(curve, curve), abs=1e-4)


MIDDLE = 0.5 * (TIMES[1:] + TIMES[:-1])
RIBBONS = {
    "coil": np.array([np.cos(2.0 * MIDDLE) * np.cos(MIDDLE), np.sin(2.0 * MIDDLE) * np.cos(MIDDLE), np.sin(MIDDLE)]),
    "trefoil": np.array([np.zeros(32), np.zeros(32), np.ones(32)]),
}
"""Normals that rotate slowly from element to element, so that the offset line stays away from the first"""


# (the trefoil's end along its tangent comes too close to the offset line for quadrature)
@pytest.mark.parametrize(
    ("name", "kind"), [*(("coil", kind) for kind in SEGMENTS), ("trefoil", "end_to_end"), ("trefoil", "net_tangent")]
)
def test_link_is_the_gauss_integral(name, kind):
    line, normals = LINES[name], RIBBONS[name]
    tangents = np.diff(line)
    across = normals - tangents * (normals * tangents).sum(axis=0) / (tangents**2).sum(axis=0)
    across *= 0.3 / np.linalg.norm(across, axis=0)
    # the offset line: a node uses the normal of the element that ends there
    beside = line + np.column_stack([across[:, 0], across])
    found = ours.compute_link(line[None], normals[None], np.full((1, 32), 0.3), LENGTH, kind)
    expected = gauss_integral(lengthened(line, kind), lengthened(line, kind, beside))
    assert found == pytest.approx(expected, abs=1e-4)


def test_collinear_segments_have_no_writhe():
    """The segments added end to end to a random walk are collinear: PyElastica adds rounding noise of up to 1."""
    for seed in range(200):
        walk = np.cumsum(np.random.default_rng(seed).standard_normal((3, 4)), axis=1)
        curve = lengthened(walk, "end_to_end")
        # without the pair of first and last segment
        cut = [ours.compute_writhe(piece[None], LENGTH, None)[0] for piece in (curve[:, :-1], curve[:, 1:], walk)]
        found = ours.compute_writhe(walk[None], LENGTH, "end_to_end")
        assert found == pytest.approx(cut[0] + cut[1] - cut[2], abs=1e-12)


@pytest.mark.parametrize("kind", ["next_tangent", "end_to_end"])
@pytest.mark.parametrize("line", LINES.values(), ids=LINES.keys())
def test_knot_theory_against_pyelastica(line, kind):
    """Except net_tangent, where PyElastica divides the sum over one half by one node too many."""
    normals, radius = normals_of(line)[None], np.full((1, line.shape[1] - 1), 0.1)
    twist, local = ours.compute_twist(line[None], normals)
    their_twist, their_local = their_knots.compute_twist(line[None], normals)
    assert np.allclose(twist, their_twist, atol=1e-7) and np.allclose(local, their_local, atol=1e-7)
    found, expected = (each.compute_link(line[None], normals, radius, LENGTH, kind) for each in (ours, their_knots))
    assert found == pytest.approx(expected, abs=1e-5)
    if kind == "next_tangent":
        found, expected = (each.compute_writhe(line[None], LENGTH, kind) for each in (ours, their_knots))
        assert found == pytest.approx(expected, abs=1e-5)


def test_link_is_twist_and_writhe():
    """For a thin open ribbon with added end segments (Calugareanu 1961)."""
    t = np.linspace(0.0, 4.0 * np.pi, 400)
    line = np.array([np.cos(t), np.sin(t), 0.2 * t])
    middle = 0.5 * (t[1:] + t[:-1])
    normals = np.array([np.cos(3.0 * middle), np.zeros(399), np.sin(3.0 * middle)])[None]
    link = ours.compute_link(line[None], normals, np.full((1, 399), 1e-3), LENGTH)
    twist, writhe = ours.compute_twist(line[None], normals)[0], ours.compute_writhe(line[None], LENGTH)
    assert link == pytest.approx(twist + writhe, abs=2e-2)


def test_errors_of_knot_theory():
    line, normals = LINES["walk"][None], normals_of(LINES["walk"])[None]
    with pytest.raises(ValueError, match=r"type_of_additional_segment must be one of .* not 'next_tangents'"):
        ours.compute_writhe(line, LENGTH, "next_tangents")
    with pytest.raises(ValueError, match="normals of its elements"):
        ours.compute_twist(line, normals[..., :-1])
