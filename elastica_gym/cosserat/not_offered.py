"""Names of PyElastica that this library lacks: they can be imported, and raise an error naming a replacement when used.

Most are PyElastica internals, which are compiled differently here. A module with some of them sets
``__getattr__ = refuse_names(__name__)``; a module with no other names is found by `_Finder`.
"""

import sys
from collections.abc import Callable
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, NoReturn

LIBRARY = str(__package__)

CONTACT = "contact is part of the compiled step: simulator.detect_contact_between(one, two).using(RodRodContact, ...)"
DECLARED = "a simulator's methods return an object with the method using(cls, ...)"
MEMORY = "a simulator has its own memory for systems, without blocks; rods and bodies have the same attributes"
STAGES = "CosseratRod.update_accelerations and the attributes of rods do not need it"
STEPPERS = "use PositionVerlet or PEFRL, and their method step(simulator, time, dt)"
EXPLICIT = "there is no explicit stepper: use PositionVerlet or PEFRL"
CHECKS = "constructors check their arguments themselves"
MAKE = "CosseratRod.straight_rod and CosseratRod.ring_rod make rods"
SKEW = "_skew_symmetrize and _inv_skew_symmetrize make and read skew matrices"
FILTER = "LaplaceDissipationFilter filters velocities"
PLANE = "InteractionPlane and AnisotropicFrictionalPlane compute the response inside the compiled step"
BODY_PLANE = "CylinderPlaneContact is contact of a cylinder with a plane, with a friction_coefficient"
KNOTS = "compute_twist, compute_writhe and compute_link take the same arguments"
RINGS = "rings are closed inside the compiled step; declare your own constraints by simulator.constrain(ring)"
CONSTRAINT = "use constrain_values(system, time) and constrain_rates(system, time)"
EXAMPLES = "these systems are tests of PyElastica's own"

