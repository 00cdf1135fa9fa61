"""A Cosserat rod with its attributes as arrays, under PyElastica's names."""

import inspect
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...engine.model import Array
from ...engine.rod import SHEAR_CORRECTION, as_count, as_number, as_numbers, require_not_negative, require_positive
from .._calculus import position_average, position_difference_kernel  # noqa: F401
from ..keywords import warn_of_unknown
from ..not_offered import refuse_names
from . import strain
from .in_place import (  # noqa: F401
    _compute_all_dilatations,
    _compute_bending_twist_strains,
    _compute_damping_forces,
    _compute_damping_torques,
    _compute_dilatation_rate,
    _compute_geometry_from_state,
    _compute_internal_bending_twist_stresses_from_model,
    _compute_internal_forces,
    _compute_internal_shear_stretch_stresses_from_model,
    _compute_internal_torques,
    _compute_shear_stretch_strains,
    _get_z_vector,
    _update_accelerations,
    _zeroed_out_external_forces_and_torques,
)
from .rod_base import RodBase

MATERIAL = (
    "rest_lengths",
    "rest_voronoi_lengths",
    "density",
    "volume",
    "mass",
    "mass_second_moment_of_inertia",
    "inv_mass_second_moment_of_inertia",
    "shear_matrix",
    "bend_matrix",
    "dissipation_constant_for_forces",
    "dissipation_constant_for_torques",
)
"""Attributes that a simulation reads when it is entered, stored contiguously."""

TOLERANCE = 1e-8
"""Tolerance of given positions, relative to the size of the rod, and of directors"""


class Field:
    """An array attribute that keeps its memory: assignment checks the shape and copies."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, rod: Any, owner: type | None = None) -> Any:
        return self if rod is None else rod._fields[self.name]

    def __set__(self, rod: Any, value: ArrayLike) -> None:
        target, given = rod._fields[self.name], np.asarray(value, dtype=np.float64)
        if given.shape not in (target.shape, ()):
            raise ValueError(f"{self.name} must have shape {target.shape}, not {given.shape}")
        target[...] = given


@dataclass(frozen=True)
class Lowered:
    """A rod's attributes under the names of `Continuum`, matrices reduced to their diagonals."""

    n_elements: int
    position: Array
    directors: Array
    radius: Array
    rest_kappa: Array
    rest_sigma: Array
    rest_length: Array
    rest_voronoi_length: Array
    shear_stiffness: Array
    bend_stiffness: Array
    nodal_mass: Array
    inv_nodal_mass: Array
    inertia: Array
    inv_inertia: Array
    viscosity: Array
    torque_viscosity: Array
    damping_rate: float = 0.0

    def closed(self) -> "Lowered":
        """Return an equivalent open rod of a ring, with its first element repeated at the end.

        That *image* has no stiffness, inertia or mass, so it has no effect and does not move; loads on it
        belong to the first element.
        """

        def again(values: Array, n: int = 1) -> Array:
            return np.concatenate([values, values[..., :n]], axis=-1)

        def nothing(values: Array, n: int = 1) -> Array:
            return np.concatenate([values, np.zeros_like(values[..., :n])], axis=-1)

        return Lowered(
            n_elements=self.n_elements + 1,
            position=again(self.position, 2),
            directors=again(self.directors),
            radius=again(self.radius),
            rest_kappa=self.rest_kappa,
            rest_sigma=again(self.rest_sigma),
            rest_length=again(self.rest_length),
            rest_voronoi_length=self.rest_voronoi_length,
            shear_stiffness=nothing(self.shear_stiffness),
            bend_stiffness=self.bend_stiffness,
            nodal_mass=again(self.nodal_mass, 2),
            inv_nodal_mass=nothing(self.inv_nodal_mass, 2),
            inertia=nothing(self.inertia),
            inv_inertia=nothing(self.inv_inertia),
            viscosity=nothing(self.viscosity),
            torque_viscosity=nothing(self.torque_viscosity),
        )

    def opened(self) -> "Lowered":
        """Return a ring cut open, for `stable_time_step`."""
        return replace(
            self, bend_stiffness=self.bend_stiffness[:, :-1], nodal_mass=np.append(self.nodal_mass, self.nodal_mass[0])
        )


