"""Muscles: order, arms, and couples without net force or torque on the animal."""

import numpy as np
import pytest

from elastica_gym.bodies import octopus, snake
from elastica_gym.bodies.muscles import (
    DIRECTIONS,
    OCTOPUS,
    SNAKE,
    activations_for,
    basis,
    couple_matrix,
)
from elastica_gym.engine import advance, at_rest

ROD = snake().rods[0]
MATRIX = couple_matrix(SNAKE, ROD)


def test_order_is_direction_arm_level_position():
    names = SNAKE.activation_names
    assert len(names) == len(set(names)) == SNAKE.n_activations == 42
    assert names[0] == "normal/front/0.0" and names[7] == "normal/rear/0.0"
    assert names[14].startswith("binormal/front") and names[41] == "tangent/rear/2.3"


def test_each_activation_acts_in_its_direction_and_arm_only():
    middle = 24
    for a, name in enumerate(SNAKE.activation_names):
        direction, arm, _ = name.split("/")
        for d, other in enumerate(DIRECTIONS):
            assert MATRIX[a, d].any() == (other == direction)
        part = slice(None, middle) if arm == "front" else slice(middle + 1, None)
        assert not MATRIX[a, :, part].any()


def test_front_arm_begins_at_the_head():
    last_level = MATRIX[3:7, 0]
    peaks = last_level.argmax(axis=1)
    assert (np.diff(peaks) < 0).all() and peaks[0] > 40


def test_basis_is_gaussian_with_its_peaks_at_the_centres():
    widths = SNAKE.widths["normal"]
    np.testing.assert_allclose(basis(np.array([0.5]), widths)[0], 1.0)
    np.testing.assert_allclose(basis(np.array([0.25 + widths[1]]), widths)[1], np.exp(-1.0))
    assert not basis(np.array([-0.01, 1.01]), widths).any()


def test_activations_for_recover_couples_of_muscles():
    wanted = np.random.default_rng(0).uniform(-0.9, 0.9, (3, 42))
    wanted[:, 14:] = 0.0
    couples = np.einsum("ma,ak->mk", wanted, MATRIX[:, 0])
    np.testing.assert_allclose(
        np.einsum("ma,ak->mk", activations_for(couples, MATRIX), MATRIX[:, 0]), couples, atol=1e-6
    )


@pytest.mark.parametrize("seed", range(3))
def test_muscles_neither_push_nor_spin_a_free_snake(seed):
    body = snake()
    free = body.model._replace(
        gravity=np.zeros(3), is_viscous=False, planes=body.model.planes._replace(origin=np.array([[0.0, -10.0, 0.0]]))
    )
    state, control = at_rest(free, body.rods)
    control.couple[0] = np.einsum("a,acl->cl", np.random.default_rng(seed).uniform(-1, 1, 42), body.couples)
    advance(free, state, control, 0, 1, 2e-5, 2000)
    x, v, m = state.x[0], state.v[0], free.mass
    first, n = int(free.first_slot[0]), ROD.n_elements
    elements = slice(first, first + n)
    stretch = np.linalg.norm(np.diff(x[:, first : first + n + 1], axis=1), axis=0) / free.rest_length[elements]
    own = free.inertia[:, elements] * state.w[0, :, elements] / stretch
    spin = np.cross(x.T, (m * v).T).sum(axis=0) + np.einsum("jik,jk->i", state.Q[0, :, :, elements], own)
    assert np.abs(m * v).sum() > 1e-4
    assert np.abs((m * v).sum(axis=1)).max() < 1e-12
    # up to the second-order error of the time step
    assert np.abs(spin).max() < 1e-6 * np.abs(np.cross(x.T, (m * v).T)).sum()


def test_joints_at_the_ends_of_arms_have_muscle():
    halves = MATRIX.reshape(3, 2, 7, 3, -1)
    assert (np.abs(halves[..., 24]).max(axis=(2, 3)) > 0.0).all()
    body = octopus()
    arms = couple_matrix(OCTOPUS, body.rods[0]).reshape(3, 2, 7, 3, -1)
    assert (np.abs(arms[:, 0, ..., 49]).max(axis=(1, 2)) > 0.0).all()
    # the arms are mirror images, both counted from the head
    np.testing.assert_allclose(arms[:, 0], arms[:, 1, ..., ::-1], atol=1e-12)
