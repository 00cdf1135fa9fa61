"""Model, State and Control: constants, the simulated state, and inputs.

All arrays are C-contiguous float64 unless said otherwise, in SI units. B is the number of
environments. Rods lie one after another along the last axis, which has L slots: first an empty
block (``LEAD``, for reading k - 1), then n + 1 slots for a rod of n elements. Its nodes use all of
them; its elements the first n and its Voronoi points (between elements k and k + 1) the first n - 1.
The unused slots, the *ghosts*, have zero stiffness, zero mass and zero inverse mass, so that every
stage runs over all slots without a branch and adjacent rods do not interact. The slots are padded
to a multiple of ``BLOCK``, so that loops have no remainder and start at a cache line, and at least
one empty block follows for reading k + 1.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

BLOCK = 8
LEAD = BLOCK
SCRATCH = 16
# capacity of the neighbour list, in pairs per element
ROOM = 32
# elements of a rod closer than this fraction of pi r, half its circumference, cannot touch
NEAR = 0.8

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class Planes(NamedTuple):
    """The P planes that all rods may touch."""

    origin: Array
    """A point of the plane [m], (P, 3)"""
    normal: Array
    """Unit normal, towards the free side, (P, 3)"""
    stiffness: Array
    """Restoring force per penetration k [N/m], (P,)"""
    damping: Array
    """Damping force per normal velocity nu [N s/m], (P,)"""
    surface_tolerance: Array
    """Gap below which an element is in contact: the lesser of a length [m] and a fraction of its radius, (P, 2)"""
    slip_tolerance: Array
    """Slip velocity below which friction is static [m/s], (P,)"""
    kinetic_friction: Array
    """Coefficients forward, backward and sideways, (P, 3)"""
    static_friction: Array
    """Coefficients forward, backward and sideways, (P, 3)"""


class Waves(NamedTuple):
    """The W travelling waves of muscle couple along rods (Gazzola et al. 2018, section 5.2)."""

    axis: Array
    """Direction of the couple in the lab, (W, 3)"""
    sine: Array
    """Factor of sin(omega t) in the net couple on each element [N m], (W, L)"""
    cosine: Array
    """Factor of cos(omega t) in the net couple on each element [N m], (W, L)"""
    angular_frequency: Array
    """omega [rad/s], (W,)"""
    ramp_time: Array
    """Time over which the wave grows linearly to full strength, 0 for none [s], (W,)"""


class Cylinders(NamedTuple):
    """The C free rigid cylinders. Their axis is d3, their position the centre of mass."""

    length: Array
    """From end to end [m], (C,)"""
    radius: Array
    """[m], (C,)"""
    mass: Array
    """[kg], (C,)"""
    inertia: Array
    """Diagonal of the moment of inertia J: m (3 r^2 + L^2)/12 twice, m r^2/2 [kg m^2], (C, 3)"""
    ground_stiffness: Array
    """Restoring force per penetration of a plane at each point of contact [N/m], (C,)"""
    ground_damping: Array
    """Damping force per velocity along the plane's normal at each point of contact [N s/m], (C,)"""
    ground_friction: Array
    """Coefficient of Coulomb friction with planes, (C,)"""
    rod_stiffness: Array
    """Restoring force per overlap with a rod's element k [N/m], (C,)"""
    rod_damping: Array
    """Damping force per velocity of approach nu [N s/m], (C,)"""
    rod_friction: Array
    """Coefficient of Coulomb friction with rods, (C,)"""
    rod_slip_damping: Array
    """Friction force per slip velocity below the Coulomb bound c [N s/m], (C,)"""


class RodContact(NamedTuple):
    """Contact between elements of rods."""

    is_on: bool
    """Whether rods touch each other"""
    stiffness: float
    """Restoring force per overlap k [N/m]"""
    damping: float
    """Damping force per velocity of approach nu [N s/m]"""
    friction: float
    """Coefficient of Coulomb friction mu"""
    slip_damping: float
    """Friction force per slip velocity below the Coulomb bound c [N s/m]"""
    stray: float
    """How far an element may move before the neighbour list is rebuilt [m]"""
    last_other: Array
    """The last slot before the rod that a slot belongs to, integer-valued, (L,)"""
    last_clear: Array
    """The last slot before an element that is far enough along the rod to touch it, integer-valued, (L,)"""


class Joints(NamedTuple):
    """The C joints, each between a node and element one and a node and element two."""

    node: Index
    """Places of the two nodes, (C, 2) int64"""
    element: Index
    """Places of the two elements, (C, 2) int64"""
    stiffness: Array
    """Force per distance k [N/m], (C,)"""
    damping: Array
    """Force per relative velocity nu [N s/m], (C,)"""
    hinge_stiffness: Array
    """Torque that turns element two back into the plane across ``axis``, kt [N m], 0 for none; (C,)"""
    axis: Array
    """Unit normal of that plane, lab frame, (C, 3)"""
    turn_stiffness: Array
    """Torque per angle from the rest rotation, kt [N m], 0 for none; (C,)"""
    turn_damping: Array
    """Torque per relative angular velocity [N m s], (C,)"""
    rest_rotation: Array
    """C with Q1 = C Q2 at rest, (C, 3, 3)"""