class CosseratRod(RodBase):
    """A Cosserat rod of n elements; make one with `straight_rod` or `ring_rod`.

    The arrays below can be read, changed in place and assigned at any time. From `finalize` on, arrays
    of motion and rest strain are views of the simulation's memory; arrays of material are read
    whenever compiled code is entered: at the start of `integrate` and after callbacks.

    Attributes
    ----------
    n_elems, n_nodes : int
        Number of elements, n, and of nodes, n + 1 (n on a ring).
    position_collection, velocity_collection : Array
        Of nodes [m], [m/s], lab frame, (3, n + 1).
    director_collection : Array
        Rows d1, d2, d3 of each element, (3, 3, n).
    omega_collection : Array
        Angular velocity of elements [rad/s], material frame, (3, n).
    rest_sigma : Array
        Shear and stretch strain at rest, (3, n).
    rest_kappa : Array
        Curvature and twist at rest [1/m], (3, n - 1); on a ring (3, n).
    external_forces, external_torques : Array
        External loads on nodes [N], lab frame, (3, n + 1), and on elements [N m], material frame, (3, n).
        Loads added between steps act in the next step; they are cleared after each.
    rest_lengths, rest_voronoi_lengths : Array
        Rest lengths of elements, (n,), and between their centres, (n - 1,) [m].
    density, volume : Array
        Of elements [kg/m^3], [m^3], (n,).
    mass : Array
        Of nodes [kg], (n + 1,).
    mass_second_moment_of_inertia, inv_mass_second_moment_of_inertia : Array
        Of elements [kg m^2] and its inverse, diagonal, (3, 3, n).
    shear_matrix, bend_matrix : Array
        Stiffness of shear and stretch [N], (3, 3, n), and of bending and twist [N m^2], (3, 3, n - 1);
        diagonal.
    dissipation_constant_for_forces, dissipation_constant_for_torques : Array
        Damping ``nu`` of 0.2.x, (n,) [kg/(m s)], [kg m/s].
    lengths, tangents, radius, dilatation, dilatation_rate, voronoi_dilatation, sigma, kappa, internal_stress,
    internal_couple, internal_forces, internal_torques, damping_forces, damping_torques : Array
        Derived from the other attributes, computed when read. Values written to them are lost, as in PyElastica
        at the next step.
    acceleration_collection, alpha_collection : Array
        Accelerations of the last kick [m/s^2], [rad/s^2], computed when read.
    """

    REQUISITE_MODULES: ClassVar[list[type]] = []

    position_collection = Field()
    velocity_collection = Field()
    director_collection = Field()
    omega_collection = Field()
    rest_sigma = Field()
    rest_kappa = Field()
    external_forces = Field()
    external_torques = Field()
    rest_lengths = Field()
    rest_voronoi_lengths = Field()
    density = Field()
    volume = Field()
    mass = Field()
    mass_second_moment_of_inertia = Field()
    inv_mass_second_moment_of_inertia = Field()
    shear_matrix = Field()
    bend_matrix = Field()
    dissipation_constant_for_forces = Field()
    dissipation_constant_for_torques = Field()

    def __init__(
        self,
        *,
        position: Array,
        directors: Array,
        radius: Array,
        density: Array,
        youngs_modulus: float,
        shear_modulus: float,
        alpha_c: float,
        nu: float,
        nu_for_torques: float,
        rest_sigma: Array,
        rest_kappa: Array,
        is_ring: bool,
    ) -> None:
        n = directors.shape[2]
        self.n_elems, self.n_nodes, self.ring_rod_flag = n, position.shape[1], is_ring
        edges = _edges(position, is_ring)
        length = np.linalg.norm(edges, axis=0)
        area = np.pi * radius**2
        second_moment = np.outer([1.0, 1.0, 2.0], area**2 / (4.0 * np.pi))
        before, after = strain.between(length, is_ring)
        shear = np.outer([alpha_c * shear_modulus] * 2 + [youngs_modulus], area)
        bend = np.array([youngs_modulus, youngs_modulus, shear_modulus])[:, None] * second_moment * length
        inertia = density * length * second_moment
        element_mass = density * area * length
        self._fields: dict[str, Array] = {
            "position_collection": position,
            "velocity_collection": np.zeros_like(position),
            "director_collection": directors,
            "omega_collection": np.zeros((3, n)),
            "rest_sigma": rest_sigma,
            "rest_kappa": rest_kappa,
            "external_forces": np.zeros_like(position),
            "external_torques": np.zeros((3, n)),
            "net_forces": np.zeros_like(position),
            "net_torques": np.zeros((3, n)),
            "rest_lengths": length,
            "rest_voronoi_lengths": 0.5 * (before + after),
            "density": density,
            "volume": area * length,
            "mass": strain.quadrature(element_mass, is_ring),
            "mass_second_moment_of_inertia": _diagonal(inertia),
            "inv_mass_second_moment_of_inertia": _diagonal(1.0 / inertia),
            "shear_matrix": _diagonal(shear),
            "bend_matrix": _diagonal(np.add(*strain.between(bend, is_ring)) / (before + after)),
            "dissipation_constant_for_forces": np.full(n, nu),
            "dissipation_constant_for_torques": np.full(n, nu_for_torques),
        }

    @classmethod
    def straight_rod(
        cls,
        n_elements: int,
        start: ArrayLike,
        direction: ArrayLike,
        normal: ArrayLike,
        base_length: float,
        base_radius: ArrayLike,
        density: ArrayLike,
        nu: float | None = None,
        youngs_modulus: float | None = None,
        poisson_ratio: float | None = None,
        *,
        nu_for_torques: float | None = None,
        shear_modulus: float | None = None,
        alpha_c: float = SHEAR_CORRECTION,
        position: ArrayLike | None = None,
        directors: ArrayLike | None = None,
        rest_sigma: ArrayLike | None = None,
        rest_kappa: ArrayLike | None = None,
        **unknown: Any,
    ) -> Self:
        """Return a straight rod of equal elements, or one through given nodes.

        Unknown keywords are ignored as in PyElastica, but with a warning.

        Parameters
        ----------
        n_elements : int
            Number of elements n, at least 2.
        start : array_like
            First node [m], (3,).
        direction, normal : array_like
            Along the rod, and d1 perpendicular to it, of any length, (3,).
        base_length : float
            [m]
        base_radius, density : float or array_like
            [m], [kg/m^3]; one for all elements, or one each, (n,).
        nu, nu_for_torques : float
            Damping of 0.2.x: force per velocity and length [kg/(m s)], torque per angular velocity and
            length [kg m/s], default ``nu``. 1.0 has dampers instead.
        youngs_modulus, shear_modulus : float
            Y and G [Pa]. If omitted, G follows from ``poisson_ratio`` by the rule of 0.2.x, Y/(1 + ratio),
            with a ratio of 1/2 if ``nu`` is given; with neither, G is Y/3 as in 1.0.
        alpha_c : float
            Shear correction: the shear stiffness is alpha_c G A. An argument of 0.1.x and 0.2.x.
        position, directors : array_like
            Nodes [m], (3, n + 1), and directors, (3, 3, n), instead of a straight rod's.
        rest_sigma, rest_kappa : array_like
            Strains at rest, (3, n), and curvatures at rest [1/m], (3, n - 1); default zero.

        Raises
        ------
        ValueError, TypeError
            If an argument is invalid; the message names it, its value and the allowed ones.
        """
        warn_of_unknown("straight_rod", unknown, _keywords(cls.straight_rod))
        n_elements = as_count("n_elements", n_elements, 2)
        require_positive("base_length", base_length)
        tangent = _unit("direction", direction)
        first = _vector("start", start)[:, None]
        if position is None:
            nodes = first + base_length * tangent[:, None] * np.linspace(0.0, 1.0, n_elements + 1)
        else:
            nodes = _array("position", position, (3, n_elements + 1))
            if np.abs(nodes[:, :1] - first).max() > TOLERANCE * (base_length + np.abs(first).max()):
                raise ValueError(f"start must be the first node of position, {nodes[:, 0]}, not {first[:, 0]}")
        return cls._made(
            nodes,
            False,
            normal,
            base_radius,
            density,
            nu,
            youngs_modulus,
            poisson_ratio,
            nu_for_torques,
            shear_modulus,
            alpha_c,
            directors,
            rest_sigma,
            rest_kappa,
        )

    @classmethod
    def ring_rod(
        cls,
        n_elements: int,
        ring_center_position: ArrayLike,
        direction: ArrayLike,
        normal: ArrayLike,
        base_length: float,
        base_radius: ArrayLike,
        density: ArrayLike,
        nu: float | None = None,
        youngs_modulus: float | None = None,
        poisson_ratio: float | None = None,
        *,
        nu_for_torques: float | None = None,
        shear_modulus: float | None = None,
        alpha_c: float = SHEAR_CORRECTION,
        position: ArrayLike | None = None,
        directors: ArrayLike | None = None,
        rest_sigma: ArrayLike | None = None,
        rest_kappa: ArrayLike | None = None,
        **unknown: Any,
    ) -> Self:
        """Return a closed rod: a circle in the plane across ``normal``, or through given nodes.

        A ring of n elements has n nodes and n Voronoi points, so ``position`` and ``rest_kappa`` are
        (3, n). The first node lies along direction x normal from the centre, and the ring starts
        towards ``direction``. If ``rest_kappa`` or ``rest_sigma`` is zero throughout at ``finalize``,
        it is set to the ring's current strain. The other parameters are those of `straight_rod`.
        """
        warn_of_unknown("ring_rod", unknown, _keywords(cls.ring_rod))
        n_elements = as_count("n_elements", n_elements, 3)
        require_positive("base_length", base_length)
        if position is None:
            d, up = _unit("direction", direction)[:, None], _unit("normal", normal)[:, None]
            angle = 2.0 * np.pi * np.arange(n_elements) / n_elements
            spoke = np.cos(angle) * np.cross(d, up, axis=0) + np.sin(angle) * d
            nodes = _vector("ring_center_position", ring_center_position)[:, None]
            nodes = nodes + base_length / (2.0 * np.pi) * spoke
        else:
            nodes = _array("position", position, (3, n_elements))
        return cls._made(
            nodes,
            True,
            normal,
            base_radius,
            density,
            nu,
            youngs_modulus,
            poisson_ratio,
            nu_for_torques,
            shear_modulus,
            alpha_c,
            directors,
            rest_sigma,
            rest_kappa,
        )

    @classmethod
    def _made(
        cls,
        nodes: Array,
        is_ring: bool,
        normal: ArrayLike,
        radius: ArrayLike,
        density: ArrayLike,
        nu: float | None,
        youngs_modulus: float | None,
        poisson_ratio: float | None,
        nu_for_torques: float | None,
        shear_modulus: float | None,
        alpha_c: float,
        directors: ArrayLike | None,
        rest_sigma: ArrayLike | None,
        rest_kappa: ArrayLike | None,
    ) -> Self:
        """Check the arguments common to both constructors, and make the rod."""
        if youngs_modulus is None:
            raise TypeError("youngs_modulus is missing; give it in Pa")
        require_positive("youngs_modulus", youngs_modulus)
        edges = _edges(nodes, is_ring)
        n, joints = edges.shape[1], edges.shape[1] - (0 if is_ring else 1)
        require_positive("element length", float(np.linalg.norm(edges, axis=0).min()))
        G = _shear_modulus(youngs_modulus, shear_modulus, poisson_ratio, nu)
        force_nu = 0.0 if nu is None else nu
        torque_nu = force_nu if nu_for_torques is None else nu_for_torques
        require_positive("alpha_c", alpha_c)
        require_not_negative("nu", force_nu)
        require_not_negative("nu_for_torques", torque_nu)
        return cls(
            position=nodes,
            directors=_directors(edges, normal, directors),
            radius=_each("base_radius", radius, n),
            density=_each("density", density, n),
            youngs_modulus=float(youngs_modulus),
            shear_modulus=G,
            alpha_c=float(alpha_c),
            nu=force_nu,
            nu_for_torques=torque_nu,
            is_ring=is_ring,
            rest_sigma=np.zeros((3, n)) if rest_sigma is None else _array("rest_sigma", rest_sigma, (3, n)),
            rest_kappa=np.zeros((3, joints)) if rest_kappa is None else _array("rest_kappa", rest_kappa, (3, joints)),
        )

    # derived arrays

    @property
    def _edges(self) -> Array:
        """Vectors from node to node [m], (3, n)."""
        return _edges(self.position_collection, self.ring_rod_flag)

    @property
    def lengths(self) -> Array:  # noqa: D102
        return np.linalg.norm(self._edges, axis=0)

    @property
    def tangents(self) -> Array:  # noqa: D102
        edges = self._edges
        return edges / np.linalg.norm(edges, axis=0)

    @property
    def radius(self) -> Array:  # type: ignore[override]  # noqa: D102
        return np.sqrt(self.volume / (np.pi * self.lengths))

    @property
    def dilatation(self) -> Array:  # type: ignore[override]  # noqa: D102
        return self.lengths / self.rest_lengths

    @property
    def dilatation_rate(self) -> Array:  # noqa: D102
        rates = _edges(self.velocity_collection, self.ring_rod_flag)
        return (self._edges * rates).sum(axis=0) / (self.lengths * self.rest_lengths)

    @property
    def voronoi_dilatation(self) -> Array:  # noqa: D102
        length = 0.5 * np.add(*strain.between(self.lengths, self.ring_rod_flag))
        return length / self.rest_voronoi_lengths

    @property
    def sigma(self) -> Array:  # type: ignore[override]  # noqa: D102
        return strain.shear(self.director_collection, self._edges, self.rest_lengths)

    @property
    def kappa(self) -> Array:  # type: ignore[override]  # noqa: D102
        return strain.curvature(self.director_collection, self.rest_voronoi_lengths, self.ring_rod_flag)

    @property
    def internal_stress(self) -> Array:  # noqa: D102
        return strain.apply(self.shear_matrix, self.sigma - self.rest_sigma)

    @property
    def internal_couple(self) -> Array:  # noqa: D102
        return strain.apply(self.bend_matrix, self.kappa - self.rest_kappa)

    @property
    def internal_forces(self) -> Array:  # noqa: D102
        stress = strain.apply_transposed(self.director_collection, self.internal_stress / self.dilatation)
        return strain.difference(stress, self.ring_rod_flag)

    @property
    def internal_torques(self) -> Array:  # noqa: D102
        return strain.internal_torques(
            directors=self.director_collection,
            omega=self.omega_collection,
            edges=self._edges,
            edge_rates=_edges(self.velocity_collection, self.ring_rod_flag),
            rest_lengths=self.rest_lengths,
            stress=self.internal_stress,
            kappa=self.kappa,
            couple=self.internal_couple,
            voronoi_dilatation=self.voronoi_dilatation,
            rest_voronoi_lengths=self.rest_voronoi_lengths,
            inertia=self.mass_second_moment_of_inertia,
            is_ring=self.ring_rod_flag,
        )

    @property
    def damping_forces(self) -> Array:  # noqa: D102
        ends = self.velocity_collection if not self.ring_rod_flag else _closed(self.velocity_collection)
        force = self.dissipation_constant_for_forces * self.lengths * 0.5 * (ends[:, 1:] + ends[:, :-1])
        return strain.quadrature(force, self.ring_rod_flag)

    @property
    def damping_torques(self) -> Array:  # noqa: D102
        return self.dissipation_constant_for_torques * self.omega_collection * self.lengths

    @property
    def acceleration_collection(self) -> Array:  # noqa: D102
        return self._fields["net_forces"] / self.mass

    @property
    def alpha_collection(self) -> Array:  # noqa: D102
        alpha = strain.apply(self.inv_mass_second_moment_of_inertia, self._fields["net_torques"])
        return alpha * self.dilatation

    @property
    def ghost_elems_idx(self) -> NDArray[np.int32]:
        """Gaps between rods in a memory block; empty for a single rod, (0,)."""
        return np.zeros(0, dtype=np.int32)

    ghost_voronoi_idx = ghost_elems_idx

    # called by hand-written steps

    def compute_internal_forces_and_torques(self, time: float) -> None:
        """Do nothing: internal forces and torques are computed when read."""

    def update_accelerations(self, time: float, dt: float) -> None:
        """Set the accelerations from internal loads, the damping ``nu`` and external loads."""
        forces, torques = self._fields["net_forces"], self._fields["net_torques"]
        forces[:] = self.internal_forces - self.damping_forces + self.external_forces
        torques[:] = self.internal_torques - self.damping_torques + self.external_torques

    def zeroed_out_external_forces_and_torques(self, time: float) -> None:
        """Clear the external loads."""
        self.external_forces[:] = 0.0
        self.external_torques[:] = 0.0

    # interface to the simulation

    def _rest_as_built(self) -> None:
        """Set zero rest strains of a ring to its current ones: a ring at rest has curvature."""
        if self.ring_rod_flag and not self.rest_sigma.any():
            self.rest_sigma[:] = self.sigma
        if self.ring_rod_flag and not self.rest_kappa.any():
            self.rest_kappa[:] = self.kappa

    def as_continuum(self) -> Lowered:
        """Return the rod as a `Continuum`, a ring cut open."""
        return self._lowered().opened() if self.ring_rod_flag else self._lowered()

    def _lowered(self) -> Lowered:
        """Return the attributes that a Model needs.

        Raises
        ------
        ValueError
            If a matrix is not diagonal, or a value that must be positive is not.
        """
        for name in ("rest_lengths", "rest_voronoi_lengths", "volume", "mass"):
            require_positive(f"smallest of {name}", float(getattr(self, name).min()))
        return Lowered(
            n_elements=self.n_elems,
            position=self.position_collection,
            directors=self.director_collection,
            radius=np.sqrt(self.volume / (np.pi * self.rest_lengths)),
            rest_kappa=self.rest_kappa,
            rest_sigma=self.rest_sigma,
            rest_length=self.rest_lengths,
            rest_voronoi_length=self.rest_voronoi_lengths,
            shear_stiffness=_diagonal_of("shear_matrix", self.shear_matrix),
            bend_stiffness=_diagonal_of("bend_matrix", self.bend_matrix),
            nodal_mass=self.mass,
            inv_nodal_mass=1.0 / self.mass,
            inertia=_diagonal_of("mass_second_moment_of_inertia", self.mass_second_moment_of_inertia),
            inv_inertia=_diagonal_of("inv_mass_second_moment_of_inertia", self.inv_mass_second_moment_of_inertia),
            viscosity=self.dissipation_constant_for_forces,
            torque_viscosity=self.dissipation_constant_for_torques,
        )

    def _move(self, memory: dict[str, Array]) -> None:
        """Copy fields to other memory and use it from now on."""
        for name, target in memory.items():
            target[...] = self._fields[name]
        self._fields = {**self._fields, **memory}


