"""Inverse roots, faster than the divider's.

A vector square root and a division in double precision keep the divider busy for 35 cycles, which
was half of the step. Single precision gives 24 bits at once, and one step of third order,
y + y (e/m + ...) with e the relative residual, gives the rest.
"""

from math import sqrt

import numpy as np

from ...jit.compiler import inline

# floor of a squared length or speed: below it, single precision has no inverse
TINY = 1e-36


@inline
def inverse_sqrt(x):
    """Return 1/sqrt(max(x, TINY)) to within two units in the last place, for x below 1e36."""
    x = x if x > TINY else TINY
    y = np.float64(np.float32(1.0) / sqrt(np.float32(x)))
    e = 1.0 - (x * y) * y
    return y + (y * e) * (0.5 + 0.375 * e)


@inline
def inverse_fourth_root(x):
    """Return x^(-1/4) to within two units in the last place, for x between TINY and 1e36."""
    y = np.float64(np.float32(1.0) / sqrt(sqrt(np.float32(x))))
    yy = y * y
    e = 1.0 - (x * yy) * yy
    return y + (y * e) * (0.25 + 0.15625 * e)
