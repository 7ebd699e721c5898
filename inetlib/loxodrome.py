"""Webs of loxodromes and parallels on surfaces of revolution: smooth, as published, exact.

A web has m quads around the axis.  Ring j lies at the meridian parameter t[j] and is turned by
turn[j]; its vertices are (angle, parameter) = (i delta + turn[j], t[j]) with delta = 2 pi / m."""

from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, root

from . import measure, mesh, ties
from .mesh import Families
from .parallelogram import check_angle, check_positive, check_whole, from_rho, ratios
from .surfaces import Profile, check_profile, mercator, revolve, torus_profile

ENOUGH = "as many as asked for"
SHORT = "the profile is too short"
FITS = 1e-12  # a last row that is too high by this part of it still fits: the rest is rounding
MOST, MARCHED = 10_000_000, 5000  # quads of a web; rows that are found one by one
AROUND = "d1", "u", "d2", "v"  # the four directions, counter-clockwise within half a turn


class Net(NamedTuple):
    """A web: vertices, quads, the four families of curves, and how far it got.

    V        (m (rows + 1), 3), vertex i (rows + 1) + j is the i-th of ring j
    Q        (m rows, 4), closed around the axis, labelled as in `mesh`
    families point arrays (k, 3): u parallels (closed), v, d1 and d2 loxodromes
    rows, t  number of rows of quads; the meridian parameters of the rings (rows + 1,)
    message  how many rows there are, and why no more
    theta, theta0  the angles the net was made for, radians"""

    V: np.ndarray
    Q: np.ndarray
    families: Families
    rows: int
    t: np.ndarray
    message: str
    theta: float
    theta0: float


def loxodrome(profile: Profile, theta0: float, angle: float = 0, samples: int = 201) -> np.ndarray:
    """Points (samples, 3) of the loxodrome that meets every parallel at theta0.

    From profile.start at the given angle around the axis (radians) to profile.stop: alpha =
    angle + cot theta0 * w, evenly spaced in the Mercator coordinate w = int ds / radius.
    Paper: Eq. (15)."""
    theta0 = _angle("theta0", theta0)
    if not np.isfinite(angle):
        raise ValueError(f"angle = {angle}: a finite number is wanted")
    w_of_t, t_of_w = mercator(profile)
    w = np.linspace(0, w_of_t(profile.stop), check_whole("samples", samples, 2))
    return revolve(profile, angle + w / np.tan(theta0), t_of_w(w))


def web(
    profile: Profile,
    theta: float,
    theta0: float,
    m: int,
    n: int | None = None,
    method: str = "exact",
    equation: str = "lam",
) -> Net:
    """A web of (theta, theta0)-quads on a surface of revolution, as `Net`.

    theta, theta0: radians in (0, pi); m >= 3 quads around the axis; n rows from profile.start
    upwards, or as many as fit; `message` says when they are fewer.  ValueError when not even one
    fits.

    method "exact"   straight-edged quads with the angles asked for, to round-off
           "smooth"  points of the smooth web, in closed form; angles off by O(1 / m^2)
           "paper"   the published algorithm, on the smooth loxodromes, with its own equation
                     for the next parallel, equation = "lam"; or the better "mu"
    Paper: Alg. 1, Eq. (16), App. A.3, B4, B5."""
    check_profile(profile)
    theta, theta0 = _angle("theta", theta), _angle("theta0", theta0)
    m = check_whole("m", m, 3)
    n = None if n is None else check_whole("n", n)
    _check_size(profile, theta, theta0, m, n, method)
    if method == "smooth":  # equal steps of the Mercator coordinate
        w_of_t, t_of_w = mercator(profile)
        step = 2 * np.pi / m * np.sin(theta0) / ratios(theta, theta0)[1]
        fit = int(w_of_t(profile.stop) / step * (1 + ties.TIE))
        w = step * np.arange(1 + (fit if n is None else min(n, fit)))
        t, turn, why = t_of_w(w), w / np.tan(theta0), ENOUGH if len(w) - 1 == n else SHORT
    elif method == "exact":
        t, turn, why = _march(profile, n, *_exact_ring(profile, theta, theta0, m)[:2])
    elif method == "paper":
        _check_not_vacuous(theta, theta0, equation)
        t, turn, why = _march(profile, n, *_paper_ring(profile, theta, theta0, m, equation)[:2])
    else:
        raise ValueError(f'method = {method!r}: "exact", "smooth" or "paper" is wanted')
    if len(t) == 1:
        may = "a larger m (smaller quads), a longer profile or other angles may do"
        raise ValueError(f"not one row of {m} quads fits, {why}: {may}")
    asked = f" of {n}" if n is not None and len(t) <= n else ""
    rows, up = len(t) - 1, np.arange(len(t))
    V = _points(profile, m, t, turn)
    index = np.arange(len(V)).reshape(m, -1)
    slanted = (np.arange(m)[:, None] + up) % m
    curves = (np.vstack([index, index[:1]]).T, index, index[slanted, rows - up], index[slanted, up])
    families = Families(*([V[line] for line in lines] for lines in curves))
    why = why if why == ENOUGH else f"a further one does not fit, {why}"
    message, Q = f"{rows}{asked} rows of {m} quads: {why}", _quads(index[:, :-1], index[:, 1:])
    if bad := len(np.union1d(measure.flipped(V, Q), measure.nonconvex(V, Q))):
        message += f"; {bad} faces are flipped or darts: take a larger m"
    return Net(V, Q, families, rows, t, message, theta, theta0)


