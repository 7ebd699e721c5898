"""Curves by arc length: Bezier curves and any other curve with its derivatives; their rulings.

Paper: Sec. 5.1.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.interpolate import BPoly


class Curve(NamedTuple):
    """A regular curve by arc length, made by `arc_length`.

    position  position(t, k): the k-th derivative at the parameters t, (..., 2 or 3)
    integral  integral(t): the arc length from the start to t
    start, stop, length
    """

    position: object
    integral: object
    start: float
    stop: float
    length: float

    def parameter(self, s):
        """The parameters t at the arc lengths s; ValueError outside [0, length]."""
        s = np.asarray(s, dtype=float)
        slack = 1e-9 * self.length
        require(
            (s >= -slack) & (s <= self.length + slack),
            lambda at: f"asks for arc length {s[at]:.6g} on a curve of length {self.length:.6g}",
        )
        t = np.linspace(self.start, self.stop, 257)
        t = np.interp(s, self.integral(t), t)
        for _ in range(6):  # Newton
            t = t - (self.integral(t) - s) / self.integral.deriv()(t)
        return t

    def point(self, s):
        """Points (..., 2 or 3) at the arc lengths s."""
        return self.position(self.parameter(s), 0)


def bezier(points):
    """A Bezier curve as a function position(t, k=0): its k-th derivative at t in [0, 1].

    points: (degree + 1, 2 or 3), at least two control points.

    Paper: Sec. 5.1 (control points).
    """
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or len(points) < 2 or points.shape[1] not in (2, 3):
        raise ValueError(
            f"points has the shape {points.shape}: at least two control points of two or "
            "three coordinates are wanted"
        )
    if not np.isfinite(points).all():
        raise ValueError("a control point has a coordinate that is not a finite number")
    return BPoly(points[:, None], [0.0, 1.0])


def arc_length(position, start=0.0, stop=1.0):
    """A `Curve` from position(t, k), the k-th derivative of a curve on start <= t <= stop.

    The speed is expanded in Chebyshev polynomials to round-off, so arc lengths are good to
    about 1e-13 of the length.  ValueError when the curve stops on its way (a cusp).

    Paper: Sec. 5.1 (arc length).
    """
    if not (np.isfinite([start, stop]).all() and start < stop):
        raise ValueError(f"the curve runs from {start} to {stop}: start < stop is wanted")

    def speed(t):
        return np.linalg.norm(position(t, 1), axis=-1)

    for degree in (32, 64, 128, 256, 512, 1024):
        series = Chebyshev.interpolate(speed, degree, domain=[start, stop])
        size = np.abs(series.coef)
        if size[-degree // 8 :].max() < 1e-14 * size.max():
            integral = series.integ(lbnd=start)
            if series(np.linspace(start, stop, 257)).min() > 1e-9 * size.max():
                return Curve(position, integral, start, stop, float(integral(stop)))
    raise ValueError("the curve has a cusp, or nearly one: its speed vanishes or jumps there")


def require(good, why):
    """ValueError that names the first grid point that is not good; why(index) says the rest.

    good: array of booleans; why: a function of the index, a tuple.

    Paper: Sec. 5.1 (errors).
    """
    if not np.all(good):
        at = np.unravel_index(np.argmin(good), np.shape(good))
        raise ValueError(f"grid point {tuple(map(int, at))} {why(at)}")


def require_dimension(curve, dimension):
    """ValueError unless the points of `curve` have so many coordinates.

    Paper: Sec. 5.1 (errors).
    """
    found = np.shape(curve.position(curve.start, 0))[-1]
    if found != dimension:
        raise ValueError(f"the curve has {found} coordinates: {dimension} are wanted here")


def require_rulings(curve):
    """ValueError unless `curve` is a space curve whose curvature never vanishes.

    Paper: Sec. 5.1 (errors).
    """
    require_dimension(curve, 3)
    t = np.linspace(curve.start, curve.stop, 1025)
    b = np.cross(curve.position(t, 1), curve.position(t, 2))
    curvature = _norm(b) / _norm(curve.position(t, 1)) ** 3
    good = curvature * curve.length > 1e-9
    good[1:] &= np.sum(b[1:] * b[:-1], axis=-1) > 0
    if not good.all():
        s = curve.integral(t[np.argmin(good)])
        raise ValueError(
            f"the curvature vanishes near arc length {s:.6g}: the surface has no ruling there"
        )


def _norm(a):
    return np.sqrt(np.sum(a * a, axis=-1))


def darboux(curve, t):
    """(cot psi, d cot psi / ds, T, B, kappa) at the parameters t of a space `Curve`.

    The ruling cot(psi) T + B has the direction of the Darboux vector tau T + kappa B and makes
    the angle psi with the tangent: cot psi = tau / kappa.

    Paper: Sec. 5.1 (geodesic).
    """
    r1, r2, r3, r4 = (curve.position(t, k) for k in (1, 2, 3, 4))
    b = np.cross(r1, r2)
    speed, size = _norm(r1), _norm(b)
    scale = (speed / size) ** 3  # tau / kappa = scale det(r1, r2, r3)
    cot = scale * np.sum(b * r3, axis=-1)
    growth = np.sum(r1 * r2, axis=-1) / speed**2
    growth = growth - np.sum(b * np.cross(r1, r3), axis=-1) / size**2
    rate = (scale * np.sum(b * r4, axis=-1) + 3 * cot * growth) / speed
    return cot, rate, r1 / speed[..., None], b / size[..., None], size / speed**3
