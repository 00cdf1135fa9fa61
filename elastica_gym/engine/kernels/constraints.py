"""Prescribed motion of single nodes, elements and bodies."""

from ..jit.compiler import apart, inline
from .ends import material_of, set_to, vector_of
from .math.vectors import dot, plus, vector


@apart
def hold(pins, clamps, time, x, Q, body_x, body_Q):
    """Set the positions and directors of held nodes, elements and bodies."""
    for j in range(pins.slot.size):
        if time > pins.start_time[j]:
            for d in range(3):
                if pins.axes[j, d] != 0.0:
                    set_to(x, body_x, pins.slot[j], d, pins.position[j, d])
    for j in range(clamps.slot.size):
        if time > clamps.start_time[j] and clamps.has_directors[j] != 0.0:
            k = clamps.slot[j]
            for a in range(3):
                for b in range(3):
                    if k >= 0:
                        Q[a, b, k] = clamps.directors[j, a, b]
                    else:
                        body_Q[-1 - k, a, b] = clamps.directors[j, a, b]


@apart
def move(pins, clamps, time, v, Q, w, body_v, body_Q, body_w):
    """Set prescribed velocities, and zero velocities along and about held axes."""
    for j in range(pins.slot.size):
        is_held = time > pins.start_time[j]
        for d in range(3):
            if not is_held:
                set_to(v, body_v, pins.slot[j], d, pins.velocity[j, d])
            elif pins.axes[j, d] != 0.0:
                set_to(v, body_v, pins.slot[j], d, 0.0)
    for j in range(clamps.slot.size):
        k = clamps.slot[j]
        spin = vector(clamps.omega[j])
        if time > clamps.start_time[j]:
            spin = free_spin(clamps.axes[j], Q, body_Q, k, vector_of(w, body_w, k))
        for d in range(3):
            set_to(w, body_w, k, d, spin[d])


@inline
def free_spin(axes, Q, body_Q, k, spin):
    """Return an angular velocity without its components about the given lab axes."""
    if axes[0] * axes[1] * axes[2] != 0.0:
        return 0.0, 0.0, 0.0
    for d in range(3):
        if axes[d] != 0.0:
            about = material_of(Q, body_Q, k, (1.0 * (d == 0), 1.0 * (d == 1), 1.0 * (d == 2)))
            spin = plus(spin, -dot(spin, about), about)
    return spin
