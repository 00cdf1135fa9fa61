"""The energy budget: the work of each kind of load, step by step.

A kick changes the kinetic energy by dt F . (v + v')/2 + dt T . (w + w')/2, with v and v' the velocities before and
after it, to rounding. So the net load of a step, split by kind, gives the work of each kind. To split it, the step is
repeated with one kind after another removed: each load is the difference between a step with it and one without.
"""

from collections.abc import Callable, Iterator
from copy import deepcopy
from typing import NamedTuple, TypeVar

import numpy as np

from .builder import inverse
from .kernels.step import advance
from .model import Array, Control, Cylinders, Index, Model, Planes, State, make_state
from .threads import Team

Table = TypeVar("Table", Planes, Cylinders)


class Energy(NamedTuple):
    """Energy of rods and free cylinders by kind, summed over each environment [J], (B,) each."""

    translational: Array
    """sum m v^2/2"""
    rotational: Array
    """sum w.J w/(2 e)"""
    shear: Array
    """sum (sigma - sigma^).S (sigma - sigma^) l^/2, divided by e if the internal loads derive from a potential"""
    bending: Array
    """sum (kappa - kappa^).B (kappa - kappa^) D^/2, divided by E^3 if the internal loads derive from a potential"""
    gravitational: Array
    """-sum m g.x"""

    @property
    def elastic(self) -> Array:
        """Elastic energy [J], (B,)."""
        return self.shear + self.bending

    @property
    def total(self) -> Array:
        """Sum of all kinds [J], (B,)."""
        return sum(self, np.zeros_like(self.shear))


def energy(model: Model, state: State, control: Control) -> Energy:
    """Return the energy of every environment (Gazzola et al. 2018, section 2), at the State's positions.

    Parameters
    ----------
    model : Model
    state : State
    control : Control
    """
    current = _at(model, state, control)
    inv_e = inverse(current.length * model.inv_rest_length)
    neighbours = current.length + np.roll(current.length, -1, axis=1)
    inv_E = 2.0 * model.rest_voronoi_length * inverse(neighbours)
    stretched, lengthened = (inv_e, inv_E**3) if model.is_reciprocal else (np.ones_like(inv_e), np.ones_like(inv_E))
    dx = np.diff(state.x, axis=2, append=0.0)
    sigma = np.einsum("bijk,bjk->bik", state.Q, dx) * model.inv_rest_length - control.rest_sigma
    sigma[:, 2] -= 1.0
    kappa = current.kappa - control.rest_kappa
    bodies, g = model.cylinders, model.gravity
    return Energy(
        translational=0.5
        * (np.einsum("k,bik->b", model.mass, state.v**2) + np.einsum("c,bci->b", bodies.mass, state.body_v**2)),
        rotational=0.5
        * (
            np.einsum("ik,bik,bk->b", model.inertia, state.w**2, inv_e)
            + np.einsum("ci,bci->b", bodies.inertia, state.body_w**2)
        ),
        shear=0.5 * np.einsum("ik,bik,k,bk->b", model.shear, sigma**2, model.rest_length, stretched),
        bending=0.5 * np.einsum("ik,bik,k,bk->b", model.bend, kappa**2, model.rest_voronoi_length, lengthened),
        gravitational=-(
            np.einsum("k,i,bik->b", model.mass, g, state.x) + np.einsum("c,i,bci->b", bodies.mass, g, state.body_x)
        ),
    )


