"""Families of gaits with a few parameters, for search: waves for the snake, strokes for the octopus."""

import dataclasses
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from ..bodies.body import Body
from ..console.bad_input import BadInputError, choose
from ..engine import Wave
from .gaits import (
    OCTOPUS_FUNCTIONS,
    SEED_COEFFICIENTS,
    SEED_PERIOD,
    TURNING,
    play_stroke,
    play_wave,
    turn_activations,
    wave_activations,
)

Play = Callable[[Any, np.ndarray], np.ndarray]
"""Function from a batch and its observations (B, d) to actions (B, 42)"""


@dataclasses.dataclass(frozen=True)
class Parameter:
    """A parameter of a search: initial mean, initial standard deviation, and bounds."""

    name: str
    start: float
    spread: float
    low: float
    high: float


@dataclasses.dataclass(frozen=True)
class Gait:
    """A family of gaits.

    Attributes
    ----------
    name : str
    body : str
        Name of the animal.
    parameters : tuple of Parameter
    prepare : callable
        From a body and the parameters of K gaits, (K, P), a function that plays them; gait k plays in the k-th of K
        equal parts of the batch.
    objective : str
        What a search maximises: distance, or return, the sum of the task's rewards.
    starts : int
        Number of initial states on which a search evaluates each candidate.
    """

    name: str
    body: str
    parameters: tuple[Parameter, ...]
    prepare: Callable[[Body, np.ndarray], Play]
    objective: str
    starts: int


class GaitPolicy:
    """A policy that plays gaits of one family.

    Parameters
    ----------
    gait
        The family.
    values
        Parameters, (P,) for all environments, or (K, P) for K equal parts of the batch.
    """

    def __init__(self, gait: Gait, values: np.ndarray):
        self.gait = gait
        self.values = np.atleast_2d(values)

    def reset(self, seeds: Sequence[int]) -> None:
        """Clear the tables; a gait reads the clock of its environment."""
        self._play: Play | None = None

    def __call__(self, observations: np.ndarray, batch: Any) -> np.ndarray:
        """Return the actions of the gaits."""
        if self._play is None:
            check_fits(self.gait, batch.body)
            self._play = self.gait.prepare(batch.body, self.values)
        return self._play(batch, observations).astype(np.float32)


def check_fits(gait: Gait, body: Body) -> None:
    """Raise ``BadInputError`` if the gait is for another animal."""
    if gait.body != body.name:
        raise BadInputError(f"The gait {gait.name!r} is for the {gait.body}, not for the {body.name}.")


def angle_to_goal(observations: np.ndarray, batch: Any) -> np.ndarray:
    """Return the angle from the heading to the goal, positive to the right [rad], (B,)."""
    columns = [batch.observation_names.index(f"goal/{axis}") for axis in ("forward", "right")]
    forward, right = observations[:, columns].astype(np.float64).T
    return np.arctan2(right, forward)


