"""Kinematic and isothermal surfaces, their fundamental forms, and meridians of revolution."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .mesh import grid_quads
from .parallelogram import library

STENCIL = {1: 45 / 60, 2: -9 / 60, 3: 1 / 60}  # of the first derivative, odd in the offset


class Surface(NamedTuple):
    """A surface: `coordinates(u, v)` returns x, y, z; numbers, arrays or sympy symbols."""

    name: str
    coordinates: Callable

    def point(self, u: ArrayLike, v: ArrayLike) -> np.ndarray:
        """Points (..., 3) at the parameters u, v (numbers or arrays that broadcast)."""
        return np.stack(np.broadcast_arrays(*self.coordinates(u, v)), axis=-1)


def darboux(matrix: Callable, generatrix: Callable, shift: Callable) -> Surface:
    """The surface A(v) X(u) + a(v) of a curve under a rigid motion.

    matrix(v): three rows of three entries, orthogonal (not checked); generatrix(u) and
    shift(v): triples."""

    def coordinates(u, v):
        X, rows = generatrix(u), zip(matrix(v), shift(v), strict=True)
        return tuple(sum(a * x for a, x in zip(row, X, strict=True)) + s for row, s in rows)

    return Surface("Darboux surface", coordinates)


def translation(generatrix: Callable, path: Callable) -> Surface:
    """The surface X(u) + a(v): one curve moved along another without turning."""
    identity = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    surface = darboux(lambda v: identity, generatrix, path)
    return surface._replace(name="translation surface")


def helical(generatrix: Callable, pitch: float) -> Surface:
    """The surface swept by a curve that turns about the z-axis by v and climbs by pitch v."""

    def turn(v):
        xp = library(v)
        c, s = xp.cos(v), xp.sin(v)
        return (c, -s, 0), (s, c, 0), (0, 0, 1)

    surface = darboux(turn, generatrix, lambda v: (0, 0, pitch * v))
    return surface._replace(name="helical surface")


def rotational(generatrix: Callable) -> Surface:
    """The surface swept by a curve that turns about the z-axis by the angle v.

    Paper: Sec. 5 (rotational surfaces), Eq. (14)."""
    return helical(generatrix, 0)._replace(name="rotational surface")


def tangents(surface: Surface, u: ArrayLike, v: ArrayLike, step: float = 0.01) -> tuple:
    """(X_u, X_v), arrays (3, ...): expressions for sympy symbols (exact, not simplified).

    Numbers: by differences, accurate to about 1e-13, second derivatives to 1e-11, where the
    surface is smooth on +-6 steps around (u, v)."""
    xp = library(u, v)
    if xp is not np:
        X = surface.coordinates(u, v)
        return tuple(np.array([xp.diff(x, t) for x in X]) for t in (u, v))
    s, t = np.asarray(u, dtype=float), np.asarray(v, dtype=float)

    def chord(i, j):
        return np.moveaxis(surface.point(s + i, t + j) - surface.point(s - i, t - j), -1, 0)

    along_u = sum(c * chord(k * step, 0) for k, c in STENCIL.items()) / step
    along_v = sum(c * chord(0, k * step) for k, c in STENCIL.items()) / step
    return along_u, along_v


def first_form(surface: Surface, u: ArrayLike, v: ArrayLike, step: float = 0.01) -> tuple:
    """(E, F, G) = (X_u . X_u, X_u . X_v, X_v . X_v); the arguments are those of `tangents`."""
    a, b = tangents(surface, u, v, step)
    return tuple(np.sum(x * y, axis=0) for x, y in ((a, a), (a, b), (b, b)))


def ratios(surface: Surface, u: ArrayLike, v: ArrayLike, step: float = 0.01) -> tuple:
    """(lam, mu) = (|Y_v| / |Y_u|, |X_u| / |X_v|) with Y_u = X_u - X_v and Y_v = X_u + X_v.

    Arguments as for `tangents`.  Where both are constant, so are all angles of the four families
    of curves: an I-web, and its parameters are linear in isothermal ones.
    Paper: Thm 7, Thm 8, B3."""
    E, F, G = first_form(surface, u, v, step)
    xp = library(u, v)
    return xp.sqrt((E + 2 * F + G) / (E - 2 * F + G)), xp.sqrt(E / G)


def second_form(surface: Surface, u: ArrayLike, v: ArrayLike, step: float = 0.01) -> tuple:
    """(L, M, N): X_uu, X_uv and X_vv times the unit normal; arguments as for `tangents`."""
    along = (Surface("", lambda u, v, k=k: tangents(surface, u, v, step)[k]) for k in (0, 1))
    (uu, uv), (_, vv) = (tangents(X, u, v, step) for X in along)
    a, b = tangents(surface, u, v, step)
    E, F, G = first_form(surface, u, v, step)
    normal, area = np.cross(a, b, axis=0), library(u, v).sqrt(E * G - F * F)
    return tuple(np.sum(x * normal, axis=0) / area for x in (uu, uv, vv))


def mean_curvature(surface: Surface, u: ArrayLike, v: ArrayLike, step: float = 0.01) -> ArrayLike:
    """(E N - 2 F M + G L) / (2 (E G - F^2)), zero on minimal surfaces; see `tangents`."""
    E, F, G = first_form(surface, u, v, step)
    L, M, N = second_form(surface, u, v, step)
    return (E * N - 2 * F * M + G * L) / (2 * (E * G - F * F))


def _revolution(name, radius, height):
    """(f(v) cos u, f(v) sin u, g(v)) with f and g given as functions of (v, library)."""

    def coordinates(u, v):
        xp = library(u, v)
        f, g = radius(v, xp), height(v, xp)
        return f * xp.cos(u), f * xp.sin(u), g + 0 * u

    return Surface(name, coordinates)


def _helicoid(u, v):
    xp = library(u, v)
    return xp.sinh(v) * xp.sin(u), -xp.sinh(v) * xp.cos(u), u + 0 * v


CYLINDER = _revolution("cylinder", lambda v, xp: 1 + 0 * v, lambda v, xp: v)
SPHERE = _revolution("sphere", lambda v, xp: 1 / xp.cosh(v), lambda v, xp: xp.tanh(v))
CATENOID = _revolution("catenoid", lambda v, xp: xp.cosh(v), lambda v, xp: v)
HELICOID = Surface("helicoid", _helicoid)  # these four are isothermal: E = G, F = 0


def conjugate(t: float) -> Surface:
    """The minimal surface cos(t) catenoid + sin(t) helicoid, isothermal for every t (radians)."""

    def coordinates(u, v):
        xp = library(u, v, t)
        pairs = zip(CATENOID.coordinates(u, v), HELICOID.coordinates(u, v), strict=True)
        return tuple(xp.cos(t) * c + xp.sin(t) * h for c, h in pairs)

    return Surface("conjugate minimal surface", coordinates)


class Profile(NamedTuple):
    """A meridian: radius(t) > 0 and height(t) on start <= t <= stop, callables of arrays.

    t is any regular parameter (radius' and height' never vanish together)."""

    radius: Callable
    height: Callable
    start: float
    stop: float


def sphere_profile(radius: float = 1.0, start: float = -1.2, stop: float = 1.2) -> Profile:
    """A sphere by latitude t (radians), between two parallels."""
    return Profile(lambda t: radius * np.cos(t), lambda t: radius * np.sin(t), start, stop)


def torus_profile(
    major: float = 2.0, minor: float = 0.8, start: float = -np.pi, stop: float = np.pi
) -> Profile:
    """A torus by the angle t around its tube, major > minor > 0."""
    if not major > minor > 0:
        raise ValueError(f"major = {major}, minor = {minor}: major > minor > 0 is wanted")
    return Profile(lambda t: major + minor * np.cos(t), lambda t: minor * np.sin(t), start, stop)


def catenoid_profile(start: float = -1.2, stop: float = 1.2) -> Profile:
    """A catenoid of unit waist by its height t."""
    return Profile(np.cosh, lambda t: t + 0.0, start, stop)


def vase_profile(start: float = 0.0, stop: float = 3.2) -> Profile:
    """A vase with a belly, a neck and a lip, by its height t."""
    return Profile(lambda t: 0.72 + 0.33 * np.sin(1.9 * t + 0.25), lambda t: t + 0.0, start, stop)


def cone_profile(gamma: float, start: float = 0.2, stop: float = 2.0) -> Profile:
    """A cone by the distance t from its vertex; gamma: half the angle there (radians)."""
    if not 0 < gamma < np.pi / 2:
        raise ValueError(f"gamma = {gamma}: half the vertex angle lies between 0 and pi/2")
    return Profile(lambda t: t * np.sin(gamma), lambda t: t * np.cos(gamma), start, stop)


def barrel_profile(start: float = 0.0, stop: float = 3.0) -> Profile:
    """A barrel, widest half way up, by its height t: a parabola."""
    return Profile(lambda t: 1.12 - 0.42 * (t / 1.5 - 1) ** 2, lambda t: t + 0.0, start, stop)


def hourglass_profile(start: float = 0.0, stop: float = 3.0) -> Profile:
    """An hourglass, a hyperboloid of one sheet, by its height t."""
    return Profile(
        lambda t: 0.55 * np.sqrt(1 + 3 * (t / 1.5 - 1) ** 2), lambda t: t + 0.0, start, stop
    )


PROFILES: dict[str, Callable[[], Profile]] = {
    "sphere": sphere_profile,
    "torus": torus_profile,
    "catenoid": catenoid_profile,
    "vase": vase_profile,
    "cone": partial(cone_profile, np.radians(30)),
    "barrel": barrel_profile,
    "hourglass": hourglass_profile,
}


def spline_profile(points: ArrayLike) -> Profile:
    """The cubic spline through sampled points of a meridian, by their chord length.

    points: (k, 2), radius and height, k >= 2, no two neighbours equal, else ValueError;
    two or three points give a line or a parabola."""
    from scipy.interpolate import make_interp_spline

    rows = np.asarray(points, dtype=float)
    if rows.ndim != 2 or rows.shape[1] != 2 or len(rows) < 2:
        raise ValueError(f"points have the shape {rows.shape}: (radius, height) rows are wanted")
    if not np.isfinite(rows).all():
        raise ValueError(f"point {np.argmin(np.isfinite(rows).all(axis=1))} is not finite")
    chords = np.hypot(*np.diff(rows, axis=0).T)
    if not chords.all():
        raise ValueError(
            f"points {np.argmin(chords)} and {np.argmin(chords) + 1} are the same: leave one out"
        )
    t = np.concatenate([[0.0], np.cumsum(chords)])
    radius, height = (make_interp_spline(t, x, k=min(3, len(t) - 1)) for x in rows.T)
    return check_profile(Profile(radius, height, 0.0, float(t[-1])))


def check_profile(profile: Profile) -> Profile:
    """The profile itself, or a ValueError that says what is wrong with it.

    Refused: an empty interval, a radius that is not positive, values that are not finite, a
    meridian that stands still, turns back or has a corner sharper than 90 degrees."""
    radius, height, start, stop = profile
    if not (np.isfinite([start, stop]).all() and start < stop):
        raise ValueError(f"the profile runs from {start} to {stop}: start < stop wanted")
    t = np.linspace(start, stop, 257)
    x, y = (np.broadcast_to(f(t), t.shape) for f in (radius, height))
    if not np.isfinite([x, y]).all():
        raise ValueError("the profile is not finite everywhere between start and stop")
    if not (x > 0).all():
        at = np.argmin(x)
        words = "it must stay positive, shorten the profile so that it does not reach the axis"
        raise ValueError(f"radius = {x[at]:.6g} at the height {y[at]:.6g}: {words}")
    steps = np.diff([x, y])
    if not np.hypot(*steps).all():
        raise ValueError("the profile stands still somewhere: radius' and height' vanish together")
    turn = np.sum(steps[:, 1:] * steps[:, :-1], axis=0)
    if not (turn > 0).all():
        at = 1 + np.argmin(turn)
        where = f"near the radius {x[at]:.6g} and the height {y[at]:.6g}"
        raise ValueError(f"the profile turns back or has a sharp corner {where}: smooth it there")
    return profile


def slope(profile: Profile, t: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """(radius'(t), height'(t)) on [start, stop], arrays of the shape of t.

    By the method `derivative` of callables that have one (scipy's splines); else by finite
    differences of order 8 that stay inside the profile, about 1e-10 relative."""
    from scipy.differentiate import derivative

    at, reach = np.asarray(t, dtype=float), (profile.stop - profile.start) / 20
    side = np.where(at - profile.start < reach, 1, np.where(profile.stop - at < reach, -1, 0))

    def of(f):
        if hasattr(f, "derivative"):
            return f.derivative()(at)
        steps = {"initial_step": reach / 2, "step_direction": side, "order": 8}
        return derivative(lambda x: f(x) + 0 * x, at, **steps).df

    return of(profile.radius), of(profile.height)


def revolve(profile: Profile, angle: ArrayLike, t: ArrayLike) -> np.ndarray:
    """Points (..., 3) of the surface of revolution at the angle and the meridian parameter t.

    Paper: Eq. (14)."""
    radius, height = profile.radius(t), profile.height(t)
    points = radius * np.cos(angle), radius * np.sin(angle), height + 0 * np.asarray(angle)
    return np.stack(np.broadcast_arrays(*points), axis=-1)


def mercator(profile: Profile) -> tuple[Callable, Callable]:
    """(w_of_t, t_of_w): the Mercator coordinate of a meridian, and its inverse.

    w(t) = int ds / radius from profile.start; both take arrays, and t_of_w stays on the
    profile.  (angle, w) is isothermal on the surface of revolution.  About 1e-12 for smooth
    callables, 1e-9 for cubic splines.  ValueError as in `check_profile`.  Paper: B4."""
    check_profile(profile)

    def rate(t):
        return np.hypot(*slope(profile, t)) / profile.radius(t)

    return _integral(rate, profile.start, profile.stop)


def _integral(rate, start, stop):
    """int rate dt from start, as a function of t, and its inverse; rate > 0."""
    from scipy.interpolate import make_interp_spline

    t = np.linspace(start, stop, 2001)
    for _ in range(4):  # closer together where the rate is high, as near the axis
        value = rate(t)
        grown = np.concatenate([[0], np.cumsum(np.diff(t) * (value[1:] + value[:-1]) / 2)])
        measure = grown / grown[-1] + (t - start) / (stop - start)
        t = np.interp(np.linspace(0, measure[-1], t.size), measure, t)
    smooth = make_interp_spline(t, rate(t), k=7)
    integral = smooth.antiderivative()
    low = integral(start)
    values = integral(t) - low

    def inverse(w):
        guess = np.interp(w, values, t)
        for _ in range(4):  # Newton
            step = (integral(guess) - low - w) / smooth(guess)
            guess = np.clip(guess - step, start, stop)
        return guess

    return lambda t: integral(t) - low, inverse


def helical_isothermal(profile: Profile, pitch: float) -> tuple[Surface, float]:
    """The helical surface of a meridian in isothermal parameters: (Surface, w_stop).

    It takes numbers or arrays (x, w), any angle x and 0 <= w <= w_stop.  With E, F, G of the
    meridian and the helices, w = int sqrt(EG - F^2) / E dt and x = angle + int F / E dt."""
    check_profile(profile)

    def rates(t):
        """Those of w and of w + int F / E dt + t, which are positive."""
        radius, (f, g) = profile.radius(t), slope(profile, t)
        E = radius**2 + pitch**2
        root = np.sqrt(radius**2 * g**2 + E * f**2)
        return root / E, 1 + (pitch * g + root) / E

    w_of_t, t_of_w = _integral(lambda t: rates(t)[0], profile.start, profile.stop)
    drift_of_t, _ = _integral(lambda t: rates(t)[1], profile.start, profile.stop)

    def coordinates(x, w):
        t = t_of_w(w)
        angle = x - (drift_of_t(t) - w_of_t(t) - (t - profile.start))
        x, y, z = np.moveaxis(revolve(profile, angle, t), -1, 0)
        return x, y, z + pitch * angle

    return Surface("helical surface", coordinates), float(w_of_t(profile.stop))


def freeform_patch(m: int = 20, n: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """A roof with a dome, a saddle and curved boundaries as a mesh (V, Q), m x n quads.

    V: ((m+1)(n+1), 3), its bounding box has the diagonal 1 and its centre at 0; Q as in
    `mesh.grid_quads`.  Every isogonal net on it has to be found.  Paper: Fig. 12."""
    Q = grid_quads(m, n)
    u, v = np.meshgrid(np.linspace(-1, 1, m + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    x = 1.25 * u + 0.38 * v + 0.08 * np.sin(2 * v)
    y = v * (1 - 0.06 * u) - 0.25 * u + 0.12 * u * u
    wave, vault = 0.52 * np.cos(2.3 * (u + 0.42) + 0.3 * v), 0.34 * (1 - 0.3 * u)
    V = np.stack([x, y, wave - vault * (v - 0.1) ** 2 - 0.1 * u * v], axis=-1).reshape(-1, 3)
    V -= (V.min(axis=0) + V.max(axis=0)) / 2
    return V / np.linalg.norm(np.ptp(V, axis=0)), Q
