"""Scene: the documented library's additions to a Model, as tables that its own compiled step reads.

The environments use none of it, so their step omits it. Shapes are written as in `model`: L slots,
and a letter for the number of rows of each table. A table without rows costs nothing. A *span* is
the range of slots that a row acts on: first and last + 1. A *place* is the slot of a node or
element of a rod, or -1 - b for rigid body b.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .model import Array, Index, Joints, Planes, Waves


class PointLoads(NamedTuple):
    """The P forces on single nodes and bodies. With t0 the ramp time, each is the sum of its parts."""

    slot: Index
    """Place, (P,) int64"""
    ramp_time: Array
    """t0 [s], (P,)"""
    growing: Array
    """Times min(1, t/t0) [N], (P, 3)"""
    before: Array
    """Until t0 [N], (P, 3)"""
    cosine: Array
    """From t0 on, times cos(omega (t - t0)) [N], (P, 3)"""
    sine: Array
    """From t0 on, times sin(omega (t - t0)) [N], (P, 3)"""
    angular_frequency: Array
    """omega [rad/s], (P,)"""


class DeadLoads(NamedTuple):
    """Loads that are constant in the lab frame."""

    has_force: bool
    """Whether any force is nonzero"""
    has_torque: bool
    """Whether any torque is nonzero"""
    force: Array
    """On nodes [N], lab frame, (3, L)"""
    torque: Array
    """On elements [N m], lab frame, (3, L)"""
    body_force: Array
    """On bodies [N], lab frame, (B, 3)"""
    body_torque: Array
    """On bodies [N m], lab frame, (B, 3)"""


class Flows(NamedTuple):
    """The F viscous fluids around slender bodies (Gazzola et al. 2018, eq. 4.13)."""

    span: Index
    """Slots of the rod's elements, (F, 2) int64"""
    viscosity: Array
    """Dynamic viscosity mu of the fluid [Pa s], (F,)"""


class Tensions(NamedTuple):
    """The T rods whose internal loads are made to derive from a potential."""

    span: Index
    """Slots of the rod's elements, those of a ring without the image, (T, 2) int64"""
    is_closed: NDArray[np.bool_]
    """Whether the rod is a ring, (T,) bool"""


class Drag(NamedTuple):
    """Forces and torques against velocities, by node and element."""

    is_on: bool
    """Whether any is nonzero"""
    force: Array
    """Per velocity of the node [N s/m], (L,)"""
    torque: Array
    """Per angular velocity of the element [N m s], (L,)"""


class Sides(NamedTuple):
    """The S pairs of elements of rods side by side that are joined at their surfaces."""

    element: Index
    """Slots of the two elements, (S, 2) int64"""
    stiffness: Array
    """Force per distance of the two points k [N/m], (S,)"""
    damping: Array
    """Force per relative velocity of the elements nu [N s/m], (S,)"""
    repulsion: Array
    """Force per overlap to the power of 3/2 [N/m^(3/2)], (S,)"""
    towards: Array
    """Unit vectors from the axis of each element to its point, material frame, (S, 2, 3)"""
    offset: Array
    """Distance between the surfaces at rest [m], (S,)"""


class Law(NamedTuple):
    """Normal force and friction between two overlapping objects."""

    stiffness: float
    """Restoring force per overlap k [N/m]"""
    damping: float
    """Damping force per velocity of approach nu [N s/m]"""
    friction: float
    """Coefficient of Coulomb friction mu"""
    slip_damping: float
    """Friction force per slip velocity below the Coulomb bound c [N s/m]"""


class BodyContacts(NamedTuple):
    """The P pairs of a rod and a rigid body that may touch."""

    span: Index
    """Slots of the rod's elements, (P, 2) int64"""
    body: Index
    """Number of the body, (P,) int64"""
    stiffness: Array
    """Restoring force per overlap k [N/m], (P,)"""
    damping: Array
    """Damping force per velocity of approach nu [N s/m], (P,)"""
    friction: Array
    """Coefficient of Coulomb friction mu, (P,)"""
    slip_damping: Array
    """Friction force per slip velocity below the Coulomb bound c [N s/m], (P,)"""


class RodContacts(NamedTuple):
    """The C pairs of rods that may touch, possibly a rod with itself, and the neighbour list of their E elements."""

    row: Index
    """First row of each rod's pairs with itself and with later rods, and the last end, (R + 1,) int64"""
    other: Index
    """The other rod of each pair, ascending among those of a rod, (C,) int64"""
    stiffness: Array
    """Restoring force per overlap k [N/m], (C,)"""
    damping: Array
    """Damping force per velocity of approach nu [N s/m], (C,)"""
    rod_of: Index
    """The rod that a slot belongs to, (L,) int64"""
    elements: Index
    """Slots of the elements that may touch others, ascending, (E,) int64"""
    stray: float
    """How far an element may move before the neighbour list is rebuilt [m]"""
    last_other: Array
    """The last slot before the rod that a slot belongs to, integer-valued, (L,)"""
    last_clear: Array
    """The last slot before an element that may touch it, at any compression, integer-valued, (L,)"""
    order: Index
    """The slots in ``elements``, in the order of the last sweep, (E,) int64"""
    neighbours: Index
    """The neighbour list, as in `State.neighbours`, (P,) int64"""
    first: Index
    """The first row of each listed pair, (P,) int64"""


