"""Every name documented for 0.2.x and 1.0 exists under its path in `elastica_gym.cosserat`."""

import importlib
import inspect
import pkgutil
import typing

import pytest

import elastica_gym.cosserat as library
from elastica_gym.cosserat.not_offered import METHODS, TABLE, NotOffered

NAMES = """
_calculus: difference_kernel difference_kernel_for_block_structure position_average position_difference_kernel
_calculus: quadrature_kernel quadrature_kernel_for_block_structure
_linalg: levi_civita_tensor _batch_matvec _batch_matmul _batch_cross _batch_dot _batch_norm _batch_product_i_k_to_ik
_linalg: _batch_product_i_ik_to_k _batch_product_k_ik_to_ik _batch_vector_sum _batch_matrix_transpose
_linalg: _batch_vec_oneD_vec_cross
_rotations: _get_rotation_matrix _rotate _inv_rotate _skew_symmetrize _inv_skew_symmetrize
_rotations: get_relative_rotation_two_systems
boundary_conditions: ConstraintBase FreeBC OneEndFixedBC FixedConstraint GeneralConstraint HelicalBucklingBC FreeRod
boundary_conditions: OneEndFixedRod
alias: stand_in_for_elastica
callback_functions: CallBackBaseClass ExportCallBack MyCallBack RerunCallBack
connections: FixedJoint FreeJoint HingeJoint
contact_forces: NoContact RodRodContact RodCylinderContact RodSelfContact RodSphereContact RodPlaneContact
contact_forces: RodPlaneContactWithAnisotropicFriction CylinderPlaneContact
timestepper: tqdm PositionVerlet PEFRL
version: VERSION
surface: SurfaceBase
utils: _bspline
dissipation: DamperBase AnalyticalLinearDamper ExponentialDamper LaplaceDissipationFilter RayleighDissipation
experimental.connection_contact_joint.generic_system_type_connection: GenericSystemTypeFreeJoint
experimental.connection_contact_joint.generic_system_type_connection: GenericSystemTypeFixedJoint
experimental.connection_contact_joint.generic_system_type_connection: compute_position_of_point
experimental.connection_contact_joint.generic_system_type_connection: compute_velocity_of_point
experimental.connection_contact_joint.parallel_connection: SurfaceJointSideBySide
experimental.connection_contact_joint.parallel_connection: get_connection_vector_straight_straight_rod
external_forces: NoForces EndpointForces GravityForces UniformForces UniformTorques MuscleTorques ReciprocalTension
external_forces: EndpointForcesSinusoidal inplace_addition inplace_subtraction inplace_substraction
interaction: AnisotropicFrictionalPlane InteractionPlane SlenderBodyTheory
joint: FreeJoint HingeJoint FixedJoint ExternalContact SelfContact BallJoint SphericalJoint ConnectionBase
modules: BaseSystemCollection CallBacks Connections Constraints Forcing Damping Contact
modules.base_system: BaseSystemCollection
modules.callbacks: CallBacks
modules.connections: Connections
modules.constraints: Constraints
modules.contact: Contact
modules.damping: Damping
modules.forcing: Forcing
restart: save_state load_state
rigidbody: Cylinder Sphere RigidBodyBase
rigidbody.cylinder: Cylinder
rigidbody.rigid_body: RigidBodyBase
rigidbody.rigid_body_base: RigidBodyBase
rigidbody.sphere: Sphere
rod: RodBase
rod.cosserat_rod: CosseratRod
rod.knot_theory: KnotTheory KnotTheoryCompatibleProtocol compute_twist compute_writhe compute_link
rod.rod_base: RodBase
surface: Plane
surface.plane: Plane
timestepper: integrate extend_stepper_interface
timestepper.symplectic_steppers: PositionVerlet PEFRL
transformations: inv_skew_symmetrize rotate skew_symmetrize
typing: RodType RigidBodyType SystemType StaticSystemType SystemCollectionType ConnectionIndex ConstrainingIndex
utils: isqrt MaxDimension Tolerance
wrappers: BaseSystemCollection CallBacks Connections Constraints Forcing Damping Contact
wrappers.base_system: BaseSystemCollection
wrappers.callbacks: CallBacks
wrappers.connections: Connections
wrappers.constraints: Constraints
wrappers.forcing: Forcing
"""
PATHS = [
    (path, name)
    for path, _, names in (line.partition(": ") for line in NAMES.strip().splitlines())
    for name in names.split()
]


@pytest.mark.parametrize(("path", "name"), PATHS, ids=[f"{path}.{name}" for path, name in PATHS])
def test_importable(path, name):
    module = importlib.import_module(f"elastica_gym.cosserat.{path}")
    assert hasattr(module, name)
    if hasattr(library, name):
        assert getattr(library, name) is getattr(module, name)


