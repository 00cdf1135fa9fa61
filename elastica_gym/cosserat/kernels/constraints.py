"""Prescribed motion of single nodes and elements."""

from .compiler import inline


@inline
def hold_nodes(pins, time, x):
    """Set the positions of nodes that are held."""
    for j in range(pins.slot.size):
        if time > pins.start_time[j]:
            for d in range(3):
                if pins.axes[j, d] != 0.0:
                    x[d, pins.slot[j]] = pins.position[j, d]


@inline
def hold_elements(clamps, time, Q):
    """Set the directors of elements that are held."""
    for j in range(clamps.slot.size):
        if time > clamps.start_time[j] and clamps.has_directors[j] != 0.0:
            for a in range(3):
                for b in range(3):
                    Q[a, b, clamps.slot[j]] = clamps.directors[j, a, b]


@inline
def move_nodes(pins, time, v):
    """Set the velocities of nodes that move as prescribed, or stop them along the axes that are held."""
    for j in range(pins.slot.size):
        k = pins.slot[j]
        for d in range(3):
            if time > pins.start_time[j]:
                v[d, k] = 0.0 if pins.axes[j, d] != 0.0 else v[d, k]
            else:
                v[d, k] = pins.velocity[j, d]


@inline
def turn_elements(clamps, time, Q, w):
    """Set the angular velocities of elements that turn as prescribed, or stop them about the axes that are held."""
    for j in range(clamps.slot.size):
        k = clamps.slot[j]
        if not time > clamps.start_time[j]:
            w[0, k], w[1, k], w[2, k] = clamps.omega[j, 0], clamps.omega[j, 1], clamps.omega[j, 2]
        elif clamps.axes[j, 0] * clamps.axes[j, 1] * clamps.axes[j, 2] != 0.0:
            w[0, k] = w[1, k] = w[2, k] = 0.0
        else:
            stop_about(clamps.axes[j], Q, w, k)


@inline
def stop_about(axes, Q, w, k):
    """Take the part about some lab axes out of an element's angular velocity."""
    w0, w1, w2 = w[0, k], w[1, k], w[2, k]
    for d in range(3):
        lab = Q[0, d, k] * w0 + Q[1, d, k] * w1 + Q[2, d, k] * w2
        if axes[d] != 0.0:
            w[0, k] -= Q[0, d, k] * lab
            w[1, k] -= Q[1, d, k] * lab
            w[2, k] -= Q[2, d, k] * lab
