"""A rod as a user describes it: geometry, material and rest shape, before it becomes part of a Model."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .model import Array

# shear correction of a circular section (Kaneko 1975) at Poisson ratio 1/2
SHEAR_CORRECTION = 27.0 / 28.0


class Continuum(Protocol):
    """The attributes of a rod that a Model needs, as described in `Rod`."""

    @property
    def n_elements(self) -> int: ...  # noqa: D102
    @property
    def position(self) -> Array: ...  # noqa: D102
    @property
    def directors(self) -> Array: ...  # noqa: D102
    @property
    def radius(self) -> Array: ...  # noqa: D102
    @property
    def rest_kappa(self) -> Array: ...  # noqa: D102
    @property
    def rest_sigma(self) -> Array: ...  # noqa: D102
    @property
    def rest_length(self) -> Array: ...  # noqa: D102
    @property
    def rest_voronoi_length(self) -> Array: ...  # noqa: D102
    @property
    def shear_stiffness(self) -> Array: ...  # noqa: D102
    @property
    def bend_stiffness(self) -> Array: ...  # noqa: D102
    @property
    def nodal_mass(self) -> Array: ...  # noqa: D102
    @property
    def inv_nodal_mass(self) -> Array: ...  # noqa: D102
    @property
    def inertia(self) -> Array: ...  # noqa: D102
    @property
    def inv_inertia(self) -> Array: ...  # noqa: D102
    @property
    def damping_rate(self) -> float: ...  # noqa: D102
    @property
    def viscosity(self) -> float | Array: ...  # noqa: D102
    @property
    def torque_viscosity(self) -> float | Array: ...  # noqa: D102


@dataclass(frozen=True, kw_only=True)
class Rod:
    """A Cosserat rod of circular section with n elements.

    Attributes
    ----------
    position : Array
        Nodes [m], (3, n + 1). Element lengths at rest are the distances between them.
    directors : Array
        Rows d1 (normal), d2, d3 (tangent) of each element, (3, 3, n).
    radius : Array
        Radius at rest [m], (n,).
    density : float
        [kg/m^3]
    youngs_modulus : float
        Y [Pa]
    shear_modulus : float
        G [Pa]
    damping_rate : float
        Uniform damping c of velocity and angular velocity [1/s].
    viscosity : float
        The documented damping nu, a force per velocity and length [kg/(m s)].
    torque_viscosity : float
        Its counterpart for rotation, a torque per angular velocity and length [kg m/s].
    rest_kappa : Array
        Curvature and twist at rest [1/m], (3, n - 1).
    rest_sigma : Array
        Shear and stretch strain at rest, (3, n).

    Raises
    ------
    ValueError
        If an argument is invalid; names it, its value and what is allowed.
    """

    position: Array
    directors: Array
    radius: Array
    density: float
    youngs_modulus: float
    shear_modulus: float
    damping_rate: float = 0.0
    viscosity: float = 0.0
    torque_viscosity: float = 0.0
    rest_kappa: Array = field(default_factory=lambda: np.zeros((3, 0)))
    rest_sigma: Array = field(default_factory=lambda: np.zeros((3, 0)))

    def __post_init__(self) -> None:
        position = _array("position", self.position, (3, None))
        n = position.shape[1] - 1
        if n < 2:
            raise ValueError(f"position has {n + 1} nodes, so the rod has {max(n, 0)} elements; at least 2 are needed")
        checked = {
            "position": position,
            "directors": _array("directors", self.directors, (3, 3, n)),
            "radius": _array("radius", np.full(n, self.radius) if np.ndim(self.radius) == 0 else self.radius, (n,)),
            "rest_kappa": _array("rest_kappa", _or_zeros(self.rest_kappa, n - 1), (3, n - 1)),
            "rest_sigma": _array("rest_sigma", _or_zeros(self.rest_sigma, n), (3, n)),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        require_positive("element length", float(self.rest_length.min()))
        require_positive("radius", float(self.radius.min()))
        for name in ("density", "youngs_modulus", "shear_modulus"):
            require_positive(name, getattr(self, name))
        for name in ("damping_rate", "viscosity", "torque_viscosity"):
            require_not_negative(name, getattr(self, name))
        gram = np.einsum("ijk,ljk->ilk", self.directors, self.directors) - np.eye(3)[:, :, None]
        if np.abs(gram).max() > 1e-9 or (np.linalg.det(self.directors.T) < 0.0).any():
            raise ValueError(
                "directors must be right-handed orthonormal rows d1, d2, d3; "
                f"their products are off by {np.abs(gram).max():.3g}"
            )

    @classmethod
    def straight(
        cls,
        n_elements: int,
        *,
        start: ArrayLike,
        direction: ArrayLike,
        normal: ArrayLike,
        length: float,
        radius: float | Array,
        **material: Any,
    ) -> "Rod":
        """Return a straight rod of equal elements.

        Parameters
        ----------
        n_elements : int
            Number of elements n, at least 2.
        start : array_like
            First node [m], (3,).
        direction : array_like
            From the first node to the last; of any length, (3,).
        normal : array_like
            d1, perpendicular to ``direction``; of any length, (3,).
        length : float
            [m]
        radius : float or Array
            One for all elements or one each [m].
        **material
            The remaining attributes of `Rod`.
        """
        n_elements = as_count("n_elements", n_elements, 2)
        require_positive("length", length)
        tangent = _unit("direction", direction)
        nodes = _array("start", start, (3,))[:, None] + length * tangent[:, None] * np.linspace(0, 1, n_elements + 1)
        return cls.through(nodes, normal=normal, radius=radius, **material)

    @classmethod
    def through(cls, position: ArrayLike, *, normal: ArrayLike, radius: ArrayLike, **material: Any) -> "Rod":
        """Return a rod through given nodes, its d1 as close to ``normal`` as its tangents allow.

        Its rest curvature is zero unless passed as ``rest_kappa``; without it, a kinked or curved rod straightens.

        Raises
        ------
        ValueError
            If an element is parallel to ``normal``.
        """
        nodes = _array("position", position, (3, None))
        tangents = np.diff(nodes, axis=1)
        tangents /= np.linalg.norm(tangents, axis=0)
        up = _unit("normal", normal)[:, None]
        d1 = up - tangents * (up * tangents).sum(axis=0)
        size = np.linalg.norm(d1, axis=0)
        if size.min() < 1e-6:
            raise ValueError(
                f"normal {np.ravel(normal)} is parallel to element {int(size.argmin())}; "
                "choose one that is perpendicular to the rod"
            )
        d1 /= size
        directors = np.stack([d1, np.cross(tangents, d1, axis=0), tangents])
        return cls(position=nodes, directors=directors, radius=np.asarray(radius, dtype=np.float64), **material)

    @property
    def n_elements(self) -> int:
        """Number of elements n."""
        return self.position.shape[1] - 1

    @property
    def rest_length(self) -> Array:
        """Element length at rest l^ [m], (n,)."""
        return np.linalg.norm(np.diff(self.position, axis=1), axis=0)

    @property
    def rest_voronoi_length(self) -> Array:
        """Voronoi length at rest D^ [m], (n - 1,)."""
        return 0.5 * (self.rest_length[1:] + self.rest_length[:-1])

    @property
    def curvature(self) -> Array:
        """Curvature and twist of the rod as described; as ``rest_kappa``, it keeps the shape [1/m], (3, n - 1)."""
        # imported here: it takes longer than the rest of `import elastica_gym`
        from scipy.spatial.transform import Rotation

        turns = np.einsum("ijk,ljk->kil", self.directors[..., 1:], self.directors[..., :-1])
        return -Rotation.from_matrix(turns).as_rotvec().T / self.rest_voronoi_length

    @property
    def area(self) -> Array:
        """Section A at rest [m^2], (n,)."""
        return np.pi * self.radius**2

    @property
    def second_moment(self) -> Array:
        """Second moments of area I1 = I2 = A^2/4 pi, I3 = 2 I1 [m^4], (3, n)."""
        return np.outer([1.0, 1.0, 2.0], self.area**2 / (4.0 * np.pi))

    @property
    def shear_stiffness(self) -> Array:
        """Diagonal of S [N], (3, n)."""
        a, G, Y = SHEAR_CORRECTION, self.shear_modulus, self.youngs_modulus
        return np.outer([a * G, a * G, Y], self.area)

    @property
    def bend_stiffness(self) -> Array:
        """Diagonal of B, averaged to Voronoi points by length [N m^2], (3, n - 1)."""
        B = np.array([self.youngs_modulus, self.youngs_modulus, self.shear_modulus])[:, None] * self.second_moment
        weighted = B * self.rest_length
        return (weighted[:, 1:] + weighted[:, :-1]) / (2.0 * self.rest_voronoi_length)

    @property
    def nodal_mass(self) -> Array:
        """Half of each adjacent element's mass [kg], (n + 1,)."""
        half = 0.5 * self.density * self.area * self.rest_length
        return np.append(half, 0.0) + np.insert(half, 0, 0.0)

    @property
    def inv_nodal_mass(self) -> Array:
        """Inverse nodal mass [1/kg], (n + 1,)."""
        return 1.0 / self.nodal_mass

    @property
    def inertia(self) -> Array:
        """Diagonal of J [kg m^2], (3, n)."""
        return self.density * self.rest_length * self.second_moment

    @property
    def inv_inertia(self) -> Array:
        """Diagonal of 1/J [1/(kg m^2)], (3, n)."""
        return 1.0 / self.inertia


