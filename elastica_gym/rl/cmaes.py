"""The search loop: CMA-ES over the parameters of a gait, one generation per batch."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cma
import numpy as np
import yaml
from matplotlib.figure import Figure

from ..console.bad_input import BadInputError
from ..files import write_atomically
from ..progress import Bar
from ..scripted.families import GAITS, Gait, GaitPolicy, check_fits, describe, gait_for
from . import curves
from .budget import Budget
from .evaluation import Evaluation, run_episodes
from .run_files import GAIT, SEARCH, Table, read_table
from .seeds import training_seeds
from .vec_env import BatchVecEnv, make_batch_vec_env

GENERATIONS_BETWEEN_TRIALS = 10


def strategy_about(
    start: np.ndarray, spread: np.ndarray, population: int, seed: int, bounds: Any = (None, None)
) -> cma.CMAEvolutionStrategy:
    """Return CMA-ES with a mean, standard deviations and a population size for its first generation."""
    # a seed of zero would mean the clock
    options = {"popsize": population, "CMA_stds": spread, "bounds": list(bounds), "seed": 1 + seed, "verbose": -9}
    return cma.CMAEvolutionStrategy(start, 1.0, options)


def generations(
    strategy: cma.CMAEvolutionStrategy, worth: Callable[[np.ndarray], np.ndarray]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield the candidates of each generation and their values; larger is better."""
    while True:
        candidates = np.array(strategy.ask())
        values = worth(candidates)
        strategy.tell(list(candidates), list(-values))
        yield candidates, values