def _points(profile, m, t, turn):
    around = 2 * np.pi / m * np.arange(m)[:, None]
    return revolve(profile, around + turn, t).reshape(-1, 3)


def _quads(low, high):
    """Quads between vertices (m, rows) and those above them, closed around the axis."""
    corners = high, low, np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
    return np.stack(corners, axis=-1).reshape(-1, 4)


def _check_size(profile, theta, theta0, m, n, method):
    """ValueError for webs of too many quads or rows, before memory and time run out."""
    t = np.linspace(profile.start, profile.stop, 257)
    radius, height = profile.radius(t) + 0 * t, profile.height(t) + 0 * t
    width = np.sum(np.hypot(np.diff(radius), np.diff(height)) / radius[1:])
    rows = width * m * ratios(theta, theta0)[1] / (2 * np.pi * np.sin(theta0))
    found = min(rows, rows if n is None else n)
    if m * found > MOST or (found > MARCHED and method != "smooth"):
        raise ValueError(f"about {rows:.0f} rows of {m} quads fit: choose a smaller n or m")


def _march(profile, n, following, turn):
    """(t, turns, why): rings from profile.start up, n rows or as many as fit (n = None).

    following(t0): (t, None) of the next ring, or (None, why) when no row fits; turn(t0, t): how
    much further it is turned; why: the reason to stop, in words."""
    t, turns, why = [profile.start], [0.0], None
    while why is None and (n is None or len(t) <= n):
        ended = profile.stop - t[-1] < FITS * (profile.stop - profile.start)
        after, why = (None, SHORT) if ended else following(t[-1])
        if why is None:
            turns.append(turns[-1] + float(turn(t[-1], after)))
            t.append(after)
    return np.array(t), np.array(turns), why or ENOUGH


def residual(
    profile: Profile,
    theta: float,
    theta0: float,
    m: int,
    t0: float,
    t: np.ndarray,
    equation: str = "exact",
) -> np.ndarray:
    """The equation whose root t is the next ring above the ring at t0, as a function of t.

    equation "lam": log(|A-D| / (lam |B-C|)), "mu": log(|m13| / (mu |m24|)), both between points
    of the smooth loxodromes; "exact": |m13|^2 - mu^2 |m24|^2 with the turn that makes the
    medial lines meet at theta0.  Draw it to see the two roots of "lam".
    Paper: Eq. (16), Alg. 1, App. A.3."""
    if equation == "exact":
        return _exact_ring(profile, theta, theta0, m)[2](t0, t)
    return _paper_ring(profile, theta, theta0, m, equation)[2](t0, t)


