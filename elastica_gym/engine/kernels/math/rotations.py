"""Rotation vectors to matrices and back, without trigonometric calls, which do not vectorise.

The coefficients are Chebyshev interpolants computed in 60-digit arithmetic; their errors, relative
to the function, are below 6e-17 over the stated ranges. Powers are summed in two or four parts:
several short chains of multiply-adds take the time of one.
"""

from ...jit.compiler import inline
from .roots import inverse_sqrt


@inline
def sine_over_angle(s):
    """Return sin(a)/a for s = a^2 and a from 0 to pi."""
    ss = s * s
    even = 1.775165055612406e-20
    even = even * ss + 2.811024030605762e-15
    even = even * ss + 1.6059042526461696e-10
    even = even * ss + 2.755731922346156e-06
    even = even * ss + 0.008333333333333321
    even = even * ss + 1.0
    odd = -8.183034366062202e-18
    odd = odd * ss - 7.647133470817639e-13
    odd = odd * ss - 2.5052108350866163e-08
    odd = odd * ss - 0.00019841269841265803
    odd = odd * ss - 0.16666666666666666
    return even + odd * s


@inline
def versine_over_angle_squared(s):
    """Return (1 - cos(a))/a^2 for s = a^2 and a from 0 to pi."""
    ss = s * s
    even = 1.5550494189681177e-16
    even = even * ss + 1.1470706194142972e-11
    even = even * ss + 2.755731919826743e-07
    even = even * ss + 0.0013888888888887974
    even = even * ss + 0.5
    odd = -3.733174793959906e-19
    odd = odd * ss - 4.7787968429046134e-14
    odd = odd * ss - 2.087675564537452e-09
    odd = odd * ss - 2.480158730134033e-05
    odd = odd * ss - 0.041666666666666664
    return even + odd * s


@inline
def half_angle_over_sine(h):
    """Return b/sin(b) for h = cos(b) and b from 0 to pi/2.

    Analytic for h > -1, hence well approximated on [0, 1] by a polynomial in 2h - 1.
    """
    z = 2.0 * h - 1.0
    zz = z * z
    zzzz = zz * zz
    p0 = 1.155596335517553e-10
    p0 = p0 * zzzz + 5.99775844099466e-09
    p0 = p0 * zzzz + 5.418287002530394e-07
    p0 = p0 * zzzz + 5.307369977099968e-05
    p0 = p0 * zzzz + 0.005861628974916285
    p0 = p0 * zzzz + 1.2091995761561452
    p1 = -1.497309269587466e-09
    p1 = p1 * zzzz - 1.7343078169085141e-07
    p1 = p1 * zzzz - 1.6749075819869722e-05
    p1 = p1 * zzzz - 0.0017729284598670242
    p1 = p1 * zzzz - 0.2636001412812842
    p2 = 4.847870212537191e-10
    p2 = p2 * zzzz + 5.579896370054702e-08
    p2 = p2 * zzzz + 5.314300137765282e-06
    p2 = p2 * zzzz + 0.000544773988660799
    p2 = p2 * zzzz + 0.06973319205204817
    p3 = -3.5494026622357296e-10
    p3 = p3 * zzzz - 1.8554844983920357e-08
    p3 = p3 * zzzz - 1.693860323878943e-06
    p3 = p3 * zzzz - 0.0001693099597410185
    p3 = p3 * zzzz - 0.0198371469225361
    return p0 + p1 * z + (p2 + p3 * z) * zz


@inline
def half_angle(cosine, a_squared):
    """Return b/sin b and 1/h for b half the angle theta of a rotation, h = cos b, and a its axial vector.

    The rotation's logarithm is then theta/|a| a, where theta/|a| is (b/sin b)/h. In terms of c, the cosine of theta,
    1/h^2 is 2/(1 + c), and near a half turn the better conditioned 2 (1 - c)/|a|^2.
    """
    c = cosine if cosine < 1.0 else 1.0
    numerator = 2.0 * (1.0 - c) if c < 0.0 else 2.0
    denominator = a_squared if c < 0.0 else 1.0 + c
    inv_h = numerator * inverse_sqrt(numerator * denominator)
    return half_angle_over_sine(0.5 * (1.0 + c) * inv_h), inv_h
