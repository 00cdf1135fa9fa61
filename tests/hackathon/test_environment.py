"""The interface of the 2020 hackathon, as used by its main loop."""

import numpy as np
import pytest

from elastica_gym.hackathon import Environment

TARGET = np.array([-0.4, 0.0, 0.5])


def activation(direction=None, arm=0, level=1.0):
    activations = np.zeros((3, 2, 7))
    if direction is not None:
        activations[direction, arm] = level
    return [[*pair] for pair in activations]


def play(env, activations, steps):
    _, systems = env.reset()
    time, done = np.float64(0.0), False
    for _ in range(steps):
        time, systems, done = env.step(activations, time)
    return time, systems, done


def test_the_published_main_loop():
    final_time = 0.02
    env = Environment(final_time, TARGET, COLLECT_DATA_FOR_POSTPROCESSING=True)
    total_steps, systems = env.reset()
    assert total_steps == 500
    time, done = np.float64(0.0), False
    arm_1_normal, rest = np.zeros(7), np.zeros(7)
    chosen = [[arm_1_normal, rest], [rest, rest], [rest, rest]]
    for i_sim in range(total_steps):
        if i_sim % 200:
            shearable_rod = systems[0]
            rigid_body = systems[1]
            arm_1_normal[0] = -shearable_rod.position_collection[0, 0]
        time, systems, done = env.step(chosen, time)
        if done:
            break
    assert time == pytest.approx(final_time) and not done
    assert shearable_rod.position_collection.shape == (3, 121) and shearable_rod.n_elems == 120
    assert shearable_rod.director_collection.shape == (3, 3, 120)
    assert rigid_body.position_collection.shape == (3, 1) and rigid_body.director_collection.shape == (3, 3, 1)


def test_initial_positions():
    _, (rod, thing) = Environment(1.0, [-0.5, 0.0, 0.3]).reset()
    np.testing.assert_allclose(rod.position_collection[[0, 2], 60], [0.0, 0.5], atol=1e-12)
    np.testing.assert_allclose(thing.position_collection[:, 0], [-0.5, 0.5 * thing.length, 0.3], atol=1e-3)
    np.testing.assert_allclose(thing.director_collection[2, :, 0], [0.0, 1.0, 0.0], atol=1e-9)
    assert (rod.velocity_collection == 0.0).all()
    # the head's axis, from the first arm to the second, is along +z as published
    assert rod.position_collection[2, 70] > 0.55 and rod.position_collection[2, 50] < 0.45


def test_at_rest_it_stays():
    env = Environment(1.0, TARGET)
    _, (rod, _) = env.reset()
    before = rod.position_collection.copy()
    for step in range(1000):
        _, systems, done = env.step(activation(), 4e-5 * step)
    assert not done and systems[0] is rod
    np.testing.assert_allclose(rod.position_collection, before, atol=2e-3)


@pytest.mark.parametrize("arm", [0, 1])
@pytest.mark.parametrize("direction", [0, 1, 2])
def test_each_activation_moves_its_own_arm(direction, arm):
    env = Environment(1.0, TARGET)
    _, (rod, _) = env.reset()
    resting = rod.kappa.copy()
    _, (rod, _), _ = play(env, activation(direction, arm), 1000)
    changed = np.abs(rod.kappa - resting)
    arms = [changed[:, :48].mean(axis=1), changed[:, 72:].mean(axis=1)]
    assert arms[arm].argmax() == direction and arms[arm][direction] > 1.0
    assert arms[1 - arm].max() < 0.2 * arms[arm][direction]


def test_activations_are_clipped_and_may_be_changed_in_place():
    ends = []
    for level in (1.0, 5.0):
        _, (rod, _), _ = play(Environment(1.0, TARGET), activation(0, 0, level), 200)
        ends.append(rod.position_collection.copy())
    np.testing.assert_array_equal(*ends)
    env = Environment(1.0, TARGET)
    env.reset()
    chosen = activation()
    env.step(chosen, 0.0)
    chosen[0][0][:] = 1.0
    for step in range(1, 201):
        _, (rod, _), _ = env.step(chosen, 4e-5 * step)
    assert np.abs(rod.position_collection - ends[0]).max() < 1e-3


def test_the_second_episode_equals_the_first():
    env = Environment(1.0, TARGET)
    first = play(env, activation(0, 1), 300)[1][0].position_collection.copy()
    np.testing.assert_array_equal(play(env, activation(0, 1), 300)[1][0].position_collection, first)


def test_a_diverged_simulation_is_done():
    env = Environment(1.0, TARGET)
    env.reset()
    env._state.v[0, 0, 40] = np.nan
    assert env.step(activation(), 0.0)[2]


def test_bad_input():
    with pytest.raises(ValueError, match="final_time"):
        Environment(0.0, TARGET)
    for target in ([0.0, 0.5], [0.0, 0.1, 0.0], [np.nan, 0.0, 0.0], None):
        with pytest.raises(ValueError, match="target_position must be a point"):
            Environment(1.0, target)
    with pytest.raises(ValueError, match="is in the animal or within"):
        Environment(1.0, [0.0, 0.0, 0.5]).reset()
    env = Environment(1.0, TARGET)
    with pytest.raises(RuntimeError, match="call reset before step"):
        env.step(activation(), 0.0)
    env.reset()
    with pytest.raises(RuntimeError, match="COLLECT_DATA_FOR_POSTPROCESSING=True"):
        env.post_processing("nothing.mp4")
    for wrong in (np.zeros(42), [[np.zeros(7)] * 2] * 2, [[np.zeros(7), np.zeros(6)]] * 3, np.full((3, 2, 7), np.nan)):
        with pytest.raises(ValueError, match="with seven numbers each"):
            env.step(wrong, 0.0)


def test_the_video(offscreen, tmp_path):
    env = Environment(0.1, TARGET, COLLECT_DATA_FOR_POSTPROCESSING=True)
    play(env, activation(0, 0), 2500)
    rollout = env.rollout()
    assert rollout.nodes.shape == (3, 121, 3) and rollout.sim_time.tolist() == [0.0, 0.05, 0.1]
    np.testing.assert_array_equal(rollout.nodes[-1], env._systems[0].position_collection.T)
    path = env.post_processing(tmp_path / "octopus.mp4")
    assert path.read_bytes()[4:8] == b"ftyp"
