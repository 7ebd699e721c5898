"""Isometric bending of planar nets: cylinders, cones, and the surface along any geodesic.

A planar net is a complex array z, or a real one (..., 2); the maps return points (..., 3),
keep lengths along the surface, and at their flat end leave the net in the plane z = 0."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.linalg import norm
from numpy.polynomial import Chebyshev
from numpy.typing import ArrayLike
from scipy.optimize import root

from .conformal import unit
from .parallelogram import check_angle, check_whole, library, ratios, rho

KNOTS = 2049  # on a curve, where the edge of regression is looked for
SLACK = 1e-12  # of the length of a curve: rounding, where the first and last rulings tie
WALKING, REACHED, BEHIND, BEYOND = range(4)
FAULTS = {
    BEHIND: "lies behind the edge of regression: y psi' < sin(psi)^2 fails on the way from (x, 0)",
    BEYOND: "lies beyond the last ruling of the curve: take a longer curve",
}


class Curve(NamedTuple):
    """A regular curve by arc length, made by `arc_length`.

    position(t, k): the k-th derivative at the parameters t, (..., 2 or 3); integral(t): the arc
    length from the start to t, a polynomial of numpy."""

    position: Callable
    integral: Chebyshev
    start: float
    stop: float
    length: float

    def parameter(self, s: ArrayLike) -> np.ndarray:
        """The parameters t at the arc lengths s; ValueError outside [0, length]."""
        s, slack = np.asarray(s, dtype=float), 1e-9 * self.length
        room = f"on a curve of length {self.length:.6g}"
        inside = (s >= -slack) & (s <= self.length + slack)
        _require(inside, lambda at: f"asks for arc length {s[at]:.6g} {room}")
        t = np.linspace(self.start, self.stop, 257)
        t = np.interp(s, self.integral(t), t)
        for _ in range(6):  # Newton
            t = t - (self.integral(t) - s) / self.integral.deriv()(t)
        return t

    def point(self, s: ArrayLike) -> np.ndarray:
        """Points (..., 2 or 3) at the arc lengths s."""
        return self.position(self.parameter(s), 0)


def bezier(points: ArrayLike) -> Callable:
    """A Bezier curve as a function position(t, k=0): its k-th derivative at t in [0, 1].

    points: (degree + 1, 2 or 3), at least two control points."""
    from scipy.interpolate import BPoly

    control = np.asarray(points, dtype=float)
    if control.ndim != 2 or len(control) < 2 or control.shape[1] not in (2, 3):
        words = "at least two control points of two or three coordinates are wanted"
        raise ValueError(f"points has the shape {control.shape}: {words}")
    if not np.isfinite(control).all():
        raise ValueError("a control point has a coordinate that is not a finite number")
    curve = BPoly(control[:, None], [0.0, 1.0])

    def position(t, k=0):
        return curve(t, min(k, len(control)))  # higher derivatives vanish, as this one does

    return position


def arc_length(position: Callable, start: float = 0.0, stop: float = 1.0) -> Curve:
    """A `Curve` from position(t, k), the k-th derivative of a curve on start <= t <= stop.

    Arc lengths are good to about 1e-13 of the length, by Chebyshev polynomials.  ValueError
    when the curve stops on its way (a cusp)."""
    if not (np.isfinite([start, stop]).all() and start < stop):
        raise ValueError(f"the curve runs from {start} to {stop}: start < stop is wanted")

    def speed(t):
        return norm(position(t, 1), axis=-1)

    for degree in (32, 64, 128, 256, 512, 1024):
        series = Chebyshev.interpolate(speed, degree, domain=[start, stop])
        size = np.abs(series.coef)
        if size[-degree // 8 :].max() < 1e-14 * size.max():
            integral = series.integ(lbnd=start)
            if series(np.linspace(start, stop, 257)).min() > 1e-9 * size.max():
                return Curve(position, integral, start, stop, float(integral(stop)))
    raise ValueError("the curve has a cusp, or nearly one: its speed vanishes or jumps there")


def roll_coordinates(x: np.ndarray, y: np.ndarray, curvature: float) -> tuple:
    """Coordinates (X, Y, Z) of the plane point (x, y) on a cylinder with rulings along y.

    X = sin(k x) / k, Y = y, Z = (1 - cos(k x)) / k for the curvature k, written so that k = 0
    is the plane; numbers, arrays or sympy symbols."""

    def sinc(t):
        xp = library(t)
        return np.sinc(t / np.pi) if xp is np else xp.sin(t) / t

    turn = curvature * x
    return x * sinc(turn), y, x * turn / 2 * sinc(turn / 2) ** 2


def roll(z: np.ndarray, curvature: float, direction: complex = 1) -> np.ndarray:
    """A planar net rolled onto a rotational cylinder of radius 1 / |curvature|: (..., 3).

    direction: across the rulings, its length ignored.  The ruling through 0 stays where it is,
    a negative curvature bends down, and a width of 2 pi / curvature closes.  Paper: Fig. 7."""
    z, along = _complex(z), unit(direction)
    if not np.isfinite(curvature):
        raise ValueError(f"curvature = {curvature}: a finite number is wanted")
    w = z * np.conj(along)
    x, y, height = roll_coordinates(w.real, w.imag, curvature)
    return _space((x + 1j * y) * along, height)


def cone_coordinates(distance: np.ndarray, angle: np.ndarray, gamma: float) -> tuple:
    """Coordinates (X, Y, Z) of a plane point in polar coordinates on a cone, apex at 0.

    gamma: the angle between the rulings and the z-axis; numbers, arrays or sympy symbols."""
    xp = library(distance, angle, gamma)
    narrow, lift = xp.sin(gamma), xp.sin(xp.pi / 2 - gamma)  # exactly 1 and 0 for pi/2
    turn = angle / narrow
    return distance * narrow * xp.cos(turn), distance * narrow * xp.sin(turn), distance * lift


def cone(z: np.ndarray, gamma: float, apex: complex = 0, direction: complex = 1) -> np.ndarray:
    """A planar net bent onto a rotational cone with a vertical axis: (..., 3).

    gamma: radians in (0, pi), between the rulings and the upward axis: pi/2 is the plane, less
    opens upwards; direction: of the ruling that keeps its vertical plane.  The sheet is slit
    opposite to it; with an angle of 2 pi sin(gamma) around the apex, the largest, it closes.
    Paper: Fig. 7."""
    z, along, gamma = _complex(z), unit(direction), check_angle("gamma", gamma)
    if not np.isfinite(apex):
        raise ValueError(f"apex = {apex}: a finite complex number is wanted")
    w = (z - apex) * np.conj(along)
    angle = np.angle(w)
    span, room = np.ptp(angle), 2 * np.pi * np.sin(gamma)
    if span > room * (1 + 1e-12):
        words = f"the cone has room for 2 pi sin(gamma) = {room:.6g} only: it would overlap itself"
        raise ValueError(f"the net spans {span:.6g} radians around the apex, but {words}")
    x, y, height = cone_coordinates(np.abs(w), angle, gamma)
    return _space((x + 1j * y) * along + apex, height)


def cylinder(z: np.ndarray, directrix: Curve, direction: complex = 1) -> np.ndarray:
    """A planar net bent onto the general cylinder over a plane curve: (..., 3).

    x runs along `direction` from 0 to the length of the curve, whose two coordinates become
    the horizontal and the vertical one."""
    z, along = _complex(z), unit(direction)
    _require_dimension(directrix, 2)
    w = z * np.conj(along)
    x, height = np.moveaxis(directrix.point(w.real), -1, 0)
    return _space((x + 1j * w.imag) * along, height)


def darboux(curve: Curve, t: np.ndarray) -> tuple:
    """(cot psi, d cot psi / ds, T, B, kappa) at the parameters t of a space curve.

    The ruling cot(psi) T + B has the direction of the Darboux vector tau T + kappa B and makes
    the angle psi with the tangent: cot psi = tau / kappa."""
    r1, r2, r3, r4 = (curve.position(t, k) for k in (1, 2, 3, 4))
    b = np.cross(r1, r2)
    speed, size = norm(r1, axis=-1), norm(b, axis=-1)
    scale = (speed / size) ** 3  # tau / kappa = scale det(r1, r2, r3)
    cot = scale * np.sum(b * r3, axis=-1)
    growth = np.sum(r1 * r2, axis=-1) / speed**2
    growth = growth - np.sum(b * np.cross(r1, r3), axis=-1) / size**2
    rate = (scale * np.sum(b * r4, axis=-1) + 3 * cot * growth) / speed
    return cot, rate, r1 / speed[..., None], b / size[..., None], size / speed**3


def rectifying(z: np.ndarray, curve: Curve) -> np.ndarray:
    """A planar net bent so that the x-axis becomes the given space curve, a geodesic: (..., 3).

    The ruling at arc length s makes the angle psi(s) with the x-axis, so the point (x, y) lies
    on the one with x - s = y cot psi(s); y > 0 is the side of the binormal.  ValueError names
    the first point behind the edge of regression or beyond the last ruling, and a place where
    the curvature vanishes.  Paper: Fig. 7."""
    z = _complex(z)
    _require_rulings(curve)
    t = _feet(curve, z.real, z.imag)
    cot, _, T, B, _ = darboux(curve, t)
    return curve.position(t, 0) + z.imag[..., None] * (cot[..., None] * T + B)


def regression(curve: Curve, s: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """The edge of regression at the arc lengths s: (plane points complex (...), points (..., 3)).

    nan where neighbouring rulings are parallel, as on a cylinder."""
    _require_rulings(curve)
    t = curve.parameter(s)
    cot, rate, T, B, _ = darboux(curve, t)
    parallel = np.abs(rate) * curve.length**2 < 1e-12
    y = np.where(parallel, np.nan, -1 / np.where(parallel, 1, rate))
    points = curve.position(t, 0) + y[..., None] * (cot[..., None] * T + B)
    return np.asarray(s) + y * cot + 1j * y, points


def _feet(curve, x, y):
    """Parameters t of the rulings through the plane points (x, y), arrays of one shape.

    The vertical line through x meets the ruling of s at the height Y(s) = (x - s) / cot psi(s),
    and Y(x) = 0.  Walk from s = x, knot by knot, until Y passes y; where Y turns back before,
    y psi' = sin(psi)^2 and the line has left the surface."""
    knots, start = np.linspace(curve.start, curve.stop, KNOTS), curve.parameter(x)
    s, (cot, rate, *_) = curve.integral(knots), darboux(curve, knots)
    slack, lean = SLACK * curve.length, y * darboux(curve, start)[0]
    way = np.where(np.abs(lean) < slack, 0, -np.sign(lean)).astype(int)  # 0: a vertical ruling
    at = np.searchsorted(s, x, side="right") - (way < 0)
    state = np.where(way == 0, REACHED, WALKING)
    while (state == WALKING).any():
        k = np.clip(at, 0, KNOTS - 1)
        reached = (s[k] + y * cot[k] - x) * -way <= slack
        turned = (cot[k] + (x - s[k]) * rate[k]) * cot[k] <= 0
        found = np.where(reached, REACHED, np.where(turned, BEHIND, WALKING))
        state = np.where(state == WALKING, np.where(k == at, found, BEYOND), state)
        at = at + way * (state == WALKING)
    hit, before = (knots[np.clip(i, 0, KNOTS - 1)] for i in (at, at - way))
    before = np.where(way > 0, np.maximum(before, start), np.minimum(before, start))
    t, slope = _newton(curve, x, y, np.where(way == 0, start, [hit, before]))
    state = np.where((state == BEYOND) | (slope > 0), state, BEHIND)
    _require(state == REACHED, lambda i: FAULTS[int(state[i])])
    return t


