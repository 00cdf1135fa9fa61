"""Inverse square roots, faster than the divider's.

A vector square root and a division keep the divider busy for 35 cycles; half of the step was that.
"""

from math import sqrt

import numpy as np

from .compiler import inline

# floor of a squared length or speed: below it, single precision has no inverse
TINY = 1e-36


@inline
def inverse_sqrt(x):
    """Return 1/sqrt(max(x, TINY)) to within two units in the last place, for x below 1e38.

    Single precision gives 24 bits, and two Newton steps all of them.
    """
    x = x if x > TINY else TINY
    y = np.float64(np.float32(1.0) / sqrt(np.float32(x)))
    y = y + y * (0.5 - 0.5 * x * y * y)
    return y + y * (0.5 - 0.5 * x * y * y)
