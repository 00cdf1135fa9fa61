"""Evaluate a policy over parallel episodes: results and their confidence intervals."""

import dataclasses
import math
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..console.bad_input import BadInputError, check_bounds

if TYPE_CHECKING:
    from .policies import Policy
    from .vec_env import BatchVecEnv

LOWEST = {"episodes": 1, "seed": 0, "threads": 1}
LARGEST_BATCH = 1024
"""Maximum number of parallel episodes; more are run in batches."""
ELSEWHERE = math.sqrt(2.0)
"""Factor by which the interval for another CPU is wider than a confidence interval; see `Evaluation.elsewhere`"""


@dataclasses.dataclass(frozen=True)
class Evaluation:
    """Results of `n` episodes; every array has one entry per episode."""

    seeds: np.ndarray
    """Seed of each episode, shape (n,)."""
    returns: np.ndarray
    """Undiscounted sum of rewards, shape (n,)."""
    lengths: np.ndarray
    """Control steps, shape (n,)."""
    distances: np.ndarray
    """The task's progress at the end [m], shape (n,)."""
    successes: np.ndarray
    """Whether the task was solved, shape (n,), bool."""
    reasons: np.ndarray
    """Why each episode ended, shape (n,): success, diverged, time_limit or a failure of the task."""
    terms: dict[str, np.ndarray]
    """Sum over the episode of each weighted reward term, shape (n,) each."""

    @property
    def divergences(self) -> int:
        """Number of diverged episodes."""
        return int(np.sum(self.reasons == "diverged"))

    def summary(self) -> dict[str, Any]:
        """Means and half widths of 95 % confidence intervals of all quantities; JSON-serialisable."""
        return {
            "episodes": len(self.returns),
            "first_seed": int(self.seeds[0]),
            "return_mean": float(self.returns.mean()),
            "return_ci95": confidence(self.returns),
            "success_rate": float(self.successes.mean()),
            "success_interval95": list(success_interval(self.successes)),
            "distance_mean": float(self.distances.mean()),
            "distance_ci95": confidence(self.distances),
            "length_mean": float(self.lengths.mean()),
            "divergences": self.divergences,
            "terms": {name: float(values.mean()) for name, values in self.terms.items()},
            "terms_ci95": {name: confidence(values) for name, values in self.terms.items()},
            "elsewhere95": self.elsewhere(),
        }

    def row(self, steps: int, seconds: float) -> dict[str, Any]:
        """Return the row of ``evaluations.csv`` for an evaluation after some environment steps and seconds."""
        summary = self.summary()
        return {
            "steps": steps,
            "seconds": seconds,
            "return": summary["return_mean"],
            "return_ci95": summary["return_ci95"],
            "distance": summary["distance_mean"],
            "distance_ci95": summary["distance_ci95"],
            "success": summary["success_rate"],
            "length": summary["length_mean"],
            "divergences": summary["divergences"],
            **{f"reward_{term}": mean for term, mean in summary["terms"].items()},
        }

    def elsewhere(self) -> dict[str, list[float]]:
        """Return 95 % prediction intervals of the means over the same seeds on another CPU; JSON-serialisable.

        Episodes on another CPU differ, but have the same distribution (`.machine`). The difference of two means over
        equally many independent episodes has twice the variance of either, so the prediction interval is sqrt(2) times
        as wide as the confidence interval.
        """
        found = {}
        for name, values in (("return", self.returns), ("distance", self.distances)):
            mean, half = float(values.mean()), ELSEWHERE * confidence(values)
            found[name] = [mean - half, mean + half]
        return {**found, "success": list(success_interval(self.successes, widened=ELSEWHERE))}

    def per_episode(self) -> list[dict[str, Any]]:
        """Return the results of each episode; JSON-serialisable."""
        return [
            {
                "seed": int(self.seeds[i]),
                "return": float(self.returns[i]),
                "length": int(self.lengths[i]),
                "distance": float(self.distances[i]),
                "success": bool(self.successes[i]),
                "termination": str(self.reasons[i]),
                "terms": {name: float(values[i]) for name, values in self.terms.items()},
            }
            for i in range(len(self.returns))
        ]


def confidence(values: np.ndarray) -> float:
    """Half width of the 95 % confidence interval of the mean of `values`, by Student's t; NaN for one value."""
    from scipy import stats

    n = len(values)
    if n < 2:
        return math.nan
    return float(stats.t.ppf(0.975, n - 1) * values.std(ddof=1) / math.sqrt(n))


