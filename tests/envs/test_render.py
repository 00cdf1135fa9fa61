"""Rendering of environments by Gymnasium's interface. Gymnasium's checker covers rendering of every id."""

import os
import pickle
import signal
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.wrappers import RecordVideo

from elastica_gym.viz import Recorder, run_rollout
from elastica_gym.viz.frames import FIELD_OF_VIEW, following

from .conftest import random_actions, still

SNAKE, OCTOPUS = "elastica_gym/SnakeReach-v1", "elastica_gym/OctopusFetch-v1"
GOAL = "elastica_gym/SnakeReachGoal-v1"
DRAWN = {"render_mode": "rgb_array", "render_size": (96, 64)}


@pytest.fixture
def drawing(offscreen, make_vec):
    """Make batches that render small pictures, and close them."""

    def make(env_id=SNAKE, num_envs=2, **kwargs):
        return make_vec(env_id, num_envs, **DRAWN, **kwargs)

    return make


@pytest.mark.parametrize("env_id", [SNAKE, OCTOPUS])
def test_each_environment_has_its_picture_and_drawing_changes_nothing(drawing, env_id):
    plain, drawn = drawing(env_id), drawing(env_id)
    for env in (plain, drawn):
        env.reset(seed=3)
    first = drawn.render()
    for action in random_actions(env_id, 0, 12, 2):
        expected, got = plain.step(action), drawn.step(action)
        for mine, other in zip(got[:4], expected[:4], strict=True):
            np.testing.assert_array_equal(mine, other)
    frames = drawn.render()
    assert isinstance(frames, tuple) and len(frames) == drawn.num_envs
    assert all(frame.shape == (64, 96, 3) and frame.dtype == np.uint8 for frame in frames)
    assert (frames[0] != frames[1]).any() and (frames[0] != first[0]).any()
    # an animal on bright ground
    assert all((frame.min(axis=-1) < 120).sum() > 20 for frame in frames)
    np.testing.assert_equal(drawn.get_state(), plain.get_state())


@pytest.mark.parametrize("env_id", [SNAKE, OCTOPUS])
def test_the_camera_covers_animal_and_objects_and_does_not_jump(env_id):
    rng = np.random.default_rng(1)
    rollout = run_rollout(
        env_id, lambda observations, env: rng.uniform(-1.0, 1.0, env.action_space.shape), seed=5, duration=1.5
    )
    assert len(rollout.step) > 15
    cameras = [following(rollout, k, 1.5) for k in range(len(rollout.step))]
    for k, camera in enumerate(cameras):
        seen = [rollout.nodes[k], *(ends[k] for ends in rollout.objects())]
        seen += [] if rollout.target is None else [rollout.target[[k]]]
        el = np.deg2rad(camera.elevation)
        forward, right = np.array([0.0, np.sin(el), -np.cos(el)]), np.array([1.0, 0.0, 0.0])
        from_eye = np.concatenate(seen) - (camera.look_at - camera.distance * forward)
        high = np.tan(np.deg2rad(0.5 * FIELD_OF_VIEW)) * (from_eye @ forward)
        assert (np.abs(from_eye @ np.cross(right, forward)) < high).all()
        assert (np.abs(from_eye @ right) < 1.5 * high).all()
    middles = rollout.nodes.mean(axis=1)
    moved = np.linalg.norm(np.diff([camera.look_at for camera in cameras], axis=0), axis=1)
    # no faster than the animal
    assert (moved <= 1.5 * np.linalg.norm(np.diff(middles, axis=0), axis=1) + 0.01 * rollout.body_length).all()
    # per twentieth of a second
    assert np.abs(np.diff([camera.distance for camera in cameras])).max() < 0.1 * rollout.body_length


def test_a_far_target_does_not_move_the_camera_away(make_vec):
    env = make_vec(SNAKE, 1)
    env.reset(seed=0)
    distances = []
    for far in (5.0, 50.0):
        env.goal[0, :2] = far
        distances.append(following(Recorder(env).capture().rollout(), 0, 1.5).distance)
    assert distances[0] == pytest.approx(distances[1], rel=0.01)
    assert distances[0] < 12.0 * env.body.sensors.length


def test_without_a_render_mode_a_warning_suggests_one(make_vec):
    env = make_vec(SNAKE)
    env.reset(seed=0)
    with pytest.warns(UserWarning, match="render_mode='rgb_array'"):
        assert env.render() is None


def test_render_before_reset_raises():
    for env in (gymnasium.make(SNAKE, **DRAWN), gymnasium.make_vec(SNAKE, num_envs=2, **DRAWN)):
        with pytest.raises(RuntimeError, match="call reset before render"):
            env.unwrapped.render()


