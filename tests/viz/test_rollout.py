from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from elastica_gym.envs import IDS, handling
from elastica_gym.viz import Recorder, run_rollout
from elastica_gym.viz.rollout import HOME_RADIUS

from .conftest import scripted

ID = "elastica_gym/SnakeForward-v1"


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
    assert forward.head_is_an_end
    assert np.array_equal(forward.head_radius, forward.radii[:, -1])
    assert forward.radii == pytest.approx(0.00385, rel=0.01)


def test_the_octopus_has_its_head_in_the_middle(octopus):
    assert octopus.nodes.shape[1:] == (121, 3)
    assert not octopus.head_is_an_end
    assert np.array_equal(octopus.head, octopus.nodes[:, 60])
    assert octopus.head_radius == pytest.approx(0.125, rel=0.05)


def test_the_head_may_be_at_the_end_of_either_rod(octopus):
    for node, is_end in ((0, True), (20, True), (21, True), (120, True), (19, False), (22, False)):
        two = replace(octopus, elements_per_rod=(20, 99), radii=octopus.radii[:, :119], head_node=node)
        assert two.head_is_an_end == is_end
    two = replace(octopus, elements_per_rod=(20, 99), radii=octopus.radii[:, :119], head_node=21)
    assert np.array_equal(two.head_radius, two.radii[:, 20])


def test_objects_are_those_of_the_environment(octopus, forward):
    assert forward.object_centre.shape == forward.object_axis.shape == (41, 0, 3)
    assert not forward.object_force.any()
    moments = len(octopus.step)
    assert octopus.object_centre.shape == octopus.object_axis.shape == (moments, 1, 3)
    begin, end = octopus.objects()
    assert begin[0, 0] == pytest.approx(octopus.object_centre[0, 0] * [1.0, 0.0, 1.0], abs=1e-3)
    assert end[0, 0, 1] == pytest.approx(octopus.object_length[0], abs=1e-3)
    assert np.linalg.norm(octopus.object_axis, axis=-1) == pytest.approx(1.0)


def test_contact_is_recorded_at_the_object(octopus):
    # the episode ends at contact
    assert octopus.sim_time[-1] < 1.0
    touched = np.flatnonzero(octopus.object_force[-1])
    assert touched.size
    begin, _ = octopus.segments()
    away = np.linalg.norm((begin[-1, touched] - octopus.object_centre[-1])[:, [0, 2]], axis=1)
    assert (away < octopus.object_radius[0] + octopus.radii[-1, touched] + 0.01).all()


def test_recorded_states_do_not_change():
    env = gymnasium.make_vec("elastica_gym/OctopusReach-v1", num_envs=2, vectorization_mode="vector_entry_point")
    env.reset(seed=0)
    recorder = Recorder(env, 1).capture()
    before = env.unwrapped.state.body_x[1].copy()
    for name in ("x", "body_x", "body_Q", "body_touch", "normal_force"):
        getattr(env.unwrapped.state, name)[:] = 7.0
    rollout = recorder.rollout()
    assert np.array_equal(rollout.object_centre[0], before)
    assert not any((getattr(rollout, name) == 7.0).any() for name in ("nodes", "object_axis", "object_force"))


def test_direction_is_that_of_the_task(forward):
    env = gymnasium.make_vec("elastica_gym/OctopusCrawl-v1", num_envs=1, vectorization_mode="vector_entry_point")
    env.reset(seed=0)
    goal = env.unwrapped.goal[0]
    assert Recorder(env).capture().rollout().direction == pytest.approx(np.array([[goal[2], 0.0, goal[3]]]))
    # the snake must keep its initial heading, independent of its current one
    assert forward.direction == pytest.approx(np.broadcast_to(forward.direction[0], (41, 3)))


def test_segments_skip_the_gap_between_rods(forward):
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


def test_single_environment_is_recorded_too():
    env = gymnasium.make(ID)
    env.reset(seed=0)
    assert Recorder(env).capture().rollout().nodes.shape == (1, 51, 3)


def test_reach_has_a_target_and_ends_at_it(reach):
    gap = np.linalg.norm((reach.head - reach.target)[:, [0, 2]], axis=1)
    assert gap[-1] <= reach.target_radius < gap[-2]


def test_non_finite_states_repeat_the_last_one():
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


@pytest.mark.parametrize("env_id", IDS)
def test_home_is_at_the_position_of_the_task(env_id):
    env = gymnasium.make_vec(env_id, num_envs=2, vectorization_mode="vector_entry_point")
    observations, _ = env.reset(seed=3)
    batch = env.unwrapped
    rollout = Recorder(env, 1).capture().rollout()
    names = batch.observation_names
    assert (rollout.home is not None) == ("home/forward" in names)
    if rollout.home is None:
        return
    # relative to the animal: forward and right of its head
    hx, hz = batch.pose.heading[1]
    x, _, z = rollout.home[0] - batch.pose.head[1]
    seen = [observations[1, names.index(f"home/{which}")] for which in ("forward", "right")]
    assert np.array(seen) * batch.body.sensors.length == pytest.approx([x * hx + z * hz, z * hx - x * hz], abs=1e-6)
    assert rollout.home[0, 1] == 0.0


def test_the_disc_of_home_has_the_radius_of_success():
    assert HOME_RADIUS == handling.AT_HOME
