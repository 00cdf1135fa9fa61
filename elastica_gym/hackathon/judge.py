"""The judge: runs a policy on targets at the default position, on the arc and anywhere, and counts the points."""

from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from ..console.bad_input import BadInputError, check_bounds, choose_environment, missing_extra
from ..progress import Bar
from ..rl.seeds import target_seeds
from .policy_process import PolicyError, PolicyProcess
from .scoring import GENERAL, GOALS, POINTS, Mask, goals_held, score
from .trials import Sampler, run_trials

INITIAL_STATES = 5
"""Number of episodes on the default target"""
MOST_TARGETS = 1000
"""Maximum number of targets, which run in parallel"""
KINDS = ("default", "arc", "anywhere")
"""Kinds of targets, called ``spread`` in environments"""


def judge(
    path: Path,
    env_id: str,
    *,
    targets: int,
    target_seed: int,
    record: Path | None = None,
    n_threads: int = 2,
    **env_kwargs: Any,
) -> dict[str, Any]:
    """Return the score of a policy; JSON-serialisable.

    Parameters
    ----------
    path
        The policy, see `elastica_gym.hackathon.policy_process.PolicyProcess`.
    env_id
        Id of an environment with an animal and its object.
    targets
        Number of targets on the arc, and the same number anywhere.
    target_seed
        Seed of all targets.
    record
        Folder for rerun recordings of the first episode on each kind of target.
    n_threads
        Threads for the physics.
    **env_kwargs
        Other arguments of the environment.

    Returns
    -------
    dict
        ``total``, the points of each goal by name, ``held`` (number of episodes that achieve each goal, by kind of
        target), ``error`` (empty, or why the policy failed, which then scores nothing), and the arguments.
    """
    _check(env_id, targets, target_seed, n_threads, record)
    held: dict[str, Mask] = {}
    error = ""
    with PolicyProcess(path) as policy:
        try:
            for stream, spread in enumerate(KINDS):
                seeds = target_seeds(target_seed, stream, INITIAL_STATES if spread == "default" else targets)
                with _Watch(f"{spread} target", record and record / f"{spread}.rrd") as watch:
                    policy.begin(len(seeds))
                    samples = run_trials(
                        policy, env_id, seeds=seeds, watch=watch, spread=spread, n_threads=n_threads, **env_kwargs
                    )
                held[spread] = goals_held(samples)
        except PolicyError as trouble:
            error = str(trouble)
    if error:
        held = {spread: np.zeros((len(GOALS), 1), dtype=bool) for spread in KINDS}
    counts = {spread: dict(zip(GOALS, mask.sum(axis=1).tolist(), strict=True)) for spread, mask in held.items()}
    return {
        **score(held),
        "error": error,
        "held": counts,
        "policy": str(path),
        "env": env_id,
        "initial_states": INITIAL_STATES,
        "targets": targets,
        "target_seed": target_seed,
    }


def print_score(result: dict[str, Any]) -> None:
    """Print the points of each goal, and the number of episodes that achieve it and all goals before it."""
    from rich.console import Console
    from rich.table import Table

    console = Console()
    if result["error"]:
        console.print(f"No points: {result['error']}.", highlight=False, markup=False, soft_wrap=True)
    table = Table(title=f"{result['policy']} on {result['env']}, target seed {result['target_seed']}")
    for column in ("goal", "points", "of", *KINDS):
        table.add_column(column, justify="left" if column == "goal" else "right")
    n = {kind: result["initial_states"] if kind == "default" else result["targets"] for kind in KINDS}
    for goal, most in POINTS.items():
        counts = [f"{result['held'][kind][goal]} of {n[kind]}" for kind in KINDS]
        table.add_row(goal, f"{result[goal]:g}", f"{most:g}", *counts)
    table.add_row("general", f"{result['general']:.4g}", f"{2.0 * GENERAL:g}", *[""] * len(KINDS))
    table.add_section()
    table.add_row("total", f"{result['total']:.4g}", f"{sum(POINTS.values()) + 2.0 * GENERAL:g}", *[""] * len(KINDS))
    console.print(table)


def _check(env_id: str, targets: int, target_seed: int, n_threads: int, record: Path | None) -> None:
    from ..envs import task_of

    choose_environment(env_id)
    if not set(KINDS) <= set(task_of(env_id).initial_states):
        raise BadInputError(f"{env_id} has no object to fetch from {', '.join(KINDS)} targets.")
    if not 1 <= targets <= MOST_TARGETS:
        raise BadInputError(f"targets must be from 1 to {MOST_TARGETS}, got {targets}")
    check_bounds({"target_seed": target_seed, "threads": n_threads}, {"target_seed": 0, "threads": 1})
    if record is not None and (message := missing_extra("viz")):
        raise BadInputError(f"A recording needs the extra viz: {message}")


class _Watch:
    """Shows progress, and optionally records the first episode."""

    def __init__(self, name: str, path: Path | None):
        self._path = path
        self._bar = Bar(name)
        self._recorder: Any = None

    def __enter__(self) -> Self:
        self._bar.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.__exit__(kind, error, trace)
        if self._recorder is not None and self._path is not None:
            from ..viz import write_recording

            print(f"recorded {write_recording(self._recorder.rollout(), self._path)}")

    def __call__(self, batch: Any, sampler: Sampler, infos: dict[str, Any] | None) -> None:
        if infos is None:
            if self._path is not None:
                from ..viz import Recorder

                self._recorder = Recorder(batch).capture()
            return
        self._bar.show(batch.elapsed.max() / batch.max_episode_steps)
        if self._recorder is not None and not sampler.is_over[0]:
            self._recorder.capture(infos)
