"""The largest stable time step for the declared rods, joints, contacts, planes, and drag.

Position Verlet with springs K and dampers C on masses M is stable while dt^2 K + 2 dt C < 4 M. Contact springs act
only in contact, and rods stiffen each other, so each limit here is for a single spring and damper on the masses that
it moves: above it, a scene is certainly unstable once these are in contact; below the smallest, a scene may still be
unstable where several act together.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .model import Array, Index, Joints, Model, Planes
from .scene import BodyContacts, Drag, Flows, RodContacts, Scene, Sides

SOMEWHAT = 0.5
"""Quantile of a rod's elements that sets the limit of a contact: in a tapered rod, some are far lighter than others"""


class Limit(NamedTuple):
    """A time step above which something is unstable."""

    time_step: float
    """[s]"""
    culprit: str
    """What is unstable, and of which systems"""


def largest_step(squared_frequency: ArrayLike, damping_rate: ArrayLike) -> float:
    """Return the largest stable step of a spring K/M [1/s^2] and a damper C/M [1/s], or the smallest of several [s]."""
    K, C = np.asarray(squared_frequency, dtype=np.float64), np.asarray(damping_rate, dtype=np.float64)
    root = C + np.sqrt(C**2 + 4.0 * K)
    return float(4.0 / root.max()) if root.size and root.max() > 0.0 else np.inf


def limits(
    model: Model, scene: Scene | None = None, rods: Sequence[str] = (), bodies: Sequence[str] = ()
) -> list[Limit]:
    """Return the limits of everything that acts on the rods and bodies of a model, except those of the rods themselves.

    Parameters
    ----------
    model : Model
    scene : Scene, optional
        The library's additions to it.
    rods, bodies : sequence of str, optional
        Their names in the limits' culprits; numbers unless given.
    """
    masses = _Masses(model, rods, bodies)
    everywhere = np.full((model.planes.stiffness.size, 2), (0, model.mass.size))
    found = [*_viscosity(masses), *_planes(masses, model.planes, everywhere), *_joints(masses, model.joints)]
    if model.rod_contact.is_on:
        law, every = model.rod_contact, range(model.first_slot.size)
        found += _rods(masses, [(i, j, law.stiffness, law.damping) for i in every for j in every[i:]])
    if scene is None:
        c, every = model.cylinders, range(model.cylinders.mass.size)
        found += [
            _touch(masses, rod, b, c.rod_stiffness[b], c.rod_damping[b])
            for b in every
            for rod in range(model.first_slot.size)
        ]
        if model.planes.stiffness.size:
            found += [_ground(masses, b, c.ground_stiffness[b], c.ground_damping[b]) for b in every]
        return found
    found += _planes(masses, scene.planes, scene.plane_span)
    found += _rods(masses, _pairs(scene.rod_contacts))
    found += _bodies(masses, scene.body_contacts)
    planes = scene.body_planes
    found += [_ground(masses, int(b), planes.stiffness[j], planes.damping[j]) for j, b in enumerate(scene.grounded)]
    found += [*_joints(masses, scene.joints), *_sides(masses, scene.sides)]
    return [*found, *_drag(masses, scene.drag), *_flows(masses, model, scene.flows)]


