"""Scripted gaits: travelling waves of couple, played through the animal's own muscles."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import BSpline

from ..cosserat.model import Array
from ..muscles import activations_for, couple_matrix
from .task import Situation

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


def wave_couples(env: "BatchEnv", phases: Array) -> Array:
    """Return the couples of the published gait at given phases of its period [N m], (m, n - 1).

    The amplitude is a cubic B-spline along the body, counted from the head (Gazzola et al. 2018, section 5.2).
    """
    b = np.array(SEED_COEFFICIENTS)
    knots = np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, len(b) - 2), np.ones(3)])
    n = env.body.rods[0].n_elements
    from_head = 1.0 - np.arange(1, n) / n
    # minus: a couple on the element before it and its reverse on the one behind is minus the moment inside
    return -BSpline(knots, b, 3)(from_head) * np.sin(phases[:, None] - 2.0 * np.pi * from_head)


def seed_gait(env: "BatchEnv") -> Callable[[], Array]:
    """Return the snake's published gait as a policy: it goes straight on, wherever it should go."""
    return _crawl(env, SEED_PERIOD, lambda situation: np.zeros(env.num_envs))


def snake_crawl(env: "BatchEnv", direction_of_goal: Callable[[Situation], Array]) -> Callable[[], Array]:
    """Return a crawl that turns towards the goal: the published gait, faster, on a constant bend."""
    return _crawl(env, CRAWL_PERIOD, direction_of_goal)


def _crawl(env: "BatchEnv", period: float, direction_of_goal: Callable[[Situation], Array]) -> Callable[[], Array]:
    phases = 2.0 * np.pi * np.arange(PHASES) / PHASES
    matrix = couple_matrix(env.body.muscles, env.body.rods[0])
    table = activations_for(wave_couples(env, phases), matrix)
    turn = activations_for(np.full((1, matrix.shape[2]), TURNING), matrix)

    def act() -> Array:
        angle = np.clip(direction_of_goal(env.situation()), -1.0, 1.0)
        phase = np.round(env.elapsed * env.control_dt / period * PHASES).astype(np.int64) % PHASES
        return np.clip(table[phase] + angle[:, None] * turn, -1.0, 1.0)

    return act