def _newton(curve, x, y, ends):
    """The root t of s + y cot psi(s) = x between two ends, and the slope, nan without a root."""
    low, high = np.sort(ends, axis=0)
    t = (low + high) / 2
    for _ in range(8):
        cot, rate, *_ = darboux(curve, t)
        off, slope = curve.integral(t) + y * cot - x, 1 + y * rate
        step = off / np.where(slope > 0, slope * curve.integral.deriv()(t), np.inf)
        t = np.clip(t - step, low, high)
    found = np.abs(off) < 1e-9 * (curve.length + np.abs(y))
    return t, np.where(found, slope, np.nan)


def tangent(bend: Callable, z: ArrayLike, direction: ArrayLike, step: float = 0.02) -> np.ndarray:
    """The derivative of a map of the plane into space along a direction: (..., 3).

    bend: function of complex arrays; z, direction: complex, broadcasting.  Differences of
    order step^8; the points z +- 4 step direction must lie on the surface."""
    z, change = np.broadcast_arrays(np.asarray(z, dtype=complex), step * np.asarray(direction))
    weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
    return sum(c * (bend(z + k * change) - bend(z - k * change)) for k, c in weights.items()) / step


def rolled_grid(
    theta: float,
    theta0: float,
    m: int,
    n: int,
    curvature: float,
    origin: complex = 0,
    edge: float = 1.0,
    direction: complex = 1,
) -> np.ndarray:
    """A planar grid, complex (m+1, n+1), that is an exact isogonal net when rolled.

    As `conformal.sheared_grid`, with another step v: the chords of `roll(z, curvature)` have
    both angles exactly.  For the direction 1 and edge = 2 pi / (m curvature) the net closes.
    ValueError when the edge is too long for such a face."""
    lam, mu = ratios(theta, theta0)
    if not np.isfinite(curvature):
        raise ValueError(f"curvature = {curvature}: a finite number is wanted")
    if not (np.isfinite(edge) and edge > 0) or abs(edge * curvature) >= np.pi:
        raise ValueError(f"edge = {edge}: it must be positive and shorter than half a turn")
    m, n = check_whole("m", m), check_whole("n", n)
    u, half = edge * unit(direction), curvature / 2

    def square(a, b=0):  # of the chord along a, in the middle of two that are b apart
        across = np.real(a) * np.sinc(half * np.real(a) / np.pi) * np.cos(half * np.real(b))
        return across**2 + np.imag(a) ** 2

    def off(parts):
        v = edge * complex(*parts)
        sides = np.log(square(u + v) / square(u - v)) - 2 * np.log(lam)
        return sides, np.log(square(u, v) / square(v, u)) - 2 * np.log(mu)

    start = rho(lam, mu) * u / edge
    found = root(off, [start.real, start.imag], tol=1e-15)
    if not np.abs(found.fun).max() < 1e-12:
        raise ValueError(f"edge = {edge}: no face with these angles fits on the cylinder")
    return origin + u * np.arange(m + 1)[:, None] + edge * complex(*found.x) * np.arange(n + 1)


