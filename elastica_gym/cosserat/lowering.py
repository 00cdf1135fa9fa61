"""Lower a user's declared features to the tables of a Scene, which the compiled step reads.

A feature with a method ``lower(builder, ...)`` writes its own rows here. A user's subclass that
overrides a method called every step is not lowered: the step calls it instead.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..engine.builder import plane_table
from ..engine.kernels.simulate import DENSE, SPARSE, UNLOADED
from ..engine.model import BLOCK, ROOM, Array, Index, Joints, Model, Waves, aligned_zeros
from ..engine.scene import (
    BodyContacts,
    Clamps,
    DeadLoads,
    Decay,
    Drag,
    Filters,
    Flows,
    Pins,
    PointLoads,
    Rings,
    RodContacts,
    Scene,
    Sides,
    Tensions,
)
from ..engine.surroundings import Plane, net_couple
from .rod.rod_base import RodBase

ALWAYS = -np.inf
CACHED = 1024
"""Slots that the strain stages process at a time: their 70 rows fill half of a 1 MB L2 cache"""
STRAY = 0.2
"""Displacement of an element, in smallest radii, after which the neighbour list is rebuilt"""


def is_built_in(cls: type, methods: Sequence[str]) -> bool:
    """Return whether features of a class can be lowered: no subclass overrides their methods.

    A user's subclass is called even if it overrides nothing, since it may change during a run. Features with only a
    compiled implementation are always lowered.
    """
    if not (cls.__module__.startswith(str(__package__)) or getattr(cls, "IS_COMPILED", False)):
        return False
    for each in cls.__mro__:
        if "lower" in vars(each):
            return all(getattr(cls, name) is getattr(each, name) for name in methods)
    return False


NO_LOADS = {
    *("_first", "_body", "_number", "_rods", "_planes", "_body_planes", "_pins", "_clamps", "_filters"),
    *("_point_loads", "_joints"),
}
"""Collections of a builder that are not loads on all nodes of a rod"""


class _Span(NamedTuple):
    first: int
    last: int


class SceneBuilder:
    """Builder of a Scene's rows.

    Parameters
    ----------
    model : Model
        Model of all rods.
    rods, bodies : sequence
        Systems in the order of the model.
    """

    def __init__(self, model: Model, rods: Sequence[Any], bodies: Sequence[Any] = ()) -> None:
        self._slots = model.mass.size
        self._starts = model.first_slot
        self._end = -(-int(model.first_slot[-1] + model.n_elements[-1] + 1) // BLOCK) * BLOCK
        # without rods, the model contains a dummy rod
        self._first = {id(rod): int(start) for rod, start in zip(rods, model.first_slot, strict=bool(rods))}
        self._body = {id(body): number for number, body in enumerate(bodies)}
        self._body_force, self._body_torque = np.zeros((len(bodies), 3)), np.zeros((len(bodies), 3))
        self._point_loads: list[tuple] = []
        self._dead_force, self._dead_torque = aligned_zeros((3, self._slots)), aligned_zeros((3, self._slots))
        self._waves: dict[tuple, tuple[Array, Array, list[_Span]]] = {}
        self._flows: list[tuple[_Span, float]] = []
        self._tensions: list[tuple[_Span, bool]] = []
        self._drag_force, self._drag_torque = aligned_zeros((self._slots,)), aligned_zeros((self._slots,))
        self._joints: list[tuple] = []
        self._sides: list[tuple] = []
        self._number = {id(rod): number for number, rod in enumerate(rods)}
        self._rods = list(rods)
        self._rod_contacts: set[tuple[int, int, float, float]] = set()
        self._body_contacts: list[tuple] = []
        self._body_planes: list[tuple[Plane, int, float]] = []
        self._planes: list[tuple[Plane, _Span]] = []
        self._pins: list[tuple] = []
        self._clamps: list[tuple] = []
        self._node_rate, self._element_rate = aligned_zeros((self._slots,)), aligned_zeros((self._slots,))
        self._dilating_rate = aligned_zeros((3, self._slots))
        self._body_rate, self._body_turn_rate = np.zeros(len(bodies)), np.zeros((len(bodies), 3))
        self._filters: list[tuple[_Span, int, bool]] = []

    # indices

    def node(self, system: Any, index: int) -> int:
        """Return the slot of a node, counted from the end if ``index`` is negative."""
        if id(system) in self._body:
            return -1 - self._body[id(system)]
        return self._first[id(system)] + _index("node", index, system.n_nodes)

    def element(self, system: Any, index: int) -> int:
        """Return the slot of an element, counted from the end if ``index`` is negative."""
        if id(system) in self._body:
            return -1 - self._body[id(system)]
        return self._first[id(system)] + _index("element", index, system.n_elems)

    def nodes(self, system: Any) -> slice:
        """Return the slots of a rod's nodes."""
        _require_rod(system)
        return slice(self._first[id(system)], self._first[id(system)] + system.n_nodes)

    def elements(self, system: Any) -> slice:
        """Return the slots of a rod's elements."""
        _require_rod(system)
        return slice(self._first[id(system)], self._first[id(system)] + system.n_elems)

    # loads

    def add_point_load(
        self,
        system: Any,
        index: int,
        *,
        ramp_time: float = 0.0,
        growing: ArrayLike = (0.0, 0.0, 0.0),
        before: ArrayLike = (0.0, 0.0, 0.0),
        cosine: ArrayLike = (0.0, 0.0, 0.0),
        sine: ArrayLike = (0.0, 0.0, 0.0),
        angular_frequency: float = 0.0,
    ) -> None:
        """Add a force on a node; see `PointLoads` for the arguments."""
        vectors = [np.ravel(v) for v in (growing, before, cosine, sine)]
        self._point_loads.append((self.node(system, index), ramp_time, *vectors, angular_frequency))

    def add_dead_force(self, system: Any, force: ArrayLike) -> None:
        """Add a force constant in the lab on each node of a system [N], (3, n + 1)."""
        if id(system) in self._body:
            self._body_force[self._body[id(system)]] += np.ravel(force)
        else:
            self._dead_force[:, self.nodes(system)] += force

    def add_dead_torque(self, system: Any, torque: ArrayLike) -> None:
        """Add a torque constant in the lab on each element of a system [N m], (3, n)."""
        if id(system) in self._body:
            self._body_torque[self._body[id(system)]] += np.ravel(torque)
        else:
            self._dead_torque[:, self.elements(system)] += torque

    def add_wave(
        self, system: Any, *, axis: Array, angular_frequency: float, ramp_time: float, sine: Array, cosine: Array
    ) -> None:
        """Add a travelling wave of couples at Voronoi points [N m], (n - 1,); see `Waves`."""
        key = (*np.ravel(axis).tolist(), float(angular_frequency), float(ramp_time))
        if key not in self._waves:
            self._waves[key] = (aligned_zeros((self._slots,)), aligned_zeros((self._slots,)), [])
        tables = self._waves[key]
        where = self.elements(system)
        tables[0][where] += net_couple(sine)
        tables[1][where] += net_couple(cosine)
        tables[2].append(_Span(where.start, where.stop))

    def add_flow(self, system: Any, viscosity: float) -> None:
        """Add a viscous fluid around a system [Pa s]."""
        where = self.elements(system)
        self._flows.append((_Span(where.start, where.stop), viscosity))

    def add_tension(self, system: Any) -> None:
        """Make the internal loads of a rod conservative."""
        where = self.elements(system)
        self._tensions.append((_Span(where.start, where.stop), system.ring_rod_flag))

    def add_drag(self, system: Any, force: ArrayLike, torque: ArrayLike) -> None:
        """Add drag per velocity of nodes [N s/m] and per angular velocity of elements [N m s]."""
        self._drag_force[self.nodes(system)] += force
        self._drag_torque[self.elements(system)] += torque

    def add_plane(self, system: Any, plane: Plane) -> None:
        """Add contact of a system with a plane."""
        _require_open(system, "plane")
        where = self.nodes(system)
        span = _Span(where.start, where.stop)
        # consecutive rods on the same plane share a row
        if self._planes and self._planes[-1][0] == plane and self._planes[-1][1].last == span.first:
            span = _Span(self._planes.pop()[1].first, span.last)
        self._planes.append((plane, span))

    # joints and constraints

    def add_joint(
        self,
        ends: tuple[Any, int, Any, int],
        *,
        stiffness: float,
        damping: float,
        hinge_stiffness: float = 0.0,
        axis: ArrayLike = (0.0, 0.0, 0.0),
        turn_stiffness: float = 0.0,
        turn_damping: float = 0.0,
        rest_rotation: ArrayLike | None = None,
    ) -> None:
        """Add a joint between two systems at indices; see `Joints` for the arguments."""
        one, i, two, j = ends
        turns = hinge_stiffness != 0.0 or turn_stiffness != 0.0 or turn_damping != 0.0
        elements = (self.element(one, i), self.element(two, j)) if turns else (0, 0)
        self._joints.append(
            (
                (self.node(one, i), self.node(two, j)),
                elements,
                stiffness,
                damping,
                hinge_stiffness,
                np.ravel(axis),
                turn_stiffness,
                turn_damping,
                np.eye(3) if rest_rotation is None else rest_rotation,
            )
        )

    def add_side(
        self,
        ends: tuple[Any, int, Any, int],
        *,
        stiffness: float,
        damping: float,
        repulsion: float,
        towards: ArrayLike,
        offset: float,
    ) -> None:
        """Join two elements side by side; see `Sides` for the arguments."""
        one, i, two, j = ends
        _require_rod(one)
        _require_rod(two)
        self._sides.append(
            ((self.element(one, i), self.element(two, j)), stiffness, damping, repulsion, towards, offset)
        )

    def add_pin(
        self,
        system: Any,
        index: int,
        *,
        position: Array,
        axes: Sequence[bool] = (True, True, True),
        start_time: float = ALWAYS,
        velocity: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        """Prescribe the motion of a node; see `Pins` for the arguments."""
        row = (self.node(system, index), start_time, np.ravel(velocity), np.array(axes, dtype=float), position)
        self._pins.append(row)

    def add_clamp(
        self,
        system: Any,
        index: int,
        *,
        directors: Array | None,
        axes: Sequence[bool] = (True, True, True),
        start_time: float = ALWAYS,
        omega: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        """Prescribe the rotation of an element; see `Clamps` for the arguments."""
        held = np.eye(3) if directors is None else directors
        self._clamps.append(
            (
                self.element(system, index),
                start_time,
                np.ravel(omega),
                np.array(axes, dtype=float),
                float(directors is not None),
                held,
            )
        )

    # contact

    def add_body_contact(
        self, rod: Any, body: Any, *, stiffness: float, damping: float, friction: float = 0.0, slip_damping: float = 0.0
    ) -> None:
        """Add contact of a rod with a rigid body; see `BodyContacts` for the arguments."""
        _require_open(rod, "rigid body")
        where = self.elements(rod)
        row = (_Span(where.start, where.stop), self._body[id(body)], stiffness, damping, friction, slip_damping)
        self._body_contacts.append(row)

    def add_rod_contact(self, one: Any, two: Any, *, stiffness: float, damping: float) -> None:
        """Add contact of two rods, or of one with itself; see `RodContacts` for the arguments."""
        _require_open(one, "rod")
        _require_open(two, "rod")
        i, j = self._number[id(one)], self._number[id(two)]
        self._rod_contacts.add((min(i, j), max(i, j), float(stiffness), float(damping)))

    def add_body_plane(self, body: Any, plane: Plane, friction: float) -> None:
        """Add contact of a rigid body with a plane, with a coefficient of Coulomb friction."""
        self._body_planes.append((plane, self._body[id(body)], friction))

    # dampers

    def add_decay(
        self, system: Any, *, node_rate: ArrayLike, element_rate: ArrayLike = 0.0, dilating_rate: ArrayLike = 0.0
    ) -> None:
        """Add exponential decay of velocities [1/s]; see `Decay` for the arguments."""
        if id(system) in self._body:
            number = self._body[id(system)]
            self._body_rate[number] += np.squeeze(node_rate)
            self._body_turn_rate[number] += element_rate + np.ravel(dilating_rate)
            return
        self._node_rate[self.nodes(system)] += node_rate
        self._element_rate[self.elements(system)] += element_rate
        self._dilating_rate[:, self.elements(system)] += dilating_rate

    def add_filter(self, system: Any, order: int) -> None:
        """Add a filter that removes the shortest waves."""
        where = self.nodes(system)
        self._filters.append((_Span(where.start, where.stop), order, system.ring_rod_flag))

    # tables

    @property
    def loading(self) -> int:
        """Where external loads other than planes on rods act: UNLOADED, SPARSE or DENSE."""
        collections = {name: each for name, each in vars(self).items() if isinstance(each, (list, dict, set))}
        if (
            any(each for name, each in collections.items() if name not in NO_LOADS)
            or self._dead_force.any()
            or self._dead_torque.any()
        ):
            return DENSE
        bodies = self._body_planes or self._body_force.any() or self._body_torque.any()
        return SPARSE if self._point_loads or self._joints or bodies else UNLOADED

    def build(self) -> Scene:
        """Return the tables."""
        waves = list(self._waves.items())
        keys = np.array([key for key, _ in waves]).reshape(len(waves), 5)
        spans = [(min(s.first for s in each), max(s.last for s in each)) for _, (_, _, each) in waves]
        places = [row[0] for row in self._point_loads] + [place for row in self._joints for place in (*row[0], *row[1])]
        rings = [(self._first[id(rod)], rod.n_elems) for rod in self._rods if rod.ring_rod_flag]
        return Scene(
            blocks=_spans(self._blocks()),
            rings=_table(Rings, rings, "i", "i"),
            touched=np.unique(np.array([place for place in places if place >= 0], dtype=np.int64)),
            point_loads=_table(PointLoads, self._point_loads, "i", "", "3", "3", "3", "3", ""),
            dead_loads=DeadLoads(
                bool(self._dead_force.any()),
                bool(self._dead_torque.any()),
                self._dead_force,
                self._dead_torque,
                self._body_force,
                self._body_torque,
            ),
            waves=Waves(
                axis=np.ascontiguousarray(keys[:, :3]),
                sine=self._stacked(sine for _, (sine, _, _) in waves),
                cosine=self._stacked(cosine for _, (_, cosine, _) in waves),
                angular_frequency=keys[:, 3].copy(),
                ramp_time=keys[:, 4].copy(),
            ),
            wave_span=_spans(spans),
            flows=Flows(
                _spans([span for span, _ in self._flows]), np.array([mu for _, mu in self._flows], dtype=np.float64)
            ),
            tensions=Tensions(
                _spans([span for span, _ in self._tensions]),
                np.array([is_closed for _, is_closed in self._tensions], dtype=np.bool_),
            ),
            drag=Drag(bool(self._drag_force.any() or self._drag_torque.any()), self._drag_force, self._drag_torque),
            joints=_table(Joints, self._joints, "i2", "i2", "", "", "", "3", "", "", "33"),
            sides=_table(Sides, self._sides, "i2", "", "", "", "23", ""),
            rod_contacts=self._rod_contact_table(),
            body_contacts=_table(BodyContacts, self._body_contacts, "i2", "i", "", "", "", ""),
            planes=plane_table([plane for plane, _ in self._planes]),
            plane_span=_spans([span for _, span in self._planes]),
            body_planes=plane_table([plane for plane, _, _ in self._body_planes]),
            grounded=np.array([body for _, body, _ in self._body_planes], dtype=np.int64),
            ground_friction=np.array([friction for _, _, friction in self._body_planes], dtype=np.float64),
            pins=_table(Pins, self._pins, "i", "", "3", "3", "3"),
            clamps=_table(Clamps, self._clamps, "i", "", "3", "3", "", "33"),
            decay=Decay(
                bool(self._node_rate.any() or self._element_rate.any()),
                bool(self._dilating_rate.any()),
                self._node_rate,
                self._element_rate,
                self._dilating_rate,
                aligned_zeros((self._slots,)),
                aligned_zeros((self._slots,)),
                bool(self._body_rate.any() or self._body_turn_rate.any()),
                self._body_rate,
                self._body_turn_rate,
            ),
            filters=Filters(
                _spans([span for span, _, _ in self._filters]),
                np.array([order for _, order, _ in self._filters], dtype=np.int64),
                np.array([is_closed for _, _, is_closed in self._filters], dtype=np.bool_),
            ),
        )

    def _blocks(self) -> list[_Span]:
        """Return spans of slots, each of as many rods as fit the cache; the last one is padded to whole blocks."""
        blocks: list[_Span] = []
        for first, end in pairwise([*self._starts.tolist(), self._end]):
            if blocks and end - blocks[-1].first <= CACHED:
                blocks[-1] = _Span(blocks[-1].first, end)
            else:
                blocks.append(_Span(first, end))
        return blocks

    def _rod_contact_table(self) -> RodContacts:
        rod_of = aligned_zeros((self._slots,), np.int64)
        last_other, last_clear = aligned_zeros((self._slots,)), aligned_zeros((self._slots,))
        pairs = sorted(self._rod_contacts)
        touching_themselves = {pair[0] for pair in pairs if pair[0] == pair[1]}
        for number, rod in enumerate(self._rods):
            nodes = self.nodes(rod)
            rod_of[nodes] = number
            last_other[nodes] = nodes.start - 1
            # adjacent elements never touch
            last_clear[nodes] = np.arange(nodes.start, nodes.stop) - 2 if number in touching_themselves else -1
        touching = [self._rods[number] for number in sorted({number for pair in pairs for number in pair[:2]})]
        spans = [self.elements(rod) for rod in touching]
        slots = np.array([slot for span in spans for slot in range(span.start, span.stop)], dtype=np.int64)
        return RodContacts(
            row=np.searchsorted([pair[0] for pair in pairs], np.arange(len(self._rods) + 1)).astype(np.int64),
            other=np.array([pair[1] for pair in pairs], dtype=np.int64),
            stiffness=np.array([pair[2] for pair in pairs], dtype=np.float64),
            damping=np.array([pair[3] for pair in pairs], dtype=np.float64),
            rod_of=rod_of,
            elements=slots,
            stray=STRAY * min((float(rod.radius.min()) for rod in touching), default=1.0),
            last_other=last_other,
            last_clear=last_clear,
            order=slots.copy(),
            neighbours=aligned_zeros((ROOM * slots.size,), np.int64),
            first=aligned_zeros((ROOM * slots.size,), np.int64),
        )

    def _stacked(self, rows: Any) -> Array:
        chosen = list(rows)
        table = aligned_zeros((len(chosen), self._slots))
        for target, row in zip(table, chosen, strict=True):
            target[:] = row
        return table


def _require_rod(system: Any) -> None:
    if not isinstance(system, RodBase):
        raise TypeError(f"this acts along a rod, not on a {type(system).__name__}")


def _require_open(rod: Any, what: str) -> None:
    if rod.ring_rod_flag:
        raise NotImplementedError(f"contact of a ring with a {what} is not supported")


def _index(what: str, index: int, count: int) -> int:
    if not -count <= index < count:
        raise IndexError(f"there is no {what} {index}; the system has {count}")
    return index % count


def _spans(rows: Sequence[tuple[int, int]]) -> Index:
    return np.array(rows, dtype=np.int64).reshape(len(rows), 2)


def _table(cls: Callable, rows: Sequence[tuple], *columns: str) -> Any:
    """Return a table of rows; a column is ``i`` for integers, then a digit for each dimension."""
    fields = []
    for position, column in enumerate(columns):
        shape = tuple(int(digit) for digit in column.removeprefix("i"))
        values = np.array([row[position] for row in rows], dtype=np.int64 if column.startswith("i") else np.float64)
        fields.append(np.ascontiguousarray(values.reshape(len(rows), *shape)))
    return cls(*fields)
