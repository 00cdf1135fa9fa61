"""Evaluate a policy: ``python -m agents.evaluate --run DIR``, ``--pretrained NAME`` or ``--policy NAME --env ID``."""

import dataclasses
import json
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from agents.checks import (
    BadInputError,
    check_bounds,
    choose,
    choose_environment,
    environment_ids,
    make_folder,
    missing_extra,
    require_extra,
    run_command,
)
from agents.seeds import TEST

if TYPE_CHECKING:
    from agents.policies import Policy
    from agents.vec_env import BatchVecEnv

LOWEST = {"episodes": 1, "seed": 0, "threads": 1}
LARGEST_BATCH = 1024
"""Episodes that run side by side; more than these are run in turns."""
ELSEWHERE = math.sqrt(2.0)
"""How much wider than a confidence interval that is which has what another CPU measures; see `Evaluation.elsewhere`"""


@dataclasses.dataclass(frozen=True)
class Evaluation:
    """What `n` episodes came to; every array has one entry per episode."""

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
        """Episodes whose numbers stopped being finite."""
        return int(np.sum(self.reasons == "diverged"))

    def summary(self) -> dict[str, Any]:
        """Means, and half widths of 95 % confidence intervals, of everything; ready for JSON."""
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

    def elsewhere(self) -> dict[str, list[float]]:
        """Return where the means over the same seeds are on another CPU, in 95 of 100 cases; ready for JSON.

        There, episodes are others with the same distribution (`agents.machine`). The difference of two means over as
        many independent episodes has twice the variance of either: sqrt(2) times the half width of a confidence
        interval holds what the other one will be.
        """
        found = {}
        for name, values in (("return", self.returns), ("distance", self.distances)):
            mean, half = float(values.mean()), ELSEWHERE * confidence(values)
            found[name] = [mean - half, mean + half]
        return {**found, "success": list(success_interval(self.successes, widened=ELSEWHERE))}

    def per_episode(self) -> list[dict[str, Any]]:
        """Return what each episode came to, ready for JSON."""
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
    policy: "Policy", env_id: str, *, episodes: int, seed: int, n_threads: int = 2, env_kwargs: dict | None = None,
    show: Callable[[float], object] | None = None,
) -> Evaluation:  # fmt: skip
    """Run `policy` for `episodes` episodes of `env_id`, side by side; episode i has the seed ``seed + i``.

    What an episode comes to depends on its seed alone, and not on how many run beside it. `show` is called often, with
    the fraction of the steps that is done.
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
    policy: "Policy", env_id: str, seeds: list[int], n_threads: int, env_kwargs: dict[str, Any],
    show: Callable[[float], object],
) -> Evaluation:  # fmt: skip
    from agents.vec_env import make_batch_vec_env

    env = make_batch_vec_env(env_id, n_envs=len(seeds), n_threads=n_threads, **env_kwargs)
    try:
        _check_fits(policy, env.observation_space.shape, env_id)
        return run_episodes(policy, env, seeds, show)
    finally:
        env.close()


def run_episodes(
    policy: "Policy", env: "BatchVecEnv", seeds: Sequence[int], show: Callable[[float], object] | None = None
) -> Evaluation:
    """Run one episode in each environment, with a seed for each; `show` is called with the fraction that is done."""
    env.seed(seeds)
    observations = env.reset()
    policy.reset(seeds)
    infos: dict[int, dict[str, Any]] = {}
    steps = 0
    while len(infos) < len(seeds):
        env.step_async(policy(observations, env.batch))
        observations, _, dones, step_infos = env.step_wait()
        for i in np.flatnonzero(dones):
            # an environment that is done goes on with episodes that nobody counts until the last one is done
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
    """Print what the episodes came to, a line per quantity."""
    from rich.console import Console
    from rich.table import Table

    summary = result.summary()
    table = Table(title=title, caption=f"Means on another CPU: within {ELSEWHERE:.1f} times the interval.")
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
    """Return the 95 % confidence interval of a success rate (Wilson 1927), or one that is wider by a factor."""
    from scipy import stats

    level = 1.0 - 2.0 * stats.norm.sf(widened * stats.norm.isf(0.025))
    interval = stats.binomtest(int(np.sum(successes)), len(successes)).proportion_ci(level, method="wilson")
    return float(interval.low), float(interval.high)


@dataclasses.dataclass
class EvaluateArguments:
    """Evaluate a trained run, a pretrained policy or a baseline on episodes with the seeds seed, seed + 1, ..."""

    run: Path | None = None
    """Folder of a run of agents.train."""
    pretrained: str | None = None
    """Instead of a run: the name of a policy in agents/pretrained."""
    policy: str | None = None
    """Instead of a run: zero, random, scripted, seed_gait, the gait.yml that agents.search wrote, or a Python file with
    a function policy(observation), as scripts/score.py takes it."""
    env: str | None = None
    """Environment id, before which may stand the module that registers it, as in my_module:my_lab/SnakeTurn-v0; by
    default the one that the policy was trained or searched on."""
    spread: str | None = None
    """How starts are drawn, for tasks that know several: of OctopusReach arc, anywhere or default."""
    episodes: int = 50
    """How many episodes."""
    seed: int = TEST.start
    """Seed of the first episode; by default one that nothing is trained or chosen with (`agents.seeds`)."""
    record: Path | None = None
    """Folder for a rerun recording of the first episode."""
    video: Path | None = None
    """File for a film of the first episode, which ends in .mp4 or .gif."""
    json: Path | None = None
    """File for the numbers as JSON: means, each episode, and what they were computed with."""
    threads: int = 2
    """Threads for the physics."""


def main() -> None:
    """Run the command line."""
    require_extra("train")
    import tyro

    arguments = tyro.cli(EvaluateArguments)
    from agents.progress import Bar

    if arguments.video is not None:
        from agents.films import SIZE, check_film

        check_film(arguments.video, SIZE)
    for folder in (arguments.record, arguments.json and arguments.json.parent):
        if folder is not None:
            make_folder(folder)
    with Bar(f"evaluating {arguments.episodes} episodes") as bar:
        policy, env_id, env_kwargs = _policy_and_environment(arguments)
        if arguments.spread is not None:
            env_kwargs = {**env_kwargs, "spread": choose("spread", arguments.spread, spreads(env_id))}
        result = evaluate(
            policy,
            env_id,
            episodes=arguments.episodes,
            seed=arguments.seed,
            n_threads=arguments.threads,
            env_kwargs=env_kwargs,
            show=bar.show,
        )
    name = arguments.policy or arguments.pretrained or str(arguments.run)
    print_table(f"{name} on {env_id}, {arguments.episodes} episodes from seed {arguments.seed}", result)
    if arguments.json is not None:
        write_json(arguments.json, arguments, result, policy=name, env=env_id, env_kwargs=env_kwargs)
    if arguments.record is not None:
        record(policy, env_id, seed=arguments.seed, folder=arguments.record, env_kwargs=env_kwargs)
    if arguments.video is not None:
        from agents.films import film

        film(policy, env_id, arguments.video, seed=arguments.seed, env_kwargs=env_kwargs)


def write_json(path: Path, arguments: EvaluateArguments, result: Evaluation, **what: Any) -> None:
    """Write means, what each episode came to, the arguments, and the machine and versions; say where that is."""
    from agents import machine

    given = {key: str(value) if isinstance(value, Path) else value for key, value in vars(arguments).items()}
    everything = {
        **what, **result.summary(), "per_episode": result.per_episode(), "arguments": given, **machine.describe(),
    }  # fmt: skip
    path.write_text(json.dumps(_without_nan(everything), indent=2, allow_nan=False) + "\n")
    print(f"wrote {path}")


def _without_nan(value: Any) -> Any:
    """Return what is written as JSON, which has no NaN, with null for each."""
    if isinstance(value, dict):
        return {key: _without_nan(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_without_nan(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _policy_and_environment(arguments: EvaluateArguments) -> "tuple[Policy, str, dict[str, Any]]":
    if sum(given is not None for given in (arguments.run, arguments.pretrained, arguments.policy)) != 1:
        raise BadInputError("Give either --run DIR, --pretrained NAME or --policy zero|random|scripted|seed_gait|FILE.")
    if arguments.env is not None:
        from agents.policies import BASELINES

        # a policy that does not look at observations takes them in any form
        choose_environment(arguments.env, goals=arguments.policy in BASELINES)
    # torch takes seconds to import: not before the arguments are known to be good
    from agents.cards import load_pretrained
    from agents.policies import load_run

    if arguments.policy is not None:
        return *_baseline_and_environment(arguments.policy, arguments.env), {}
    policy: Policy
    if arguments.pretrained is not None:
        policy, card = load_pretrained(arguments.pretrained)
        env_id, env_kwargs = card["environment"], card["env_kwargs"]
    else:
        assert arguments.run is not None
        policy, config = load_run(arguments.run)
        env_id, env_kwargs = config["env"], config["hyperparameters"].get("env_kwargs") or {}
    return policy, arguments.env or choose_environment(env_id), env_kwargs


def _baseline_and_environment(name: str, env_id: str | None) -> "tuple[Policy, str]":
    from agents.gaits import load_gait
    from agents.policies import baseline
    from elastica_gym.envs import task_of

    if Path(name).suffix == ".yml":
        gait, searched_on = load_gait(Path(name))
        return gait, env_id or choose_environment(searched_on)
    if env_id is None:
        raise BadInputError(f"--policy needs --env, one of {', '.join(environment_ids())}.")
    if Path(name).suffix == ".py":
        return _file_policy(Path(name)), env_id
    if name == "seed_gait" and task_of(env_id).make_body().name != "snake":
        raise BadInputError(f"seed_gait is the snake's published gait; {env_id} is not a snake's.")
    return baseline(name), env_id


def _file_policy(path: Path) -> "Policy":
    """Return the policy of a Python file, as the score takes it, in this process."""
    from agents.policy_file import FilePolicy

    if not path.is_file():
        raise BadInputError(f"There is no policy file {path}.")
    return FilePolicy(path)


def spreads(env_id: str) -> tuple[str, ...]:
    """Return the ways in which an environment can draw its starts."""
    from elastica_gym.envs import task_of

    return tuple(task_of(env_id).starts)


def record(policy: "Policy", env_id: str, *, seed: int, folder: Path, env_kwargs: dict[str, Any]) -> Path | None:
    """Record the episode with `seed` for rerun; without rerun, say how to get it and return None."""
    if message := missing_extra("viz"):
        print(f"no recording: {message}")
        return None
    from agents.films import run_shown
    from elastica_gym.viz import write_recording

    path = folder / f"{env_id.rpartition('/')[2]}-seed{seed}.rrd"
    policy.reset([seed])
    write_recording(run_shown(policy, env_id, seed=seed, env_kwargs=env_kwargs), path)
    print(f"recorded {path}")
    return path


if __name__ == "__main__":
    run_command(main)