def _squares(profile, m, t0, t, turn):
    """|d1|^2, |d2|^2, |m13|^2, |m24|^2 of the quad ABCD, without cancellation."""
    half = np.pi / m
    r0, r1 = profile.radius(t0), profile.radius(t)
    rise = (profile.height(t) - profile.height(t0)) ** 2
    across, product = (r1 - r0) ** 2, 4 * r0 * r1

    def chord(angle):
        return across + product * np.sin(angle) ** 2

    m13 = np.sin(half) ** 2 * (across + product * np.cos(turn / 2) ** 2)
    m24 = np.cos(half) ** 2 * chord(turn / 2) + rise
    return chord(turn / 2 - half) + rise, chord(turn / 2 + half) + rise, m13, m24


def _exact_ring(profile, theta, theta0, m):
    """(following, turn, off) of straight-edged quads with these angles, for two rings t0 and t.

    off is positive at t = t0: its first sign change is the shortest row."""
    mu, half = ratios(theta, theta0)[1], np.pi / m
    psi = np.arctan(np.cos(theta0) / mu * np.tan(half))  # half the turn for equal radii
    little = (profile.stop - profile.start) * 1e-5

    def turn(t0, t):  # for which the medial lines meet at theta0; NaN if none does
        ratio = profile.radius(t) / profile.radius(t0)
        sine = np.sin(psi) * (ratio + 1 / ratio) / 2
        return psi + np.arcsin(np.where(np.abs(sine) <= 1, sine, np.nan))

    def off(t0, t):
        _, _, m13, m24 = _squares(profile, m, t0, t, turn(t0, t))
        return m13 - mu**2 * m24

    def following(t0):
        ends, radius = np.array([t0, min(t0 + little, profile.stop)]), profile.radius(t0)
        moved = np.hypot(*(np.ptp(f(ends)) for f in (profile.radius, profile.height)))
        smooth = 2 * half * np.sin(theta0) / mu * radius * np.ptp(ends) / max(moved, 1e-300)
        low, length, t = t0, 2 * smooth, None
        while t is None and low < profile.stop:
            high = min(low + length, profile.stop)
            t = _first_root(partial(off, t0), low, high)
            low, length = high, 2 * length
        if t is None:
            fits = off(t0, profile.stop) < FITS * (2 * radius * np.sin(half)) ** 2
            return (profile.stop, None) if fits else (None, SHORT)
        if np.isnan(t):
            return None, f"no quad with these angles stands where the radius is {radius:.6g}"
        return t, None

    return following, turn, off


def _first_root(function, low, high, depth=3):
    """The first root in (low, high] of a function, positive at low; None, or NaN if it ends."""
    t = np.linspace(low, high, 33)
    value = function(t)
    out = np.flatnonzero(~(value > 0))
    first = out[0] if out.size else len(t)
    if first == 0:  # too thin for floating point
        return np.nan
    inner = value[1:-1]
    dips = 1 + np.flatnonzero((inner < value[:-2]) & (inner <= value[2:]))
    for k in dips[dips < first] if depth else []:  # two roots may hide between two samples
        if (found := _first_root(function, t[k - 1], t[k + 1], depth - 1)) is not None:
            return found
    if first == len(t):
        return None
    if np.isnan(value[first]):
        return _first_root(function, t[first - 1], t[first], depth - 1) if depth else np.nan
    return _root(function, t[first - 1], t[first])


def _root(function, low, high):
    return brentq(function, low, high, xtol=1e-15 * (high - low), rtol=4 * np.finfo(float).eps)


