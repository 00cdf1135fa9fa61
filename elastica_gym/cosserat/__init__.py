"""Cosserat rods under PyElastica's names: scripts run on the engine's compiled step once their import is changed.

A simulator class derives from `BaseSystemCollection` and its features; add rods, loads and constraints, call
``finalize`` and integrate it.
"""

from ..engine.rod import stable_time_step
from . import contact_utils as contact_utils
from . import typing as typing
from . import version as version
from ._calculus import (
    difference_kernel,
    difference_kernel_for_block_structure,
    position_average,
    position_difference_kernel,
    quadrature_kernel,
    quadrature_kernel_for_block_structure,
)
from ._linalg import levi_civita_tensor
from .boundary_conditions import (
    ConstraintBase,
    FixedConstraint,
    FreeBC,
    FreeRod,
    GeneralConstraint,
    HelicalBucklingBC,
    OneEndFixedBC,
    OneEndFixedRod,
)
from .callback_functions import CallBackBaseClass, ExportCallBack, MyCallBack, RerunCallBack
from .contact_forces import (
    CylinderPlaneContact,
    NoContact,
    RodCylinderContact,
    RodPlaneContact,
    RodPlaneContactWithAnisotropicFriction,
    RodRodContact,
    RodSelfContact,
    RodSphereContact,
)
from .dissipation import (
    AnalyticalLinearDamper,
    DamperBase,
    ExponentialDamper,
    LaplaceDissipationFilter,
    RayleighDissipation,
)
from .external_forces import (
    EndpointForces,
    EndpointForcesSinusoidal,
    GravityForces,
    MuscleTorques,
    NoForces,
    ReciprocalTension,
    UniformForces,
    UniformTorques,
)
from .interaction import AnisotropicFrictionalPlane, InteractionPlane, SlenderBodyTheory
from .joint import (
    BallJoint,
    ConnectionBase,
    ExternalContact,
    FixedJoint,
    FreeJoint,
    HingeJoint,
    SelfContact,
    SphericalJoint,
)
from .modules import BaseSystemCollection, CallBacks, Connections, Constraints, Contact, Damping, Forcing
from .not_offered import refuse_names
from .restart import load_state, save_state
from .rigidbody import Cylinder, RigidBodyBase, Sphere
from .rod.cosserat_rod import CosseratRod
from .rod.knot_theory import KnotTheory, compute_link, compute_twist, compute_writhe
from .rod.rod_base import RodBase
from .surface import Plane
from .systems.protocol import StaticSystemProtocol, SystemProtocol
from .timestepper import extend_stepper_interface, integrate
from .timestepper.symplectic_steppers import PEFRL, PositionVerlet
from .transformations import inv_skew_symmetrize, rotate
from .utils import isqrt

__all__ = [
    "PEFRL",
    "AnalyticalLinearDamper",
    "AnisotropicFrictionalPlane",
    "BallJoint",
    "BaseSystemCollection",
    "CallBackBaseClass",
    "CallBacks",
    "ConnectionBase",
    "Connections",
    "ConstraintBase",
    "Constraints",
    "Contact",
    "CosseratRod",
    "Cylinder",
    "CylinderPlaneContact",
    "DamperBase",
    "Damping",
    "EndpointForces",
    "EndpointForcesSinusoidal",
    "ExponentialDamper",
    "ExportCallBack",
    "ExternalContact",
    "FixedConstraint",
    "FixedJoint",
    "Forcing",
    "FreeBC",
    "FreeJoint",
    "FreeRod",
    "GeneralConstraint",
    "GravityForces",
    "HelicalBucklingBC",
    "HingeJoint",
    "InteractionPlane",
    "KnotTheory",
    "LaplaceDissipationFilter",
    "MuscleTorques",
    "MyCallBack",
    "NoContact",
    "NoForces",
    "OneEndFixedBC",
    "OneEndFixedRod",
    "Plane",
    "PositionVerlet",
    "RayleighDissipation",
    "ReciprocalTension",
    "RerunCallBack",
    "RigidBodyBase",
    "RodBase",
    "RodCylinderContact",
    "RodPlaneContact",
    "RodPlaneContactWithAnisotropicFriction",
    "RodRodContact",
    "RodSelfContact",
    "RodSphereContact",
    "SelfContact",
    "SlenderBodyTheory",
    "Sphere",
    "SphericalJoint",
    "StaticSystemProtocol",
    "SystemProtocol",
    "UniformForces",
    "UniformTorques",
    "compute_link",
    "compute_twist",
    "compute_writhe",
    "difference_kernel",
    "difference_kernel_for_block_structure",
    "extend_stepper_interface",
    "integrate",
    "inv_skew_symmetrize",
    "isqrt",
    "levi_civita_tensor",
    "load_state",
    "position_average",
    "position_difference_kernel",
    "quadrature_kernel",
    "quadrature_kernel_for_block_structure",
    "rotate",
    "save_state",
    "stable_time_step",
]

__getattr__ = refuse_names(__name__)
