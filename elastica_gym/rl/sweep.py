"""Sweeps over seeds, environments and hyperparameters: settings, trials, and the table of all trials.

A trial is an ordinary run with a ``trial.yml`` in its folder, which is all that a sweep remembers. `.tuning` runs
trials on one machine or on many; nothing here needs Ray.
"""

import contextlib
import csv
import hashlib
import io
import itertools
import platform
import re
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from ..console.bad_input import BadInputError, choose, make_folder
from ..files import write_atomically
from .hyperparameters import checked, parse_overrides
from .run_files import EVALUATIONS, METRICS, read_table

TRIAL = "trial.yml"
"""File in a run's folder: what the trial is, when and where it was started, and how it ended"""
SWEEP = "sweep.yml"
"""File in a sweep's folder: configurations of its environments before the settings of trials"""
TRIALS = "trials.csv"
LOG = "train.log"
"""What a trial has printed"""
WAITING, RUNNING, FINISHED, FAILED = "waiting", "running", "finished", "failed"
NOT_SWEPT = {"n_timesteps": "steps", "policy": "config"}
"""Hyperparameters that other options set for the whole sweep"""
COLUMNS = ("status", "retries", "score", "score_steps", "distance", "success", "steps", "seconds", "hosts", "error")
LONGEST_NAME = 100


class Trial(NamedTuple):
    """One run of a sweep."""

    env: str
    """Environment id"""
    seed: int
    settings: dict[str, Any]
    """Hyperparameters that differ from the sweep's configuration"""

    @property
    def folder(self) -> str:
        """Path inside the sweep's folder: the environment, then settings and seed."""
        parts = [*(f"{key}={value}" for key, value in sorted(self.settings.items())), f"seed={self.seed}"]
        wanted = "-".join(parts)
        name = re.sub(r"[^\w.=+-]+", "_", wanted)[:LONGEST_NAME]
        if name != wanted:
            name = f"{name}-{hashlib.sha256(wanted.encode()).hexdigest()[:8]}"
        return f"{self.env.rpartition('/')[2]}/{name}"


class Range(NamedTuple):
    """A hyperparameter that is searched."""

    key: str
    prefix: str
    """Prefix of the values, such as ``lin_`` of a decaying learning rate, or an empty string"""
    kind: str
    """One of `KINDS`"""
    values: tuple[Any, ...]
    """Lowest and highest value, or the choices"""

    def setting(self, sampled: Any) -> Any:
        """Return the hyperparameter for a sampled value."""
        return f"{self.prefix}{sampled}" if self.prefix else sampled

    def sampled(self, setting: Any) -> Any:
        """Return the sampled value of a hyperparameter."""
        return float(setting.removeprefix(self.prefix)) if self.prefix else setting


KINDS = ("uniform", "log", "int", "choice")


# Settings


def parse_values(assignments: Sequence[str]) -> dict[str, list[Any]]:
    """Turn ``["gamma=0.95,0.98"]`` into ``{"gamma": [0.95, 0.98]}``; commas within brackets do not separate values."""
    found = {}
    for assignment in assignments:
        key, separator, text = assignment.partition("=")
        values = [parse_overrides([f"{key}{separator}{part}"])[key] for part in _split(text)]
        if len({repr(value) for value in values}) < len(values):
            raise BadInputError(f"The values of {key} must differ, got {text!r}.")
        found[key] = values
    return found


def parse_ranges(texts: Sequence[str]) -> list[Range]:
    """Turn ``["learning_rate=log(1e-4,1e-3)"]`` into ranges.

    Raises
    ------
    BadInputError
        If a text is not KEY=KIND(LOW,HIGH) or KEY=choice(A,B,...).
    """
    ranges = [_range(text) for text in texts]
    if len({each.key for each in ranges}) < len(ranges):
        raise BadInputError(f"Each hyperparameter can be searched once, got {', '.join(texts)}")
    return ranges


def _range(text: str) -> Range:
    match = re.fullmatch(r"(\w+)=(lin_)?(\w+)\((.*)\)", text)
    if match is None:
        raise BadInputError(f"Expected KEY=KIND(LOW,HIGH) or KEY=choice(A,B,...), got {text!r}.")
    key, prefix, kind, inside = match[1], match[2] or "", match[3], match[4]
    choose("kind of search", kind, KINDS)
    values = tuple(parse_overrides([f"{key}={part}"])[key] for part in _split(inside))
    if kind != "choice":
        values = tuple(_number(key, value) for value in values)
        if len(values) != 2 or not values[0] < values[1]:
            raise BadInputError(f"{kind} needs a lowest and a highest value, got {text!r}.")
        if kind == "log" and values[0] <= 0.0:
            raise BadInputError(f"log needs values above 0, got {text!r}.")
        if kind == "int" and any(value != int(value) for value in values):
            raise BadInputError(f"int needs whole numbers, got {text!r}.")
    return Range(key, prefix, kind, tuple(map(int, values)) if kind == "int" else values)


