"""The starter kit: a first policy, and a tour of the tools for it.

The policy below is complete: ``python scripts/score.py --policy scripts/starter_kit.py`` scores it. Copy the
file and change it. ``bash scripts/starter_kit.sh`` installs and runs the rest, as the notebook next to it does: it
draws the effect of activations, records and films the policy, trains networks shipped with the repository for another
minute, and scores both, and the shipped networks as well.
"""

import dataclasses
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

# memory: the file is run again for every episode
steps = 0

PERIOD = 0.37
"""Period of a stroke [s]"""
CONTROL_DT = 0.05
"""Time between actions [s]"""
SEEN_FORWARD, SEEN_RIGHT = 206, 207
"""Indices in the observation of the direction from the head to the object"""
FUNCTIONS = np.array([0, 1, 2, 14, 15, 16])
"""Activations of the first arm: the three lowest functions that bend it sideways, and the three that lift it"""
OFFSET = np.array([1.02, 1.57, 0.53, -0.74, -1.52, 0.51])
SINE = np.array([1.4, -0.19, -0.7, 0.29, -0.95, 0.08])
COSINE = np.array([-0.71, 0.46, -0.43, 1.71, -1.63, 1.62])
"""A stroke of both arms with which the octopus walks to its right, found by CMA-ES"""


def policy(observation: np.ndarray) -> np.ndarray:
    """Walk to the right, and turn to keep the object there: both arms row, and one rows less to correct the course.

    Parameters
    ----------
    observation
        (210,); the table is in `elastica_gym.envs.tasks.octopus_reach`.

    Returns
    -------
    np.ndarray
        Activations in [-1, 1], (42,): about the normal, the binormal and the tangent; of the first arm, then of the
        second; seven each.
    """
    global steps
    phase = 2.0 * np.pi * steps * CONTROL_DT / PERIOD
    steps += 1
    stroke = np.clip(OFFSET + SINE * np.sin(phase) + COSINE * np.cos(phase), -1.0, 1.0)
    ahead = np.arctan2(observation[SEEN_FORWARD], observation[SEEN_RIGHT])
    action = np.zeros(42)
    # the second arm is in front of the head, the first one behind it
    action[FUNCTIONS] = stroke * np.clip(1.0 + ahead, 0.0, 1.0)
    action[FUNCTIONS + 7] = stroke * np.clip(1.0 - ahead, 0.0, 1.0)
    return action


ROOT = Path(__file__).resolve().parents[1]


@dataclasses.dataclass
class Arguments:
    """Run the starter kit."""

    env: str = "elastica_gym/OctopusFetch-v1"
    """Environment id."""
    spread: str = "default"
    """Position of the object in the recording: default, arc or anywhere."""
    start_from: str = "octopus_fetch_dagger"
    """Pretrained policy whose networks initialise training; new ones score nothing within minutes."""
    imitate: int = 12_800
    """Environment steps of further imitation of the task's script; about a minute on two cores."""
    targets: int = 5
    """Number of targets on the arc in the score, and also of those anywhere."""
    seconds: float = 8.0
    """Simulated time of the video [s]."""
    out: Path = Path("runs/starter_kit")
    """Output folder."""


def main() -> None:
    """Run the command line."""
    import tyro

    from elastica_gym.console.bad_input import check_bounds, choose, environment_ids
    from elastica_gym.envs import task_of

    arguments = tyro.cli(Arguments)
    check_bounds(dataclasses.asdict(arguments), {"imitate": 1, "targets": 1, "seconds": 0.05})
    env_id = choose("environment", arguments.env, environment_ids())
    choose("spread", arguments.spread, task_of(env_id).initial_states)
    out = arguments.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    run(ROOT / "scripts" / "draw_activations.py", "--output", out / "activations.png")
    show(arguments, out)
    trained = out / "trained"
    # results of an earlier run
    shutil.rmtree(trained, ignore_errors=True)
    run(
        "-m",
        "agents.train",
        "--env",
        arguments.env,
        "--algo",
        "ppo",
        "--config",
        ROOT / "configs" / "imitation.yml",
        "--start-from",
        arguments.start_from,
        "--steps",
        0,
        "--imitate",
        arguments.imitate,
        "--evaluations",
        0,
        "--folder",
        trained,
    )
    # the last is where training began: a minute of it may help or harm
    for policy in (Path(__file__), trained, arguments.start_from):
        score = ROOT / "scripts" / "score.py", "--env", arguments.env, "--targets", arguments.targets
        run(*score, "--policy", policy, "--json", out / f"{Path(policy).stem}.json")


def show(arguments: Arguments, out: Path) -> None:
    """Record an episode of the policy for rerun, and make a video of its start."""
    from elastica_gym.viz import render_frames, run_rollout, write_recording, write_video

    def act(observations: np.ndarray, batch: Any) -> np.ndarray:
        return policy(observations[0])[None]

    rollout = run_rollout(arguments.env, act, seed=0, spread=arguments.spread, duration=arguments.seconds)
    recording = write_recording(rollout, out / "rollout.rrd")
    print(f"recorded {recording}: look at it with {sys.executable} {ROOT / 'scripts' / 'replay.py'} {recording}")
    print(f"wrote {write_video(render_frames(rollout, width=640, height=360), out / 'rollout.mp4')}")


def run(*command: Any) -> None:
    """Run a command of the repository, and exit with its status unless it is 0."""
    print(f"$ {' '.join(['python', *map(str, command)])}", flush=True)
    status = subprocess.run([sys.executable, *map(str, command)], cwd=ROOT).returncode
    if status != 0:
        sys.exit(status)


if __name__ == "__main__":
    from elastica_gym.console.bad_input import run_command

    run_command(main)
