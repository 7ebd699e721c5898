"""Isometric bending of planar nets: cylinders, cones, and the surface along any geodesic.

A planar net is a complex array z (or an array (..., 2) of plane points); every map here
returns points (..., 3) and keeps lengths, angles and areas measured along the surface.  At
its flat end each map leaves the net where it is, in the plane z = 0.

Paper: Sec. 5.1.
"""

import numpy as np
from scipy.optimize import root

from .conformal import unit
from .curves import Curve as Curve  # public here too
from .curves import arc_length as arc_length
from .curves import bezier as bezier
from .curves import darboux as darboux
from .curves import require, require_dimension, require_rulings
from .mesh import _check_counts
from .parallelogram import _lib, ratios, rho

KNOTS = 2049  # on a curve, where the edge of regression is looked for
SLACK = 1e-12  # of the length of a curve: rounding, where the first and last rulings tie
BEHIND = "lies behind the edge of regression: y psi' < sin(psi)^2 fails on the way from (x, 0)"
BEYOND = "lies beyond the last ruling of the curve: take a longer curve"
DIFFERENCES = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])  # of eighth order, central


def _complex(z):
    """The points of a plane net as a complex array, or a ValueError."""
    z = np.asarray(z)
    if z.dtype.kind in "iuf" and z.ndim and z.shape[-1] == 2:
        z = z[..., 0] + 1j * z[..., 1]
    if z.dtype.kind != "c" or z.size == 0:
        raise ValueError(
            f"z has the shape {z.shape} and type {z.dtype}: complex numbers or real points "
            "(..., 2) of the plane are wanted, at least one"
        )
    require(np.isfinite(z), lambda at: "is not a finite number")
    return z


def _space(xy, height):
    return np.stack([xy.real, xy.imag, height], axis=-1)


# --- cylinders and cones ------------------------------------------------------------------


def roll_coordinates(x, y, curvature):
    """Coordinates (X, Y, Z) of the plane point (x, y) on a cylinder with rulings along y.

    X = sin(k x) / k, Y = y, Z = (1 - cos(k x)) / k for the curvature k, written so that k = 0
    is the plane; numbers, arrays or sympy symbols.

    Paper: Sec. 5.1 (rotational cylinder).
    """
    xp = _lib(x, y, curvature)

    def sinc(t):
        return np.sinc(t / np.pi) if xp is np else xp.sin(t) / t

    turn = curvature * x
    return x * sinc(turn), y, x * turn / 2 * sinc(turn / 2) ** 2


def roll(z, curvature, direction=1):
    """A planar net rolled onto a rotational cylinder of radius 1 / |curvature|: (..., 3).

    z: complex (...) or real (..., 2); direction: complex, along which the sheet curls (its
    length ignored), across the rulings.  The ruling through 0 stays where it is.  Curvature 0
    is the plane; the cylinder closes when curvature times the width along `direction` is
    2 pi.  A negative curvature bends down.

    Paper: Sec. 5.1, Fig. 7.
    """
    z, along = _complex(z), unit(direction)
    if not np.isfinite(curvature):
        raise ValueError(f"curvature = {curvature}: a finite number is wanted")
    w = z * np.conj(along)
    x, y, height = roll_coordinates(w.real, w.imag, curvature)
    return _space((x + 1j * y) * along, height)


def cone_coordinates(distance, angle, gamma):
    """Coordinates (X, Y, Z) of a plane point in polar coordinates on a cone, apex at 0.

    gamma: the angle between the rulings and the z-axis; numbers, arrays or sympy symbols.

    Paper: Sec. 5.1 (cone).
    """
    xp = _lib(distance, angle, gamma)
    narrow, lift = xp.sin(gamma), xp.sin(xp.pi / 2 - gamma)  # exactly 1 and 0 for pi/2
    turn = angle / narrow
    return distance * narrow * xp.cos(turn), distance * narrow * xp.sin(turn), distance * lift


def cone(z, gamma, apex=0, direction=1):
    """A planar net bent onto a rotational cone with a vertical axis: (..., 3).

    z: complex (...) or real (..., 2); gamma: radians in (0, pi), the angle between the rulings
    and the upward axis: pi/2 is the plane, less opens upwards, more downwards; apex: complex;
    direction: complex, of the ruling that keeps its vertical plane.  The sheet is slit opposite
    to it and may span an angle of at most 2 pi sin(gamma) around the apex: then the cone closes.

    Paper: Sec. 5.1, Fig. 7.
    """
    z, along = _complex(z), unit(direction)
    if not 0 < gamma < np.pi:
        raise ValueError(f"gamma = {gamma}: an angle between 0 and pi is wanted")
    if not np.isfinite(apex):
        raise ValueError(f"apex = {apex}: a finite complex number is wanted")
    w = (z - apex) * np.conj(along)
    angle = np.angle(w)
    span, room = np.ptp(angle), 2 * np.pi * np.sin(gamma)
    if span > room * (1 + 1e-12):
        raise ValueError(
            f"the net spans {span:.6g} radians around the apex, but the cone has room for "
            f"2 pi sin(gamma) = {room:.6g} only: it would overlap itself"
        )
    x, y, height = cone_coordinates(np.abs(w), angle, gamma)
    return _space((x + 1j * y) * along + apex, height)


