"""Scripted gaits: travelling waves of couple, produced by the animal's muscles."""

import functools
from collections.abc import Sequence

import numpy as np

from ..bodies.body import Body
from ..bodies.muscles import N_FUNCTIONS, OCTOPUS, activations_for, couple_matrix
from ..engine import Rod, Wave
from ..engine.model import Array
from ..envs.batch import BatchEnv

SEED_COEFFICIENTS = (3.4e-3, 3.3e-3, 4.2e-3, 2.6e-3, 3.6e-3, 3.5e-3)
"""Spline coefficients of the snake's published gait [N m]"""
SEED_PERIOD = 2.0
"""Its period [s]"""
SEED_WAVE = Wave(coefficients=SEED_COEFFICIENTS, period=SEED_PERIOD, wave_number=2.0 * np.pi)
"""The published gait; its wave length is the body length"""
CRAWL_PERIOD = 1.0
"""Period of the scripted crawl [s]: these muscles work better at twice the published frequency"""
PHASES = 64
TURNING = 1.5e-3
"""Maximum turning couple of the scripted crawl [N m]"""


def seed_gait(env: BatchEnv) -> Array:
    """Return the actions of the snake's published gait, which always goes straight, (B, 42)."""
    return _crawl(env, SEED_PERIOD, np.zeros(env.num_envs))


def snake_crawl(env: BatchEnv, angle: Array) -> Array:
    """Return the actions of a crawl that turns: the published gait, faster, plus a constant bend, (B, 42).

    Parameters
    ----------
    env : BatchEnv
        Of snakes.
    angle : Array
        Desired direction, relative to the heading, positive to the right [rad], (B,).
    """
    return _crawl(env, CRAWL_PERIOD, np.clip(angle, -1.0, 1.0))


def _crawl(env: BatchEnv, period: float, turning: Array) -> Array:
    wave, turn = _seed_tables(env.body)
    return play_wave(env, wave[None], np.full(env.num_envs, period), turning[:, None] * TURNING * turn)


def play_wave(env: BatchEnv, tables: Array, period: Array, turn: Array | float = 0.0) -> Array:
    """Return the actions of waves at the time of each environment, (B, 42).

    Parameters
    ----------
    env : BatchEnv
        Of snakes.
    tables : Array
        Activations over the period of each wave, (W, PHASES, 42). Each wave has B/W environments, in order.
    period : Array
        [s], (B,)
    turn : Array or float
        Activations to add, (B, 42).
    """
    which = np.arange(env.num_envs) * len(tables) // env.num_envs
    phase = np.round(env.elapsed * env.control_dt / period * PHASES).astype(np.int64) % PHASES
    return np.clip(tables[which, phase] + turn, -1.0, 1.0)


@functools.lru_cache(maxsize=4)
def _seed_tables(body: Body) -> tuple[Array, Array]:
    return wave_activations(body, SEED_WAVE), turn_activations(body)


def wave_activations(body: Body, wave: Wave) -> Array:
    """Return the activations that produce a wave over its period, (PHASES, 42)."""
    phases = 2.0 * np.pi * np.arange(PHASES) / PHASES
    return activations_for(wave_couples(body.rods[0], phases, wave), couple_matrix(body.muscles, body.rods[0]))


def turn_activations(body: Body) -> Array:
    """Return the activations of a constant bend to the right, linearly scaled to 1 N m, (42,)."""
    matrix = couple_matrix(body.muscles, body.rods[0])
    return activations_for(np.full((1, matrix.shape[2]), TURNING), matrix)[0] / TURNING


def wave_couples(rod: Rod, phases: Array, wave: Wave = SEED_WAVE) -> Array:
    """Return the couples of a wave at m phases of its period [N m], (m, n - 1)."""
    sine, cosine = wave.profiles(rod.rest_length)
    # minus: the couple on the element behind, and its reverse on the one before, is minus the internal moment
    return -(np.sin(phases)[:, None] * sine + np.cos(phases)[:, None] * cosine)


OCTOPUS_STROKES = {
    "left": (
        0.8,
        (
            (-0.11, -1.71, -1.45, -0.72, 0.52, 0.02),
            (0.42, -0.18, -0.25, 0.68, 0.42, -0.86),
            (0.12, -0.33, 1.21, -1.68, 0.33, -0.47),
        ),
    ),
    "right": (
        0.37,
        (
            (1.02, 1.57, 0.53, -0.74, -1.52, 0.51),
            (1.4, -0.19, -0.7, 0.29, -0.95, 0.08),
            (-0.71, 0.46, -0.43, 1.71, -1.63, 1.62),
        ),
    ),
}
"""The scripted crawls of the octopus: period [s], and offset, sine and cosine of six activations, equal in both arms:
the first three functions about the normal and about the binormal. Each is the final mean of CMA-ES, 240 trials, on the
distance covered in 6 s without toppling; to the left with periods of at least 0.8 s"""
OCTOPUS_FUNCTIONS = np.concatenate([OCTOPUS.columns(direction, "first")[:3] for direction in ("normal", "binormal")])
"""The first arm's activations used by a stroke"""


def octopus_crawl(env: BatchEnv, angle: Array) -> Array:
    """Return the actions of a crawl to the left or to the right, whichever is closer to the desired direction, (B, 42).

    Both arms stroke alike, so these are the only two directions: towards the arms and away from them.

    Parameters
    ----------
    env : BatchEnv
        Of octopuses.
    angle : Array
        Desired direction, relative to the head's axis, positive to the right [rad], (B,).
    """
    strokes = {name: _stroke(env, *gait) for name, gait in OCTOPUS_STROKES.items()}
    return np.where((angle > 0.0)[:, None], strokes["right"], strokes["left"])


def _stroke(env: BatchEnv, period: float, table: tuple[tuple[float, ...], ...]) -> Array:
    return play_stroke(env, np.full(env.num_envs, period), [np.array(table)] * len(env.body.muscles.arms))


def play_stroke(env: BatchEnv, period: Array, tables: Sequence[Array]) -> Array:
    """Return the actions of a stroke of the arms at the time of each environment, (B, 42).

    Parameters
    ----------
    env : BatchEnv
        Of octopuses.
    period : Array
        [s], (B,)
    tables : sequence of Array
        Offset, sine and cosine of the activations ``OCTOPUS_FUNCTIONS`` of each arm, (3, 6), or (B, 3, 6) if
        environments differ.
    """
    # the first control step begins at phase zero
    phase = (2.0 * np.pi * env.elapsed * env.control_dt / period)[:, None]
    actions = np.zeros((env.num_envs, env.body.n_activations))
    for arm, table in enumerate(tables):
        offset, sine, cosine = np.moveaxis(table, -2, 0)
        level = np.clip(offset + sine * np.sin(phase) + cosine * np.cos(phase), -1.0, 1.0)
        actions[:, OCTOPUS_FUNCTIONS + arm * N_FUNCTIONS] = level
    return actions


SWING = 0.7
"""Activation with which the scripted reach bends an arm towards an object ahead or behind"""


def octopus_reach(env: BatchEnv, angle: Array) -> Array:
    """Return the actions that crawl to an object at the side, or bend an arm to one ahead or behind, (B, 42)."""
    actions = octopus_crawl(env, angle)
    for rows, arm in ((np.abs(angle) < 0.25 * np.pi, 1), (np.abs(angle) > 0.75 * np.pi, 0)):
        bend = np.zeros(env.body.n_activations)
        bend[arm * N_FUNCTIONS] = SWING
        actions[rows] = np.sign(angle[rows])[:, None] * bend
    return actions