class Model(NamedTuple):
    """Everything that is constant during an episode."""

    first_slot: Index
    """Slot of each rod's first node, (R,) int64"""
    n_elements: Index
    """Number of elements of each rod, (R,) int64"""
    rest_length: Array
    """Element length at rest l^ [m], (L,)"""
    inv_rest_length: Array
    """1 / l^ [1/m], one at ghosts, (L,)"""
    rest_voronoi_length: Array
    """Voronoi length at rest D^ [m], (L,)"""
    inv_rest_voronoi_length: Array
    """1 / D^ [1/m], one at ghosts, (L,)"""
    volume_root: Array
    """Square root of element volume over pi, r sqrt(l) [m^(3/2)], (L,)"""
    contact_radius: Array
    """Radius of each element in contact, its rest radius [m], (L,)"""
    shear: Array
    """Diagonal of the shear and stretch stiffness S [N], (3, L)"""
    bend: Array
    """Diagonal of the bending and twist stiffness B [N m^2], (3, L)"""
    inv_bend: Array
    """Diagonal of its inverse [1/(N m^2)], zero at ghosts, (3, L)"""
    mass: Array
    """Nodal mass m [kg], (L,)"""
    inv_mass: Array
    """1 / m [1/kg], zero at ghosts, (L,)"""
    inertia: Array
    """Diagonal of the element's moment of inertia J [kg m^2], (3, L)"""
    inv_inertia: Array
    """Diagonal of its inverse [1/(kg m^2)], zero at ghosts, (3, L)"""
    share: Array
    """Shares of the left and right node's force in an element's: 1/2, at rod ends 1; (2, L)"""
    weight: Array
    """Weights of the left and right node's velocity in an element's, by mass, (2, L)"""
    viscosity: Array
    """The documented damping nu per velocity and length [kg/(m s)], and per angular velocity and
    length [kg m/s], (2, L)"""
    damping_rate: Array
    """Uniform damping c of velocity and angular velocity [1/s], (L,)"""
    gravity: Array
    """Acceleration of gravity [m/s^2], (3,)"""
    is_loaded: bool
    """Whether the external loads of Control act"""
    is_muscular: bool
    """Whether the muscle couples of Control act"""
    is_viscous: bool
    """Whether any viscosity is nonzero"""
    is_balanced: bool
    """Whether the two couples of a joint are exactly opposite in the lab, which conserves angular momentum"""
    is_reciprocal: bool
    """Whether the internal loads derive from a potential, through a tension that the documented model omits"""
    activation_time: float
    """Time constant of muscle activation, 0 for immediate [s]"""
    planes: Planes
    waves: Waves
    cylinders: Cylinders
    joints: Joints
    """Joints of rods"""
    rod_contact: RodContact


class State(NamedTuple):
    """All that a step changes. The first seven fields and the bodies' motion and contact are the state proper."""

    x: Array
    """Node position [m], lab frame, (B, 3, L)"""
    v: Array
    """Node velocity [m/s], lab frame, (B, 3, L)"""
    Q: Array
    """Element directors: rows d1, d2, d3 in the lab, (B, 3, 3, L)"""
    w: Array
    """Element angular velocity [rad/s], material frame, (B, 3, L)"""
    couple: Array
    """Muscle couple at Voronoi points [N m], material frame, (B, 3, L)"""
    time: Array
    """Simulated time [s], (B,)"""
    step: Index
    """Steps done, (B,) int64"""
    length: Array
    """Element length l [m], (B, L)"""
    radius: Array
    """Element radius r at constant volume [m], (B, L)"""
    kappa: Array
    """Curvature and twist [1/m], material frame, (B, 3, L)"""
    force: Array
    """Net force on nodes F + F_ext [N], lab frame, (B, 3, L)"""
    torque: Array
    """Net torque on elements T + T_ext [N m], material frame, (B, 3, L)"""
    normal_force: Array
    """Normal load on planes by element, summed over planes [N], (B, L)"""
    scratch: Array
    """Intermediate results of the stages of a step, (B, SCRATCH, L)"""
    decay: Array
    """exp(-c dt) by node and element, (B, L)"""
    body_x: Array
    """Position of a body's centre of mass [m], lab frame, (B, C, 3)"""
    body_v: Array
    """Its velocity [m/s], lab frame, (B, C, 3)"""
    body_Q: Array  # noqa: N815
    """Its directors: rows d1, d2, d3 in the lab, (B, C, 3, 3)"""
    body_w: Array
    """Its angular velocity [rad/s], material frame, (B, C, 3)"""
    body_force: Array
    """Net force on it [N], lab frame, (B, C, 3)"""
    body_torque: Array
    """Net torque on it about its centre [N m], material frame, (B, C, 3)"""
    body_contact: Array
    """At each point that may touch a plane, for the last plane and in the lab frame: normal force, friction force [N]
    and the point relative to the centre [m], (B, C, 6, 7)"""
    body_touch: Array
    """Normal force between an element and cylinders, if any [N], (B, L)"""
    rod_touch: Array
    """Normal force between an element and other elements, if rods touch [N], (B, L)"""
    n_neighbours: Index
    """Number of pairs of elements near enough to touch soon, -1 if they are not listed, (B,) int64"""
    neighbours: Index
    """The neighbour list of these pairs, the lower slot times L plus the higher one, sorted, (B, P) int64"""
    neighbour_x: Array
    """Node positions when the list was built [m], (B, 3, L)"""
    neighbour_reach: Array
    """Radii of the elements' bounding spheres when the list was built [m], (B, L)"""
    order: Index
    """Slots of the E elements that may touch others, in the order of a sweep: any order is correct, the sorted one
    is fastest; (B, E) int64"""