class Ledger:
    """The work of each kind of load on a batch as it advances: a `Team` of one thread, about ten times slower.

    Parameters
    ----------
    model : Model
    state : State
    control : Control

    Attributes
    ----------
    work : dict of str to Array
        Work since the beginning by kind [J], (B,) each: ``muscles``; ``gravity``; ``damping`` of the rods; of contact
        among rods and between rods and cylinders ``contact friction``, ``contact damping`` and ``contact spring``; of
        planes, on rods and cylinders, ``ground friction``, ``ground damping``, ``ground spring`` and
        ``ground reaction``, which cancels forces into them; ``internal``: of stress and of the transport of spin.
    start : Energy
        Energy at the beginning.
    """

    def __init__(self, model: Model, state: State, control: Control) -> None:
        self.model, self.state, self.control = model, state, control
        self._team = Team(model, state, control, 1)
        self._shadow = make_state(model, state.time.size)
        self._teams = {name: Team(variant, self._shadow, control, 1) for name, variant in _without(model)}
        self.start = energy(model, state, control)
        self.work = {name: np.zeros(state.time.size) for name in (*self._teams, "internal")}

    def advance(self, n_envs: int, dt: float, n_substeps: int, then: Callable[[Index], None] | None = None) -> None:
        """Advance all environments, as `Team.advance` does, and add up the work."""
        for _ in range(n_substeps):
            self._step(n_envs, dt)
        if then is not None:
            then(np.arange(n_envs))

    def _step(self, n_envs: int, dt: float) -> None:
        model, state, shadow = self.model, self.state, self._shadow
        before = {name: getattr(state, name).copy() for name in _MOVING}
        self._team.advance(n_envs, dt, 1)
        kept = state.decay[:, None]
        velocities = [
            0.5 * (a / b + before[name])
            for name, a, b in (
                ("v", state.v, kept),
                ("w", state.w, kept),
                ("body_v", state.body_v, 1.0),
                ("body_w", state.body_w, 1.0),
            )
        ]
        power = _power(state, velocities)
        for name, team in self._teams.items():
            for field, value in before.items():
                getattr(shadow, field)[...] = value
            team.advance(n_envs, dt, 1)
            without = _power(shadow, velocities)
            self.work[name] += dt * (power - without)
            power = without
        self.work["internal"] += dt * power
        # uniform damping is not a load: it scales the velocities after the kick
        lost, e_inv = 0.5 * (1.0 - kept**-2), inverse(state.length * model.inv_rest_length)
        self.work["damping"] += np.einsum("k,bik->b", model.mass, lost * state.v**2)
        self.work["damping"] += np.einsum("ik,bik,bk->b", model.inertia, lost * state.w**2, e_inv)

    @property
    def imbalance(self) -> Array:
        """Energy created by the rods' internal loads since the beginning [J], (B,).

        It is their work plus the increase of elastic energy: 0 for loads that derive from that energy.
        """
        return self.work["internal"] + energy(self.model, self.state, self.control).elastic - self.start.elastic


# the fields a step starts from; neighbour lists are checked against the positions
_MOVING = ("x", "v", "Q", "w", "couple", "time", "step", "body_x", "body_v", "body_Q", "body_w", "body_contact")


def _without(model: Model) -> Iterator[tuple[str, Model]]:
    """Yield each kind of load, with the model without it and all earlier ones."""
    planes, cylinders, contact = model.planes, model.cylinders, model.rod_contact
    planes, cylinders = _zeroed(planes, "_friction"), _zeroed(cylinders, "ground_friction")
    yield "ground friction", model._replace(planes=planes, cylinders=cylinders)
    planes, cylinders = _zeroed(planes, "damping"), _zeroed(cylinders, "ground_damping")
    yield "ground damping", model._replace(planes=planes, cylinders=cylinders)
    planes, cylinders = _zeroed(planes, "stiffness"), _zeroed(cylinders, "ground_stiffness")
    yield "ground spring", model._replace(planes=planes, cylinders=cylinders)
    model = model._replace(planes=Planes(*(column[:0] for column in planes)))
    yield "ground reaction", model._replace(cylinders=cylinders)
    cylinders, contact = _zeroed(cylinders, "rod_friction"), contact._replace(friction=0.0)
    yield "contact friction", model._replace(cylinders=cylinders, rod_contact=contact)
    cylinders, contact = _zeroed(cylinders, "rod_damping"), contact._replace(damping=0.0)
    yield "contact damping", model._replace(cylinders=cylinders, rod_contact=contact)
    cylinders, contact = _zeroed(cylinders, "rod_stiffness"), contact._replace(is_on=False)
    model = model._replace(cylinders=cylinders, rod_contact=contact)
    yield "contact spring", model
    yield "damping", (model := model._replace(is_viscous=False))
    yield "muscles", (model := model._replace(is_muscular=False))
    yield "gravity", model._replace(gravity=np.zeros(3))


def _zeroed(table: Table, ending: str) -> Table:
    """Return a table with zeros in the columns whose names end with ``ending``."""
    return table._replace(**{n: np.zeros_like(getattr(table, n)) for n in table._fields if n.endswith(ending)})


def _power(state: State, velocities: list[Array]) -> Array:
    """Return the power of the net loads of a step at given v, w, and those of bodies, (B,)."""
    loads = state.force, state.torque, state.body_force, state.body_torque
    return sum(((f * u).sum(axis=(1, 2)) for f, u in zip(loads, velocities, strict=True)), np.zeros(state.time.size))


def _at(model: Model, state: State, control: Control) -> State:
    """Return a copy of the State with length and curvature at its positions; after a step they lag half a step."""
    copy = deepcopy(state)
    advance(model, copy, control, 0, state.time.size, 0.0, 1)
    return copy
