"""The 4-web of a parallelogram as a harmonic pencil, and the half plane of the number rho.

rho = X_v / X_u = exp(i theta0) / mu is a point of the upper half plane.  The four numbers of
the parallelogram are four families of circles and rays there:

    mu      circles about 0            lam     circles of Apollonius of -1 and 1
    theta0  rays from 0                theta   arcs through -1 and 1

Every function takes numbers, arrays or sympy symbols, as in `parallelogram`.

Paper: Sec. 3.1 (beyond the paper: B2, B10).
"""

import numpy as np

from .parallelogram import _lib, angles, half_angles


def directions(rho):
    """The directions (X_u, Y_v, X_v, Y_u) of the web, complex, counter-clockwise mod pi.

    rho: complex number X_v / X_u.  They are 1, 1 + rho, rho and 1 - rho.

    Paper: Sec. 3.1 (beyond the paper: B10).
    """
    return 1 + 0 * rho, 1 + rho, rho, 1 - rho


def cross_ratio(a, b, c, d):
    """(a, b; c, d) of four lines through a point, given by complex directions; -1: harmonic.

    It does not depend on the lengths and signs of the directions.  No two of a, d and of
    b, c parallel, else ValueError.

    Paper: Sec. 3.1 (beyond the paper: B10).
    """
    below = _area(a, d) * _area(b, c)
    if np.any(below == 0):
        raise ValueError("two of the lines coincide: the cross ratio is infinite")
    return _area(a, c) * _area(b, d) / below


def _area(a, b):
    """The oriented area Im(conj(a) b)."""
    if hasattr(a, "as_real_imag") or hasattr(b, "as_real_imag"):
        import sympy

        (p, q), (r, s) = (sympy.sympify(z).as_real_imag() for z in (a, b))
        return sympy.expand(p * s - q * r)
    return np.imag(np.conj(a) * b)


def gaps(lam, mu):
    """The angles (alpha, theta0 - alpha, pi - theta0 - beta, beta) between neighbouring lines.

    In the order of `directions`, radians, their sum is pi; ValueError for ratios outside the
    range of parallelograms.

    Paper: Sec. 3.1 (beyond the paper: B10).
    """
    alpha, beta = half_angles(lam, mu)
    _, theta0 = angles(lam, mu)
    return alpha, theta0 - alpha, _lib(lam, mu).pi - theta0 - beta, beta


def mu_circle(mu):
    """Centre and radius of the circle of all rho with this mu.

    Paper: Sec. 3.1 (beyond the paper: B2).
    """
    return 0 * mu, 1 / mu


def lam_circle(lam):
    """Centre (on the real axis) and radius of the circle of all rho with this lam, not 1.

    For lam = 1 it is the imaginary axis, and this is a ValueError.

    Paper: Sec. 3.1 (beyond the paper: B2).
    """
    if np.any(lam == 1):
        raise ValueError("lam = 1: the imaginary axis, no circle")
    return (lam**2 + 1) / (lam**2 - 1), 2 * lam / abs(lam**2 - 1)


def theta_circle(theta):
    """Height of the centre above 0 and radius of the circle through -1 and 1 with this theta.

    theta: radians in (0, pi).  Only the arc in the upper half plane counts.

    Paper: Sec. 3.1 (beyond the paper: B2).
    """
    xp = _lib(theta)
    return -xp.cos(theta) / xp.sin(theta), 1 / xp.sin(theta)


def equal_circle():
    """Centre and radius of the circle of all rho with theta = theta0, that is lam = mu.

    Its mirror image in the imaginary axis holds theta + theta0 = pi.

    Paper: Sec. 3.2 (beyond the paper: B2).
    """
    return -1, np.sqrt(2)
