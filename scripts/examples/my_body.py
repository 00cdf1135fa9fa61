"""A body of one's own: a worm half as long as the snake, on ice, that crawls like it.

``elastica-gym train --env my_body:my_lab/WormForward-v0`` finds it in the current folder.
"""

import dataclasses
import functools

import numpy as np

import elastica_gym
from elastica_gym.bodies import Body, Sensors, couples_of
from elastica_gym.bodies.muscles import SNAKE
from elastica_gym.engine import Rod, build_model, stable_time_step
from elastica_gym.engine.surroundings import Plane
from elastica_gym.envs import task_of

LENGTH, RADIUS, N_ELEMENTS, GRAVITY = 0.18, 0.002, 40, 9.80665


@functools.cache
def worm() -> Body:
    """Return the worm, straight along +x on the plane y = 0."""
    rod = Rod.straight(
        N_ELEMENTS,
        start=(-0.5 * LENGTH, RADIUS, 0.0),
        direction=(1.0, 0.0, 0.0),
        normal=(0.0, 1.0, 0.0),
        length=LENGTH,
        radius=RADIUS,
        density=1000.0,
        youngs_modulus=1e6,
        shear_modulus=4e5,
        torque_viscosity=1e-4,
    )
    ice = Plane(stiffness=2e3, damping=0.05, kinetic_friction=(0.02, 0.03, 0.1), slip_tolerance=1e-8)
    # the snake's muscles, weaker by the section's bending stiffness
    weaker = (RADIUS / (0.011 * 0.35)) ** 4
    magnitudes = {name: tuple(weaker * size for size in sizes) for name, sizes in SNAKE.magnitudes.items()}
    muscles = dataclasses.replace(SNAKE, magnitudes=magnitudes)
    model = build_model(
        [rod], planes=[ice], gravity=(0.0, -GRAVITY, 0.0), activation_time=muscles.activation_time, is_balanced=True
    )
    start = int(model.first_slot[0])

    def places(first: int, last: int, count: int) -> np.ndarray:
        return start + np.round(np.linspace(first, last, count)).astype(np.int64)

    half = N_ELEMENTS // 2
    return Body(
        name="worm",
        rods=(rod,),
        model=model,
        muscles=muscles,
        couples=couples_of(muscles, [rod], model),
        sensors=Sensors(
            nodes=places(0, N_ELEMENTS, 9),
            joints=places(2, N_ELEMENTS - 4, 10),
            skin=places(0, N_ELEMENTS, 9),
            front=np.array([start + half, start + N_ELEMENTS]),
            rear=np.array([start, start + half]),
            head=start + N_ELEMENTS,
            crown=start + N_ELEMENTS - 1,
            length=LENGTH,
            curvature_scale=20.0,
            weight=float(rod.nodal_mass.sum() * GRAVITY),
            fastest=10.0,
        ),
        frame="forward is the horizontal direction from the middle of the rear half to that of the front half",
        order="tail to head",
        sim_dt=0.5 * stable_time_step(rod),
    )


FORWARD = task_of("elastica_gym/SnakeForward-v1")
TASK = dataclasses.replace(
    FORWARD, name="WormForward", description="WormForward: crawl as far as you can in 10 s.", make_body=worm
)
elastica_gym.register("my_lab/WormForward-v0", TASK)