class _Masses:
    """Inverse masses and inertias of nodes, elements and bodies, by place."""

    def __init__(self, model: Model, rods: Sequence[str], bodies: Sequence[str]) -> None:
        self.model = model
        self.rod_names = list(rods) or [f"rod {number}" for number in range(model.first_slot.size)]
        self.body_names = list(bodies) or [f"body {number}" for number in range(model.cylinders.mass.size)]
        inverse = model.inv_mass
        # a force on an element acts half on each of its nodes
        self.element = np.append(0.25 * (inverse[1:] + inverse[:-1]), 0.0)
        spans = zip(model.first_slot.tolist(), model.n_elements.tolist(), strict=True)
        self.rods = [slice(first, first + n) for first, n in spans]
        self.of_nodes, self.of_elements = (
            [float(np.quantile(values[here], SOMEWHAT)) for here in self.rods] for values in (inverse, self.element)
        )

    def node(self, place: int) -> float:
        """Return 1/m of a node or a body [1/kg]."""
        return float(self.model.inv_mass[place] if place >= 0 else 1.0 / self.model.cylinders.mass[-1 - place])

    def total(self, elements: slice) -> float:
        """Return the mass of a rod with these elements [kg]."""
        return float(np.sum(self.model.mass[elements.start : elements.stop + 1]))

    def turn(self, place: int) -> Array:
        """Return the diagonal of 1/J of an element or a body [1/(kg m^2)], (3,)."""
        bodies = self.model.cylinders.inertia
        return self.model.inv_inertia[:, place] if place >= 0 else 1.0 / bodies[-1 - place]

    def rod(self, place: int) -> int:
        """Return the rod that a slot belongs to."""
        return int(np.searchsorted(self.model.first_slot, place, side="right")) - 1

    def name(self, place: int) -> str:
        """Return the name of the rod or the body at a place."""
        return self.rod_names[self.rod(place)] if place >= 0 else self.body_names[-1 - place]


def _viscosity(masses: _Masses) -> Iterator[Limit]:
    """Yield the limits of rods' own viscosity: of rotation with its elastic stiffness, of translation alone."""
    m = masses.model
    for number, span in enumerate(masses.rods if m.is_viscous else ()):
        # the image of a ring's first element has no inertia
        here = slice(span.start, span.start + int(np.count_nonzero(m.inertia[0, span])))
        length, nu = m.rest_length[here], m.viscosity[:, here]
        bend = np.maximum(m.bend[:, here], m.bend[:, here.start - 1 : here.stop - 1]) / length**2
        stiff = 4.0 * (bend + np.outer([0.25, 0.25, 0.0], np.ones_like(length)) * m.shear[:, here])
        inertia = m.inertia[:, here] / length
        spin = largest_step(stiff / inertia, nu[1] / inertia)
        motion = largest_step(0.0, np.sum(nu[0] * length) / masses.total(here))
        yield Limit(min(spin, motion), f"the viscosity of {masses.rod_names[number]}")


def _planes(masses: _Masses, planes: Planes, spans: Index) -> Iterator[Limit]:
    """Yield the limits of planes that whole rods lie on: each node carries the stiffness of an element."""
    for j, (first, last) in enumerate(spans):
        for rod, start in enumerate(masses.model.first_slot):
            if first <= start < last:
                inverse = masses.of_nodes[rod]
                step = largest_step(planes.stiffness[j] * inverse, planes.damping[j] * inverse)
                yield Limit(step, f"contact of {masses.rod_names[rod]} with a plane")


def _pairs(contacts: RodContacts) -> list[tuple[int, int, float, float]]:
    """Return the two rods of each contact between rods, and its stiffness and damping."""
    first = np.repeat(np.arange(contacts.row.size - 1), np.diff(contacts.row))
    return list(
        zip(
            first.tolist(), contacts.other.tolist(), contacts.stiffness.tolist(), contacts.damping.tolist(), strict=True
        )
    )


def _rods(masses: _Masses, pairs: list[tuple[int, int, float, float]]) -> Iterator[Limit]:
    for one, two, k, nu in pairs:
        inverse = masses.of_elements[one] + masses.of_elements[two]
        what = "itself" if one == two else masses.rod_names[two]
        yield Limit(largest_step(k * inverse, nu * inverse), f"contact of {masses.rod_names[one]} with {what}")


def _touch(masses: _Masses, rod: int, body: int, k: float, nu: float) -> Limit:
    inverse = masses.of_elements[rod] + masses.node(-1 - body)
    culprit = f"contact of {masses.rod_names[rod]} with {masses.body_names[body]}"
    return Limit(largest_step(k * inverse, nu * inverse), culprit)


