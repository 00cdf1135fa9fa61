"""The continuum snake (Zhang et al. 2021; Gazzola et al. 2018, section 5.2) on anisotropic ground.

A rod of 0.35 m, of 1,000 kg/m^3 and 1 MPa, lies on a plane whose Coulomb friction is 1 : 1.5 : 2
forward, backward and sideways, in gravity. Its head is the last node: forward is along the tangent.

Damping is the original's: 0.0001 kg/(m s) against velocity, which is negligible, and 0.0001 kg m/s
against angular velocity, which is 580 1/s for a thin rod. The second keeps strong random actions
from shaking the body until the simulation diverges; a uniform damping of all velocities would have
to be so strong (10 1/s) that it halves the speed of every gait.
"""

import functools

import numpy as np

from ..engine import Rod, build_model, stable_time_step
from ..engine.surroundings import Contact, Plane
from .body import Body, Sensors, couples_of
from .mirror import Mirror
from .muscles import SNAKE

LENGTH = 0.35
RADIUS = 0.011 * LENGTH
DENSITY = 1000.0
YOUNGS_MODULUS = 1e6
SHEAR_MODULUS = YOUNGS_MODULUS / 1.5
GRAVITY = 9.80665
FROUDE = 0.1
PERIOD = 2.0
FRICTION = LENGTH / (PERIOD**2 * GRAVITY * FROUDE)
"""Coefficient of friction forward; backward it is 1.5 times, sideways 2 times as large"""
VISCOSITY = 1e-4
"""Damping force per velocity and length [kg/(m s)], and torque per angular velocity and length [kg m/s]"""
GROUND_STIFFNESS, GROUND_DAMPING = 1e4, 0.5
"""Per element on the ground [N/m, N s/m]: impact at full strength penetrates by a sixteenth of the radius. The
published planar case has 1 N/m and 1e-6 N s/m; a snake that lifts sinks through that, and the ground's reaction, which
cancels forces into the ground even during lift-off, adds 10 % to the muscles' work (4 % at 100 N/m and 0.01 N s/m,
none here; `scripts/audit_energy.py`)."""
SKIN = Contact(stiffness=2e3, damping=0.1, friction=FRICTION, slip_damping=0.1)
"""Self-contact. Without it, a learned gait passed through itself in 5 % of control steps."""
SIM_DT = 1.1e-4
"""Largest time step, to 10 microseconds, at which fewer than 1 of 10,000 control steps diverge under random actions
[s]: none of 100,000 does. At 113 microseconds none of 15,000 did, at 116 all; the undeformed rod is stable below 117.
Count with scripts/count_divergence.py."""


@functools.cache
def snake(n_elements: int = 50) -> Body:
    """Return the snake, straight along +x on the plane y = 0.

    Parameters
    ----------
    n_elements : int
        At least 16, so that every part of the body has a sensor.

    Raises
    ------
    ValueError
        If there are fewer elements.
    """
    if n_elements < 16:
        raise ValueError(f"n_elements must be at least 16, not {n_elements}")
    rod = Rod.straight(
        n_elements,
        start=(-0.5 * LENGTH, RADIUS, 0.0),
        direction=(1.0, 0.0, 0.0),
        normal=(0.0, 1.0, 0.0),
        length=LENGTH,
        radius=RADIUS,
        density=DENSITY,
        youngs_modulus=YOUNGS_MODULUS,
        shear_modulus=SHEAR_MODULUS,
        viscosity=VISCOSITY,
        torque_viscosity=VISCOSITY,
    )
    friction = (FRICTION, 1.5 * FRICTION, 2.0 * FRICTION)
    # friction is kinetic: the original's static coefficients are zero
    ground = Plane(stiffness=GROUND_STIFFNESS, damping=GROUND_DAMPING, kinetic_friction=friction, slip_tolerance=1e-8)
    model = build_model(
        [rod],
        planes=[ground],
        rod_contact=SKIN,
        gravity=(0.0, -GRAVITY, 0.0),
        activation_time=SNAKE.activation_time,
        is_balanced=True,
    )
    start = int(model.first_slot[0])
    return Body(
        name="snake",
        rods=(rod,),
        model=model,
        muscles=SNAKE,
        mirror=Mirror(across="right", is_later=True),
        frame="forward is the horizontal direction from the middle of the rear half to that of the front half",
        order="tail to head",
        couples=couples_of(SNAKE, [rod], model),
        sensors=_sensors(start, n_elements, float(rod.nodal_mass.sum() * GRAVITY)),
        sim_dt=min(SIM_DT, 0.94 * stable_time_step(rod)),
    )


def _sensors(start: int, n: int, weight: float) -> Sensors:
    half = n // 2

    def spread(first: int, last: int, count: int) -> np.ndarray:
        return start + np.round(np.linspace(first, last, count)).astype(np.int64)

    return Sensors(
        nodes=spread(0, n, 9),
        joints=spread(2, n - 4, 10),
        skin=spread(0, n, 9),
        front=np.array([start + half, start + n]),
        rear=np.array([start, start + half]),
        head=start + n,
        crown=start + n - 1,
        length=LENGTH,
        curvature_scale=10.0,
        weight=weight,
        fastest=10.0,
    )