def cylinder(z, directrix, direction=1):
    """A planar net bent onto the general cylinder over a plane curve: (..., 3).

    z: complex (...) or real (..., 2), x along `direction` from 0 to the length of the curve;
    directrix: a `Curve` of two coordinates, which become the horizontal and the vertical one.

    Paper: Sec. 5.1 (general cylinder).
    """
    z, along = _complex(z), unit(direction)
    require_dimension(directrix, 2)
    w = z * np.conj(along)
    x, height = np.moveaxis(directrix.point(w.real), -1, 0)
    return _space((x + 1j * w.imag) * along, height)


# --- the rectifying developable -----------------------------------------------------------


def rectifying(z, curve):
    """A planar net bent so that the x-axis becomes the given space curve, a geodesic: (..., 3).

    z: complex (...) or real (..., 2); curve: a `Curve` of three coordinates.  The ruling at
    arc length s makes the angle psi(s) with the x-axis, so the point (x, y) lies on the one
    with x - s = y cot psi(s).  The side y > 0 is that of the binormal.  ValueError names the
    first point behind the edge of regression, where y psi' < sin(psi)^2 fails, or beyond the
    last ruling of the curve; a curve whose curvature vanishes has no rulings.

    Paper: Sec. 5.1, Fig. 7.
    """
    z = _complex(z)
    require_rulings(curve)
    t = _feet(curve, z.real, z.imag)
    cot, _, T, B, _ = darboux(curve, t)
    return curve.position(t, 0) + z.imag[..., None] * (cot[..., None] * T + B)


def _feet(curve, x, y):
    """Parameters t of the rulings through the plane points (x, y), arrays of one shape.

    The vertical line through x meets the ruling of s at the height Y(s) = (x - s) / cot psi(s),
    and Y(x) = 0.  Walk from s = x, knot by knot, until Y passes y; where Y turns back before,
    y psi' = sin(psi)^2 and the line has left the surface.
    """
    start = curve.parameter(x)
    knots = np.linspace(curve.start, curve.stop, KNOTS)
    s, (cot, rate, *_) = curve.integral(knots), darboux(curve, knots)
    first = y * darboux(curve, start)[0]  # 0: the ruling is vertical, up to rounding
    first = np.where(np.abs(first) < SLACK * curve.length, 0, first)
    way = -np.sign(first).astype(int)
    at = np.searchsorted(s, x, side="right") - (way < 0)
    walking, ended, turned = way != 0, np.zeros(x.shape, bool), np.zeros(x.shape, bool)
    while walking.any():
        ended = ended | (walking & ((at < 0) | (at >= KNOTS)))
        k = np.clip(at, 0, KNOTS - 1)
        walking = walking & ~ended & ((s[k] + y * cot[k] - x) * -way > SLACK * curve.length)
        turned = turned | (walking & ((cot[k] + (x - s[k]) * rate[k]) * cot[k] <= 0))
        walking = walking & ~turned
        at = at + way * walking
    hit, before = (knots[np.clip(i, 0, KNOTS - 1)] for i in (at, at - way))
    before = np.where(way > 0, np.maximum(before, start), np.minimum(before, start))
    t, slope = _newton(curve, x, y, np.where(way == 0, start, [hit, before]))
    turned = turned | (~ended & ~(slope > 0))
    require(~(ended | turned), lambda i: BEHIND if turned[i] else BEYOND)
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


def regression(curve, s):
    """The edge of regression at the arc lengths s: (plane points complex (...), points (..., 3)).

    nan where neighbouring rulings are parallel, as on a cylinder.

    Paper: Sec. 5.1 (tangent surface).
    """
    require_rulings(curve)
    t = curve.parameter(s)
    cot, rate, T, B, _ = darboux(curve, t)
    parallel = np.abs(rate) * curve.length**2 < 1e-12
    y = np.where(parallel, np.nan, -1 / np.where(parallel, 1, rate))
    points = curve.position(t, 0) + y[..., None] * (cot[..., None] * T + B)
    return np.asarray(s) + y * cot + 1j * y, points


# --- measuring, and chords ----------------------------------------------------------------


def tangent(bend, z, direction, step=0.02):
    """The derivative of a map of the plane into space along a direction: (..., 3).

    bend: function of complex arrays; z, direction: complex, broadcasting.  Eight central
    differences of order step^8; the points z +- 4 step direction must lie on the surface.

    Paper: Sec. 5.1 (measuring).
    """
    z, change = np.broadcast_arrays(np.asarray(z, dtype=complex), step * np.asarray(direction))
    total = 0
    for k, weight in enumerate(DIFFERENCES, 1):
        total = total + weight * (bend(z + k * change) - bend(z - k * change))
    return total / step


def rolled_grid(theta, theta0, m, n, curvature, origin=0, edge=1.0, direction=1):
    """A planar grid, complex (m+1, n+1), that is an exact isogonal net when rolled.

    As `conformal.sheared_grid`, but the step v is changed a little, so that the chords of
    `roll(z, curvature)` have exactly the angles theta and theta0 in every face.  For the
    direction 1 and edge = 2 pi / (m curvature) the net closes.  ValueError when the edge is
    too long for such a face.

    Paper: Sec. 5.1 (beyond the paper).
    """
    lam, mu = ratios(theta, theta0)
    if not np.isfinite(curvature):
        raise ValueError(f"curvature = {curvature}: a finite number is wanted")
    if not (np.isfinite(edge) and edge > 0) or abs(edge * curvature) >= np.pi:
        raise ValueError(f"edge = {edge}: it must be positive and shorter than half a turn")
    m, n = _check_counts(m, n)
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
    v = edge * complex(*found.x)
    return origin + u * np.arange(m + 1)[:, None] + v * np.arange(n + 1)