class Limited(Protocol):
    """A simulator that reports its largest stable time step."""

    def stable_time_step(self) -> float: ...  # noqa: D102


class Convertible(Protocol):
    """A rod with other attribute names that can be converted to a `Continuum`."""

    def as_continuum(self) -> Continuum: ...  # noqa: D102


def stable_time_step(rod: "Continuum | Convertible | Limited") -> float:
    """Return the largest stable time step of position Verlet for a rod at rest or a finalized simulator [s].

    For a simulator, it is the smallest over its rods and each joint, contact, plane and drag by itself.

    The highest frequency of a uniform rod is that of its shortest wave, in which neighbouring nodes
    and elements move oppositely: stretch, twist, and bending coupled to shear. Measured for r/l from
    0.1 to 8 and G/Y from 0.33 to 3.3: stable at 0.98 of it and unstable at 1.02. In a non-uniform
    rod, each element is taken with the stiffer of its joints and the lighter of its nodes.

    Parameters
    ----------
    rod : Rod, CosseratRod or BaseSystemCollection
    """
    if hasattr(rod, "stable_time_step"):
        return rod.stable_time_step()
    if hasattr(rod, "as_continuum"):
        rod = rod.as_continuum()
    l, S, J = rod.rest_length, rod.shear_stiffness, rod.inertia / rod.rest_length  # noqa: E741
    B = np.maximum(*(np.insert(rod.bend_stiffness, end, 0.0, axis=1) for end in (0, l.size - 1)))
    m = _mass_per_length(rod.nodal_mass, l)
    p, q, s = S[:2] / (l**2 * m), (0.25 * S[:2] + B[:2] / l**2) / J[:2], 0.5 * S[:2] / (l * np.sqrt(m * J[:2]))
    bending = 0.5 * (p + q) + np.sqrt(0.25 * (p - q) ** 2 + s**2)
    fastest = np.max([bending.max(axis=0), S[2] / (l**2 * m), B[2] / (l**2 * J[2])])
    return float(1.0 / np.sqrt(fastest))