class Search:
    """Search for the gait with the largest objective.

    Candidates are drawn by CMA-ES (Hansen, The CMA evolution strategy: a tutorial, 2016). All candidates of a
    generation share the same initial states, and each generation draws new ones. Every few generations the mean of the
    distribution and the best candidate of the last generation are evaluated on the evaluation episodes, and the best
    gait so far is saved.

    Parameters
    ----------
    folder
        Existing folder for the output files.
    config
        The arguments of ``python -m agents.search``.
    """

    def __init__(self, folder: Path, config: dict[str, Any]):
        self.folder, self.config = folder, config
        self._trials = self._environments(2 * config["evaluation_episodes"])
        body = self._trials.batch.body
        self.gait: Gait = GAITS[config["gait"]] if config["gait"] else gait_for(config["env"], body.name)
        check_fits(self.gait, body)
        self._batch = self._environments(config["population"] * self.gait.starts)
        self._rng = np.random.default_rng(config["seed"])
        self._n_starts = 0
        self.evaluations = 0
        self.best = -np.inf

    def _environments(self, n: int) -> BatchVecEnv:
        try:
            return make_batch_vec_env(self.config["env"], n_envs=n, n_threads=self.config["threads"])
        except ValueError as error:
            raise BadInputError(f"The environment refuses its arguments: {error}") from error

    def run(self) -> None:
        """Search until the budget is spent, and write the plot, even if interrupted."""
        self._table = Table(self.folder / SEARCH)
        with Bar("searching", file=sys.stdout) as self._display:
            self._compile()
            self.budget = Budget(steps=self.config["evaluations"], minutes=self.config["minutes"])
            try:
                number = 0
                while self.evaluations == 0 or self._spent() < 1.0:
                    self._descend(number)
                    number += 1
            finally:
                self._table.close()
                figure = plot(self.folder, f"{self.gait.name} on {self.config['env']}", self.gait.objective)
                write_atomically(self.folder / "search.png", lambda path: curves.save(figure, path))

    def _compile(self) -> None:
        """Step one environment, so that compilation does not count."""
        env = self._environments(1)
        env.reset()
        env.step(np.zeros((1, *env.action_space.shape), np.float32))  # type: ignore[misc]
        env.close()

    def _spent(self) -> float:
        return self.budget.fraction(self.evaluations)

    def _descend(self, number: int) -> None:
        """Run one restart until its share of the budget is spent or CMA-ES stops."""
        end = min(1.0, (number + 1) / (self.config["restarts"] + 1))
        strategy = self._strategy(number)
        # at least one generation, so that the shortest search finds something
        for generation, (candidates, values) in enumerate(generations(strategy, self._worth), 1):
            self.evaluations += len(candidates)
            goes_on = self._spent() < end and not strategy.stop()
            if generation % GENERATIONS_BETWEEN_TRIALS == 0 or not goes_on:
                self._try(number, strategy.result.xfavorite, candidates[values.argmax()])
            # after the trial, so that the last row includes its result
            self._note(number, generation, values, strategy.sigma)
            if not goes_on:
                break

    def _strategy(self, number: int) -> cma.CMAEvolutionStrategy:
        """Return CMA-ES centred on the published gait, or on a random gait for later restarts."""
        parameters = self.gait.parameters
        start, spread, low, high = (
            np.array([getattr(p, name) for p in parameters]) for name in ("start", "spread", "low", "high")
        )
        if number:
            start = np.clip(start + 2.0 * spread * self._rng.standard_normal(len(start)), low, high)
        seed = int(np.random.SeedSequence([self.config["seed"], number]).generate_state(1)[0] >> 1)
        return strategy_about(start, spread, self.config["population"], seed, bounds=[low, high])

    def _draw_starts(self) -> list[int]:
        seeds = training_seeds(self.config["seed"], self._n_starts, self.gait.starts)
        self._n_starts += self.gait.starts
        return seeds

    def _worth(self, candidates: np.ndarray) -> np.ndarray:
        """Return the mean objective of each candidate over the same new initial states."""
        return self._values(self._batch, candidates, self._draw_starts())[0]

    def _values(self, env: BatchVecEnv, candidates: np.ndarray, seeds: list[int]) -> tuple[np.ndarray, Evaluation]:
        """Return the mean objective of each candidate over these seeds, and the evaluation of all episodes."""
        result = run_episodes(GaitPolicy(self.gait, candidates), env, seeds * len(candidates))
        return self._objective(result).reshape(len(candidates), -1).mean(axis=1), result

    def _objective(self, result: Evaluation) -> np.ndarray:
        if self.gait.objective == "return":
            return result.returns
        # a diverged episode counts as no distance
        return np.where(result.reasons == "diverged", 0.0, result.distances)

    def _try(self, number: int, *candidates: np.ndarray) -> None:
        """Evaluate candidates on the evaluation episodes; save the best if it is the best so far."""
        episodes, first = self.config["evaluation_episodes"], self.config["evaluation_seed"]
        values, result = self._values(self._trials, np.array(candidates), list(range(first, first + episodes)))
        which = int(values.argmax())
        if values[which] > self.best:
            self.best = float(values[which])
            self._keep(number, candidates[which], result, slice(which * episodes, (which + 1) * episodes))

    def _keep(self, number: int, values: np.ndarray, result: Evaluation, episodes: slice) -> None:
        found = {
            "env": self.config["env"],
            **describe(self.gait, values),
            "score": {
                "episodes": self.config["evaluation_episodes"],
                "first_seed": self.config["evaluation_seed"],
                "distance_mean": float(result.distances[episodes].mean()),
                "return_mean": float(result.returns[episodes].mean()),
                "success_rate": float(result.successes[episodes].mean()),
            },
            "found": {"restart": number, "evaluations": self.evaluations, "seconds": round(self.budget.seconds, 1)},
        }
        text = yaml.safe_dump(found, sort_keys=False)
        write_atomically(self.folder / GAIT, lambda path: path.write_text(text))
        self._display.say(
            f"{self.evaluations:,} evaluations, restart {number}: {self.gait.objective} {self.best:.4f}, best so far"
        )

    def _note(self, number: int, generation: int, values: np.ndarray, sigma: float) -> None:
        row = {
            "restart": number,
            "generation": generation,
            "evaluations": self.evaluations,
            "seconds": self.budget.seconds,
            "generation_best": float(values.max()),
            "generation_mean": float(values.mean()),
            "sigma": float(sigma),
            "best_so_far": self.best if np.isfinite(self.best) else np.nan,
        }
        self._table.append(row)
        shown = ("evaluations", "restart", "generation_best", "best_so_far")
        self._display.show(self._spent(), {key.replace("_", " "): row[key] for key in shown})


def plot(folder: Path, title: str, objective: str) -> Figure:
    """Plot each generation's best and mean, and the best so far on the evaluation episodes."""
    table = read_table(folder / SEARCH)
    figure = Figure(figsize=(8, 4), layout="constrained")
    axes = figure.subplots()
    axes.set_title(title, fontsize=10)
    axes.set_xlabel("evaluations")
    axes.set_ylabel("distance [m]" if objective == "distance" else objective)
    axes.grid(alpha=0.3)
    if table:
        evaluations = table["evaluations"]
        axes.plot(evaluations, table["generation_best"], ".", ms=3, label="best of the generation, on its starts")
        axes.plot(evaluations, table["generation_mean"], ".", ms=3, label="mean of the generation, on its starts")
        axes.step(evaluations, table["best_so_far"], where="post", label="best so far, on the evaluation's episodes")
        for border in evaluations[1:][np.diff(table["restart"]) > 0]:
            axes.axvline(border, color="0.6", lw=0.8, ls=":")
        axes.legend(fontsize=8)
    return figure
