"""Sweeps on Ray: a local cluster, one of whose nodes is killed, and a search; skipped without Ray."""

import csv
import os
import signal
import subprocess
import threading
import time

import pytest
import yaml

from elastica_gym import commands
from tests.agents.commands import FORWARD, ROOT, run
from tests.agents.test_resume import assert_same, table

ray = pytest.importorskip("ray")
pytest.importorskip("optuna")
pytestmark = pytest.mark.slow

VALUES = {
    **{"n_envs": 2, "policy": "MlpPolicy", "n_steps": 20, "batch_size": 20, "n_epochs": 2},
    "env_kwargs": {"duration": 0.5},
}


STEPS = 2000
SOON = {"health_check_initial_delay_ms": 0, "health_check_period_ms": 1000, "health_check_failure_threshold": 3}
"""How Ray finds a lost node in seconds"""


@pytest.fixture
def small(tmp_path):
    """Options of trials with small networks and short episodes."""
    file = tmp_path / "config.yml"
    file.write_text(yaml.safe_dump({"default": VALUES}))
    return ("--config", file, "--evaluations", 2, "--evaluation-episodes", 2, "--checkpoint-minutes", 0)


@pytest.fixture
def workers(monkeypatch):
    """Two nodes with one core each, and this process connected to them, all on the loopback interface only."""
    monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    # workers are otherwise the last to run on a busy machine
    monkeypatch.setenv("RAY_worker_niceness", "0")
    from ray._private import services
    from ray.cluster_utils import Cluster

    # Ray replaces the loopback address by that of the network, where this cluster does not listen
    monkeypatch.setattr(services, "get_node_ip_address", lambda address=None: "127.0.0.1")
    here = {"node_ip_address": "127.0.0.1", "include_dashboard": False}
    cluster = Cluster(
        initialize_head=True, connect=True, head_node_args={"num_cpus": 0, "_system_config": SOON, **here}
    )
    yield [cluster.add_node(num_cpus=1, **here) for _ in range(2)]
    ray.shutdown()
    cluster.shutdown()


def trials(out):
    return list(csv.DictReader((out / "trials.csv").open()))


def kill(node, out):
    """Kill all processes of a node once two trials have checkpoints."""
    deadline = time.monotonic() + 200
    while len({path.parent for path in out.glob("*/*/checkpoints/[0-9]*")}) < 2 and time.monotonic() < deadline:
        time.sleep(0.05)
    started = [process.pid for _, process in node.live_processes()]
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", ",".join(map(str, started))], capture_output=True, text=True)
    # workers first, as if the machine had lost its power
    for pid in [*map(int, found.stdout.split()), *started]:
        os.kill(pid, signal.SIGKILL)


def test_trials_of_a_killed_node_continue_on_another(workers, small, tmp_path, monkeypatch, capsys):
    out = tmp_path / "sweep"
    options = ("--steps", STEPS, "--seeds", 0, 1, *small)
    monkeypatch.setattr("sys.argv", ["elastica-gym sweep", *map(str, options), "--out", str(out)])
    killer = threading.Thread(target=kill, args=(workers[0], out))
    killer.start()
    commands.run("sweep")
    killer.join()
    output = "".join(capsys.readouterr())
    rows = trials(out)
    assert [row["status"] for row in rows] == ["finished"] * 2
    assert sorted(int(row["retries"]) for row in rows) == [0, 1], output
    assert "A worker died; its trial continues from its last checkpoint." in output
    assert (out / "comparison" / "scores.csv").exists()

    # the same bits as a run that was not disturbed
    (retried,) = (row for row in rows if row["retries"] == "1")
    given = ("--env", FORWARD, "--steps", STEPS, "--recordings", 0, *small)
    run("agents.train", *given, "--seed", retried["seed"], "--folder", tmp_path / "undisturbed")
    for name in ("metrics.csv", "evaluations.csv"):
        assert table(out / retried["trial"] / name) == table(tmp_path / "undisturbed" / name)
    from elastica_gym.rl.policies import load_run

    ends = [load_run(folder)[0].model.get_parameters() for folder in (out / retried["trial"], tmp_path / "undisturbed")]
    assert_same(*ends)

    # nothing is left to do
    before = (out / retried["trial"] / "model.zip").stat().st_mtime_ns
    run("agents.sweep", *options, "--out", out)
    assert trials(out) == rows and (out / retried["trial"] / "model.zip").stat().st_mtime_ns == before


def test_a_search_tries_settings_with_every_seed_and_continues(small, tmp_path):
    out = tmp_path / "search"
    ranges = ("--search", "learning_rate=lin_log(1e-5,1e-2)", "n_epochs=int(1,3)", "gamma=choice(0.9,0.95)")
    command = (*ranges, "--steps", 80, "--seeds", 0, 1, *small, "--out", out)
    run("agents.sweep", *command, "--trials", 2)
    first = trials(out)
    assert len(first) == 4 and {row["status"] for row in first} == {"finished"}
    assert len({(row["learning_rate"], row["n_epochs"], row["gamma"]) for row in first}) == 2
    run("agents.sweep", *command, "--trials", 3)
    rows = trials(out)
    assert len(rows) == 6 and all(row in rows for row in first)