def _paper_ring(profile, theta, theta0, m, equation):
    """(following, turn, off) as published: A, B on the ring t0; C, D on their loxodromes.

    D is C turned by 2 pi / m, so the chord |C-D| is 2 r sin(pi / m) on every parallel: the
    first printed equation decides nothing (and names the arc 2 pi r / m instead).  Left is
    |A-D| = lam |B-C|, "lam", with two roots; the one on the smooth web's side of
    |m13| = |m24| is taken.  "mu" is |m13| = mu |m24| instead."""
    if equation not in ("lam", "mu"):
        raise ValueError(f'equation = {equation!r}: "lam" or "mu" is wanted')
    lam, mu = ratios(theta, theta0)
    w_of_t, t_of_w = mercator(profile)
    end, unit = w_of_t(profile.stop), 2 * np.pi / m * np.sin(theta0)
    # In units of the smooth row with |m13| = |m24|: the row wanted is 1 / mu, the other root of
    # "lam" near mu, and |A-D| / |B-C| largest or smallest near 1.
    search = 1e-3 / mu, 4 / mu + 4
    if equation == "lam":
        search = (1e-3 / mu, 1) if mu > 1 else (1, 4 / mu + 4)

    def turn(t0, t):
        return (w_of_t(t) - w_of_t(t0)) / np.tan(theta0)

    def off(t0, t):
        d1, d2, m13, m24 = _squares(profile, m, t0, t, turn(t0, t))
        if equation == "lam":
            return np.log(d2 / d1) / 2 - np.log(lam)
        return np.log(m13 / m24) / 2 - np.log(mu)

    def following(t0):
        low, high = (w_of_t(t0) + x * unit for x in search)
        ended = high >= end * (1 - FITS)
        low, high = t_of_w(min(low, end)), profile.stop if ended else t_of_w(high)
        if ended and abs(off(t0, high)) < FITS:
            return high, None
        if off(t0, low) * off(t0, high) < 0:
            return _root(partial(off, t0), low, high), None
        none = f'the equation "{equation}" has no root where the next row should be'
        return None, SHORT if ended else none

    return following, turn, off


def _check_not_vacuous(theta, theta0, equation):
    lam, mu = ratios(theta, theta0)
    use = 'use method = "exact" (or equation = "mu", in Python)'
    if equation == "lam" and abs(np.log(lam)) < 1e-9:
        why = "theta0 = 90 degrees: lam = 1, and |A-D| = lam |B-C| holds on every parallel"
        raise ValueError(f"{why}, so it finds none; {use}")
    if equation == "lam" and abs(np.log(mu)) < 1e-9:
        why = "theta = 90 degrees: |A-D| = lam |B-C| has a double root, where no sign changes"
        raise ValueError(f"{why} and no solver is safe; {use}")


def subnet(net: Net, first: str, second: str, mirror: bool = False) -> tuple:
    """(V, Q): quads whose edges run along two of the four families of a web.

    first, second: two of "u", "v", "d1", "d2"; the quads' u-edges follow `first`, their
    v-edges `second`.  ("d1", "d2") takes every other vertex and so needs an even m.
    mirror=True reflects the net in the meridian plane y = 0: theta stays and theta0 becomes
    its supplement.  V keeps the vertices of the net, used or not.  Paper: Fig. 11."""
    if first == second or not {first, second} <= set(AROUND):
        raise ValueError(f"{first!r}, {second!r}: two of u, v, d1, d2 are wanted")
    backwards = AROUND.index(first) > AROUND.index(second)
    if {first, second} == {"d1", "d2"}:
        Q = np.roll(mesh.diagonal_meshes(net.Q)[0], backwards, axis=1)
    else:
        v1, v2, v3, v4 = net.Q.T
        right, left, up, down = np.full((4, len(net.V) + 1), -1)  # the last one is for -1
        right[v2], left[v3], up[v2], down[v1] = v3, v2, v1, v2
        right[v1], left[v4], up[v3], down[v4] = v4, v1, v4, v3
        ahead = {"u": right, "v": up, "d1": down[right], "d2": up[right]}
        back = {"u": left, "v": down, "d1": up[left], "d2": down[left]}
        v3, v1 = ahead[first][:-1], (back if backwards else ahead)[second][:-1]
        Q = np.stack([v1, np.arange(len(net.V)), v3, ahead[first][v1]], axis=1)
        Q = Q[(Q >= 0).all(axis=1)]
    if not len(Q):
        raise ValueError(f"{net.rows} rows of quads are too few for a quad along {first}, {second}")
    return (net.V * [1, -1, 1], Q[:, ::-1]) if mirror else (net.V, Q)