def evaluate(
    policy: "Policy",
    env_id: str,
    *,
    episodes: int,
    seed: int,
    n_threads: int = 2,
    env_kwargs: dict | None = None,
    show: Callable[[float], object] | None = None,
) -> Evaluation:
    """Run `policy` for `episodes` parallel episodes of `env_id`; episode i has the seed ``seed + i``.

    The result of an episode depends only on its seed, not on the number of parallel episodes. `show` is called
    regularly with the fraction of steps done.
    """
    check_bounds({"episodes": episodes, "seed": seed, "threads": n_threads}, LOWEST)
    parts: list[Evaluation] = []
    for first in range(0, episodes, LARGEST_BATCH):
        seeds = [seed + i for i in range(first, min(first + LARGEST_BATCH, episodes))]

        def show_part(done: float, first: int = first, n: int = len(seeds)) -> None:
            if show is not None:
                show((first + done * n) / episodes)

        parts.append(_evaluate_batch(policy, env_id, seeds, n_threads, env_kwargs or {}, show_part))
    if len(parts) == 1:
        return parts[0]
    fields = {f.name: [getattr(part, f.name) for part in parts] for f in dataclasses.fields(Evaluation)}
    terms = {name: np.concatenate([t[name] for t in fields["terms"]]) for name in parts[0].terms}
    return Evaluation(**{name: np.concatenate(v) for name, v in fields.items() if name != "terms"}, terms=terms)


def _evaluate_batch(
    policy: "Policy",
    env_id: str,
    seeds: list[int],
    n_threads: int,
    env_kwargs: dict[str, Any],
    show: Callable[[float], object],
) -> Evaluation:
    from .vec_env import make_batch_vec_env

    env = make_batch_vec_env(env_id, n_envs=len(seeds), n_threads=n_threads, **env_kwargs)
    try:
        _check_fits(policy, env.observation_space.shape, env_id)
        return run_episodes(policy, env, seeds, show)
    finally:
        env.close()


def run_episodes(
    policy: "Policy", env: "BatchVecEnv", seeds: Sequence[int], show: Callable[[float], object] | None = None
) -> Evaluation:
    """Run one episode in each environment, one seed each; `show` is called with the fraction done."""
    env.seed(seeds)
    observations = env.reset()
    policy.reset(seeds)
    infos: dict[int, dict[str, Any]] = {}
    steps = 0
    while len(infos) < len(seeds):
        env.step_async(policy(observations, env.batch))
        observations, _, dones, step_infos = env.step_wait()
        for i in np.flatnonzero(dones):
            # finished environments continue with further episodes, which are ignored
            infos.setdefault(int(i), step_infos[i])
        steps += 1
        if show is not None:
            show(steps / env.batch.max_episode_steps)
    return _collect(seeds, [infos[i] for i in range(len(seeds))])


def _check_fits(policy: "Policy", shape: tuple[int, ...] | None, env_id: str) -> None:
    model = getattr(policy, "model", None)
    if model is not None and model.observation_space.shape != shape:
        raise BadInputError(f"The model observes {model.observation_space.shape}, but {env_id} gives {shape}.")


def _collect(seeds: Sequence[int], infos: list[dict[str, Any]]) -> Evaluation:
    episodes = [info["episode"] for info in infos]
    terms = [key for key in episodes[0] if key.startswith("reward_")]
    return Evaluation(
        seeds=np.array(seeds),
        returns=np.array([episode["r"] for episode in episodes]),
        lengths=np.array([episode["l"] for episode in episodes]),
        distances=np.array([episode["distance"] for episode in episodes]),
        successes=np.array([info["is_success"] for info in infos]),
        reasons=np.array([info["termination_reason"] for info in infos]),
        terms={key.removeprefix("reward_"): np.array([episode[key] for episode in episodes]) for key in terms},
    )


def print_table(title: str, result: Evaluation) -> None:
    """Print the results, one line per quantity."""
    from rich.console import Console
    from rich.table import Table

    summary = result.summary()
    table = Table(title=title, caption=f"On another CPU, means may differ by {ELSEWHERE:.1f} times these intervals.")
    table.add_column("over the episode")
    table.add_column("mean", justify="right")
    table.add_column("95 % interval", justify="right")
    for name, mean, half in _rows(summary):
        interval = f"{mean - half:.3f} to {mean + half:.3f}" if math.isfinite(half) else ""
        table.add_row(name, f"{mean:.3f}", interval)
    low, high = success_interval(result.successes)
    table.add_row("success rate", f"{summary['success_rate']:.1%}", f"{low:.1%} to {high:.1%}")
    table.add_row("length (control steps)", f"{summary['length_mean']:.1f}", "")
    table.add_row("diverged", f"{result.divergences} of {summary['episodes']}", "")
    Console().print(table)


def _rows(summary: dict[str, Any]) -> Iterator[tuple[str, float, float]]:
    yield "return", summary["return_mean"], summary["return_ci95"]
    yield "distance (m)", summary["distance_mean"], summary["distance_ci95"]
    for name, mean in summary["terms"].items():
        yield f"reward: {name}", mean, summary["terms_ci95"][name]


def success_interval(successes: np.ndarray, *, widened: float = 1.0) -> tuple[float, float]:
    """Return the 95 % confidence interval of a success rate (Wilson 1927), `widened` by a factor."""
    from scipy import stats

    level = 1.0 - 2.0 * stats.norm.sf(widened * stats.norm.isf(0.025))
    interval = stats.binomtest(int(np.sum(successes)), len(successes)).proportion_ci(level, method="wilson")
    return float(interval.low), float(interval.high)