def _mass_per_length(nodal_mass: Array, length: Array) -> Array:
    """Return the mass per length of the lighter of each element's nodes [kg/m], (n,)."""
    m = nodal_mass / (0.5 * (np.append(length, 0.0) + np.insert(length, 0, 0.0)))
    return np.minimum(m[1:], m[:-1])


def require_stable(rods: Sequence[Continuum], time_step: float) -> None:
    """Raise ValueError unless ``time_step`` is below that of every rod's `stable_time_step` [s]."""
    bound = min(stable_time_step(rod) for rod in rods)
    if not time_step < bound:
        raise ValueError(f"the time step must be below {bound:.4g} s for these rods to be stable, not {time_step:g} s")


def as_number(name: str, value: ArrayLike) -> float:
    """Return a finite number as a float.

    Raises
    ------
    TypeError
        If it is not a number.
    ValueError
        If it is infinite or NaN.
    """
    _require_number(name, value)
    number = float(np.asarray(value, dtype=np.float64).reshape(()))
    if not np.isfinite(number):
        raise ValueError(f"{name} must be a finite number, not {number}")
    return number


def as_numbers(name: str, value: ArrayLike) -> Array:
    """Return an array of floats, or raise TypeError if ``value`` is not numeric."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be numbers, not {value!r}") from None


def three(name: str, value: ArrayLike) -> Array:
    """Return three finite numbers, (3,); an array is returned as a view, so that later changes to it take effect.

    Raises
    ------
    TypeError, ValueError
        If ``value`` is anything else.
    """
    numbers = as_numbers(name, value)
    if numbers.size != 3 or not np.isfinite(numbers).all():
        raise ValueError(f"{name} must be three finite numbers, not {numbers.tolist()}")
    return np.asarray(value).reshape(3)


def as_count(name: str, value: object, least: int) -> int:
    """Return a whole number of at least ``least`` as an int.

    Raises
    ------
    TypeError
        If it is not of an integer type.
    ValueError
        If it is too small.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError(f"{name} must be a whole number, not {value!r}")
    if value < least:
        raise ValueError(f"{name} must be at least {least}, not {value}")
    return int(value)