class Closing(NamedTuple):
    """A closed torus web: m quads around, n rows, ends `shift` quads further; smooth angles."""

    m: int
    n: int
    shift: int
    theta: float
    theta0: float


def closings(
    major: float, minor: float, theta: float, theta0: float, limit: int = 96, count: int = 10
) -> list[Closing]:
    """The closed torus webs nearest to (theta, theta0): a list of `Closing`, nearest first.

    m and n go up to `limit`; at most `count` are listed, nearest by the larger deviation of
    the two angles, of equals that with the smaller m.  The smooth web closes with a shift of k
    quads exactly when X_v / X_u = (k + i m W / (2 pi)) / n, where W = 2 pi minor /
    sqrt(major^2 - minor^2) is the period of the Mercator coordinate.  Paper: B4."""
    wide = _torus_width(major, minor)
    theta, theta0 = _angle("theta", theta), _angle("theta0", theta0)
    limit, count = check_whole("limit", limit, 3), check_whole("count", count)
    rho = np.exp(1j * theta0) / ratios(theta, theta0)[1]
    m, n = np.mgrid[3 : limit + 1, 3 : limit + 1].reshape(2, -1)
    shift = ties.nearest_whole(n * rho.real)
    shape = from_rho((shift + 1j * m * wide) / n)
    off = np.maximum(abs(shape.theta - theta), abs(shape.theta0 - theta0))
    best = np.lexsort([m, ties.ranks(off, 1e-12)])[:count]
    table = (column[best].tolist() for column in (m, n, shift, shape.theta, shape.theta0))
    return [Closing(*row) for row in zip(*table, strict=True)]


def _torus_width(major, minor):
    """W / (2 pi) of the torus; ValueError unless major > minor > 0."""
    torus_profile(major, minor)
    check_positive("major", major)
    return minor / np.sqrt((major - minor) * (major + minor))


def torus_web(major: float, minor: float, m: int, n: int, shift: int) -> Net:
    """The exact closed web of a torus, as `Net` with m n vertices, numbered i n + j.

    n rows of m quads; going once around the tube every loxodrome ends `shift` quads further
    around the axis.  All quads have the same two angles, net.theta and net.theta0, near those
    of the smooth web (see `closings`).  ValueError when no closed web is found.  Paper: B4."""
    wide = _torus_width(major, minor)
    m, n = check_whole("m", m, 3), check_whole("n", n, 3)
    if shift % 1 != 0:
        raise ValueError(f"shift = {shift}: a whole number is wanted")
    shift = int(shift)
    profile = torus_profile(major, minor, -np.pi, 3 * np.pi)
    smooth = from_rho((shift + 1j * m * wide) / n)

    def miss(angles):
        t, turn, _ = _march(profile, n, *_exact_ring(profile, *angles, m)[:2])
        if len(t) <= n:
            raise ValueError(f"m = {m}, n = {n}, shift = {shift}: the rows do not fit on the torus")
        return t, turn, [t[-1] - np.pi, turn[-1] - 2 * np.pi / m * shift]

    found = root(lambda angles: miss(angles)[2], smooth[2:], tol=1e-15)
    t, turn, gap = miss(found.x)
    if not np.abs(gap).max() < 1e-12:
        raise ValueError("no closed web near the smooth one: take more quads")
    V, index = _points(profile, m, t[:-1], turn[:-1]), np.arange(m * n).reshape(m, n)
    Q = _quads(index, np.hstack([index[:, 1:], np.roll(index[:, :1], -shift, axis=0)]))
    families = Families(*([V[line] for line in lines] for lines in mesh.polylines(Q)))
    message = f"{n} rows of {m} quads, closed with a shift of {shift}"
    return Net(V, Q, families, n, t, message, *found.x)


def _angle(name, value):
    if np.ndim(value):
        raise ValueError(f"{name}: one angle is wanted, not an array")
    return float(check_angle(name, value))