class Control(NamedTuple):
    """Inputs, set between calls of ``advance``."""

    couple: Array
    """Muscle couple that ``State.couple`` approaches [N m], material frame, (B, 3, L)"""
    rest_kappa: Array
    """Curvature and twist at rest [1/m], (B, 3, L)"""
    rest_sigma: Array
    """Shear and stretch strain at rest, (B, 3, L)"""
    force: Array
    """External force on nodes, if the model is loaded [N], lab frame, (B, 3, L)"""
    torque: Array
    """External torque on elements, if the model is loaded [N m], material frame, (B, 3, L)"""


def aligned_zeros(shape: tuple[int, ...], dtype: type = np.float64) -> NDArray:
    """Return 8-byte zeros aligned to a cache line (64 bytes)."""
    size = 8 * int(np.prod(shape, dtype=np.int64))
    raw = np.zeros(size + 64, dtype=np.uint8)
    start = -raw.ctypes.data % 64
    return raw[start : start + size].view(dtype).reshape(shape)


def make_state(model: Model, n_envs: int = 1) -> State:
    """Allocate a State of zeros, with unit directors, for ``n_envs`` environments.

    Parameters
    ----------
    model : Model
    n_envs : int
        Number of environments B.
    """
    slots = model.mass.size
    vector, scalar = (n_envs, 3, slots), (n_envs, slots)
    shapes = {
        "Q": (n_envs, 3, 3, slots),
        "time": (n_envs,),
        "scratch": (n_envs, SCRATCH, slots),
        "length": scalar,
        "radius": scalar,
        "normal_force": scalar,
        "decay": scalar,
        "rod_touch": scalar,
    }
    n_bodies = model.cylinders.mass.size
    shapes |= {name: (n_envs, n_bodies, 3) for name in State._fields if name.startswith("body_")}
    shapes |= {"body_Q": (n_envs, n_bodies, 3, 3), "body_contact": (n_envs, n_bodies, 6, 7), "body_touch": scalar}
    elements = _elements(model) if model.rod_contact.is_on else np.zeros(0, dtype=np.int64)
    room = min(elements.size * (elements.size - 1) // 2, ROOM * elements.size)
    shapes |= {
        "step": (n_envs,),
        "order": (n_envs, elements.size),
        "n_neighbours": (n_envs,),
        "neighbours": (n_envs, room),
        "neighbour_reach": scalar,
    }
    whole = ("step", "order", "n_neighbours", "neighbours")
    state = State(
        *(aligned_zeros(shapes.get(name, vector), np.int64 if name in whole else np.float64) for name in State._fields)
    )
    for i in range(3):
        state.Q[:, i, i] = state.body_Q[:, :, i, i] = 1.0
    state.order[:], state.n_neighbours[:] = elements, -1
    _assert_disjoint(state)
    return state


def make_control(model: Model, n_envs: int = 1) -> Control:
    """Allocate a Control of zeros for ``n_envs`` environments."""
    control = Control(*(aligned_zeros((n_envs, 3, model.mass.size)) for _ in Control._fields))
    _assert_disjoint(control)
    return control


def _elements(model: Model) -> Index:
    """Return the slots of all elements, (E,)."""
    slots = [start + np.arange(n) for start, n in zip(model.first_slot, model.n_elements, strict=True)]
    return np.concatenate(slots).astype(np.int64)


def _assert_disjoint(arrays: State | Control) -> None:
    """Assert that no two arrays overlap, as the stages promise the compiler."""
    spans = sorted((a.ctypes.data, a.ctypes.data + a.nbytes) for a in arrays if a.size)
    assert all(end <= start for (_, end), (start, _) in pairwise(spans))
