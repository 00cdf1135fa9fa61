"""The running simulation behind a finalized simulator: tables, memory, hooks and callbacks."""

import ctypes
import functools
import math
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ..engine.builder import at_rest, build_model, lay_out
from ..engine.jit.compiler import Bound
from ..engine.kernels.simulate import DENSE, simulate
from ..engine.model import Array
from ..engine.rod import Continuum, Rod, as_indices, stable_time_step
from ..engine.scene import Hooks, Scene, Scheme
from ..engine.stability import Limit, limits
from .declaration import Declaration
from .dissipation import AnalyticalLinearDamper
from .lowering import SceneBuilder, is_built_in
from .rigidbody.rigid_body import RigidBodyBase
from .rod.cosserat_rod import MATERIAL, CosseratRod, Lowered
from .surface.plane import Plane

NEVER = 2**62
_BYSTANDER = Rod.straight(
    2,
    start=(1e6, 0.0, 0.0),
    direction=(1.0, 0.0, 0.0),
    normal=(0.0, 1.0, 0.0),
    length=1.0,
    radius=0.1,
    density=1.0,
    youngs_modulus=1.0,
    shear_modulus=1.0,
)
INTERVALS = ("every", "step_skip", "sample_every")
"""Attributes of a callback that set the steps between its calls"""

CALLED = {
    "constraints": ("constrain_values", "constrain_rates"),
    "forcing": ("apply_forces", "apply_torques"),
    "connections": ("apply_forces", "apply_torques"),
    "contacts": ("apply_contact",),
    "damping": ("dampen_rates",),
}
"""Methods that a step calls on a user's own features, by kind"""

Call = Callable[[float], None]


class Hook:
    """Calls Python functions of time in order from compiled code.

    An exception is stored, and the compiled code stops.
    """

    _signature = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_double)

    def __init__(self) -> None:
        self.calls: list[Call] = []
        self.error: BaseException | None = None
        self._function = self._signature(self._run)
        self._address = int(ctypes.cast(self._function, ctypes.c_void_p).value or 0)

    @property
    def address(self) -> int:
        """Address of the C function, 0 if there are no functions."""
        return self._address if self.calls else 0

    def _run(self, time: float) -> int:
        now = np.float64(time)
        try:
            for call in self.calls:
                call(now)
        except BaseException as error:
            self.error = error
            return 1
        return 0


class Callbacks:
    """Callbacks called between steps.

    Parameters
    ----------
    declared : sequence of Declaration
        Callbacks in calling order.
    """

    def __init__(self, declared: Sequence[Declaration] = ()) -> None:
        made = [(declaration.make(), declaration.observed) for declaration in declared]
        self._all = [(callback, observed, _interval(callback)) for callback, observed in made]

    def __iter__(self) -> Iterator[Any]:
        return (callback for callback, _, _ in self._all)

    def call(self, time: float, step: int) -> None:
        """Call the callbacks due after a number of steps."""
        for callback, observed, interval in self._all:
            if step % interval == 0:
                callback.make_callback(observed, np.float64(time), step)

    def steps_to_next(self, step: int) -> int:
        """Return the number of steps from a given one until any callback is due."""
        return min((interval - step % interval for _, _, interval in self._all), default=NEVER)

    def close(self) -> None:
        """Call ``on_close`` of all callbacks."""
        for callback in self:
            callback.on_close()