def test_without_mujoco_an_error_says_what_to_install(monkeypatch, make_vec):
    env = make_vec(SNAKE, **DRAWN)
    env.reset(seed=0)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(ImportError, match=r"pip install 'elastica-gym\[viz\]'"):
        env.render()


def test_a_diverged_environment_is_drawn_in_its_last_state(drawing):
    env = drawing(num_envs=1)
    env.reset(seed=0)
    env.state.x[0] = np.nan
    bare = env.render()[0]
    env.reset(seed=0)
    sound = env.render()[0]
    env.state.x[0] = np.nan
    assert np.abs(env.render()[0].astype(int) - sound).max() <= 2 < np.abs(sound.astype(int) - bare).max()


def test_a_pickled_environment_draws_the_same(drawing):
    env = drawing()
    env.reset(seed=0)
    frames = env.render()
    copy = pickle.loads(pickle.dumps(env))
    for mine, other in zip(copy.render(), frames, strict=True):
        assert np.abs(mine.astype(int) - other).max() <= 2
    copy.close()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes do not fork here")
def test_a_forked_environment_steps_but_raises_in_render(drawing):
    env = drawing(n_threads=1)
    env.reset(seed=0)
    env.render()
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        env.step(still(env))
        try:
            env.render()
        except RuntimeError as error:
            env.close()
            # exit status 0 only if it raises and closing does not hang
            os._exit(0 if "spawn" in str(error) else 1)
        os._exit(2)
    assert os.waitpid(child, 0)[1] == 0
    env.render()


@pytest.mark.parametrize("env_id", [SNAKE, GOAL])
def test_gymnasium_collects_the_pictures_of_an_episode(offscreen, env_id):
    env = gymnasium.make(env_id, duration=0.5, **DRAWN | {"render_mode": "rgb_array_list"})
    env.reset(seed=0)
    for _ in range(3):
        env.step(still(env))
    frames = env.render()
    assert env.render_mode == "rgb_array_list" and [frame.shape for frame in frames] == [(64, 96, 3)] * 4
    assert env.render() == []
    env.close()


@pytest.mark.parametrize("env_id", [SNAKE, GOAL])
def test_a_window_shows_the_simulation(offscreen, env_id, monkeypatch):
    pygame = pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    env = gymnasium.make(env_id, duration=0.5, **DRAWN | {"render_mode": "human"})
    env.reset(seed=0)
    env.step(still(env))
    shown = pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)
    np.testing.assert_array_equal(shown, env.unwrapped.render())
    assert env.render() is None and env.render_mode == "human"
    env.close()


def test_without_pygame_the_error_suggests_another_mode(monkeypatch):
    instead = "render_mode='rgb_array' draws without a window"
    monkeypatch.setitem(sys.modules, "pygame", None)
    with pytest.raises(ImportError, match=rf"'human' needs pygame \(pip install pygame\); {instead}"):
        gymnasium.make(SNAKE, render_mode="human")


def test_without_a_display_the_error_suggests_another_mode(monkeypatch):
    pytest.importorskip("pygame").display.quit()
    monkeypatch.setenv("SDL_VIDEODRIVER", "none of them")
    with pytest.raises(RuntimeError, match=r"'human' finds no display \(.*\); render_mode='rgb_array' draws"):
        gymnasium.make(SNAKE, render_mode="human")
    for name in ("SDL_VIDEODRIVER", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    if sys.platform.startswith("linux"):
        with pytest.raises(RuntimeError, match="'human' finds no display; render_mode='rgb_array' draws"):
            gymnasium.make(SNAKE, render_mode="human")


@pytest.mark.parametrize("mode", ["human", "rgb_array_list", "ansi"])
def test_batches_reject_other_render_modes_and_name_their_use(mode):
    with pytest.raises(ValueError, match=rf"not '{mode}': gymnasium.make takes 'human' and 'rgb_array_list'"):
        gymnasium.make_vec(SNAKE, num_envs=2, render_mode=mode)


def test_closing_twice_is_fine(drawing):
    env = drawing()
    env.reset(seed=0)
    env.render()
    env.close()
    env.close()


def test_videos_of_one_and_of_a_batch(offscreen, tmp_path):
    pytest.importorskip("moviepy")
    one = RecordVideo(gymnasium.make(SNAKE, duration=0.1, **DRAWN), str(tmp_path / "one"), disable_logger=True)
    batch = gymnasium.make_vec(SNAKE, num_envs=2, duration=0.1, **DRAWN)
    both = gymnasium.wrappers.vector.RecordVideo(batch, str(tmp_path / "batch"), video_aspect_ratio=(1, 1))
    for env in (one, both):
        env.reset(seed=0)
        for _ in range(2):
            env.step(np.zeros(env.action_space.shape))
        env.close()
    for name in ("one", "batch"):
        videos = list((tmp_path / name).glob("*.mp4"))
        assert videos and all(video.stat().st_size > 500 for video in videos)
