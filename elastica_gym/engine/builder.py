"""Build a Model from a description of rods and surroundings, and a State at rest."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .model import (
    BLOCK,
    LEAD,
    NEAR,
    Array,
    Control,
    Cylinders,
    Index,
    Joints,
    Model,
    Planes,
    RodContact,
    State,
    Waves,
    aligned_zeros,
    make_control,
    make_state,
)
from .rod import Continuum, require_finite, require_not_negative
from .surroundings import Contact, Cylinder, Joint, Plane, Wave, net_couple


def build_model(
    rods: Sequence[Continuum],
    *,
    planes: Sequence[Plane] = (),
    waves: Sequence[Wave] = (),
    gravity: ArrayLike = (0.0, 0.0, 0.0),
    activation_time: float = 0.0,
    is_loaded: bool = False,
    is_muscular: bool = True,
    is_balanced: bool = False,
    is_reciprocal: bool = False,
    cylinders: Sequence[Cylinder] = (),
    rod_contact: Contact | None = None,
    joints: Sequence[Joint] = (),
    clamped: Sequence[int] = (),
) -> Model:
    """Lay rods out one after another and collect what acts on them.

    Parameters
    ----------
    rods : sequence of Rod, or of objects with its attributes
        At least one.
    planes : sequence of Plane
        Touched by all rods.
    waves : sequence of Wave
        Each on the rod it names.
    gravity : array_like
        Acceleration [m/s^2], (3,).
    activation_time : float
        Time constant with which muscle couples approach those set in Control, 0 for immediately [s].
    is_loaded : bool
        Whether ``Control.force`` and ``Control.torque`` act.
    is_muscular : bool
        Whether ``Control.couple`` acts.
    is_balanced : bool
        Whether the couples that a joint exerts on its two elements are exactly opposite, which conserves angular
        momentum. By default they are as documented (Gazzola et al. 2018, eq. 2.21) and in PyElastica: in three
        dimensions, opposite except for terms of third order in the joint's angle.
    is_reciprocal : bool
        Whether the internal loads derive from a potential, which conserves the energy of strongly bent rods. By
        default they are as documented, without the tension of `ReciprocalTension`.
    cylinders : sequence of Cylinder
        Touched by all rods and planes, not by each other.
    rod_contact : Contact, optional
        Contact between elements of two rods, or of one rod if they are far enough apart along it;
        if omitted, rods pass through each other.
    joints : sequence of Joint
        Between the ends of rods.
    clamped : sequence of int
        Numbers of the rods whose first node and first element are held in place.

    Raises
    ------
    ValueError
        If there are no rods, or a wave, a joint or ``clamped`` names a rod that does not exist.
    """
    if not rods:
        raise ValueError("rods is empty; a model needs at least one")
    require_not_negative("activation_time", activation_time)
    require_finite("gravity", gravity, 3)
    counts = np.array([rod.n_elements for rod in rods])
    first = LEAD + np.concatenate([[0], np.cumsum(counts + 1)[:-1]])
    occupied = int(np.sum(counts + 1))
    blocks = -(-(LEAD + occupied) // BLOCK) + 1
    # an odd number of blocks per row puts the rows of a stage into different cache sets and at different
    # page offsets; at equal offsets, the processor would mistake their addresses for equal
    slots = BLOCK * (blocks | 1)
    fields: dict[str, Any] = {name: aligned_zeros((slots,)) for name in _SCALAR}
    fields |= {name: aligned_zeros((rows, slots)) for name, rows in _ROWS.items()}
    fields["inv_rest_length"][:] = fields["inv_rest_voronoi_length"][:] = 1.0
    for rod, start in zip(rods, first, strict=True):
        lay_out(fields, rod, int(start))
    for number in clamped:
        start = int(first[_rod_number("clamped", number, rods)])
        # with zero inverse mass and inertia, no load moves them
        fields["inv_mass"][start] = 0.0
        fields["inv_inertia"][:, start] = 0.0
    return Model(
        first_slot=first.astype(np.int64),
        n_elements=counts.astype(np.int64),
        **fields,
        gravity=np.array(gravity, dtype=np.float64),
        is_loaded=is_loaded,
        is_muscular=is_muscular,
        is_viscous=bool(fields["viscosity"].any()),
        is_balanced=is_balanced,
        is_reciprocal=is_reciprocal,
        activation_time=float(activation_time),
        planes=plane_table(planes),
        waves=_wave_table(waves, rods, first, slots),
        cylinders=_cylinder_table(cylinders),
        joints=_joint_table(joints, rods, first),
        rod_contact=_rod_contact(rod_contact, rods, first, slots),
    )


_SCALAR = (
    "rest_length",
    "inv_rest_length",
    "rest_voronoi_length",
    "inv_rest_voronoi_length",
    "volume_root",
    "contact_radius",
    "mass",
    "inv_mass",
    "damping_rate",
)
_ROWS = {"shear": 3, "bend": 3, "inv_bend": 3, "inertia": 3, "inv_inertia": 3, "share": 2, "weight": 2, "viscosity": 2}


def lay_out(fields: Mapping[str, Array], rod: Continuum, start: int) -> None:
    """Write a rod's constants into its slots."""
    n = rod.n_elements
    nodes, elements, voronoi = slice(start, start + n + 1), slice(start, start + n), slice(start, start + n - 1)
    m = rod.nodal_mass
    share = np.full((2, n), 0.5)
    share[0, 0] = share[1, -1] = 1.0
    for name, where, value in (
        ("mass", nodes, m),
        ("inv_mass", nodes, rod.inv_nodal_mass),
        ("damping_rate", nodes, rod.damping_rate),
        ("rest_length", elements, rod.rest_length),
        ("inv_rest_length", elements, 1.0 / rod.rest_length),
        ("volume_root", elements, rod.radius * np.sqrt(rod.rest_length)),
        ("contact_radius", elements, rod.radius),
        ("shear", elements, rod.shear_stiffness),
        ("inertia", elements, rod.inertia),
        ("inv_inertia", elements, rod.inv_inertia),
        ("share", elements, share),
        ("weight", elements, np.stack([m[:-1], m[1:]]) / (m[:-1] + m[1:])),
        ("viscosity", elements, [np.broadcast_to(nu, n) for nu in (rod.viscosity, rod.torque_viscosity)]),
        ("rest_voronoi_length", voronoi, rod.rest_voronoi_length),
        ("inv_rest_voronoi_length", voronoi, 1.0 / rod.rest_voronoi_length),
        ("bend", voronoi, rod.bend_stiffness),
        ("inv_bend", voronoi, inverse(rod.bend_stiffness)),
    ):
        fields[name][..., where] = value