class Pins(NamedTuple):
    """The N nodes and bodies whose motion is prescribed."""

    slot: Index
    """Place, (N,) int64"""
    start_time: Array
    """Time from which the node is held [s]; until then it moves with ``velocity``; (N,)"""
    velocity: Array
    """Velocity before the start [m/s], lab frame, (N, 3)"""
    axes: Array
    """One for the lab axes along which it is held, else zero, (N, 3)"""
    position: Array
    """Held position [m], (N, 3)"""


class Clamps(NamedTuple):
    """The N elements and bodies whose rotation is prescribed."""

    slot: Index
    """Place, (N,) int64"""
    start_time: Array
    """Time from which the element is held [s]; until then it rotates with ``omega``; (N,)"""
    omega: Array
    """Angular velocity before the start [rad/s], material frame, (N, 3)"""
    axes: Array
    """One for the lab axes about which it does not rotate, else zero, (N, 3)"""
    has_directors: Array
    """One if the directors are set, zero if only the angular velocity is, (N,)"""
    directors: Array
    """Held directors, (N, 3, 3)"""


class Decay(NamedTuple):
    """Exponential damping of velocities, and its factors at the current time step."""

    is_on: bool
    """Whether any rate is nonzero"""
    is_dilating: bool
    """Whether any dilating rate is nonzero"""
    node_rate: Array
    """Of velocity [1/s], (L,)"""
    element_rate: Array
    """Of angular velocity [1/s], (L,)"""
    dilating_rate: Array
    """Of angular velocity, to be multiplied by the dilatation e [1/s], material frame, (3, L)"""
    node_factor: Array
    """exp(-rate dt) for nodes, (L,)"""
    element_factor: Array
    """exp(-rate dt) for elements, without the dilating part, (L,)"""
    is_on_bodies: bool
    """Whether any rate of bodies is nonzero"""
    body_rate: Array
    """Of the velocity of bodies [1/s], (B,)"""
    body_turn_rate: Array
    """Of their angular velocity [1/s], material frame, (B, 3)"""


class Filters(NamedTuple):
    """The F filters of the shortest waves in velocities (Jeanmart and Winckelmans 2007)."""

    span: Index
    """Slots of the rod's nodes, those of a ring without the images, (F, 2) int64"""
    order: Index
    """Number of times the Laplacian is applied, (F,) int64"""
    is_closed: NDArray[np.bool_]
    """Whether the rod is a ring, (F,) bool"""


class Rings(NamedTuple):
    """The R closed rods, each an open one whose last element is the image of its first."""

    first: Index
    """Slot of the first node, (R,) int64"""
    n_elements: Index
    """Number of elements n without the image, (R,) int64"""


class Scene(NamedTuple):
    """All features of a simulation that are not in its Model."""

    blocks: Index
    """Spans of rods that the strain stages process at a time, so that they stay in the cache, (N, 2) int64"""
    rings: Rings
    touched: Index
    """Slots of the rods that point loads and joints act on, (T,) int64"""
    point_loads: PointLoads
    dead_loads: DeadLoads
    waves: Waves
    wave_span: Index
    """Slots of the elements that a wave acts on, (W, 2) int64"""
    flows: Flows
    tensions: Tensions
    drag: Drag
    joints: Joints
    sides: Sides
    rod_contacts: RodContacts
    body_contacts: BodyContacts
    planes: Planes
    plane_span: Index
    """Slots of the nodes that a plane acts on, (P, 2) int64"""
    body_planes: Planes
    grounded: Index
    """Number of the body that each of ``body_planes`` acts on, (Q,) int64"""
    ground_friction: Array
    """Coefficient of Coulomb friction of that pair, (Q,)"""
    pins: Pins
    clamps: Clamps
    decay: Decay
    filters: Filters


class Hooks(NamedTuple):
    """Addresses of C functions that call the user's own classes, 0 for none."""

    values: int
    """After each drift: constraints of position and directors"""
    loads: int
    """After all built-in loads except those of planes"""
    rates: int
    """After each kick: constraints of velocities"""
    damping: int
    """At the end of a step's kicks: dampers"""


class Scheme(NamedTuple):
    """A symplectic time stepper: drifts and kicks in turn, a drift first and last."""

    drifts: Array
    """Parts of the time step by which positions move, (S + 1,)"""
    kicks: Array
    """Parts of the time step by which velocities change, (S,)"""