def _bodies(masses: _Masses, contacts: BodyContacts) -> Iterator[Limit]:
    """Yield the limits of contact with rigid bodies, along the normal and, with friction, along the surface."""
    for j, body in enumerate(contacts.body.tolist()):
        rod = masses.rod(int(contacts.span[j, 0]))
        yield _touch(masses, rod, body, contacts.stiffness[j], contacts.damping[j])
        if contacts.friction[j] > 0.0:
            rubs = _touch(masses, rod, body, 0.0, contacts.slip_damping[j])
            yield rubs._replace(culprit=f"friction of {masses.rod_names[rod]} on {masses.body_names[body]}")


def _ground(masses: _Masses, body: int, k: float, nu: float) -> Limit:
    """Return the limit of a body that lies on a plane, on a point of each rim."""
    inverse = 2.0 * masses.node(-1 - body)
    return Limit(largest_step(k * inverse, nu * inverse), f"contact of {masses.body_names[body]} with a plane")


def _joints(masses: _Masses, joints: Joints) -> Iterator[Limit]:
    """Yield the limits of joints along and about their axes, and of all joints at one place together."""
    at: dict[int, list[float]] = {}
    for j, (one, two) in enumerate(joints.node.tolist()):
        k, nu = float(joints.stiffness[j]), float(joints.damping[j])
        inverse = masses.node(one) + masses.node(two)
        culprit = f"a joint of {masses.name(one)} and {masses.name(two)}"
        yield Limit(largest_step(k * inverse, nu * inverse), culprit)
        for place in (one, two):
            total = at.setdefault(place, [0.0, 0.0, 0.0])
            total[0], total[1], total[2] = total[0] + k, total[1] + nu, total[2] + 1
        kt, nut, hinge = joints.turn_stiffness[j], joints.turn_damping[j], joints.hinge_stiffness[j]
        if kt > 0.0 or nut > 0.0 or hinge > 0.0:
            a, b = (np.sort(masses.turn(place)) for place in joints.element[j].tolist())
            # in any orientation, the planes of their two lightest axes intersect in a line
            gives = max(a[1] + b[1], a[2] + b[0], a[0] + b[2])
            yield Limit(largest_step(kt * gives, nut * gives), f"the torque of {culprit}")
            yield Limit(largest_step(hinge * (a[0] + b[0]), 0.0), f"the torque of {culprit}")
    for place, (k, nu, count) in at.items():
        if count > 1:
            inverse = masses.node(place)
            yield Limit(largest_step(k * inverse, nu * inverse), f"the joints of {masses.name(place)}")


def _sides(masses: _Masses, sides: Sides) -> Iterator[Limit]:
    for j, (one, two) in enumerate(sides.element.tolist()):
        inverse = float(masses.element[one] + masses.element[two])
        yield Limit(
            largest_step(sides.stiffness[j] * inverse, sides.damping[j] * inverse),
            f"a joint of {masses.name(one)} and {masses.name(two)}",
        )


def _drag(masses: _Masses, drag: Drag) -> Iterator[Limit]:
    """Yield the limits of drag on nodes and elements."""
    if drag.is_on:
        rates = np.maximum(drag.force * masses.model.inv_mass, drag.torque * masses.model.inv_inertia.max(axis=0))
        yield Limit(largest_step(0.0, rates), f"the drag of RayleighDissipation on {masses.name(int(rates.argmax()))}")


def _flows(masses: _Masses, model: Model, flows: Flows) -> Iterator[Limit]:
    """Yield the limits of the drag of fluids on slender rods, across them."""
    for (first, last), viscosity in zip(flows.span.tolist(), flows.viscosity.tolist(), strict=True):
        here = slice(first, last)
        length = model.rest_length[here]
        slender = np.log(length.sum() / (model.volume_root[here] / np.sqrt(length)))
        drag = 4.0 * np.pi * viscosity * np.sum(length / slender)
        yield Limit(largest_step(0.0, drag / masses.total(here)), f"the drag of the fluid on {masses.name(first)}")


def require_stable_model(model: Model, time_step: float) -> None:
    """Raise ValueError unless ``time_step`` [s] is below every limit of what acts on a model's rods and bodies."""
    bound, culprit = min(limits(model), default=Limit(np.inf, "nothing"))
    if not time_step < bound:
        raise ValueError(f"the time step must be below {bound:.4g} s for {culprit} to be stable, not {time_step:g} s")
