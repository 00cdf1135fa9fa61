"""The octopus with two soft arms of the 2020 Cosserat-rod hackathon, and the object it handles.

One rod of 1 m, 121 nodes: the first arm up to node 49, the head from 50 to 70, the second arm from
71. y is up. At rest the head's axis is along +z, both arms are kinked 30 degrees from it, and their
tips point towards +x. The arms are as thick as a wrist; the head is a ball of 0.25 m in diameter
that rests on the ground, and the arms descend to the ground from the height of its middle.

Friction with the ground is isotropic, so no direction is easier to slide in, and the head is most of
the weight: to move a part of its body, the animal has to take weight off it.
"""

import functools
from dataclasses import replace

import numpy as np

from ..engine import Rod, build_model
from ..engine.model import Array
from ..engine.surroundings import Contact, Cylinder, Plane
from .body import Body, Sensors, couples_of
from .mirror import Mirror
from .muscles import OCTOPUS

N_ELEMENTS = 120
HEAD = (50, 70)
"""First and last node of the head"""
MIDDLE = 60
"""The node at the head's centre"""
LENGTH = 1.0
TIP_RADIUS, BASE_RADIUS, HEAD_RADIUS = 0.025, 0.03, 0.125
KINK = np.pi / 6.0
"""Angle between each arm and the head's axis, seen from above [rad]"""
KINK_ELEMENTS = 8
"""Number of elements over which the rod turns by this angle"""
DESCENT = 0.25
"""Length along the rod over which it descends from the head's middle to the ground [m]"""
BEYOND_DESCENT = 95
"""An element of the second arm that lies on the ground"""
DENSITY = 1000.0
YOUNGS_MODULUS = 1e6
SHEAR_MODULUS = YOUNGS_MODULUS / 1.5
GRAVITY = 9.80665
KINETIC_FRICTION = 1.02
STATIC_FRICTION = 2.04
DAMPING_RATE = 2.0
"""Uniform damping [1/s]"""
TORQUE_VISCOSITY = 0.2
"""Torque per angular velocity and length [kg m/s]: a damping rate of 310 to 650 1/s along the arms, half of
that for twist, and 1 1/s at the head's middle"""
SIM_DT = 1.25e-4
"""Time step [s]: at 160 microseconds, 3 of 16 diverge within 3 s at full activation with signs changing every 0.4 s;
at 125, none does"""

OBJECT_LENGTH, OBJECT_RADIUS, OBJECT_MASS = 0.6, 0.05, 4.0
OBJECT_FRICTION = 0.4
SKIN = Contact(stiffness=6e4, damping=20.0, friction=OBJECT_FRICTION, slip_damping=25.0)
"""Contact of arms and head with the object, each other and themselves"""


def radii() -> Array:
    """Return the radius of each element at rest [m], (120,)."""
    s = np.arange(N_ELEMENTS) + 0.5
    arm = BASE_RADIUS + (TIP_RADIUS - BASE_RADIUS) * np.maximum(HEAD[0] - s, s - HEAD[1]) / HEAD[0]
    bulge = np.cos(np.pi * (s - MIDDLE) / (HEAD[1] - HEAD[0])) ** 2
    return np.where((s > HEAD[0]) & (s < HEAD[1]), BASE_RADIUS + (HEAD_RADIUS - BASE_RADIUS) * bulge, arm)


def nodes() -> Array:
    """Return the nodes at rest [m], (3, 121), the head's middle above the origin."""
    from_middle = (np.arange(N_ELEMENTS) + 0.5 - MIDDLE) * LENGTH / N_ELEMENTS
    outwards, side = np.abs(from_middle), np.sign(from_middle)
    # seen from above, the angle from the head's axis to the arms' direction
    base, turn = (HEAD[1] - MIDDLE) * LENGTH / N_ELEMENTS, KINK_ELEMENTS * LENGTH / N_ELEMENTS
    yaw = KINK * np.clip((outwards - base) / turn + 0.5, 0.0, 1.0)
    bell = np.sin(np.pi * np.minimum(outwards / DESCENT, 1.0)) ** 2

    def path(steepest: float) -> Array:
        pitch = steepest * bell
        tangents = np.stack([side * np.sin(yaw) * np.cos(pitch), -side * np.sin(pitch), np.cos(yaw) * np.cos(pitch)])
        steps = tangents * LENGTH / N_ELEMENTS
        points = np.concatenate([np.zeros((3, 1)), np.cumsum(steps, axis=1)], axis=1)
        return points - points[:, [MIDDLE]] + np.array([[0.0], [HEAD_RADIUS], [0.0]])

    def clearance(steepest: float) -> float:
        centres = 0.5 * (path(steepest)[1, 1:] + path(steepest)[1, :-1])
        return float((centres - radii())[BEYOND_DESCENT])

    # imported here: it takes longer than the rest of `import elastica_gym`
    from scipy.optimize import brentq

    return path(brentq(clearance, 0.1, 1.5))


