"""A run that was interrupted, killed and lost its last checkpoint ends bit-identical to an undisturbed one."""

import csv
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import torch

from elastica_gym.rl.checkpoints import checkpoint_folders
from elastica_gym.rl.policies import TrainedPolicy, load_run
from tests.agents.commands import ROOT, SMALL_PPO, arguments, environment, run

STEPS = 2000
ARGS = ("--steps", STEPS, "--checkpoint-minutes", 0, *SMALL_PPO)


def run_until(checkpoints: int, sign: int, folder: Path, *args: str | Path) -> tuple[int, str]:
    """Send a signal to agents.train after that many new checkpoints; return its status and output."""
    seen = set(checkpoint_folders(folder / "checkpoints"))
    process = subprocess.Popen(
        arguments("agents.train", *args),
        env=environment(),
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    deadline = time.monotonic() + 400
    while len(seen) < checkpoints and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.002)
        seen |= set(checkpoint_folders(folder / "checkpoints"))
    process.send_signal(sign)
    output = process.communicate(timeout=400)[0]
    assert not (folder / "learning_curve.png").exists() or sign == signal.SIGINT, output
    return process.returncode, output


def table(path: Path) -> list[dict[str, str]]:
    rows = list(csv.DictReader(path.open()))
    return [{key: v for key, v in row.items() if key not in ("seconds", "steps_per_second")} for row in rows]


def assert_same(a, b, path: str = "") -> None:
    if isinstance(a, dict):
        assert a.keys() == b.keys(), path
        for key in a:
            assert_same(a[key], b[key], f"{path}/{key}")
    elif isinstance(a, (list, tuple)):
        for i, (x, y) in enumerate(zip(a, b, strict=True)):
            assert_same(x, y, f"{path}/{i}")
    elif isinstance(a, torch.Tensor):
        assert torch.equal(a, b), path
    else:
        np.testing.assert_array_equal(a, b, err_msg=path)


def assert_same_end(one: TrainedPolicy, other: TrainedPolicy) -> None:
    assert_same(one.model.get_parameters(), other.model.get_parameters())
    assert one.model.num_timesteps == other.model.num_timesteps == STEPS
    for name in ("obs_rms", "ret_rms"):
        assert_same(vars(getattr(one.normalization, name)), vars(getattr(other.normalization, name)), name)
    assert_same(one.model._last_obs, other.model._last_obs, "last observations")


def test_interrupted_killed_and_damaged_runs_end_bit_identical(tmp_path):
    undisturbed, disturbed = tmp_path / "undisturbed", tmp_path / "disturbed"
    run("agents.train", *ARGS, "--folder", undisturbed)

    status, output = run_until(2, signal.SIGINT, disturbed, *ARGS, "--folder", disturbed)
    assert status == 130, output
    assert f"python -m agents.train --resume {disturbed}" in output
    assert (disturbed / "model.zip").exists()
    (disturbed / "learning_curve.png").unlink()

    status, output = run_until(6, signal.SIGKILL, disturbed, "--resume", disturbed)
    assert status == -signal.SIGKILL, output
    newest = checkpoint_folders(disturbed / "checkpoints")[-1]
    assert int(newest.name) < STEPS
    with (newest / "model.zip").open("r+b") as file:
        file.seek(2000)
        file.write(b"damage")

    output = run("agents.train", "--resume", disturbed)
    assert f"{newest} is damaged" in output
    assert_same_end(load_run(disturbed)[0], load_run(undisturbed)[0])
    best = [load_run(folder / "best")[0].model for folder in (disturbed, undisturbed)]
    assert_same(best[0].get_parameters(), best[1].get_parameters())
    assert best[0].num_timesteps == best[1].num_timesteps
    for name in ("metrics.csv", "evaluations.csv"):
        assert table(disturbed / name) == table(undisturbed / name)
    assert len(table(disturbed / "metrics.csv")) == STEPS // 40
