"""Scripted gaits: travelling waves of couple, played through the animal's own muscles."""

import functools
from typing import TYPE_CHECKING

import numpy as np

from ..bodies.body import Body
from ..cosserat import Rod, Wave
from ..cosserat.model import Array
from ..muscles import activations_for, couple_matrix

if TYPE_CHECKING:
    from .batch import BatchEnv

SEED_COEFFICIENTS = (3.4e-3, 3.3e-3, 4.2e-3, 2.6e-3, 3.6e-3, 3.5e-3)
"""Spline coefficients of the snake's published gait [N m]"""
SEED_PERIOD = 2.0
"""Its period [s]; its wave length is the body's"""
CRAWL_PERIOD = 1.0
"""Period of the scripted crawl [s]: twice as fast suits these muscles better"""
PHASES = 64
TURNING = 1.5e-3
"""Couple with which the scripted crawl turns, at most [N m]"""


def seed_gait(env: "BatchEnv") -> Array:
    """Return the actions of the snake's published gait, which goes straight on wherever it should go, (B, 42)."""
    return _crawl(env, SEED_PERIOD, np.zeros(env.num_envs))


def snake_crawl(env: "BatchEnv", angle: Array) -> Array:
    """Return the actions of a crawl that turns: the published gait, faster, on a constant bend, (B, 42).

    Parameters
    ----------
    env : BatchEnv
        Of snakes.
    angle : Array
        Where to go, from the heading and positive to the right [rad], (B,).
    """
    return _crawl(env, CRAWL_PERIOD, np.clip(angle, -1.0, 1.0))


def _crawl(env: "BatchEnv", period: float, turning: Array) -> Array:
    wave, turn = _activation_tables(env.body)
    phase = np.round(env.elapsed * env.control_dt / period * PHASES).astype(np.int64) % PHASES
    return np.clip(wave[phase] + turning[:, None] * turn, -1.0, 1.0)


@functools.lru_cache(maxsize=4)
def _activation_tables(body: Body) -> tuple[Array, Array]:
    """Return the activations of the wave at each phase, (PHASES, 42), and of a bend to the right, (42,)."""
    matrix = couple_matrix(body.muscles, body.rods[0])
    phases = 2.0 * np.pi * np.arange(PHASES) / PHASES
    wave = activations_for(wave_couples(body.rods[0], phases), matrix)
    turn = activations_for(np.full((1, matrix.shape[2]), TURNING), matrix)
    return wave, turn[0]


def wave_couples(rod: Rod, phases: Array) -> Array:
    """Return the couples of the published gait at given phases of its period [N m], (m, n - 1)."""
    published = Wave(coefficients=SEED_COEFFICIENTS, period=SEED_PERIOD, wave_number=2.0 * np.pi)
    sine, cosine = published.profiles(rod.rest_length)
    # minus: a couple on the element behind and its reverse on the one before are minus the moment inside
    return -(np.sin(phases)[:, None] * sine + np.cos(phases)[:, None] * cosine)


def octopus_crawl(env: "BatchEnv", angle: Array) -> Array:
    return np.zeros((env.num_envs, 42))


def octopus_reach(env: "BatchEnv", angle: Array) -> Array:
    return np.zeros((env.num_envs, 42))
