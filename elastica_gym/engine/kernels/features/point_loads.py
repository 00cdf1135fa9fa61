"""Forces on single nodes and bodies."""

from math import cos, sin

from ...jit.compiler import apart, inline
from ..ends import add_to
from ..math.vectors import plus, times, vector


@inline
def apply(model, scene, state, control):
    """Add them to the external loads."""
    if scene.point_loads.slot.size > 0:
        _apply(scene.point_loads, state.time[0], control.force[0], state.body_force[0])


@apart
def _apply(loads, time, force, body_force):
    for j in range(loads.slot.size):
        late = time - loads.ramp_time[j]
        growth = time / loads.ramp_time[j] if late < 0.0 else 1.0
        f = times(growth, vector(loads.growing[j]))
        if late < 0.0:
            f = plus(f, 1.0, vector(loads.before[j]))
        elif loads.angular_frequency[j] != 0.0:
            angle = loads.angular_frequency[j] * late
            f = plus(plus(f, cos(angle), vector(loads.cosine[j])), sin(angle), vector(loads.sine[j]))
        add_to(force, body_force, loads.slot[j], 1.0, f)
