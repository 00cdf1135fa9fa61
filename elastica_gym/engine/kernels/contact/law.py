"""Contact of two round objects: closest points of their axes, and the force of one on the other.

Rods and cylinders touch as segments swept by a sphere of their radius, for elements that at rest. n points
from the first to the second, g is the overlap r1 + r2 - d of their surfaces, and u the velocity of the
first minus that of the second.

The spring's energy k g^2/2 depends on positions alone, so its force goes to nodes alone: N n by the weights
1 - s and s of the point (1 - s) x_k + s x_k+1 where it acts. As the closest points are stationary, this is
the energy's gradient: contact conserves energy, momentum and angular momentum. Friction acts in the middle of
the overlap, on the line through both points. (Radii that follow the stretch would push the nodes of an
element apart by N r/(2 l), which is unstable at any time step used for arms where l < r.)
"""

from math import sqrt

from ...jit.compiler import ONE, inline
from ..math.roots import TINY
from ..math.vectors import add_column, column, cross, dot, norm, plus, times, to_lab_at, to_material_at

# how strongly closest points are drawn to the middles of elements, per squared radius
CENTRING = 0.03


@inline
def clip(t):
    """Return the point of [0, 1] nearest to t."""
    t = t if t > 0.0 else 0.0
    return t if t < 1.0 else 1.0


@inline
def closest(a, e, c1, b, f, c2):
    """Return s and t in [0, 1] that minimise |b + t f - a - s e|^2 + c1 (s - 1/2)^2 + c2 (t - 1/2)^2, and the minimum.

    Also returns b + t f - a - s e. The points are the closest of two segments (Ericson 2005, section 5.1.9), drawn
    slightly to their middles: as parallel segments turn, the closest would jump from end to end.
    """
    r = plus(a, -1.0, b)
    ee, ff, ef = dot(e, e) + c1, dot(f, f) + c2, dot(e, f)
    er, fr = dot(e, r) - 0.5 * c1, dot(f, r) + 0.5 * c2
    s = clip((ef * fr - er * ff) / (ee * ff - ef * ef))
    t = clip((ef * s + fr) / ff)
    s = clip((ef * t - er) / ee)
    towards = plus(plus(b, t, f), -1.0, plus(a, s, e))
    return s, t, towards, dot(towards, towards) + c1 * (s - 0.5) * (s - 0.5) + c2 * (t - 0.5) * (t - 0.5)


@inline
def overlap(a, e, r1, b, f, r2, is_rod):
    """Return the overlap of segments of radii r1 and r2, n, and s and t of their closest points a + s e and b + t f.

    The first is an element, the second another element or the axis of a body.
    """
    s, t, towards, squared = closest(a, e, CENTRING * r1 * r1, b, f, CENTRING * r2 * r2 if is_rod else 0.0)
    d = sqrt(squared)
    # axes that intersect have no normal
    return r1 + r2 - d, times(1.0 / d if squared > TINY else 0.0, towards), s, t


@inline
def normal_force(g, approach, stiffness, damping):
    """Return N: k g + nu times the velocity of approach, never adhesive."""
    N = stiffness * g + damping * approach
    return N if N > 0.0 else 0.0


@inline
def friction_force(n, u, N, friction, slip_damping):
    """Return the friction on the second, min(c |u_t|, mu N) along u_t, of surfaces whose velocities differ by u."""
    # n is shorter than one, because the points are drawn away from the closest
    nn = dot(n, n)
    slip = plus(u, -dot(u, n) / nn if nn > 0.0 else 0.0, n)
    speed = norm(slip)
    drag = slip_damping * speed
    drag = drag if drag < friction * N else friction * N
    return times(drag / speed if speed > 0.0 else 0.0, slip)


@inline
def middle(x, k):
    """Return the centre of element k."""
    return times(0.5, plus(column(x, k), 1.0, column(x, k + ONE)))


@inline
def axis_velocity(v, k, s):
    """Return the velocity of the point (1 - s) x_k + s x_k+1 of element k."""
    return plus(times(1.0 - s, column(v, k)), s, column(v, k + ONE))


@inline
def spin_velocity(Q, w, k, arm):
    """Return the velocity that the spin of element k adds at ``arm`` from its axis."""
    return cross(to_lab_at(Q, k, column(w, k)), arm)


@inline
def load(force, k, s, f):
    """Add a force f at the point s of element k to its nodes."""
    add_column(force, k, 1.0 - s, f)
    add_column(force, k + ONE, s, f)


@inline
def twist(torque, Q, k, a):
    """Add a torque a, in the lab, to element k."""
    add_column(torque, k, 1.0, to_material_at(Q, k, a))
