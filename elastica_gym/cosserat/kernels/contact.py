"""Contact of two round things: closest points of their axes, and the force of one on the other.

Rods and cylinders touch as segments swept by a sphere of their radius. n points from the first to
the second, g is the overlap r1 + r2 - d of their surfaces, u the velocity of the first's surface at
the point of contact less that of the second's.
"""

from .compiler import inner
from .vectors import dot, norm, plus, times

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
def press(overlap, n, u, stiffness, damping, friction, slip_damping):
    """Return the force on the second: k g + nu u.n along n, never adhesive, and min(c |u_t|, mu N) along the slip."""
    approach = dot(u, n)
    N = stiffness * overlap + damping * approach
    N = N if N > 0.0 else 0.0
    slip = plus(u, -approach, n)
    speed = norm(slip)
    drag = slip_damping * speed
    drag = drag if drag < friction * N else friction * N
    return plus(times(N, n), drag / speed if speed > 0.0 else 0.0, slip)