def _complex(z):
    """The points of a plane net as a complex array, or a ValueError."""
    z = np.asarray(z)
    if z.dtype.kind in "iuf" and z.ndim and z.shape[-1] == 2:
        z = z[..., 0] + 1j * z[..., 1]
    if z.dtype.kind != "c" or z.size == 0:
        words = "complex numbers or real points (..., 2) of the plane are wanted, at least one"
        raise ValueError(f"z has the shape {z.shape} and type {z.dtype}: {words}")
    _require(np.isfinite(z), lambda at: "is not a finite number")
    return z


def _space(xy, height):
    return np.stack([xy.real, xy.imag, height], axis=-1)


def _require(good, why):
    """ValueError that names the first grid point that is not good; why(index) says the rest."""
    if not np.all(good):
        at = np.unravel_index(np.argmin(good), np.shape(good))
        raise ValueError(f"grid point {tuple(map(int, at))} {why(at)}")


def _require_dimension(curve, dimension):
    found = len(curve.position(curve.start, 0))
    if found != dimension:
        raise ValueError(f"the curve has {found} coordinates: {dimension} are wanted here")


def _require_rulings(curve):
    """ValueError unless `curve` is a space curve whose curvature never vanishes."""
    _require_dimension(curve, 3)
    t = np.linspace(curve.start, curve.stop, 1025)
    r1, r2 = curve.position(t, 1), curve.position(t, 2)
    b = np.cross(r1, r2)
    good = norm(b, axis=-1) * curve.length > 1e-9 * norm(r1, axis=-1) ** 3
    good[1:] &= np.sum(b[1:] * b[:-1], axis=-1) > 0
    if not good.all():
        s = curve.integral(t[np.argmin(good)])
        words = "the surface has no ruling there"
        raise ValueError(f"the curvature vanishes near arc length {s:.6g}: {words}")
