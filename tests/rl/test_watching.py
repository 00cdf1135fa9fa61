"""Training that is watched: TensorBoard's events, and rerun's viewer, which never stops it."""

import csv
import os
import signal

import pytest

from elastica_gym.rl.run_files import EVALUATIONS, TENSORBOARD
from elastica_gym.viz import run_rollout
from tests.agents.commands import FORWARD, SMALL_PPO, run
from tests.viz.test_replay import free_port


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """Return the folder of a run that nobody watches."""
    folder = tmp_path_factory.mktemp("plain")
    run("agents.train", "--steps", 80, "--seed", 3, "--folder", folder, *SMALL_PPO)
    return folder


def evaluations(folder):
    """Return the evaluations of a run, but for their times."""
    rows = list(csv.DictReader((folder / EVALUATIONS).open()))
    return [{key: value for key, value in row.items() if key != "seconds"} for row in rows]


def test_tensorboard_gets_what_stable_baselines3s_users_expect(plain, tmp_path):
    accumulator = pytest.importorskip("tensorboard.backend.event_processing.event_accumulator")
    run("agents.train", "--steps", 80, "--seed", 3, "--folder", tmp_path, *SMALL_PPO, "--tensorboard")
    events = accumulator.EventAccumulator(str(tmp_path / TENSORBOARD))
    events.Reload()
    tags = set(events.Tags()["scalars"])
    assert {"time/fps", "eval/mean_reward", "eval/success_rate", "train/loss", "train/approx_kl"} <= tags
    assert [event.step for event in events.Scalars("train/loss")] == [40, 80]
    assert evaluations(tmp_path) == evaluations(plain)


def test_a_watched_run_is_the_same_run(plain, tmp_path):
    pytest.importorskip("rerun")
    output = run("agents.train", "--steps", 80, "--seed", 3, "--folder", tmp_path, *SMALL_PPO, "--rerun-web")
    assert "Watch it: http://127.0.0.1:9090/?url=" in output
    assert evaluations(tmp_path) == evaluations(plain)


def test_without_a_display_a_window_is_not_asked_for(tmp_path, monkeypatch):
    pytest.importorskip("rerun")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    output = run("agents.train", "--steps", 40, "--folder", tmp_path, *SMALL_PPO, "--rerun")
    assert "--rerun-web shows the same in a browser" in output


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
def test_a_viewer_that_was_closed_costs_nothing():
    pytest.importorskip("rerun")
    from elastica_gym.viz.viewer import LiveView

    live = LiveView("a training", web=True, page=free_port(), data=free_port())
    rollout = run_rollout(FORWARD, lambda observations, batch: batch.action_space.sample() * 0.0, seed=0, duration=0.2)
    live.log_numbers(1, {"evaluation/return": 1.0})
    os.kill(live._viewer.pid, signal.SIGKILL)
    live._viewer.wait()
    assert not live.is_open
    for steps in range(100):
        live.log_numbers(steps, {"evaluation/return": 1.0})
    live.log_episode(rollout, "evaluation")
    live.close()
