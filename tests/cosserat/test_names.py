"""Every name that the documentation of 0.2.x and 1.0 gives, by its path, under `elastica_gym.cosserat`."""

import importlib

import pytest

import elastica_gym.cosserat as library

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
PATHS = [(path, name) for path, _, names in (line.partition(": ") for line in NAMES.strip().splitlines())
         for name in names.split()]  # fmt: skip


@pytest.mark.parametrize(("path", "name"), PATHS, ids=[f"{path}.{name}" for path, name in PATHS])
def test_importable(path, name):
    module = importlib.import_module(f"elastica_gym.cosserat.{path}")
    assert hasattr(module, name)
    if hasattr(library, name):
        assert getattr(library, name) is getattr(module, name)


def test_all_that_is_exported_exists():
    assert [name for name in library.__all__ if not hasattr(library, name)] == []


def test_nothing_of_the_originals_namespace_is_missing():
    theirs = pytest.importorskip("elastica")
    # protocols and memory blocks are the original's own machinery
    machinery = {"MemoryBlockCosseratRod", "MemoryBlockRigidBody", "StaticSystemProtocol", "SystemProtocol"}
    public = {name for name in dir(theirs) if name[0] != "_" and isinstance(getattr(theirs, name), type)}
    assert public - machinery - set(library.__all__) == set()