def test_all_exported_names_exist():
    assert [name for name in library.__all__ if not hasattr(library, name)] == []


# names of 0.2.2 and 0.3.3 that 1.0.0 lacks
OLDER = """
_calculus: _get_zero_array
_elastica_numpy: _elastica_numpy
boundary_conditions: FreeRod OneEndFixedRod
experimental.timestepper.explicit_steppers: EulerForward EulerForwardMemory ExplicitStepperMixin RungeKutta4
experimental.timestepper.explicit_steppers: RungeKutta4Memory
experimental.timestepper.memory: MemoryCollection make_memory_for_explicit_stepper
experimental.timestepper.protocol: ExplicitStepperProtocol ExplicitSystemProtocol MemoryProtocol
external_forces: inplace_substraction
interaction: AnisotropicFrictionalPlane InteractionPlane anisotropic_friction apply_normal_force_numba
interaction: apply_normal_force_numba_rigid_body elements_to_nodes_inplace find_slipping_elements
interaction: node_to_element_pos_or_vel nodes_to_elements
joint: ExternalContact SelfContact _aabbs_not_intersecting _calculate_contact_forces_rod_rigid_body
joint: _calculate_contact_forces_rod_rod _calculate_contact_forces_self_rod _clip _dot_product _find_min_dist _norm
joint: _out_of_bounds _prune_using_aabbs_rod_rigid_body _prune_using_aabbs_rod_rod get_relative_rotation_two_systems
memory_block.memory_block_rod: make_block_memory_metadata
memory_block.protocol: BlockProtocol BlockRigidBodyProtocol BlockRodProtocol
modules.protocol: ConnectedSystemCollectionProtocol ConstrainedSystemCollectionProtocol
modules.protocol: ContactedSystemCollectionProtocol DampenedSystemCollectionProtocol ForcedSystemCollectionProtocol
modules.protocol: MixinProtocol SystemCollectionWithCallbackProtocol
rigidbody.data_structures: _DynamicState _KinematicState _bootstrap_from_data
rigidbody.protocol: RigidBodyProtocol
rigidbody.rigid_body: RigidBodyBase
rod.cosserat_rod: _compute_damping_forces _compute_damping_torques
rod.data_structures: _DerivativeState _DynamicState _KinematicState _State _bootstrap_from_data
rod.factory_function: get_shear_modulus
rod.protocol: CosseratRodProtocol _CosseratRodEnergy
surface.surface_base: SurfaceBase
systems: MemoryCollection make_memory_for_explicit_stepper
systems.analytical: BaseStatefulSystem BaseSymplecticSystem BaseUndampedSimpleHarmonicOscillatorSystem CollectiveSystem
systems.analytical: DampedSimpleHarmonicOscillatorSystem ScalarExponentialDampedHarmonicOscillatorCollectiveSystem
systems.analytical: ScalarExponentialDecaySystem SimpleSystemWithPositionsDirectors
systems.analytical: SymplecticUndampedHarmonicOscillatorCollectiveSystem
systems.analytical: SymplecticUndampedSimpleHarmonicOscillatorSystem TestDynamicState TestKinematicState
systems.analytical: make_simple_system_with_positions_directors
systems.protocol: SlenderBodyGeometryProtocol
timestepper._stepper_interface: _TimeStepper
timestepper.explicit_steppers: EulerForward ExplicitStepperMethods ExplicitStepperTag RungeKutta4
timestepper.explicit_steppers: _SystemCollectionStepper _SystemInstanceStepper
timestepper.protocol: SymplecticStepperProtocol
timestepper.symplectic_steppers: SymplecticStepperMethods SymplecticStepperTag _SystemCollectionStepper
timestepper.symplectic_steppers: _SystemInstanceStepper
typing: CosseratRodProtocol RigidBodyProtocol State StateType SurfaceBase SurfaceType SymplecticStepperProtocol
wrappers.base_system: BaseSystemCollection
wrappers.callbacks: CallBacks _CallBack
wrappers.connections: Connections _Connect
wrappers.constraints: Constraints _Constraint
wrappers.forcing: Forcing _ExtForceTorque
wrappers.memory_block: construct_memory_block_structures
"""


def modules_of(package):
    """Return the modules of a package by their relative paths."""
    found = {"": package}
    for info in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        # this module of 1.0.0 cannot be imported: its class has no method resolution order
        if info.name != "elastica.experimental.interaction":
            found[info.name.removeprefix(f"{package.__name__}.")] = importlib.import_module(info.name)
    return found