@functools.cache
def octopus() -> Body:
    """Return the octopus on the plane y = 0, with its object 0.4 m in front of its head.

    Full activation in one bending direction curls a free arm by 427 degrees, and an arm with the object in its bend
    holds it, wrapped by more than 200 degrees (`tests/bodies/test_octopus.py`). Sticking contacts creep at the force
    over ``SKIN``'s slip damping and the number of elements in contact: some centimetres per second for a dragged
    object.
    """
    limp = Rod.through(
        nodes(),
        normal=(0.0, 1.0, 0.0),
        radius=radii(),
        density=DENSITY,
        youngs_modulus=YOUNGS_MODULUS,
        shear_modulus=SHEAR_MODULUS,
        damping_rate=DAMPING_RATE,
        torque_viscosity=TORQUE_VISCOSITY,
    )
    rod = replace(limp, rest_kappa=limp.curvature)
    ground = Plane(
        stiffness=1e5,
        damping=50.0,
        kinetic_friction=(KINETIC_FRICTION,) * 3,
        static_friction=(STATIC_FRICTION,) * 3,
        slip_tolerance=1e-3,
    )
    thing = Cylinder(
        start=(0.0, 0.0, 0.4),
        direction=(0.0, 1.0, 0.0),
        normal=(1.0, 0.0, 0.0),
        length=OBJECT_LENGTH,
        radius=OBJECT_RADIUS,
        mass=OBJECT_MASS,
        rods=SKIN,
        ground_stiffness=2e4,
        ground_damping=100.0,
        ground_friction=OBJECT_FRICTION,
    )
    model = build_model(
        [rod],
        planes=[ground],
        cylinders=[thing],
        rod_contact=SKIN,
        gravity=(0.0, -GRAVITY, 0.0),
        activation_time=OCTOPUS.activation_time,
        is_balanced=True,
        is_reciprocal=True,
    )
    start = int(model.first_slot[0])
    return Body(
        name="octopus",
        rods=(rod,),
        cylinders=(thing,),
        model=model,
        muscles=OCTOPUS,
        mirror=Mirror(across="forward", arms=("first", "second")),
        frame="forward is the horizontal direction of the head's axis, from the first arm to the second; at rest the "
        "arms point half to the left",
        order="tip to tip",
        couples=couples_of(OCTOPUS, [rod], model),
        sim_dt=SIM_DT,
        settling=1.0,
        sensors=_sensors(start, float(rod.nodal_mass.sum() * GRAVITY)),
    )


def _sensors(start: int, weight: float) -> Sensors:
    arm_nodes, arm_joints = np.array([0, 10, 20, 30, 40]), np.array([4, 11, 18, 25, 32, 39])
    skin = np.array([0, 7, 14, 21, 28, 50])
    last = N_ELEMENTS
    return Sensors(
        nodes=start + np.concatenate([arm_nodes, [MIDDLE], last - arm_nodes[::-1]]),
        joints=start + np.concatenate([arm_joints, last - 2 - arm_joints[::-1]]),
        skin=start + np.concatenate([skin, last - skin[::-1]]),
        front=np.array([start + MIDDLE + 1, start + HEAD[1]]),
        rear=np.array([start + HEAD[0], start + MIDDLE - 1]),
        head=start + MIDDLE,
        crown=start + MIDDLE,
        length=LENGTH,
        curvature_scale=10.0,
        weight=weight,
        fastest=50.0,
    )