def _number(key: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise BadInputError(f"The range of {key} needs numbers, got {value!r}.") from None


def _split(text: str) -> list[str]:
    """Split at the commas outside of brackets."""
    parts, depth = [""], 0
    for sign in text:
        depth += (sign in "([{") - (sign in ")]}")
        if sign == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += sign
    return parts


def check_settings(algo: str, values: dict[str, Any], settings: dict[str, list[Any]], ranges: Sequence[Range]) -> None:
    """Check every value of `settings`, and the ends and the inside of `ranges`, as hyperparameters.

    Parameters
    ----------
    algo : str
    values : dict
        The other hyperparameters.
    settings : dict of str to list
    ranges : sequence of Range

    Raises
    ------
    BadInputError
        If a key is unknown, given twice, or set by another option, or a value is not allowed.
    """
    for key in [*settings, *(each.key for each in ranges)]:
        if key in NOT_SWEPT:
            raise BadInputError(f"{key} is the same for all trials: give it with --{NOT_SWEPT[key]}")
    for each in ranges:
        if each.key in settings:
            raise BadInputError(f"{each.key} is both set and searched; leave out one of them")
        probes = each.values
        if each.kind in ("uniform", "log"):
            # not a whole number, which some keys need
            probes = (*probes, probes[0] + (probes[1] - probes[0]) / np.pi)
        settings = {**settings, each.key: [each.setting(value) for value in probes]}
    for key, several in settings.items():
        for value in several:
            checked(algo, {**values, key: value})


def grid(envs: Sequence[str], seeds: Sequence[int], settings: dict[str, list[Any]]) -> list[Trial]:
    """Return a trial for every combination, with all settings of the first seed first."""
    combinations = [dict(zip(settings, values, strict=True)) for values in itertools.product(*settings.values())]
    return [Trial(env, seed, each) for seed in seeds for env in envs for each in combinations]


# The folder of a sweep


def open_sweep(out: Path, configs: dict[str, dict[str, Any]]) -> None:
    """Create the folder of a sweep, or check that the sweep there has the same configurations.

    Parameters
    ----------
    out : Path
    configs : dict of str to dict
        Contents of ``config.yml`` by environment id, before the settings of trials.

    Raises
    ------
    BadInputError
        If a configuration differs from that of earlier trials; names what differs.
    """
    make_folder(out)
    path = out / SWEEP
    known: dict[str, dict[str, Any]] = yaml.safe_load(path.read_text()) if path.exists() else {}
    plain: dict[str, dict[str, Any]] = yaml.safe_load(yaml.safe_dump(configs))
    for env in plain.keys() & known.keys():
        differing = sorted(key for key in plain[env] if plain[env][key] != known[env].get(key))
        if differing:
            raise BadInputError(f"The sweep in {out} has another {', '.join(differing)} for {env}: use another --out")
    text = yaml.safe_dump(known | plain, sort_keys=False)
    write_atomically(path, lambda file: file.write_text(text))


def announce(out: Path, trial: Trial) -> dict[str, Any]:
    """Return what is known of a trial, after creating its folder if there is none."""
    folder = out / trial.folder
    if not (folder / TRIAL).exists():
        folder.mkdir(parents=True, exist_ok=True)
        _write(folder, {**trial._asdict(), "status": WAITING, "starts": [], "error": ""})
    return read_trial(folder)


def read_trial(folder: Path) -> dict[str, Any]:
    """Return the contents of a ``trial.yml``."""
    return yaml.safe_load((folder / TRIAL).read_text())


def _write(folder: Path, record: dict[str, Any]) -> None:
    text = yaml.safe_dump(record, sort_keys=False)
    write_atomically(folder / TRIAL, lambda path: path.write_text(text))


def run_trial(out: Path, trial: Trial, config: dict[str, Any]) -> float:
    """Train a trial to its end, from its last checkpoint if it was started before; a finished one is not repeated.

    Exceptions are recorded and not raised: only a trial whose process died is worth another attempt.

    Parameters
    ----------
    out : Path
        Folder of the sweep.
    trial : Trial
    config : dict
        Contents of ``config.yml`` before the settings of the trial.

    Returns
    -------
    float
        Score of the trial, NaN if it failed.
    """
    folder = out / trial.folder
    record = announce(out, trial)
    if record["status"] != FINISHED:
        start = {"time": time.strftime("%Y-%m-%d %H:%M:%S"), "host": platform.node()}
        record |= {"status": RUNNING, "error": "", "starts": [*record["starts"], start]}
        _write(folder, record)
        try:
            with (folder / LOG).open("a") as log, contextlib.redirect_stdout(log), contextlib.redirect_stderr(log):
                _train(folder, trial, config)
            record["status"] = FINISHED
        except Exception as error:
            record |= {"status": FAILED, "error": f"{type(error).__name__}: {error}".partition("\n")[0]}
        _write(folder, record)
    return score_of(folder)["score"] if record["status"] == FINISHED else float("nan")


def _train(folder: Path, trial: Trial, config: dict[str, Any]) -> None:
    # torch takes seconds to import
    from . import machine
    from .policies import read_config
    from .training import Training

    resume = (folder / "config.yml").exists()
    if resume:
        config = read_config(folder)
    else:
        values = checked(config["algo"], {**config["hyperparameters"], **trial.settings})
        config = {**config, "seed": trial.seed, "hyperparameters": values, **machine.describe()}
        text = yaml.safe_dump(config, sort_keys=False)
        write_atomically(folder / "config.yml", lambda path: path.write_text(text))
    Training(folder, config, resume=resume).run()


# Results


def score_of(folder: Path) -> dict[str, float]:
    """Return the evaluation of a run's best checkpoint.

    Returns
    -------
    dict of str to float
        ``score``, its return, NaN without evaluations; with some, also ``score_steps``, ``distance`` and ``success``.
    """
    table = read_table(folder / EVALUATIONS)
    if not table:
        return {"score": float("nan")}
    best = int(np.argmax(table["return"]))
    found = {key: float(table[key][best]) for key in ("distance", "success")}
    return {"score": float(table["return"][best]), "score_steps": float(table["steps"][best]), **found}


def trials_of(out: Path) -> Iterator[tuple[Path, dict[str, Any]]]:
    """Yield folder and record of every trial of a sweep."""
    for path in sorted(out.glob(f"*/*/{TRIAL}")):
        yield path.parent, read_trial(path.parent)


def evaluated_points(
    out: Path, env: str, seeds: Sequence[int], ranges: Sequence[Range]
) -> tuple[list[tuple[dict[str, Any], float]], list[dict[str, Any]]]:
    """Return the settings that an earlier search has tried.

    Parameters
    ----------
    out : Path
    env : str
    seeds : sequence of int
    ranges : sequence of Range

    Returns
    -------
    finished
        Sampled values and mean score over the seeds, of settings whose trials have all ended.
    unfinished
        Sampled values of the others.
    """
    groups: dict[str, dict[int, Any]] = {}
    points: dict[str, dict[str, Any]] = {}
    for folder, record in trials_of(out):
        settings = record["settings"]
        if record["env"] == env and settings.keys() >= {each.key for each in ranges}:
            name = repr(sorted(settings.items()))
            points[name] = {each.key: each.sampled(settings[each.key]) for each in ranges}
            ended = record["status"] == FINISHED
            groups.setdefault(name, {})[record["seed"]] = score_of(folder)["score"] if ended else None
    finished, unfinished = [], []
    for name, scores in groups.items():
        of_seeds = [scores[seed] for seed in seeds if scores.get(seed) is not None]
        if len(of_seeds) < len(seeds):
            unfinished.append(points[name])
        else:
            finished.append((points[name], float(np.mean(of_seeds))))
    return finished, unfinished


def rows_of(out: Path) -> list[dict[str, Any]]:
    """Return a row a trial, the best score first."""
    rows = []
    for folder, record in trials_of(out):
        metrics = read_table(folder / METRICS)
        last = {key: metrics[key][-1] for key in ("steps", "seconds")} if metrics else {}
        rows.append(
            {
                "trial": str(folder.relative_to(out)),
                "env": record["env"],
                "seed": record["seed"],
                **record["settings"],
                "status": record["status"],
                "retries": max(0, len(record["starts"]) - 1),
                **score_of(folder),
                **last,
                "hosts": " ".join(dict.fromkeys(start["host"] for start in record["starts"])),
                "error": record["error"],
            }
        )
    return sorted(rows, key=lambda row: (-np.nan_to_num(row["score"], nan=-np.inf), row["trial"]))


def table_csv(rows: Sequence[dict[str, Any]]) -> str:
    """Return `rows_of` as CSV, with settings between the seed and the results."""
    settings = dict.fromkeys(key for row in rows for key in row if key not in COLUMNS)
    text = io.StringIO()
    writer = csv.DictWriter(text, fieldnames=[*settings, *COLUMNS])
    writer.writeheader()
    for row in rows:
        writer.writerow({key: f"{v:.6g}" if key in COLUMNS and isinstance(v, float) else v for key, v in row.items()})
    return text.getvalue()


def write_table(out: Path) -> None:
    """Write ``trials.csv``."""
    text = table_csv(rows_of(out))
    write_atomically(out / TRIALS, lambda path: path.write_text(text))