TABLE = {
    "": dict.fromkeys(("MemoryBlockCosseratRod", "MemoryBlockRigidBody"), MEMORY),
    "_calculus": {"_get_zero_array": "numpy.zeros makes arrays"},
    "_contact_functions": dict.fromkeys(
        (
            "_calculate_contact_forces_cylinder_plane",
            "_calculate_contact_forces_rod_cylinder",
            "_calculate_contact_forces_rod_plane",
            "_calculate_contact_forces_rod_plane_with_anisotropic_friction",
            "_calculate_contact_forces_rod_rod",
            "_calculate_contact_forces_rod_sphere",
            "_calculate_contact_forces_self_rod",
        ),
        CONTACT,
    ),
    "_elastica_numpy": {"_elastica_numpy": "there is one implementation, compiled by Numba"},
    "_rotations": dict.fromkeys(
        (
            "_generate_skew_map",
            "_generate_skew_map_sentinel",
            "_get_diag_map",
            "_get_inv_skew_map",
            "_get_skew_map",
            "_get_skew_symmetric_pair",
            "_skew_symmetrize_sq",
        ),
        SKEW,
    ),
    "_synchronize_periodic_boundary": dict.fromkeys(
        (
            "_ConstrainPeriodicBoundaries",
            "_synchronize_periodic_boundary_of_matrix_collection",
            "_synchronize_periodic_boundary_of_scalar_collection",
            "_synchronize_periodic_boundary_of_vector_collection",
        ),
        RINGS,
    ),
    "collision": {},
    "collision.AABBCollection": dict.fromkeys(
        ("AABBCollection", "AABBHierarchy", "are_aabb_intersecting", "find_nearest_integer_square_root"), CONTACT
    ),
    "dissipation": dict.fromkeys(
        (
            "DampenType",
            "_filter_function_periodic_condition",
            "_filter_function_periodic_condition_ring_rod",
            "nb_filter_rate",
        ),
        FILTER,
    ),
    "experimental.interaction": dict.fromkeys(
        ("AnisotropicFrictionalPlaneRigidBody", "anisotropic_friction_numba_rigid_body"), BODY_PLANE
    ),
    "experimental.timestepper": {},
    "experimental.timestepper.explicit_steppers": dict.fromkeys(
        ("EulerForward", "EulerForwardMemory", "ExplicitStepperMixin", "RungeKutta4", "RungeKutta4Memory"), EXPLICIT
    ),
    "experimental.timestepper.memory": dict.fromkeys(
        ("MemoryCollection", "make_memory_for_explicit_stepper"), EXPLICIT
    ),
    "experimental.timestepper.protocol": dict.fromkeys(
        ("ExplicitStepperProtocol", "ExplicitSystemProtocol", "MemoryProtocol"), EXPLICIT
    ),
    "interaction": {
        **dict.fromkeys(("anisotropic_friction", "apply_normal_force_numba"), PLANE),
        "apply_normal_force_numba_rigid_body": BODY_PLANE,
    },
    "joint": dict.fromkeys(
        (
            "_calculate_contact_forces_rod_rigid_body",
            "_calculate_contact_forces_rod_rod",
            "_calculate_contact_forces_self_rod",
        ),
        CONTACT,
    ),
    "memory_block": dict.fromkeys(("MemoryBlockCosseratRod", "MemoryBlockRigidBody"), MEMORY),
    "memory_block.memory_block_rigid_body": {"MemoryBlockRigidBody": MEMORY},
    "memory_block.memory_block_rod": dict.fromkeys(("MemoryBlockCosseratRod", "make_block_memory_metadata"), MEMORY),
    "memory_block.memory_block_rod_base": dict.fromkeys(
        ("MemoryBlockRodBase", "make_block_memory_metadata", "make_block_memory_periodic_boundary_metadata"), MEMORY
    ),
    "memory_block.protocol": dict.fromkeys(
        ("BlockProtocol", "BlockRigidBodyProtocol", "BlockRodProtocol", "BlockSystemProtocol"), MEMORY
    ),
    "memory_block.utils": dict.fromkeys(
        ("make_block_memory_metadata", "make_block_memory_periodic_boundary_metadata"), MEMORY
    ),
    "modules.callbacks": dict.fromkeys(("_CallBack", "SystemDSType", "SystemIdxDSType"), DECLARED),
    "modules.connections": {"_Connect": DECLARED},
    "modules.constraints": {"_Constraint": DECLARED},
    "modules.contact": {"_Contact": DECLARED},
    "modules.damping": {"_Damper": DECLARED},
    "modules.forcing": {"_ExtForceTorque": DECLARED},
    "modules.memory_block": {"construct_memory_block_structures": MEMORY},
    "modules.operator_group": {"OperatorGroupFIFO": DECLARED},
    "reset_functions_for_block_structure": {"_reset_scalar_ghost": MEMORY, "_reset_vector_ghost": MEMORY},
    "reset_functions_for_block_structure._reset_ghost_vector_or_scalar": dict.fromkeys(
        ("_reset_scalar_ghost", "_reset_vector_ghost"), MEMORY
    ),
    "rigidbody.cylinder": dict.fromkeys(("_assert_check_array_size", "_assert_check_lower_bound"), CHECKS),
    "rigidbody.data_structures": dict.fromkeys(
        ("_RigidRodSymplecticStepperMixin", "_DynamicState", "_KinematicState", "_bootstrap_from_data"), MEMORY
    ),
    "rod.data_structures": dict.fromkeys(
        (
            "_RodSymplecticStepperMixin",
            "_DerivativeState",
            "_DynamicState",
            "_KinematicState",
            "_State",
            "_bootstrap_from_data",
            "overload_operator_dynamic_numba",
            "overload_operator_kinematic_numba",
        ),
        MEMORY,
    ),
    "rod.cosserat_rod": {"_compute_sigma_kappa_for_blockstructure": STAGES},
    "rod.factory_function": {
        "allocate": MAKE,
        "get_shear_modulus": MAKE,
        **dict.fromkeys(
            (
                "_assert_dim",
                "_assert_shape",
                "_directors_validity_checker",
                "_position_validity_checker",
                "_position_validity_checker_ring_rod",
            ),
            CHECKS,
        ),
    },
    "rod.knot_theory": dict.fromkeys(
        (
            "_compute_additional_segment",
            "_compute_auxiliary_line",
            "_compute_auxiliary_line_added_segments",
            "_compute_link",
            "_compute_twist",
            "_compute_writhe",
        ),
        KNOTS,
    ),
    "rod.protocol": {"_CosseratRodEnergy": "rod.energy.RodEnergy has a rod's energies"},
    "systems": dict.fromkeys(("MemoryCollection", "make_memory_for_explicit_stepper"), EXPLICIT),
    "systems.analytical": dict.fromkeys(
        (
            "BaseStatefulSystem",
            "BaseSymplecticSystem",
            "BaseUndampedSimpleHarmonicOscillatorSystem",
            "CollectiveSystem",
            "DampedSimpleHarmonicOscillatorSystem",
            "ScalarExponentialDampedHarmonicOscillatorCollectiveSystem",
            "ScalarExponentialDecaySystem",
            "SimpleSystemWithPositionsDirectors",
            "SymplecticUndampedHarmonicOscillatorCollectiveSystem",
            "SymplecticUndampedSimpleHarmonicOscillatorSystem",
            "TestDynamicState",
            "TestKinematicState",
            "make_simple_system_with_positions_directors",
        ),
        EXAMPLES,
    ),
    "timestepper._stepper_interface": {"_TimeStepper": STEPPERS},
    "timestepper.explicit_steppers": dict.fromkeys(
        (
            "EulerForward",
            "ExplicitStepperMethods",
            "ExplicitStepperTag",
            "RungeKutta4",
            "_SystemCollectionStepper",
            "_SystemInstanceStepper",
        ),
        EXPLICIT,
    ),
    "timestepper.symplectic_steppers": dict.fromkeys(
        (
            "SymplecticStepperMethods",
            "SymplecticStepperMixin",
            "SymplecticStepperTag",
            "_SystemCollectionStepper",
            "_SystemInstanceStepper",
        ),
        STEPPERS,
    ),
    "typing": {
        **dict.fromkeys(("BlockSystemProtocol", "BlockSystemType"), MEMORY),
        **dict.fromkeys(("State", "StateType"), "motion is in attributes of systems, such as position_collection"),
    },
    "wrappers.callbacks": {"_CallBack": DECLARED},
    "wrappers.connections": {"_Connect": DECLARED},
    "wrappers.constraints": {"_Constraint": DECLARED},
    "wrappers.forcing": {"_ExtForceTorque": DECLARED},
    "wrappers.memory_block": {"construct_memory_block_structures": MEMORY},
}
"""Names not offered, by module, and their replacements"""