def inverse(a: Array) -> Array:
    """Return 1/a, or 0 where a is 0: at ghosts, and at joints that bend freely."""
    return np.divide(1.0, a, out=np.zeros_like(a), where=a > 0.0)


def plane_table(planes: Sequence[Plane]) -> Planes:
    """Return the table of planes, their normals of unit length."""

    def column(name: str, width: int) -> Array:
        values = np.array([getattr(plane, name) for plane in planes], dtype=np.float64)
        return values.reshape((len(planes), width) if width > 1 else len(planes))

    normal = column("normal", 3)
    return Planes(
        origin=column("origin", 3),
        normal=normal / np.linalg.norm(normal, axis=1, keepdims=True),
        stiffness=column("stiffness", 1),
        damping=column("damping", 1),
        surface_tolerance=column("reach", 2),
        slip_tolerance=column("slip_tolerance", 1),
        kinetic_friction=column("kinetic_friction", 3),
        static_friction=column("static_friction", 3),
    )


def _wave_table(waves: Sequence[Wave], rods: Sequence[Continuum], first: np.ndarray, slots: int) -> Waves:
    sine, cosine = aligned_zeros((len(waves), slots)), aligned_zeros((len(waves), slots))
    for row, wave in enumerate(waves):
        if not 0 <= wave.rod < len(rods):
            raise ValueError(f"wave {row} is on rod {wave.rod}, but there are rods 0 to {len(rods) - 1}")
        n, start = rods[wave.rod].n_elements, int(first[wave.rod])
        for table, couple in zip((sine, cosine), wave.profiles(rods[wave.rod].rest_length), strict=True):
            table[row, start : start + n] = net_couple(couple)
    return Waves(
        axis=np.array([wave.axis for wave in waves], dtype=np.float64).reshape(len(waves), 3),
        sine=sine,
        cosine=cosine,
        angular_frequency=np.array([2.0 * np.pi / wave.period for wave in waves], dtype=np.float64),
        ramp_time=np.array([wave.ramp_time for wave in waves], dtype=np.float64),
    )