def _rows(values: np.ndarray, batch: Any) -> np.ndarray:
    """Repeat values per gait (K, ...) for the environments that play it (B, ...)."""
    return np.repeat(values, batch.num_envs // len(values), axis=0)


COUPLES = tuple(Parameter(f"coefficient_{i}", b, 4e-3, -0.03, 0.03) for i, b in enumerate(SEED_COEFFICIENTS))
"""Spline coefficients [N m], up to five times the muscles' strength, at which activations saturate"""
WAVE_LENGTH = Parameter("wave_length", 1.0, 0.5, 0.2, 10.0)
"""In body lengths"""


def _wave(body: Body, coefficients: np.ndarray, wave_length: float, period: float) -> np.ndarray:
    wave = Wave(coefficients=tuple(coefficients), period=period, wave_number=2.0 * np.pi / wave_length)
    return wave_activations(body, wave)


def _prepare_wave(body: Body, values: np.ndarray) -> Play:
    tables = np.stack([_wave(body, row[:6], row[6], SEED_PERIOD) for row in values])
    return lambda batch, observations: play_wave(batch, tables, np.full(batch.num_envs, SEED_PERIOD))


def _prepare_steered_wave(body: Body, values: np.ndarray) -> Play:
    tables, turn = np.stack([_wave(body, row[:6], row[6], row[7]) for row in values]), turn_activations(body)

    def play(batch: Any, observations: np.ndarray) -> np.ndarray:
        _, period, couple = _rows(values[:, 6:], batch).T
        bend = couple * np.clip(angle_to_goal(observations, batch), -1.0, 1.0)
        return play_wave(batch, tables, period, bend[:, None] * turn)

    return play


STROKE_SHAPE = (3, 3, len(OCTOPUS_FUNCTIONS))
"""(always, forward, right), (offset, sine, cosine), functions"""


def _prepare_stroke(body: Body, values: np.ndarray) -> Play:
    def play(batch: Any, observations: np.ndarray) -> np.ndarray:
        rows, angle = _rows(values, batch), angle_to_goal(observations, batch)
        always, forward, right = np.moveaxis(rows[:, 1:].reshape(-1, *STROKE_SHAPE), 1, 0)
        ahead, aside = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
        # the arms are mirror images: ahead of one is behind the other
        tables = [always + aside * right + side * ahead * forward for side in (1.0, -1.0)]
        return play_stroke(batch, rows[:, 0], tables)

    return play


WAVE = Gait("wave", "snake", (*COUPLES, WAVE_LENGTH), _prepare_wave, "distance", 1)
"""The snake's published gait, with the published period: six spline coefficients and a wave length."""

STEERED_WAVE = Gait(
    "steered_wave",
    "snake",
    (*COUPLES, WAVE_LENGTH, Parameter("period", 1.0, 0.2, 0.3, 4.0), Parameter("turn", TURNING, 5e-4, 0.0, 0.01)),
    _prepare_steered_wave,
    "return",
    8,
)
"""A wave with a variable period [s], and a bend towards the goal, in N m per radian."""

STROKE = Gait(
    "stroke",
    "octopus",
    (
        Parameter("period", 0.8, 0.2, 0.3, 3.0),
        *(
            Parameter(f"{direction}_{part}_{function}", 0.0, 0.3, -3.0, 3.0)
            for direction in ("always", "forward", "right")
            for part in ("offset", "sine", "cosine")
            for function in OCTOPUS_FUNCTIONS
        ),
    ),
    _prepare_stroke,
    "return",
    8,
)
"""A period [s], and activations that depend on the direction to the goal; the arms are mirror images."""

GAITS = {gait.name: gait for gait in (WAVE, STEERED_WAVE, STROKE)}


def gait_for(env_id: str, body: str) -> Gait:
    """Return the default gait of a search; SnakeForward, which goes straight ahead, has the published wave."""
    if body == STROKE.body:
        return STROKE
    return WAVE if "SnakeForward" in env_id else STEERED_WAVE


def describe(gait: Gait, values: np.ndarray) -> dict[str, Any]:
    """Return a gait as the contents of a YAML file, for `load_gait`."""
    names = (parameter.name for parameter in gait.parameters)
    return {"gait": gait.name, "parameters": dict(zip(names, map(float, values), strict=True))}


def load_gait(path: Path) -> tuple[GaitPolicy, str]:
    """Load a gait written by a search.

    Returns
    -------
    policy
        The gait.
    env_id
        The environment of the search.
    """
    try:
        saved = yaml.safe_load(path.read_text())
    except OSError as error:
        raise BadInputError(f"Cannot read the gait {path}: {error.strerror}.") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise BadInputError(f"The gait {path} is not YAML: {error}") from error
    absent = {"env", "gait", "parameters"} - set(saved if isinstance(saved, dict) else ())
    if absent:
        raise BadInputError(f"{path} is not a gait: no {', '.join(sorted(absent))}.")
    gait = GAITS[choose("gait", saved["gait"], GAITS)]
    names = [parameter.name for parameter in gait.parameters]
    try:
        values = np.array([float(saved["parameters"][name]) for name in names])
    except (KeyError, TypeError, ValueError) as error:
        raise BadInputError(f"{path}: the gait {gait.name!r} needs a number for each of {', '.join(names)}.") from error
    return GaitPolicy(gait, values), saved["env"]
