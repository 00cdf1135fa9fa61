"""Detection of non-finite motion."""

from ..jit.compiler import apart, inline, stage


@stage
def count_broken(first, n, v, w):
    """Return the number of slots with an infinite or NaN velocity or angular velocity."""
    count = 0
    for k in range(first, n):
        total = v[0][k] + v[1][k] + v[2][k] + w[0][k] + w[1][k] + w[2][k]
        # infinities minus themselves are NaN
        count += 0 if total - total == 0.0 else 1
    return count


@inline
def is_broken(v, w):
    """Return whether any component of a velocity or an angular velocity is infinite or NaN."""
    total = v[0] + v[1] + v[2] + w[0] + w[1] + w[2]
    return total - total != 0.0


@apart
def find_broken(first, n, v, w, body_v, body_w):
    """Return the place of the first infinite or NaN velocity: a slot, or -1 - b for body b; 0 if there is none."""
    for b in range(body_v.shape[0]):
        if is_broken(body_v[b], body_w[b]):
            return -1 - b
    if count_broken(first, n, (v[0], v[1], v[2]), (w[0], w[1], w[2])) > 0:
        for k in range(v.shape[1]):
            if is_broken(v[:, k], w[:, k]):
                return k
    return 0