def _keywords(constructor: Callable) -> list[str]:
    parameters = inspect.signature(constructor).parameters.values()
    return [p.name for p in parameters if p.kind is not p.VAR_KEYWORD]


def _closed(values: Array) -> Array:
    return np.concatenate([values, values[..., :1]], axis=-1)


def _edges(position: Array, is_ring: bool) -> Array:
    return np.diff(_closed(position) if is_ring else position, axis=1)


def _diagonal(rows: Array) -> Array:
    """Return diagonal matrices, (3, n) to (3, 3, n)."""
    return np.eye(3)[:, :, None] * rows[:, None, :]


def _diagonal_of(name: str, matrices: Array) -> Array:
    rows = np.einsum("iik->ik", matrices)
    if np.count_nonzero(matrices) > np.count_nonzero(rows):
        raise ValueError(f"{name} must be diagonal for each element; off-diagonal entries are not supported")
    return rows


def _shear_modulus(Y: float, G: float | None, poisson_ratio: float | None, nu: float | None) -> float:
    if G is not None:
        require_positive("shear_modulus", G)
        return float(G)
    if poisson_ratio is None and nu is None:
        return Y / 3.0
    ratio = 0.5 if poisson_ratio is None else poisson_ratio
    if not as_number("poisson_ratio", ratio) > -1.0:
        raise ValueError(f"poisson_ratio must be above -1, not {ratio}")
    return Y / (1.0 + ratio)


