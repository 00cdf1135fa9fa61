"""Rods and surroundings shared by tests and benchmark."""

import numpy as np
from numpy.typing import NDArray

from elastica_gym.bodies.muscles import DIRECTIONS, Arm, Muscles
from elastica_gym.engine import Rod, State, Wave
from elastica_gym.engine.model import Array, Model
from elastica_gym.engine.surroundings import Contact, Cylinder, Plane

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
        n,
        start=(0.0, RADIUS, 0.0),
        direction=(0.0, 0.0, 1.0),
        normal=(0.0, 1.0, 0.0),
        length=LENGTH,
        radius=RADIUS,
        density=1000.0,
        youngs_modulus=1e6,
        shear_modulus=1e6 / 1.5,
        **material,
    )


def ground(static: float = 2.0, **options: float) -> Plane:
    """Return the snake's plane, with static friction ``static`` times the kinetic."""
    kinetic = (FRICTION, 1.5 * FRICTION, 2.0 * FRICTION)
    return Plane(
        kinetic_friction=kinetic,
        static_friction=tuple(static * mu for mu in kinetic),
        stiffness=1.0,
        damping=1e-6,
        **options,
    )


def kinked(n: int = 40, **material: object) -> Rod:
    """Return a rod that tapers to a third, with a kink of 0.6 rad in its middle at rest."""
    half = n // 2
    turned = np.array([0.0, np.sin(0.6), np.cos(0.6)])
    steps = np.where(np.arange(n) < half, np.array([0.0, 0.0, 1.0])[:, None], turned[:, None]) * 0.01
    nodes = np.concatenate([np.zeros((3, 1)), np.cumsum(steps, axis=1)], axis=1)
    rest_kappa = np.zeros((3, n - 1))
    rest_kappa[0, half - 1] = -0.6 / 0.01
    radius = np.linspace(0.012, 0.004, n)
    given = dict(rest_kappa=rest_kappa, density=900.0, youngs_modulus=5e5, shear_modulus=2e5)
    return Rod.through(nodes, normal=(1.0, 0.0, 0.0), radius=radius, **{**given, **material})


def loop(n: int, *, size: float, gap: float, radius: float, **material: float) -> Rod:
    """Return a rod at rest in a loop of a given size, whose ends pass each other with their axes ``gap`` apart."""
    t = np.linspace(-1.4, 1.4, 1001)
    curve = np.array([size * (t**2 - 1.0), 0.5 * gap * t, size * t * (t**2 - 1.0)])
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve), axis=0))])
    nodes = np.array([np.interp(np.linspace(0.0, s[-1], n + 1), s, row) for row in curve])
    return Rod.through(nodes, normal=(0.0, 1.0, 0.0), radius=np.full(n, radius), **material)


ARMS_STEP = 4e-5
"""[s]"""
ARMS_MUSCLES = Muscles(
    magnitudes=dict.fromkeys(DIRECTIONS, (0.3, 0.2, 0.1)),
    widths=dict.fromkeys(DIRECTIONS, (0.40, 0.25, 0.15)),
    arms={"first": Arm(0.4, 0.0), "second": Arm(0.6, 1.0)},
    activation_time=0.0,
)
ARMS_CONTACT = Contact(stiffness=1e4, damping=5.0, friction=0.4, slip_damping=20.0)


def arms(n: int = 120) -> Rod:
    """Return two arms of 0.4 m on the ground, joined by a bend of 0.2 m at an angle of 70 degrees."""
    angle = np.interp((np.arange(n) + 0.5) / n, (0.4, 0.6), (-0.96, 0.96))
    edges = np.array([np.cos(angle), np.zeros(n), np.sin(angle)]) / n
    nodes = np.concatenate([np.zeros((3, 1)), np.cumsum(edges, axis=1)], axis=1)
    directors = np.zeros((3, 3, n))
    directors[0, 1], directors[2] = 1.0, edges * n
    directors[1] = np.cross(directors[2], directors[0], axis=0)
    # rest curvature of the current shape: bending of each joint about d1, which is up
    rest_kappa = np.zeros((3, n - 1))
    rest_kappa[0] = -np.diff(angle) * n
    return Rod(
        position=nodes + np.array([[0.0], [0.03], [0.0]]),
        directors=directors,
        radius=np.full(n, 0.03),
        rest_kappa=rest_kappa,
        density=1000.0,
        youngs_modulus=1e6,
        shear_modulus=1e6 / 1.5,
        damping_rate=5.0,
    )


