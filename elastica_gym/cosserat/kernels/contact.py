"""Contact of two round things: closest points of their axes, and the force of one on the other.

Rods and cylinders touch as segments swept by a sphere of their radius. n points from the first to
the second, g is the overlap r1 + r2 - d of their surfaces, and u the velocity of the first less that
of the second, both where the overlap is in the middle. Action and reaction act there, so that they
change neither momentum nor angular momentum.
"""

from .compiler import ONE, inner
from .roots import TINY
from .vectors import add_column, column, cross, dot, norm, plus, times, to_lab_at, to_material_at

# squared sine of the angle below which two segments count as parallel
PARALLEL = 1e-6


@inner
def clip(t):
    """Return the point of [0, 1] nearest to t."""
    t = t if t > 0.0 else 0.0
    return t if t < 1.0 else 1.0


@inner
def closest(a, e, b, f):
    """Return s and t of the closest points a + s e and b + t f of two segments (Ericson 2005, section 5.1.9).

    Where parallel segments run side by side, s is the middle of the stretch that they share.
    """
    r = plus(a, -1.0, b)
    ee, ff, ef = dot(e, e), dot(f, f), dot(e, f)
    er, fr = dot(e, r), dot(f, r)
    sine = ee * ff - ef * ef
    if sine > PARALLEL * ee * ff:
        s = clip((ef * fr - er * ff) / sine)
    else:
        p, q = -er / ee, (ef - er) / ee
        low, high = (p, q) if p < q else (q, p)
        s = clip(0.5 * ((low if low > 0.0 else 0.0) + (high if high < 1.0 else 1.0)))
    t = clip((ef * s + fr) / ff)
    return clip((ef * t - er) / ee), t


@inner
def overlap(a, e, r1, b, f, r2):
    """Return how deep two segments a + s e and b + t f of radii r1 and r2 overlap, n, and the middle of the overlap."""
    s, t = closest(a, e, b, f)
    on_axis = plus(a, s, e)
    towards = plus(plus(b, t, f), -1.0, on_axis)
    d = norm(towards)
    g = r1 + r2 - d
    # axes that cross have no direction to part in
    n = times(1.0 / d if d * d > TINY else 0.0, towards)
    return g, n, plus(on_axis, r1 - 0.5 * g, n)


@inner
def press(g, n, u, stiffness, damping, friction, slip_damping):
    """Return the force on the second, and N: k g + nu u.n along n, never adhesive, and min(c |u_t|, mu N) along u_t."""
    approach = dot(u, n)
    N = stiffness * g + damping * approach
    N = N if N > 0.0 else 0.0
    slip = plus(u, -approach, n)
    speed = norm(slip)
    drag = slip_damping * speed
    drag = drag if drag < friction * N else friction * N
    return plus(times(N, n), drag / speed if speed > 0.0 else 0.0, slip), N


@inner
def middle(x, k):
    """Return the centre of element k."""
    return times(0.5, plus(column(x, k), 1.0, column(x, k + ONE)))


@inner
def surface_velocity(v, Q, w, k, arm):
    """Return the velocity of a point of element k that is ``arm`` from its centre."""
    return plus(middle(v, k), 1.0, cross(to_lab_at(Q, k, column(w, k)), arm))


@inner
def load(force, torque, Q, k, f, arm):
    """Add a force f on element k, ``arm`` from its centre: half of it to each node, and the torque to the element."""
    add_column(force, k, 0.5, f)
    add_column(force, k + ONE, 0.5, f)
    add_column(torque, k, 1.0, to_material_at(Q, k, cross(arm, f)))