class Simulation:
    """The compiled simulation of a finalized simulator.

    Parameters
    ----------
    systems : sequence
        Rods and rigid bodies.
    declared : mapping
        The features of each kind, as declared.
    callbacks : Callbacks, optional
        Callbacks of the systems.
    names : mapping, optional
        Names of systems in messages, by identity; default the type's name.

    Attributes
    ----------
    model, scene, state, control
        Data that the compiled step reads and writes.
    """

    _scene: Scene | None = None

    def __init__(
        self,
        systems: Sequence[Any],
        declared: Mapping[str, Sequence[Declaration]],
        callbacks: Callbacks | None = None,
        names: Mapping[int, str] | None = None,
    ) -> None:
        self.rods = [system for system in systems if isinstance(system, CosseratRod)]
        self.bodies = [system for system in systems if isinstance(system, RigidBodyBase)]
        for rod in self.rods:
            rod._rest_as_built()
        # a Model needs a rod: bodies alone get a dummy that is far away and unloaded
        lowered: list[Continuum] = [_laid(rod) for rod in self.rods] or [_BYSTANDER]
        bodies: Any = [body._lowered() for body in self.bodies]
        self.model = build_model(lowered, cylinders=bodies, is_muscular=False)
        self.state, self.control = at_rest(self.model, lowered, cylinders=bodies)
        self._material = self._move_rods()
        self._move_bodies()
        self._as_laid_out = self._material.tobytes()
        self._hooks = {name: Hook() for name in Hooks._fields}
        self.callbacks = callbacks or Callbacks()
        self._names = names or {}
        self._constraints: list[tuple[Any, Any]] = []
        self._has_warned = self._is_judged = False
        # step and slot of the first non-finite motion found, and the last step with finite motion
        self._broken, self._is_told = np.zeros(3, dtype=np.int64), False

        self._announced: set[float] = set()
        self._lowerings: list[Callable[[SceneBuilder], None]] = []
        self._followed: dict[int, tuple[Any, list[str]]] = {}
        self._add_constraints(declared.get("constraints", ()))
        self._add_loads(declared.get("forcing", ()))
        self._add_joints(declared.get("connections", ()))
        self._add_contacts(declared.get("contacts", ()))
        self._add_dampers(declared.get("damping", ()))
        self._lower()
        for dt in self._announced:
            self._warn_of(dt)

    # setup

    def _move_rods(self) -> Array:
        """Make the rods' attributes views of the simulation's memory, and return the memory of their material."""
        material = np.zeros(sum(rod._fields[name].size for rod in self.rods for name in MATERIAL))
        used = 0
        s, c = self.state, self.control
        for rod, first in zip(self.rods, self.model.first_slot, strict=bool(self.rods)):
            nodes, elements = slice(first, first + rod.n_nodes), slice(first, first + rod.n_elems)
            voronoi = slice(first, first + rod.rest_kappa.shape[1])
            memory = {
                "position_collection": s.x[0][:, nodes],
                "velocity_collection": s.v[0][:, nodes],
                "director_collection": s.Q[0][:, :, elements],
                "omega_collection": s.w[0][:, elements],
                "net_forces": s.force[0][:, nodes],
                "net_torques": s.torque[0][:, elements],
                "external_forces": c.force[0][:, nodes],
                "external_torques": c.torque[0][:, elements],
                "rest_sigma": c.rest_sigma[0][:, elements],
                "rest_kappa": c.rest_kappa[0][:, voronoi],
            }
            for name in MATERIAL:
                values = rod._fields[name]
                memory[name] = material[used : used + values.size].reshape(values.shape)
                used += values.size
            rod._move(memory)
        return material

    def _move_bodies(self) -> None:
        """Make the bodies' attributes views of the simulation's memory."""
        s = self.state
        for b, body in enumerate(self.bodies):
            body._move(
                {
                    "position_collection": s.body_x[0, b, :, None],
                    "velocity_collection": s.body_v[0, b, :, None],
                    "director_collection": s.body_Q[0, b, :, :, None],
                    "omega_collection": s.body_w[0, b, :, None],
                    "external_forces": s.body_force[0, b, :, None],
                    "external_torques": s.body_torque[0, b, :, None],
                    "plane_contact": s.body_contact[0, b],
                }
            )

    def _lower(self) -> None:
        """Write the tables of the scene from the built-in features and the current values of their arrays."""
        builder = SceneBuilder(self.model, self.rods, self.bodies)
        for lower in self._lowerings:
            lower(builder)
        before, scene = self._scene, builder.build()
        if before is not None:
            # keep the dampers of finalize and the neighbour list
            scene = scene._replace(rod_contacts=before.rod_contacts, decay=before.decay, drag=before.drag)
        self.scene = scene
        self._loading = DENSE if self._hooks["loads"].calls else builder.loading
        self._as_lowered = self._values()

    @property
    def scene(self) -> Scene:
        """Tables of the features."""
        assert self._scene is not None
        return self._scene

    @scene.setter
    def scene(self, scene: Scene) -> None:
        self._scene = scene
        self._simulate = Bound(simulate, self.model, scene, self.state, self.control)

    def _follow(self, *features: Any) -> None:
        """Register the features' arrays, which the caller may change between calls of compiled code."""
        for feature in features:
            names = [name for name, value in vars(feature).items() if isinstance(value, np.ndarray)]
            self._followed[id(feature)] = feature, names

    def _values(self) -> bytes:
        """Return the contents of the followed arrays."""
        return b"".join(
            np.asarray(getattr(feature, name)).tobytes() for feature, names in self._followed.values() for name in names
        )

    def _add_constraints(self, declared: Sequence[Declaration]) -> None:
        """Add constraints so that the last one wins: after a user's own, built-in ones on the system are called too."""
        called: set[int] = set()
        for declaration in declared:
            (system,) = declaration.systems
            constraint = _make_constraint(declaration, system)
            self._constraints.append((constraint, system))
            if is_lowered("constraints", declaration) and id(system) not in called:
                self._lowerings.append(constraint.lower)
            else:
                called.add(id(system))
                self._hook("values", constraint.constrain_values, system)
                self._hook("rates", constraint.constrain_rates, system)

    def _add_loads(self, declared: Sequence[Declaration]) -> None:
        for declaration in declared:
            load, (system,) = declaration.make(), declaration.systems
            if is_lowered("forcing", declaration):
                self._follow(load)
                self._lowerings.append(functools.partial(_lower_load, load, system))
            else:
                self._hook("loads", load.apply_forces, system)
                self._hook("loads", load.apply_torques, system)

    def _add_joints(self, declared: Sequence[Declaration]) -> None:
        for declaration in declared:
            joint, (one, two), (first, second) = declaration.make(), declaration.systems, declaration.indices
            if is_lowered("connections", declaration):
                self._follow(joint)
                self._lowerings.append(functools.partial(lower_joint, joint, one, first, two, second))
            else:
                self._hook("loads", joint.apply_forces, one, first, two, second)
                self._hook("loads", joint.apply_torques, one, first, two, second)

    def _add_contacts(self, declared: Sequence[Declaration]) -> None:
        for declaration in declared:
            contact, (one, two) = declaration.make(), declaration.systems
            contact.require_systems(one, two)
            if is_lowered("contacts", declaration):
                self._follow(contact, *(each for each in (one, two) if isinstance(each, Plane)))
                self._lowerings.append(functools.partial(_lower_contact, contact, one, two))
            else:
                self._hook("loads", contact.apply_contact, one, two)

    def _add_dampers(self, declared: Sequence[Declaration]) -> None:
        for declaration in declared:
            (system,) = declaration.systems
            damper = declaration.make(_system=system)
            if isinstance(damper, AnalyticalLinearDamper) and damper.time_step is not None:
                self._announced.add(damper.time_step)
            if is_lowered("damping", declaration):
                self._lowerings.append(damper.lower)
            else:
                self._hook("damping", damper.dampen_rates, system)

    def _hook(self, point: str, function: Callable, *systems: Any) -> None:
        """Call a method of a user's class at a point of the step, with the systems and the time."""
        if _takes_time(function, len(systems)):
            self._hooks[point].calls.append(lambda time: function(*systems, time))
        else:
            self._hooks[point].calls.append(lambda time: function(*systems))

    # run

    def begin(self) -> None:
        """Apply constraints and call callbacks at time 0."""
        self.constrain_values(0.0)
        self.constrain_rates(0.0)
        self.callbacks.call(0.0, 0)

    def constrain_values(self, time: float) -> None:
        """Apply the constraints of positions and directors."""
        for constraint, system in self._constraints:
            constraint.constrain_values(system, np.float64(time))

    def constrain_rates(self, time: float) -> None:
        """Apply the constraints of velocities."""
        for constraint, system in self._constraints:
            constraint.constrain_rates(system, np.float64(time))

    @property
    def steps(self) -> int:
        """Number of steps taken."""
        return int(self.state.step[0])

    @steps.setter
    def steps(self, count: int) -> None:
        self.state.step[0] = self._broken[2] = count

    def advance(self, scheme: Scheme, dt: float, n_steps: int, time: float) -> float:
        """Take steps from a time, without callbacks, and return the time afterwards [s]."""
        self.require_time_step(dt)
        if self.read_material() or self._values() != self._as_lowered:
            self._lower()
        for body in self.bodies:
            body._time_step = dt
        self._time_step, self.state.time[0] = dt, time
        hooks = Hooks(**{name: hook.address for name, hook in self._hooks.items()})
        loading = DENSE if self._loading == DENSE or self._has_loads else self._loading
        stopped = self._simulate(hooks, scheme, dt, n_steps, loading, self._broken)
        if stopped:
            self.warn_of_divergence()
            self._raise_error()
        return float(self.state.time[0])

    def read_material(self) -> bool:
        """Lay out the rods' material again if it has changed, and return whether it has."""
        material = self._material.tobytes()
        if material == self._as_laid_out:
            return False
        for rod, first in zip(self.rods, self.model.first_slot, strict=True):
            lay_out(self.model._asdict(), _laid(rod), int(first))
        self._as_laid_out = material
        return True

    def warn_of_divergence(self) -> None:
        """Warn once if motion is not finite, naming the system and the step or range of steps."""
        step, place, sound = self._broken.tolist()
        if step == 0 or self._is_told:
            return
        self._is_told = True
        rod = int(np.searchsorted(self.model.first_slot, place, side="right")) - 1
        name = self._name(self.bodies[-1 - place] if place < 0 else self.rods[rod])
        since = f"step {step}" if step == sound + 1 else f"a step from {sound + 1} to {step}"
        warnings.warn(
            f"velocities of {name} are infinite or NaN since {since}; the time step of "
            f"{self._time_step:.4g} s may be too large",
            RuntimeWarning,
            stacklevel=3,
        )

    def _name(self, system: Any) -> str:
        return self._names.get(id(system), type(system).__name__)

    @property
    def _has_loads(self) -> bool:
        """Whether any external load is set."""
        arrays = (self.control.force, self.control.torque, self.state.body_force, self.state.body_torque)
        return any(bool(each.any()) for each in arrays)

    def clear_loads(self) -> None:
        """Clear the external loads."""
        for each in (self.control.force, self.control.torque, self.state.body_force, self.state.body_torque):
            each[:] = 0.0

    def _raise_error(self) -> None:
        for hook in self._hooks.values():
            error, hook.error = hook.error, None
            if error is not None:
                raise error

    def require_time_step(self, dt: float) -> None:
        """Raise ValueError unless a time step is a positive number; warn once if it is too large."""
        if not (math.isfinite(dt) and dt > 0.0):
            raise ValueError(f"the time step must be a positive number, not {dt}")
        if not self._is_judged:
            self._is_judged = True
            self._warn_of(dt)

    def limit(self) -> Limit:
        """Return the largest stable time step and what limits it."""
        rods, bodies = ([self._name(system) for system in systems] for systems in (self.rods, self.bodies))
        found = limits(self.model, self.scene, rods, bodies)
        found += [Limit(stable_time_step(rod), f"{name} at rest") for rod, name in zip(self.rods, rods, strict=True)]
        return min(found, default=Limit(math.inf, "nothing"))

    def _warn_of(self, dt: float) -> None:
        """Warn once if a time step is too large for the declared features."""
        bound, culprit = self.limit()
        if dt > bound and not self._has_warned:
            self._has_warned = True
            warnings.warn(
                f"the time step of {dt:.4g} s is above {bound:.4g} s, the largest stable one of {culprit}",
                RuntimeWarning,
                stacklevel=5,
            )


