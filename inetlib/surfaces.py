"""Parametrised surfaces: kinematic ones, isothermal ones, and profiles of revolution.

A `Surface` is a function of two parameters; it takes numbers, arrays or sympy symbols.  A
`Profile` is the meridian of a surface of revolution, two callables of one parameter; its
Mercator coordinate w = int ds / radius makes (angle, w) isothermal.  The last one is a
freeform mesh, a start for the optimisation.

Paper: Sec. 5, Sec. 5.2, Fig. 12.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.differentiate import derivative
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import make_interp_spline

from .mesh import grid_quads
from .parallelogram import library


class Surface(NamedTuple):
    """A surface: `coordinates(u, v)` returns x, y, z; numbers, arrays or sympy symbols."""

    name: str
    coordinates: object

    def point(self, u, v):
        """Points (..., 3) at the parameters u, v (numbers or arrays that broadcast)."""
        return np.stack(np.broadcast_arrays(*self.coordinates(u, v)), axis=-1)


class Profile(NamedTuple):
    """A meridian: radius(t) > 0 and height(t) on start <= t <= stop, callables of arrays.

    t is any regular parameter (radius' and height' never vanish together).
    """

    radius: object
    height: object
    start: float
    stop: float


# --- isothermal parametrisations: E = G, F = 0 --------------------------------------------


def _revolution(name, radius, height):
    """(f(v) cos u, f(v) sin u, g(v)) with f and g given as functions of (v, library)."""

    def coordinates(u, v):
        xp = library(u, v)
        f, g = radius(v, xp), height(v, xp)
        return f * xp.cos(u), f * xp.sin(u), g + 0 * u

    return Surface(name, coordinates)


CYLINDER = _revolution("cylinder", lambda v, xp: 1 + 0 * v, lambda v, xp: v)
SPHERE = _revolution("sphere", lambda v, xp: 1 / xp.cosh(v), lambda v, xp: xp.tanh(v))
CATENOID = _revolution("catenoid", lambda v, xp: xp.cosh(v), lambda v, xp: v)


def _helicoid(u, v):
    xp = library(u, v)
    return xp.sinh(v) * xp.sin(u), -xp.sinh(v) * xp.cos(u), u + 0 * v


HELICOID = Surface("helicoid", _helicoid)


def conjugate(t):
    """The minimal surface cos(t) catenoid + sin(t) helicoid, isothermal for every t (radians)."""

    def coordinates(u, v):
        xp = library(u, v, t)
        pairs = zip(CATENOID.coordinates(u, v), HELICOID.coordinates(u, v), strict=True)
        return tuple(xp.cos(t) * c + xp.sin(t) * h for c, h in pairs)

    return Surface("conjugate minimal surface", coordinates)


# --- surfaces of revolution from any profile ----------------------------------------------


def slope(profile, t):
    """(radius'(t), height'(t)) on [start, stop], arrays of the shape of t.

    Callables with a method `derivative` (scipy's splines) are asked for it; for others
    finite differences of order 8 that stay inside the profile, about 1e-10 relative for
    smooth callables.

    Paper: Eq. (14).
    """
    t = np.asarray(t, dtype=float)
    return tuple(_slope(f, t, profile) for f in (profile.radius, profile.height))


def _slope(f, t, profile):
    if hasattr(f, "derivative"):
        return f.derivative()(t)
    reach = (profile.stop - profile.start) / 20
    side = np.where(t - profile.start < reach, 1, np.where(profile.stop - t < reach, -1, 0))
    options = {"initial_step": reach / 2, "step_direction": side, "order": 8}
    return derivative(lambda x: f(x) + 0 * x, t, **options).df


def mercator(profile):
    """The Mercator coordinate of a meridian and its inverse: two callables (w_of_t, t_of_w).

    w(t) = int ds / radius from profile.start, for w from 0 to w(stop); both take arrays, and
    t_of_w gives start or stop for a w beyond this range.  (angle, w) is an isothermal
    parametrisation of the surface of revolution.  About 1e-12 for smooth callables, 1e-9 for
    cubic splines.  ValueError for a profile that `check_profile` refuses.

    Paper: Sec. 5.2 (isothermal; beyond the paper: B4).
    """
    check_profile(profile)

    def rate(t):
        return np.hypot(*slope(profile, t)) / profile.radius(t)

    return _integral(rate, profile.start, profile.stop)


def _integral(rate, start, stop):
    """int rate dt from start, as a function of t, and its inverse; rate > 0."""
    t = _nodes(rate, start, stop)
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


def _nodes(rate, start, stop, count=2001):
    """Parameters between start and stop, closer together where the rate is high.

    Near the axis ds / radius grows without bounds, and nodes that are uniform in t miss it.
    """
    t = np.linspace(start, stop, count)
    for _ in range(4):
        grown = cumulative_trapezoid(rate(t), t, initial=0)
        measure = grown / grown[-1] + (t - start) / (stop - start)
        t = np.interp(np.linspace(0, measure[-1], count), measure, t)
    return t


def check_profile(profile):
    """The profile itself, or a ValueError that says what is wrong with it.

    Refused: an empty interval, a radius that is not positive, values that are not finite, a
    meridian that stands still, turns back or has a corner sharper than 90 degrees.

    Paper: Eq. (14).
    """
    if not (np.isfinite([profile.start, profile.stop]).all() and profile.start < profile.stop):
        raise ValueError(
            f"the profile runs from {profile.start} to {profile.stop}: start < stop wanted"
        )
    t = np.linspace(profile.start, profile.stop, 257)
    radius, height = (np.broadcast_to(f(t), t.shape) for f in (profile.radius, profile.height))
    if not (np.isfinite(radius) & np.isfinite(height)).all():
        raise ValueError("the profile is not finite everywhere between start and stop")
    if not (radius > 0).all():
        worst = np.argmin(radius)
        raise ValueError(
            f"radius = {radius[worst]:.6g} at t = {t[worst]:.6g}: it must stay positive, "
            "shorten the profile so that it does not reach the axis"
        )
    steps = np.stack([np.diff(radius), np.diff(height)])
    if not np.all(np.hypot(*steps) > 0):
        raise ValueError("the profile stands still somewhere: radius' and height' vanish together")
    turn = np.sum(steps[:, 1:] * steps[:, :-1], axis=0)
    if not np.all(turn > 0):
        raise ValueError(
            f"the profile turns back or has a sharp corner near t = {t[1 + np.argmin(turn)]:.6g}"
        )
    return profile


def revolve(profile, angle, t):
    """Points (..., 3) of the surface of revolution at the angle and the meridian parameter t.

    Paper: Eq. (14).
    """
    radius, height = profile.radius(t), profile.height(t)
    points = radius * np.cos(angle), radius * np.sin(angle), height + 0 * np.asarray(angle)
    return np.stack(np.broadcast_arrays(*points), axis=-1)


def sphere_profile(radius=1.0, start=-1.2, stop=1.2):
    """A sphere by latitude t (radians), between two parallels.

    Paper: Sec. 5.3, Fig. 11.
    """
    return Profile(lambda t: radius * np.cos(t), lambda t: radius * np.sin(t), start, stop)


def torus_profile(major=2.0, minor=0.8, start=-np.pi, stop=np.pi):
    """A torus by the angle t around its tube, major > minor > 0."""
    if not major > minor > 0:
        raise ValueError(f"major = {major}, minor = {minor}: major > minor > 0 is wanted")
    return Profile(lambda t: major + minor * np.cos(t), lambda t: minor * np.sin(t), start, stop)


def cone_profile(gamma, start=0.2, stop=2.0):
    """A cone of half vertex angle gamma (radians) by the distance t from its vertex."""
    if not 0 < gamma < np.pi / 2:
        raise ValueError(f"gamma = {gamma}: half the vertex angle lies between 0 and pi/2")
    return Profile(lambda t: t * np.sin(gamma), lambda t: t * np.cos(gamma), start, stop)


def catenoid_profile(start=-1.2, stop=1.2):
    """A catenoid of unit waist by its height t."""
    return Profile(lambda t: np.cosh(t), lambda t: t + 0.0, start, stop)


def vase_profile(start=0.0, stop=3.2):
    """A vase with a belly, a neck and a lip, by its height t.

    Paper: Fig. 11.
    """
    return Profile(lambda t: 0.72 + 0.33 * np.sin(1.9 * t + 0.25), lambda t: t + 0.0, start, stop)


PROFILES: dict[str, Callable[[], Profile]] = {
    "sphere": sphere_profile,
    "torus": torus_profile,
    "catenoid": catenoid_profile,
    "vase": vase_profile,
    "cone": partial(cone_profile, np.radians(30)),
}


def spline_profile(points):
    """The cubic spline through sampled points of a meridian, by their chord length.

    points: (k, 2), radius and height, k >= 2, no two neighbours equal, else ValueError;
    two or three points give a line or a parabola.
    """
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2:
        raise ValueError(f"points have the shape {points.shape}: (radius, height) rows are wanted")
    if not np.isfinite(points).all():
        raise ValueError(f"point {np.argmin(np.isfinite(points).all(axis=1))} is not finite")
    chords = np.hypot(*np.diff(points, axis=0).T)
    if not chords.all():
        raise ValueError(f"points {np.argmin(chords)} and {np.argmin(chords) + 1} are the same")
    t = np.concatenate([[0.0], np.cumsum(chords)])
    radius, height = (make_interp_spline(t, x, k=min(3, len(t) - 1)) for x in points.T)
    return check_profile(Profile(radius, height, 0.0, float(t[-1])))


# --- a freeform patch ---------------------------------------------------------------------


def freeform_patch(m=20, n=20):
    """A roof with a dome, a saddle and curved boundaries as a mesh (V, Q), m x n quads.

    V: ((m+1)(n+1), 3), its bounding box has the diagonal 1 and its centre at 0; Q as in
    `mesh.grid_quads`.  The quads are neither square nor alike, so every isogonal net on it
    has to be found.

    Paper: Fig. 12.
    """
    Q = grid_quads(m, n)
    u, v = np.meshgrid(np.linspace(-1, 1, m + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    x = 1.25 * u + 0.38 * v + 0.08 * np.sin(2 * v)
    y = v * (1 - 0.06 * u) - 0.25 * u + 0.12 * u * u
    wave, vault = 0.52 * np.cos(2.3 * (u + 0.42) + 0.3 * v), 0.34 * (1 - 0.3 * u)
    V = np.stack([x, y, wave - vault * (v - 0.1) ** 2 - 0.1 * u * v], axis=-1).reshape(-1, 3)
    V -= (V.min(axis=0) + V.max(axis=0)) / 2
    return V / np.linalg.norm(np.ptp(V, axis=0)), Q


# --- The fundamental forms of a parametrised surface. ---

STENCIL = {1: 45 / 60, 2: -9 / 60, 3: 1 / 60}  # of the first derivative, odd in the offset
STEP = 0.01


def tangents(surface, u, v, step=STEP):
    """(X_u, X_v): triples of expressions for symbols, arrays (3, ...) for numbers.

    Numbers: accurate to about 1e-13 where the surface is smooth on +-3 steps around (u, v).
    """
    if library(u, v) is not np:
        X = surface.coordinates(u, v)
        return tuple(tuple(x.diff(t) for x in X) for t in (u, v))
    return _difference(_points(surface), u, v, step)


def _points(surface):
    return lambda u, v: np.moveaxis(surface.point(u, v), -1, 0)


def _difference(f, u, v, h):
    """Both first derivatives of an array-valued function."""
    u, v = np.asarray(u, dtype=float), np.asarray(v, dtype=float)
    along_u = sum(c * (f(u + k * h, v) - f(u - k * h, v)) for k, c in STENCIL.items()) / h
    along_v = sum(c * (f(u, v + k * h) - f(u, v - k * h)) for k, c in STENCIL.items()) / h
    return along_u, along_v


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def first_form(surface, u, v, step=STEP):
    """(E, F, G) = (X_u . X_u, X_u . X_v, X_v . X_v) at the parameters u, v.

    u, v: sympy symbols (exact, not simplified), or numbers or arrays (see `tangents`).
    """
    a, b = tangents(surface, u, v, step)
    return _dot(a, a), _dot(a, b), _dot(b, b)


def second_form(surface, u, v, step=STEP):
    """(L, M, N), the products of X_uu, X_uv and X_vv with the unit normal X_u x X_v / |.|.

    u, v: sympy symbols (exact, not simplified), or numbers or arrays (about 1e-11).
    """
    a, b = tangents(surface, u, v, step)
    if library(u, v) is not np:
        uu, uv = (tuple(x.diff(t) for x in a) for t in (u, v))
        vv = tuple(x.diff(v) for x in b)
    else:
        (uu, uv), (_, vv) = (
            _difference(lambda *p, k=k: np.stack(tangents(surface, *p, step)[k]), u, v, step)
            for k in (0, 1)
        )
    E, F, G = _dot(a, a), _dot(a, b), _dot(b, b)
    normal = tuple(a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3))
    area = library(u, v).sqrt(E * G - F * F)
    return tuple(_dot(x, normal) / area for x in (uu, uv, vv))


def mean_curvature(surface, u, v, step=STEP):
    """The mean curvature (E N - 2 F M + G L) / (2 (E G - F^2)); zero on minimal surfaces.

    u, v as in `second_form`.
    """
    E, F, G = first_form(surface, u, v, step)
    L, M, N = second_form(surface, u, v, step)
    return (E * N - 2 * F * M + G * L) / (2 * (E * G - F * F))


# --- Surfaces swept by a moving curve: Darboux surfaces and the three kinematic kinds. ---


def darboux(matrix, generatrix, shift):
    """The surface A(v) X(u) + a(v) of a curve under a rigid motion.

    matrix(v): three rows of three entries, orthogonal (not checked); generatrix(u) and
    shift(v): triples.
    """

    def coordinates(u, v):
        curve = generatrix(u)
        rows = zip(matrix(v), shift(v), strict=True)
        return tuple(sum(a * x for a, x in zip(row, curve, strict=True)) + s for row, s in rows)

    return Surface("Darboux surface", coordinates)


def turn(v):
    """The rotation by the angle v about the z-axis, as three rows."""
    xp = library(v)
    c, s = xp.cos(v), xp.sin(v)
    return (c, -s, 0), (s, c, 0), (0, 0, 1)


def translation(generatrix, path):
    """The surface X(u) + a(v): one curve moved along another without turning."""
    unit = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    return darboux(lambda v: unit, generatrix, path)._replace(name="translation surface")


def rotational(generatrix):
    """The surface swept by a curve that turns about the z-axis by the angle v.

    Paper: Sec. 5 (rotational surfaces), Eq. (14).
    """
    return helical(generatrix, 0)._replace(name="rotational surface")


def helical(generatrix, pitch):
    """The surface swept by a curve that turns by the angle v and climbs by pitch v."""
    surface = darboux(turn, generatrix, lambda v: (0, 0, pitch * v))
    return surface._replace(name="helical surface")


def helical_isothermal(profile, pitch):
    """A helical surface in isothermal parameters, and their range: (Surface, w_stop).

    profile: a `surfaces.Profile`, turned and lifted by pitch a radian.  The surface takes
    (x, w), any angle x and 0 <= w <= w_stop.  With E, F, G of the meridian and the helices,
    w = int sqrt(EG - F^2) / E dt and x = angle + int F / E dt.  Numbers and arrays only; with
    pitch = 0 it is `surfaces.mercator`.
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