def _cylinder_table(cylinders: Sequence[Cylinder]) -> Cylinders:
    def column(name: str) -> Array:
        return np.array([getattr(cylinder, name) for cylinder in cylinders], dtype=np.float64)

    def rods(name: str) -> Array:
        return np.array([getattr(cylinder.rods, name) for cylinder in cylinders], dtype=np.float64)

    return Cylinders(
        length=column("length"),
        radius=column("radius"),
        mass=column("mass"),
        inertia=column("inertia").reshape(len(cylinders), 3),
        ground_stiffness=column("ground_stiffness"),
        ground_damping=column("ground_damping"),
        ground_friction=column("ground_friction"),
        rod_stiffness=rods("stiffness"),
        rod_damping=rods("damping"),
        rod_friction=rods("friction"),
        rod_slip_damping=rods("slip_damping"),
    )


def _joint_table(joints: Sequence[Joint], rods: Sequence[Continuum], first: np.ndarray) -> Joints:
    nodes, elements = np.zeros((2, len(joints), 2), dtype=np.int64)
    rest = np.zeros((len(joints), 3, 3))
    for j, joint in enumerate(joints):
        directors = []
        for side, (number, end) in enumerate(zip(joint.rods, joint.ends, strict=True)):
            rod, start = rods[_rod_number("rods of a joint", number, rods)], int(first[number])
            element = 0 if end == 0 else rod.n_elements - 1
            nodes[j, side], elements[j, side] = start + (0 if end == 0 else rod.n_elements), start + element
            directors.append(rod.directors[:, :, element])
        rest[j] = directors[0] @ directors[1].T

    def column(name: str) -> Array:
        return np.array([getattr(joint, name) for joint in joints], dtype=np.float64)

    return Joints(
        node=nodes,
        element=elements,
        stiffness=column("stiffness"),
        damping=column("damping"),
        hinge_stiffness=np.zeros(len(joints)),
        axis=np.zeros((len(joints), 3)),
        turn_stiffness=column("turn_stiffness"),
        turn_damping=column("turn_damping"),
        rest_rotation=rest,
    )


def _rod_number(what: str, number: int, rods: Sequence[Continuum]) -> int:
    if not 0 <= number < len(rods):
        raise ValueError(f"{what} must be numbers from 0 to {len(rods) - 1}, not {number}")
    return number


def _rod_contact(contact: Contact | None, rods: Sequence[Continuum], first: np.ndarray, slots: int) -> RodContact:
    last_other, last_clear = aligned_zeros((slots,)), aligned_zeros((slots,))
    for rod, start in zip(rods, first, strict=True):
        here = slice(start, start + rod.n_elements)
        last_other[here], last_clear[here] = start - 1, start + _last_clear(rod)
    law = contact or Contact(stiffness=1.0)
    return RodContact(
        is_on=contact is not None,
        stiffness=float(law.stiffness),
        damping=float(law.damping),
        friction=float(law.friction),
        slip_damping=float(law.slip_damping),
        last_other=last_other,
        last_clear=last_clear,
        stray=0.2 * min(float(rod.radius.min()) for rod in rods),
    )


def _last_clear(rod: Continuum) -> Index:
    """Return the last element before each that is far enough along the rod to touch it, -1 for none, (n,).

    Far enough is `NEAR` of half the circumference at the elements' mean radius.
    """
    s = np.cumsum(rod.rest_length) - 0.5 * rod.rest_length
    near = s[:, None] - s < NEAR * np.pi * 0.5 * (rod.radius[:, None] + rod.radius)
    # an element is always near itself
    return np.argmax(near, axis=1) - 1


def at_rest(
    model: Model, rods: Sequence[Continuum], n_envs: int = 1, *, cylinders: Sequence[Cylinder] = ()
) -> tuple[State, Control]:
    """Allocate State and Control, with every rod and cylinder at rest as described, in all environments.

    Raises
    ------
    ValueError
        If the model has a different number of cylinders.
    """
    if len(cylinders) != model.cylinders.mass.size:
        raise ValueError(f"cylinders must be {model.cylinders.mass.size}, as in the model, not {len(cylinders)}")
    state, control = make_state(model, n_envs), make_control(model, n_envs)
    for rod, start in zip(rods, model.first_slot, strict=True):
        n = rod.n_elements
        state.x[:, :, start : start + n + 1] = rod.position
        state.Q[:, :, :, start : start + n] = rod.directors
        control.rest_kappa[:, :, start : start + n - 1] = rod.rest_kappa
        control.rest_sigma[:, :, start : start + n] = rod.rest_sigma
    for b, cylinder in enumerate(cylinders):
        state.body_x[:, b], state.body_Q[:, b] = cylinder.centre, cylinder.directors
    return state, control
