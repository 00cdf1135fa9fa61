import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from elastica_gym.viz import Recorder, run_rollout

from .conftest import scripted

ID = "elastica_gym/SnakeForward-v0"


def make(num_envs=2, **kwargs):
    return gymnasium.make_vec(ID, num_envs=num_envs, vectorization_mode="vector_entry_point", **kwargs)


def test_shapes_and_times(forward):
    assert forward.nodes.shape == (41, 51, 3)
    assert forward.radii.shape == forward.normal_force.shape == (41, 50)
    assert forward.activations.shape == (41, 42)
    assert len(forward.activation_names) == 42
    assert forward.sim_time == pytest.approx(np.arange(41) * 0.05)
    assert forward.target is None
    assert forward.duration == pytest.approx(2.0)


def test_head_is_a_node_and_radii_are_those_of_the_body(forward):
    assert np.array_equal(forward.head, forward.nodes[:, -1])
    assert forward.radii == pytest.approx(0.00385, rel=0.01)


def test_segments_skip_the_gap_between_rods(forward):
    from dataclasses import replace

    two = replace(forward, elements_per_rod=(20, 29), radii=forward.radii[:, :49])
    begin, end = two.segments()
    assert begin.shape == end.shape == (41, 49, 3)
    assert np.array_equal(begin[:, 20], forward.nodes[:, 21])
    assert np.array_equal(end[:, 19], forward.nodes[:, 20])


def test_rewards_are_those_of_the_environment(forward):
    env = make(1, duration=2.0, autoreset_mode=AutoresetMode.DISABLED)
    observations, _ = env.reset(seed=3)
    total = 0.0
    for _ in range(40):
        observations, rewards, *_ = env.step(scripted(observations, env.unwrapped))
        total += rewards[0]
    assert forward.episode_return[0] == 0.0
    assert forward.episode_return[-1] == pytest.approx(total, rel=1e-12)
    first = env.unwrapped.body.model.first_slot[0]
    assert np.array_equal(forward.nodes[-1].T, env.unwrapped.state.x[0, :, first : first + 51])


def test_one_environment_of_a_batch():
    env = make(3, duration=0.5)
    followed = run_rollout(env, scripted, seed=5, index=1)
    alone = run_rollout(ID, scripted, seed=6, duration=0.5)
    assert np.array_equal(followed.nodes, alone.nodes)


def test_single_view_is_recorded_too():
    env = gymnasium.make(ID)
    env.reset(seed=0)
    assert Recorder(env).capture().rollout().nodes.shape == (1, 51, 3)


def test_reach_has_a_target_and_ends_when_it_is_reached(reach):
    gap = np.linalg.norm((reach.head - reach.target)[:, [0, 2]], axis=1)
    assert gap[-1] <= reach.target_radius < gap[-2]


def test_what_is_not_finite_repeats_the_last_moment():
    env = make(1)
    env.reset(seed=0)
    recorder = Recorder(env).capture()
    env.unwrapped.state.x[0] = np.nan
    rollout = recorder.capture().rollout()
    assert np.array_equal(rollout.nodes[0], rollout.nodes[1])


def test_bad_arguments():
    with pytest.raises(ValueError, match="index must be from 0 to 1, not 2"):
        Recorder(make(2), 2)
    with pytest.raises(ValueError, match="SAME_STEP"):
        run_rollout(make(1, autoreset_mode=AutoresetMode.SAME_STEP), scripted)
    with pytest.raises(RuntimeError, match="capture"):
        Recorder(make(1)).rollout()
