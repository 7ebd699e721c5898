"""Surfaces swept by a moving curve: Darboux surfaces and the three kinematic kinds.

The generatrix and the motion are functions of one parameter that return triples; they take
numbers, arrays or sympy symbols, and so does the `Surface` made of them.  As in the paper u
runs along the generatrix and v is the time of the motion.

Paper: Sec. 5.
"""

import numpy as np

from .parallelogram import _lib
from .surfaces import Surface, _integral, check_profile, slope


def darboux(matrix, generatrix, shift):
    """The surface A(v) X(u) + a(v) of a curve under a rigid motion.

    matrix(v): three rows of three entries, orthogonal (not checked); generatrix(u) and
    shift(v): triples.

    Paper: Sec. 5 (Darboux surfaces).
    """

    def coordinates(u, v):
        curve = generatrix(u)
        rows = zip(matrix(v), shift(v), strict=True)
        return tuple(sum(a * x for a, x in zip(row, curve, strict=True)) + s for row, s in rows)

    return Surface("Darboux surface", coordinates)


def turn(v):
    """The rotation by the angle v about the z-axis, as three rows.

    Paper: Sec. 5 (kinematic surfaces).
    """
    xp = _lib(v)
    c, s = xp.cos(v), xp.sin(v)
    return (c, -s, 0), (s, c, 0), (0, 0, 1)


def translation(generatrix, path):
    """The surface X(u) + a(v): one curve moved along another without turning.

    Paper: Sec. 5 (translation surfaces).
    """
    unit = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    return darboux(lambda v: unit, generatrix, path)._replace(name="translation surface")


def rotational(generatrix):
    """The surface swept by a curve that turns about the z-axis by the angle v.

    Paper: Sec. 5 (rotational surfaces), Eq. (14).
    """
    return helical(generatrix, 0)._replace(name="rotational surface")


def helical(generatrix, pitch):
    """The surface swept by a curve that turns by the angle v and climbs by pitch v.

    Paper: Sec. 5 (helical surfaces).
    """
    surface = darboux(turn, generatrix, lambda v: (0, 0, pitch * v))
    return surface._replace(name="helical surface")


def helical_isothermal(profile, pitch):
    """A helical surface in isothermal parameters, and their range: (Surface, w_stop).

    profile: a `surfaces.Profile`, turned and lifted by pitch a radian.  The surface takes
    (x, w), any angle x and 0 <= w <= w_stop.  With E, F, G of the meridian and the helices,
    w = int sqrt(EG - F^2) / E dt and x = angle + int F / E dt.  Numbers and arrays only; with
    pitch = 0 it is `surfaces.mercator`.

    Paper: Sec. 5.2 (beyond the paper for helical surfaces).
    """
    check_profile(profile)

    def forms(t):
        radius = profile.radius(t)
        (f, g), E = slope(profile, t), radius**2 + pitch**2
        return E, pitch * g, np.sqrt(radius**2 * g**2 + E * f**2)

    def rate(t):
        E, _, root = forms(t)
        return root / E

    def drift_rate(t):  # positive, so that one routine integrates both
        E, F, root = forms(t)
        return 1 + (F + root) / E

    w_of_t, t_of_w = _integral(rate, profile.start, profile.stop)
    drift_of_t, _ = _integral(drift_rate, profile.start, profile.stop)

    def coordinates(x, w):
        t = t_of_w(w)
        drift = drift_of_t(t) - w_of_t(t) - (t - profile.start)
        angle, radius = x - drift, profile.radius(t)
        height = profile.height(t) + pitch * angle
        return radius * np.cos(angle), radius * np.sin(angle), height

    return Surface("helical surface", coordinates), float(w_of_t(profile.stop))