def _directors(edges: Array, normal: ArrayLike, directors: ArrayLike | None) -> Array:
    """Return given directors after checks, or directors with d3 along the elements and d1 along ``normal``."""
    n = edges.shape[1]
    tangents = edges / np.linalg.norm(edges, axis=0)
    if directors is not None:
        Q = _array("directors", directors, (3, 3, n))
        off = np.abs(np.einsum("ijk,ljk->ilk", Q, Q) - np.eye(3)[:, :, None]).max()
        if off > TOLERANCE or (np.linalg.det(Q.T) < 0.0).any():
            raise ValueError(
                f"directors must be right-handed orthonormal rows d1, d2, d3; their products are off by {off:.3g}"
            )
        return Q
    d1 = np.repeat(_unit("normal", normal)[:, None], n, axis=1)
    slant = np.abs((d1 * tangents).sum(axis=0)).max()
    if slant > TOLERANCE:
        raise ValueError(f"normal must be perpendicular to the rod; the cosine between them is {slant:.3g}")
    return np.stack([d1, np.cross(tangents, d1, axis=0), tangents])


def _each(name: str, value: ArrayLike, n: int) -> Array:
    values = as_numbers(name, value)
    if values.shape not in ((), (1,), (n,)):
        raise ValueError(f"{name} must be one number or {n}, one per element; its shape is {values.shape}")
    require_positive(f"smallest {name}", float(values.min()))
    return np.broadcast_to(values, (n,)).copy()


def _array(name: str, value: ArrayLike, shape: tuple[int, ...]) -> Array:
    array = np.array(as_numbers(name, value), order="C")
    if array.shape != shape:
        raise ValueError(f"{name} must have shape {shape}, not {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, but has {int((~np.isfinite(array)).sum())} non-finite entries")
    return array


def _vector(name: str, value: ArrayLike) -> Array:
    return _array(name, np.ravel(as_numbers(name, value)), (3,))


def _unit(name: str, value: ArrayLike) -> Array:
    vector = _vector(name, value)
    size = float(np.linalg.norm(vector))
    require_positive(f"length of {name}", size)
    return vector / size


__getattr__ = refuse_names(__name__)