def held(height: float = 0.0) -> Cylinder:
    """Return an object standing in the bend of the arms in contact, ``height`` above the ground [m]."""
    rod = arms()
    middle, up = rod.n_elements // 2, np.array([0.0, 1.0, 0.0])
    inwards = np.cross(up, rod.directors[2, :, middle])
    x, _, z = rod.position[:, middle] - (0.03 + 0.05 - 5e-4) * inwards
    return Cylinder(
        start=(x, height, z),
        direction=(0.0, 1.0, 0.0),
        normal=(1.0, 0.0, 0.0),
        length=0.6,
        radius=0.05,
        mass=4.0,
        rods=ARMS_CONTACT,
        ground_stiffness=1e4,
        ground_damping=20.0,
        ground_friction=0.4,
    )


def motion(model: Model, state: State, env: int = 0, rod: int = 0) -> tuple[Array, Array, Array, Array]:
    """Return views of a rod's positions, velocities, directors and angular velocities."""
    start, n = int(model.first_slot[rod]), int(model.n_elements[rod])
    nodes, elements = slice(start, start + n + 1), slice(start, start + n)
    return state.x[env][:, nodes], state.v[env][:, nodes], state.Q[env][:, :, elements], state.w[env][:, elements]


def disturb(
    rod: Rod, model: Model, state: State, rng: np.random.Generator, speed: float = 1.0, number: int = 0
) -> None:
    """Shake a rod in place: nodes by 3 % of an element, directors by 0.05 rad, velocities by 0.1 m/s and 5 rad/s."""
    x, v, Q, w = motion(model, state, rod=number)
    n = rod.n_elements
    x[:] = rod.position + 0.03 * rod.rest_length.mean() * rng.standard_normal((3, n + 1))
    v[:] = speed * 0.1 * rng.standard_normal((3, n + 1))
    w[:] = speed * 5.0 * rng.standard_normal((3, n))
    Q[:] = np.einsum("kij,jlk->ilk", rotations(0.05 * rng.standard_normal((n, 3))), rod.directors)


def disturb_body(cylinder: Cylinder, state: State, rng: np.random.Generator, number: int = 0) -> None:
    """Shake a cylinder in place: by 1 mm, 0.05 rad, 0.1 m/s and 0.2 rad/s."""
    state.body_x[0, number] = cylinder.centre + 1e-3 * rng.standard_normal(3)
    state.body_v[0, number] = 0.1 * rng.standard_normal(3)
    state.body_w[0, number] = 0.2 * rng.standard_normal(3)
    state.body_Q[0, number] = rotations(0.05 * rng.standard_normal((1, 3)))[0] @ cylinder.directors


def rotations(vectors: Array) -> Array:
    """Return the matrices of rotation vectors [rad], (n, 3) to (n, 3, 3)."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(vectors).as_matrix()


def without_contact(model: Model) -> Model:
    """Return a model without contact of rods with cylinders or each other."""
    none = type(model.cylinders)(*(column[:0] for column in model.cylinders))
    return model._replace(cylinders=none, rod_contact=model.rod_contact._replace(is_on=False))


def exact_rotation_vectors(Q: Array) -> NDArray[np.longdouble]:
    """Return the logarithms of Q[k+1] Q[k]^T in extended precision, negated, (3, n - 1)."""
    wide = Q.astype(np.longdouble)
    R = np.einsum("ijk,ljk->ilk", wide[..., 1:], wide[..., :-1])
    a = 0.5 * np.stack([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    size = np.sqrt((a * a).sum(axis=0))
    theta = np.arctan2(size, 0.5 * (R[0, 0] + R[1, 1] + R[2, 2] - 1.0))
    return -np.where(size > 0.0, theta / np.where(size > 0.0, size, 1.0), 1.0) * a


def energy(rod: Rod, model: Model, state: State, number: int = 0) -> float:
    """Return kinetic and elastic energy [J]."""
    x, v, Q, w = motion(model, state, rod=number)
    e = np.linalg.norm(np.diff(x, axis=1), axis=0) / rod.rest_length
    sigma = np.einsum("ijk,jk->ik", Q, np.diff(x, axis=1)) / rod.rest_length - np.array([[0.0], [0.0], [1.0]])
    kappa = exact_rotation_vectors(Q).astype(np.float64) / rod.rest_voronoi_length
    return 0.5 * float(
        (rod.nodal_mass * v * v).sum()
        + (rod.inertia * w * w / e).sum()
        + (rod.shear_stiffness * sigma * sigma * rod.rest_length).sum()
        + (rod.bend_stiffness * (kappa - rod.rest_kappa) ** 2 * rod.rest_voronoi_length).sum()
    )


def momenta(rod: Rod, model: Model, state: State) -> tuple[Array, Array]:
    """Return a rod's momentum, and its angular momentum about the origin, (3,) each."""
    x, v, Q, w = motion(model, state)
    m = rod.nodal_mass
    e = np.linalg.norm(np.diff(x, axis=1), axis=0) / rod.rest_length
    spin = np.einsum("jik,jk->ik", Q, rod.inertia * w / e)
    return (m * v).sum(axis=1), (m * np.cross(x, v, axis=0)).sum(axis=1) + spin.sum(axis=1)
