"""Joints: springs between two nodes, and between the directions of two elements (Zhang et al. 2019)."""

from math import sqrt

from .compiler import inline
from .rotations import half_angle_over_sine


@inline
def pull(joints, j, x, v, force):
    """Add the force of joint j, k (x2 - x1) + nu (v2 - v1), to its two nodes."""
    one, two = joints.node[j, 0], joints.node[j, 1]
    for d in range(3):
        f = joints.stiffness[j] * (x[d, two] - x[d, one]) + joints.damping[j] * (v[d, two] - v[d, one])
        force[d, one] += f
        force[d, two] -= f


@inline
def give_torque(one, two, Q, torque, t0, t1, t2):
    """Add a torque of the lab frame to element two, and its opposite to element one."""
    for d in range(3):
        torque[d, one] -= Q[d, 0, one] * t0 + Q[d, 1, one] * t1 + Q[d, 2, one] * t2
        torque[d, two] += Q[d, 0, two] * t0 + Q[d, 1, two] * t1 + Q[d, 2, two] * t2


@inline
def flap(joints, j, Q, torque):
    """Add the torque that keeps the tangent of element two in a plane: -kt (d3 . h)(d3 x h)."""
    one, two = joints.element[j, 0], joints.element[j, 1]
    h0, h1, h2 = joints.axis[j, 0], joints.axis[j, 1], joints.axis[j, 2]
    d0, d1, d2 = Q[2, 0, two], Q[2, 1, two], Q[2, 2, two]
    c = -joints.hinge_stiffness[j] * (d0 * h0 + d1 * h1 + d2 * h2)
    give_torque(one, two, Q, torque, c * (d1 * h2 - d2 * h1), c * (d2 * h0 - d0 * h2), c * (d0 * h1 - d1 * h0))


@inline
def align(joints, j, Q, w, torque):
    """Add the torque kt Q2^T vee log(Q2 Q1^T C) - nut (Q2^T w2 - Q1^T w1)."""
    one, two = joints.element[j, 0], joints.element[j, 1]
    axis, trace = deviation(joints.rest_rotation[j], Q, one, two)
    a0, a1, a2 = axis
    # as in `curvature.logarithm`: with h = cos(theta/2), theta/|a| is (b/sin b)/h, b = theta/2
    c = min(1.0, 0.5 * trace - 0.5)
    inv_h = sqrt(2.0 / (1.0 + c)) if c > 0.0 else sqrt(2.0 * (1.0 - c) / (a0 * a0 + a1 * a1 + a2 * a2))
    h = 0.5 * (1.0 + c) * inv_h
    scale = joints.turn_stiffness[j] * half_angle_over_sine(h) * inv_h
    nut = joints.turn_damping[j]
    t0 = turn_torque(0, a0, a1, a2, scale, nut, Q, w, one, two)
    t1 = turn_torque(1, a0, a1, a2, scale, nut, Q, w, one, two)
    t2 = turn_torque(2, a0, a1, a2, scale, nut, Q, w, one, two)
    give_torque(one, two, Q, torque, t0, t1, t2)


@inline
def deviation(rest, Q, one, two):
    """Return the axial vector of R = Q2 Q1^T C, (R - R^T)/2, and the trace of R."""
    R00, R01, R02 = deviation_row(rest, Q, one, two, 0)
    R10, R11, R12 = deviation_row(rest, Q, one, two, 1)
    R20, R21, R22 = deviation_row(rest, Q, one, two, 2)
    return (0.5 * (R21 - R12), 0.5 * (R02 - R20), 0.5 * (R10 - R01)), R00 + R11 + R22


@inline
def deviation_row(rest, Q, one, two, i):
    """Return row i of Q2 Q1^T C."""
    p0 = Q[i, 0, two] * Q[0, 0, one] + Q[i, 1, two] * Q[0, 1, one] + Q[i, 2, two] * Q[0, 2, one]
    p1 = Q[i, 0, two] * Q[1, 0, one] + Q[i, 1, two] * Q[1, 1, one] + Q[i, 2, two] * Q[1, 2, one]
    p2 = Q[i, 0, two] * Q[2, 0, one] + Q[i, 1, two] * Q[2, 1, one] + Q[i, 2, two] * Q[2, 2, one]
    return (
        p0 * rest[0, 0] + p1 * rest[1, 0] + p2 * rest[2, 0],
        p0 * rest[0, 1] + p1 * rest[1, 1] + p2 * rest[2, 1],
        p0 * rest[0, 2] + p1 * rest[1, 2] + p2 * rest[2, 2],
    )


@inline
def turn_torque(d, a0, a1, a2, scale, nut, Q, w, one, two):
    """Return component d in the lab of a joint's torque."""
    spring = scale * (Q[0, d, two] * a0 + Q[1, d, two] * a1 + Q[2, d, two] * a2)
    w_two = Q[0, d, two] * w[0, two] + Q[1, d, two] * w[1, two] + Q[2, d, two] * w[2, two]
    w_one = Q[0, d, one] * w[0, one] + Q[1, d, one] * w[1, one] + Q[2, d, one] * w[2, one]
    return spring - nut * (w_two - w_one)
