"""A body defined outside the package: a tentacle clamped at its base, in water, with one arm."""

import functools

import numpy as np

from elastica_gym.bodies import Body, Sensors, couples_of
from elastica_gym.bodies.muscles import DIRECTIONS, Arm, Muscles
from elastica_gym.engine import Rod, build_model, stable_time_step

LENGTH, RADIUS, N_ELEMENTS = 0.4, 0.01, 32
MUSCLES = Muscles(
    magnitudes={"normal": (0.03, 0.02, 0.01), "binormal": (0.03, 0.02, 0.01), "tangent": (0.01, 0.007, 0.004)},
    widths=dict.fromkeys(DIRECTIONS, (0.40, 0.25, 0.15)),
    arms={"whole": Arm(0.0, 1.0)},
    activation_time=0.06,
)


@functools.cache
def tentacle() -> Body:
    """Return the tentacle, straight along +x from its base at a height of 0.5 m, neutrally buoyant in water."""
    rod = Rod.straight(
        N_ELEMENTS,
        start=(0.0, 0.5, 0.0),
        direction=(1.0, 0.0, 0.0),
        normal=(0.0, 1.0, 0.0),
        length=LENGTH,
        radius=RADIUS,
        density=1000.0,
        youngs_modulus=1e6,
        shear_modulus=4e5,
        damping_rate=5.0,
        torque_viscosity=1e-3,
    )
    model = build_model([rod], clamped=[0], activation_time=MUSCLES.activation_time, is_balanced=True)
    first = int(model.first_slot[0])
    return Body(
        name="tentacle",
        rods=(rod,),
        model=model,
        muscles=MUSCLES,
        couples=couples_of(MUSCLES, [rod], model),
        sensors=Sensors(
            nodes=first + np.array([8, 16, 24, 32]),
            joints=first + np.array([4, 10, 16, 22, 28]),
            skin=first + np.array([0, 16, 32]),
            front=first + np.array([17, 32]),
            rear=first + np.array([0, 15]),
            head=first + N_ELEMENTS,
            crown=first + 1,
            length=LENGTH,
            curvature_scale=10.0,
            weight=float(rod.nodal_mass.sum() * 9.81),
            fastest=20.0,
        ),
        frame="forward is the horizontal direction from the half at the base to that at the tip",
        order="base to tip",
        sim_dt=0.5 * stable_time_step(rod),
    )