def as_indices(name: str, value: Any) -> NDArray[np.int64]:
    """Return one or more indices as an array, or raise TypeError if they are not whole numbers."""
    given = np.ravel(np.asarray(value))
    if given.size and given.dtype.kind not in "iu":
        raise TypeError(f"{name} must be whole numbers, not {value!r}")
    return given.astype(np.int64)


def _require_number(name: str, value: Any) -> None:
    given = np.asarray(value)
    if given.size != 1 or given.dtype.kind not in "iuf":
        raise TypeError(f"{name} must be a number, not {value!r}")


def require_positive(name: str, value: float) -> None:
    """Raise ValueError unless ``value`` is finite and positive, and TypeError unless it is a number."""
    _require_number(name, value)
    if not (np.isfinite(value) and value > 0.0):
        raise ValueError(f"{name} must be a positive number, not {value}")


def require_not_negative(name: str, value: float) -> None:
    """Raise ValueError unless ``value`` is finite and not negative, and TypeError unless it is a number."""
    _require_number(name, value)
    if not (np.isfinite(value) and value >= 0.0):
        raise ValueError(f"{name} must be zero or a positive number, not {value}")


def require_finite(name: str, values: ArrayLike, size: int) -> None:
    """Raise ValueError unless ``values`` are ``size`` finite numbers."""
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (size,) or not np.isfinite(array).all():
        raise ValueError(f"{name} must be {size} finite number{'s' if size > 1 else ''}, not {array.tolist()}")


def _array(name: str, value: ArrayLike, shape: tuple[int | None, ...]) -> Array:
    """Return a contiguous copy of ``value``, of the given shape (None: any size) and finite."""
    array = np.array(as_numbers(name, value), order="C")
    if array.ndim != len(shape) or any(b is not None and a != b for a, b in zip(array.shape, shape, strict=True)):
        wanted = str(tuple("any" if size is None else size for size in shape)).replace("'", "")
        raise ValueError(f"{name} must have shape {wanted}, not {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, but has {int((~np.isfinite(array)).sum())} entries that are not")
    return array


def _or_zeros(value: Array, size: int) -> Array:
    return value if np.size(value) else np.zeros((3, size))


def _unit(name: str, value: ArrayLike) -> Array:
    vector = _array(name, value, (3,))
    size = float(np.linalg.norm(vector))
    if size == 0.0:
        raise ValueError(f"{name} must not be zero")
    return vector / size