def is_lowered(kind: str, declaration: Declaration) -> bool:
    """Return whether a feature is part of the compiled step rather than called by it."""
    return declaration.cls is not None and is_built_in(declaration.cls, CALLED[kind])


def lower_joint(joint: Any, one: Any, first: Any, two: Any, second: Any, builder: SceneBuilder) -> None:
    """Write the rows of a joint, one for each pair of indices."""
    if np.size(first) != np.size(second):
        raise ValueError(
            f"first_connect_idx and second_connect_idx of {type(joint).__name__} must have equal length, "
            f"not {np.size(first)} and {np.size(second)}"
        )
    # contact declared as a joint, as in 0.2.x, has no indices
    for i, j in zip(np.ravel(first), np.ravel(second), strict=True) if np.size(first) else ((0, 0),):
        joint.lower(builder, (one, int(i), two, int(j)))


def _lower_load(load: Any, system: Any, builder: SceneBuilder) -> None:
    load.lower(builder, system)


def _lower_contact(contact: Any, one: Any, two: Any, builder: SceneBuilder) -> None:
    contact.lower(builder, one, two)


def _laid(rod: CosseratRod) -> Lowered:
    """Return a rod in the layout of the slots."""
    return rod._lowered().closed() if rod.ring_rod_flag else rod._lowered()


