"""Small products, rotations and knot theory, beside PyElastica 1.0.0."""

import numpy as np
import pytest

import elastica_gym.cosserat as ours
from elastica_gym.cosserat import _calculus, _linalg, _rotations, transformations

pytest.importorskip("elastica", reason="pip install 'elastica-gym[bench]'")

from elastica import _calculus as their_calculus
from elastica import _linalg as their_linalg
from elastica import _rotations as their_rotations
from elastica import transformations as their_transformations
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
]  # fmt: skip


@pytest.mark.parametrize(("mine", "theirs", "name", "given"), CALLS, ids=[name for _, _, name, _ in CALLS])
def test_same_numbers(mine, theirs, name, given):
    expected, found = (getattr(each, name)(*(np.array(a) if isinstance(a, np.ndarray) else a for a in given))
                       for each in (theirs, mine))  # fmt: skip
    assert np.shape(found) == np.shape(expected)
    assert np.allclose(found, expected, atol=1e-12)


def test_inverse_rotation_and_skew():
    frames = _rotations._rotate(np.repeat(np.eye(3)[:, :, None], N, axis=2), 1.0, 0.5 * A)
    turned = _rotations._inv_rotate(np.ascontiguousarray(frames))
    assert np.allclose(_rotations._rotate(frames[..., :-1], 1.0, turned), frames[..., 1:], atol=1e-13)
    assert np.allclose(ours.inv_skew_symmetrize(transformations.skew_symmetrize(A)), A)
    with pytest.raises(ValueError, match="skew-symmetric"):
        ours.inv_skew_symmetrize(M)


def test_isqrt():
    assert [ours.isqrt(n) for n in (0, 15, 16, 10**20)] == [0, 3, 4, 10**10]


@pytest.mark.parametrize("kind", ["next_tangent", "end_to_end", "net_tangent"])
def test_knot_theory(kind):
    t = np.linspace(0.0, 4.0 * np.pi, 40)
    lines = np.array([[np.cos(t), np.sin(t), a * t + 0.1 * np.sin(3.0 * t)] for a in (0.1, 0.4)])
    tangents = np.diff(lines, axis=2)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    middle = 0.5 * (t[1:] + t[:-1])
    normals = np.repeat(np.array([np.cos(2.0 * middle), np.zeros(39), np.sin(2.0 * middle)])[None], 2, axis=0)
    normals = normals - tangents * (normals * tangents).sum(axis=1, keepdims=True)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    radius = np.full((2, 39), 0.01)
    assert np.allclose(ours.compute_writhe(lines, 5.0, kind), their_knots.compute_writhe(lines, 5.0, kind), atol=1e-6)
    assert np.allclose(ours.compute_twist(lines, normals)[0], their_knots.compute_twist(lines, normals)[0], atol=2e-3)
    assert np.allclose(ours.compute_link(lines, normals, radius, 5.0, kind),
                       their_knots.compute_link(lines, normals, radius, 5.0, kind), atol=2e-3)  # fmt: skip