def names_of(module):
    """Return the names that a module defines or the package exports, without type variables."""
    found = []
    for name, value in vars(module).items():
        is_own = getattr(value, "__module__", module.__name__) == module.__name__ or module.__name__ == "elastica"
        # strings, unions and other annotations do not know where they were defined
        is_own &= module.__name__ == "elastica.typing" or name not in vars(importlib.import_module("elastica.typing"))
        is_helper = inspect.ismodule(value) or isinstance(value, typing.TypeVar) or name.startswith("__") or name == "_"
        if is_own and not is_helper and name not in {"Any", "logger", "TYPE_CHECKING"}:
            found.append(name)
    return found


def ours(path):
    return importlib.import_module(f"elastica_gym.cosserat.{path}" if path else "elastica_gym.cosserat")


def is_there_or_refused(path, name):
    found = getattr(ours(path), name)
    if not isinstance(found, NotOffered):
        return True
    with pytest.raises(NotImplementedError, match=f"{name} of PyElastica is not offered by elastica_gym: ."):
        found(1, option=2)
    with pytest.raises(NotImplementedError, match="is not offered"):
        type("Own", (found,), {})
    return True


def test_every_name_of_pyelastica_exists_or_has_a_stand_in():
    missing, n_walked = [], 0
    for path, module in modules_of(pytest.importorskip("elastica")).items():
        for name in names_of(module):
            n_walked += 1
            try:
                assert is_there_or_refused(path, name)
            except (ImportError, AttributeError):
                missing.append(f"{path}.{name}")
    assert missing == []
    assert n_walked > 250


def test_every_public_method_of_pyelastica_exists_or_has_a_stand_in():
    missing, n_walked = [], 0
    for path, module in modules_of(pytest.importorskip("elastica")).items():
        for name in names_of(module):
            theirs, mine = getattr(module, name), getattr(ours(path), name)
            # protocols are for annotations, and stand-ins have no methods
            if not isinstance(theirs, type) or isinstance(mine, NotOffered) or getattr(theirs, "_is_protocol", False):
                continue
            methods = [each for each, value in vars(theirs).items() if each[0] != "_" and callable(value)]
            n_walked += len(methods)
            missing += [f"{path}.{name}.{each}" for each in methods if not hasattr(mine, each)]
    assert missing == []
    assert n_walked > 80


OLD = [
    (path, name)
    for path, _, names in (line.partition(": ") for line in OLDER.strip().splitlines())
    for name in names.split()
]


@pytest.mark.parametrize(("path", "name"), OLD, ids=[f"{path}.{name}" for path, name in OLD])
def test_every_name_of_older_versions_exists_or_has_a_stand_in(path, name):
    assert is_there_or_refused(path, name)


@pytest.mark.parametrize(("path", "name"), [(path, name) for path, names in TABLE.items() for name in names])
def test_names_in_the_table_do_not_exist(path, name):
    assert isinstance(getattr(ours(path), name), NotOffered)
    assert not isinstance(1, getattr(ours(path), name))


def test_stand_ins_of_methods_name_a_replacement():
    class Simulator(library.BaseSystemCollection):
        pass

    for name, instead in METHODS["BaseSystemCollection"].items():
        with pytest.raises(NotImplementedError, match=f"BaseSystemCollection.{name} of PyElastica is not offered .*"):
            getattr(Simulator(), name)(0.0)
        assert instead in getattr(Simulator, name).message


def test_unknown_names_stay_unknown():
    for path in ("", "joint", "collision.AABBCollection", "timestepper"):
        assert not hasattr(ours(path), "nothing_of_the_kind")
    with pytest.raises(ModuleNotFoundError):
        ours("nothing_of_the_kind")


def test_modules_that_scripts_use_as_attributes():
    theirs = pytest.importorskip("elastica")
    attributes = {name for name, value in vars(theirs).items() if inspect.ismodule(value)}
    mine = {name for name, value in vars(library).items() if inspect.ismodule(value)}
    machinery = {
        "collision",
        "memory_block",
        "reset_functions_for_block_structure",
        "np",
        "os",
        "_contact_functions",
        "_synchronize_periodic_boundary",
    }
    assert attributes - machinery - mine == set()


def test_simulators_of_older_scripts():
    class Simulator(library.BaseSystemCollection, library.CallBacks):
        pass

    sim = Simulator()
    # no callbacks yet
    sim.close()
    sim.override_allowed_types((library.Sphere,))
    with pytest.raises(TypeError, match="a simulator holds Sphere; not Plane"):
        sim.append(library.Plane([0, 0, 0], [0, 0, 1]))
    sim.append(library.Sphere([0, 0, 0], 0.1, 1000.0))
    assert list(sim.final_systems()) == [sim[0]]
    assert isinstance(sim[0], library.SystemProtocol) and not isinstance(1, library.StaticSystemProtocol)
