"""The trials of a sweep on Ray Tune, with Optuna as its search; see `.sweep` for what a trial is.

Ray Tune places trials on free cores and starts those again whose worker has died. Everything that is to be kept is in
the folders of the trials, so that Ray's own state is not needed to continue a sweep.
"""

import os
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

# our own bar and table replace Tune's, which are chosen at its import
os.environ["RAY_AIR_NEW_OUTPUT"] = "0"
os.environ["TUNE_DISABLE_AUTO_CALLBACK_LOGGERS"] = "1"
import optuna
from ray import tune
from ray.tune.search import Repeater, Searcher
from ray.tune.search.optuna import OptunaSearch
from ray.tune.search.repeater import TRIAL_INDEX

from ..progress import Bar
from .cluster import connected
from .sweep import FINISHED, Range, Trial, announce, evaluated_points, run_trial, write_table

SCORE = "score"
STATE = ".ray"
"""Folder in a sweep for Ray Tune's own state, which is deleted at the end"""


def run_grid(
    trials: Sequence[Trial],
    *,
    out: Path,
    configs: dict[str, dict[str, Any]],
    cores_each: int,
    retries: int,
    address: str | None,
) -> None:
    """Run all trials that have not finished.

    Parameters
    ----------
    trials : sequence of Trial
    out : Path
        Folder of the sweep, which every node of the cluster must see under the same path.
    configs : dict of str to dict
        Contents of ``config.yml`` by environment id, before the settings of trials.
    cores_each : int
        Cores of a trial.
    retries : int
        How often a trial is started again after its worker died.
    address : str, optional
        Of a cluster; by default Ray runs on the cores of this machine.
    """
    open_trials = [trial for trial in trials if announce(out, trial)["status"] != FINISHED]
    if not open_trials:
        return

    def train(config: dict[str, Any]) -> None:
        trial = Trial(*config["trial"])
        tune.report({SCORE: run_trial(out, trial, configs[trial.env])})

    space = {"trial": tune.grid_search([tuple(trial) for trial in open_trials])}
    _fit(train, space, None, out, len(open_trials), cores_each, retries, address)


def run_search(
    ranges: Sequence[Range],
    *,
    env: str,
    seeds: Sequence[int],
    n_settings: int,
    out: Path,
    configs: dict[str, dict[str, Any]],
    cores_each: int,
    retries: int,
    address: str | None,
) -> None:
    """Search `ranges` for the highest mean score over `seeds`, until `n_settings` settings have been tried.

    Parameters
    ----------
    ranges : sequence of Range
    env : str
    seeds : sequence of int
        Each setting is trained once with each.
    n_settings : int
        Settings to try in total, with those of earlier searches in the same folder.
    out, configs, cores_each, retries, address
        As in `run_grid`.
    """
    finished, unfinished = evaluated_points(out, env, seeds, ranges)
    left = n_settings - len(finished)
    if left <= 0:
        return
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    search = OptunaSearch(
        {each.key: _distribution(each) for each in ranges},
        metric=SCORE,
        mode="max",
        points_to_evaluate=unfinished[:left],
        # not the same suggestions after a restart
        sampler=optuna.samplers.TPESampler(seed=len(finished)),
    )
    for point, score in finished:
        search.add_evaluated_point(point, score)

    def train(config: dict[str, Any]) -> None:
        found = {each.key: each.setting(config[each.key]) for each in ranges}
        trial = Trial(env, seeds[config[TRIAL_INDEX]], found)
        tune.report({SCORE: run_trial(out, trial, configs[env])})

    _fit(train, {}, Repeater(search, repeat=len(seeds)), out, left * len(seeds), cores_each, retries, address)


def _distribution(searched: Range) -> optuna.distributions.BaseDistribution:
    match searched.kind:
        case "choice":
            return optuna.distributions.CategoricalDistribution(searched.values)
        case "int":
            return optuna.distributions.IntDistribution(*searched.values)
    low, high = searched.values
    return optuna.distributions.FloatDistribution(low, high, log=searched.kind == "log")


def _fit(
    train: Any,
    space: dict[str, Any],
    search: Searcher | None,
    out: Path,
    n_trials: int,
    cores_each: int,
    retries: int,
    address: str | None,
) -> None:
    """Run trials on Ray Tune; show a bar, and write the table whenever a trial has ended."""
    state = out / STATE
    shutil.rmtree(state, ignore_errors=True)
    with connected(address), Bar("sweep") as bar:
        tuner = tune.Tuner(
            tune.with_resources(train, {"cpu": cores_each}),
            param_space=space,
            tune_config=tune.TuneConfig(search_alg=search, num_samples=n_trials if search else 1),
            run_config=tune.RunConfig(
                name="tune",
                storage_path=str(state),
                failure_config=tune.FailureConfig(max_failures=retries),
                callbacks=[_Watch(bar, out, n_trials)],
                verbose=0,
            ),
        )
        tuner.fit()
    shutil.rmtree(state, ignore_errors=True)


class _Watch(tune.Callback):
    """Shows how many trials have ended, and keeps the table up to date."""

    def __init__(self, bar: Bar, out: Path, n_trials: int):
        self._bar, self._out, self._n_trials = bar, out, n_trials
        self._ended = 0

    def __getstate__(self) -> dict[str, Any]:
        # Ray Tune keeps a copy, which is never used
        return {}

    def on_trial_complete(self, iteration: int, trials: list[Any], trial: Any, **info: Any) -> None:
        self._ended += 1
        write_table(self._out)
        self._bar.show(self._ended / self._n_trials, {"trials": float(self._ended)})

    def on_trial_error(self, iteration: int, trials: list[Any], trial: Any, **info: Any) -> None:
        self._bar.say(f"A worker died more often than --retries allows: {trial.trial_id}")
        self.on_trial_complete(iteration, trials, trial)

    def on_trial_recover(self, iteration: int, trials: list[Any], trial: Any, **info: Any) -> None:
        self._bar.say("A worker died; its trial continues from its last checkpoint.")