def _make_constraint(declaration: Declaration, system: Any) -> Any:
    """Make a constraint from the current values at its indices, its own arguments and the system."""
    kwargs = dict(declaration.kwargs)
    indices = {name: kwargs.pop(name, ()) for name in ("constrained_position_idx", "constrained_director_idx")}
    positions, directors = (as_indices(name, index) for name, index in indices.items())
    for name, index, count in (
        ("constrained_position_idx", positions, system.n_nodes),
        ("constrained_director_idx", directors, system.n_elems),
    ):
        if ((index < -count) | (index >= count)).any():
            raise IndexError(f"{name} must be from {-count} to {count - 1}, not {index.tolist()}")
    fixed = [system.position_collection[..., i].copy() for i in positions]
    fixed += [system.director_collection[..., i].copy() for i in directors]
    more = {"_system": system, **indices} if declaration.cls is None or declaration.accepts("_system") else {}
    declaration.kwargs = kwargs
    try:
        constraint = declaration.make(*fixed, **more)
    except TypeError as error:
        raise TypeError(
            f"{error}; its first arguments are the positions at constrained_position_idx "
            f"{positions.tolist()} and the directors at constrained_director_idx {directors.tolist()}"
        ) from error
    constraint._set_up(system, *indices.values())
    return constraint


def _interval(callback: Any) -> int:
    """Return the number of steps between calls of a callback."""
    for name in INTERVALS:
        value = getattr(callback, name, None)
        if isinstance(value, int | np.integer) and not isinstance(value, bool) and value > 0:
            return int(value)
    return 1


def _takes_time(function: Callable, n_before: int) -> bool:
    """Return whether a user's method takes a time after the systems; methods of 0.2.x joints did not."""
    import inspect

    parameters = inspect.signature(function).parameters.values()
    if any(p.kind is p.VAR_POSITIONAL for p in parameters):
        return True
    return sum(p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD) for p in parameters) > n_before
