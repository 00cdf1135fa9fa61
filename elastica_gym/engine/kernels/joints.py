"""Joints: springs between two nodes, and between the directions of two elements (Zhang et al. 2019)."""

from ..jit.compiler import apart, inline
from .ends import add_to, director_of, lab_of, material_of, vector_of
from .math.rotations import half_angle
from .math.vectors import cross, dot, plus, times


@apart
def join(joints, x, v, Q, w, force, torque, body_x, body_v, body_Q, body_w, body_force, body_torque):
    """Add the loads of all joints."""
    for j in range(joints.stiffness.size):
        one, two = joints.node[j, 0], joints.node[j, 1]
        apart_by = plus(vector_of(x, body_x, two), -1.0, vector_of(x, body_x, one))
        parting = plus(vector_of(v, body_v, two), -1.0, vector_of(v, body_v, one))
        f = plus(times(joints.stiffness[j], apart_by), joints.damping[j], parting)
        add_to(force, body_force, one, 1.0, f)
        add_to(force, body_force, two, -1.0, f)

        one, two = joints.element[j, 0], joints.element[j, 1]
        t = 0.0, 0.0, 0.0
        if joints.hinge_stiffness[j] != 0.0:
            t = flap(joints, j, director_of(Q, body_Q, two, 2))
        if joints.turn_stiffness[j] != 0.0:
            t = plus(t, joints.turn_stiffness[j], turn(joints.rest_rotation[j], Q, body_Q, one, two))
        if joints.turn_damping[j] != 0.0:
            turning = plus(lab_of(Q, body_Q, two, vector_of(w, body_w, two)), -1.0,
                           lab_of(Q, body_Q, one, vector_of(w, body_w, one)))  # fmt: skip
            t = plus(t, -joints.turn_damping[j], turning)
        add_to(torque, body_torque, one, -1.0, material_of(Q, body_Q, one, t))
        add_to(torque, body_torque, two, 1.0, material_of(Q, body_Q, two, t))


@inline
def flap(joints, j, d3):
    """Return the torque that keeps the tangent of element two in a plane, -kt (d3 . h)(d3 x h), in the lab."""
    h = joints.axis[j, 0], joints.axis[j, 1], joints.axis[j, 2]
    return times(-joints.hinge_stiffness[j] * dot(d3, h), cross(d3, h))


@inline
def turn(rest, Q, body_Q, one, two):
    """Return the remaining rotation to the rest rotation, Q2^T vee log(Q2 Q1^T C), in the lab."""
    # the rows of C^T Q1 are the directors that element two has at rest, so R = Q2 (C^T Q1)^T
    a, b, c = (director_of(Q, body_Q, one, 0), director_of(Q, body_Q, one, 1), director_of(Q, body_Q, one, 2))
    p = mixed(rest, 0, a, b, c), mixed(rest, 1, a, b, c), mixed(rest, 2, a, b, c)
    q = director_of(Q, body_Q, two, 0), director_of(Q, body_Q, two, 1), director_of(Q, body_Q, two, 2)
    axis = (
        0.5 * (dot(q[2], p[1]) - dot(q[1], p[2])),
        0.5 * (dot(q[0], p[2]) - dot(q[2], p[0])),
        0.5 * (dot(q[1], p[0]) - dot(q[0], p[1])),
    )
    cosine = 0.5 * (dot(q[0], p[0]) + dot(q[1], p[1]) + dot(q[2], p[2])) - 0.5
    ratio, inv_h = half_angle(cosine, dot(axis, axis))
    return lab_of(Q, body_Q, two, times(ratio * inv_h, axis))


@inline
def mixed(rest, i, a, b, c):
    """Return row i of C^T Q, given the rows of Q."""
    return plus(plus(times(rest[0, i], a), rest[1, i], b), rest[2, i], c)