METHODS = {
    "BaseSystemCollection": {
        "enable_block_supports": MEMORY,
        "block_systems": MEMORY,
        "synchronize": "loads are computed inside the step: use PositionVerlet().step(simulator, time, dt)",
    },
    "GeneralConstraint": dict.fromkeys(
        (
            "nb_constrain_translational_values",
            "nb_constrain_translational_rates",
            "nb_constrain_rotational_rates",
            "nb_constraint_rotational_values",
        ),
        CONSTRAINT,
    ),
    "InteractionPlane": {"apply_normal_force": PLANE},
    "SurfaceJointSideBySide": {
        "_apply_forces": "use apply_forces",
        "_apply_torques": "use apply_torques",
    },
    "SymplecticStepper": dict.fromkeys(
        ("get_steps", "get_prefactors", "step_methods", "step_single_instance"), STEPPERS
    ),
}
"""Methods not offered, by class, and their replacements"""


class NotOffered(type):
    """Metaclass of stand-ins for names not offered: classes without instances or subclasses."""

    message: str

    def __call__(cls, *args: Any, **kwargs: Any) -> NoReturn:
        """Raise NotImplementedError."""
        raise NotImplementedError(cls.message)

    def __getattr__(cls, name: str) -> NoReturn:
        raise AttributeError(cls.message)


def stand_in(name: str, instead: str) -> NotOffered:
    """Return the stand-in for a name not offered, given with its full path."""
    message = f"{name} of PyElastica is not offered by elastica_gym: {instead}"

    def refuse(cls: type, **kwargs: Any) -> NoReturn:
        raise NotImplementedError(message)

    short = name.rpartition(".")[2]
    return NotOffered(short, (), {"message": message, "__doc__": message, "__init_subclass__": classmethod(refuse)})


def refuse_names(module: str) -> Callable[[str], Any]:
    """Return a module's ``__getattr__``, which returns stand-ins for the names in the table."""
    path = module.removeprefix(LIBRARY).lstrip(".")
    names, made = TABLE[path], dict[str, NotOffered]()

    def get(name: str) -> Any:
        if name not in names:
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        return made.setdefault(name, stand_in(f"{path}.{name}".lstrip("."), names[name]))

    return get


def refuse_methods(cls: type) -> type:
    """Add stand-ins for the methods in the table to a class."""
    for name, instead in METHODS[cls.__name__].items():
        setattr(cls, name, stand_in(f"{cls.__name__}.{name}", instead))
    return cls


class _Finder(MetaPathFinder, Loader):
    """Finds modules in the table that do not exist as files."""

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        if not fullname.startswith(f"{LIBRARY}."):
            return None
        inner = fullname.removeprefix(f"{LIBRARY}.")
        if inner not in TABLE:
            return None
        return ModuleSpec(fullname, self, is_package=any(each.startswith(f"{inner}.") for each in TABLE))

    def create_module(self, spec: ModuleSpec) -> None:
        """Use Python's default."""

    def exec_module(self, module: ModuleType) -> None:
        module.__doc__ = "A module of PyElastica with no names offered here."
        module.__getattr__ = refuse_names(module.__name__)  # type: ignore[method-assign]


sys.meta_path.append(_Finder())
