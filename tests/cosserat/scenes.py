"""Rods and surroundings that the tests and the benchmark share."""

import numpy as np

from elastica_gym.cosserat import Rod, State, Wave
from elastica_gym.cosserat.model import Array, Model
from elastica_gym.cosserat.surroundings import Plane

LENGTH = 0.35
RADIUS = 0.011 * LENGTH
GRAVITY = (0.0, -9.80665, 0.0)
FRICTION = LENGTH / (2.0**2 * 9.80665 * 0.1)
TIME_STEP = 1e-5
"""For 50 elements [s]"""

WAVE = Wave(
    coefficients=(3.4e-3, 3.3e-3, 4.2e-3, 2.6e-3, 3.6e-3, 3.5e-3), period=2.0, wave_number=2.0 * np.pi, ramp_time=2.0
)


def snake(n: int = 50, **material: float) -> Rod:
    """Return the continuum snake, along +z with its lowest line at y = 0."""
    return Rod.straight(
        n, start=(0.0, RADIUS, 0.0), direction=(0.0, 0.0, 1.0), normal=(0.0, 1.0, 0.0), length=LENGTH, radius=RADIUS,
        density=1000.0, youngs_modulus=1e6, shear_modulus=1e6 / 1.5, **material,
    )  # fmt: skip


def ground(static: float = 2.0, **options: float) -> Plane:
    """Return the snake's plane, with static friction ``static`` times the kinetic."""
    kinetic = (FRICTION, 1.5 * FRICTION, 2.0 * FRICTION)
    return Plane(
        kinetic_friction=kinetic, static_friction=tuple(static * mu for mu in kinetic), stiffness=1.0, damping=1e-6,
        **options,
    )  # fmt: skip


def kinked(n: int = 40, **material: object) -> Rod:
    """Return a rod that tapers to a third, with a kink of 0.6 rad in its middle at which it is at rest."""
    half = n // 2
    turned = np.array([0.0, np.sin(0.6), np.cos(0.6)])
    steps = np.where(np.arange(n) < half, np.array([0.0, 0.0, 1.0])[:, None], turned[:, None]) * 0.01
    nodes = np.concatenate([np.zeros((3, 1)), np.cumsum(steps, axis=1)], axis=1)
    rest_kappa = np.zeros((3, n - 1))
    rest_kappa[0, half - 1] = -0.6 / 0.01
    radius = np.linspace(0.012, 0.004, n)
    given = dict(rest_kappa=rest_kappa, density=900.0, youngs_modulus=5e5, shear_modulus=2e5)
    return Rod.through(nodes, normal=(1.0, 0.0, 0.0), radius=radius, **{**given, **material})


def motion(model: Model, state: State, env: int = 0, rod: int = 0) -> tuple[Array, Array, Array, Array]:
    """Return views of a rod's positions, velocities, directors and angular velocities."""
    start, n = int(model.first_slot[rod]), int(model.n_elements[rod])
    nodes, elements = slice(start, start + n + 1), slice(start, start + n)
    return state.x[env][:, nodes], state.v[env][:, nodes], state.Q[env][:, :, elements], state.w[env][:, elements]


def disturb(rod: Rod, model: Model, state: State, rng: np.random.Generator, speed: float = 1.0) -> None:
    """Shake a rod in place: nodes by 3 % of an element, directors by 0.05 rad, velocities by 0.1 m/s and 5 rad/s."""
    x, v, Q, w = motion(model, state)
    n = rod.n_elements
    x[:] = rod.position + 0.03 * rod.rest_length.mean() * rng.standard_normal((3, n + 1))
    v[:] = speed * 0.1 * rng.standard_normal((3, n + 1))
    w[:] = speed * 5.0 * rng.standard_normal((3, n))
    Q[:] = np.einsum("kij,jlk->ilk", rotations(0.05 * rng.standard_normal((n, 3))), rod.directors)


def rotations(vectors: Array) -> Array:
    """Return the matrices of rotation vectors [rad], (n, 3) to (n, 3, 3)."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(vectors).as_matrix()
