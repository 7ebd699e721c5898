"""Webs of loxodromes and parallels on surfaces of revolution: smooth, as published, exact.

A web has m quads around the axis.  Ring j lies at the meridian parameter t[j] and is turned by
turn[j]; its vertices are (angle, parameter) = (i delta + turn[j], t[j]) with delta = 2 pi / m.
One strip of quads, turned m times, is the whole net.  `rings` finds the next ring.

Paper: Sec. 5.3, Alg. 1, App. A.3.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, root

from . import mesh, surfaces, ties
from .mesh import Families
from .parallelogram import check_angle, check_positive, from_rho, ratios

FITS = 1e-12  # a last row that is too high by this part of it still fits: the rest is rounding


class NoRow(ValueError):
    """No further row of quads fits; the text says why.

    Paper: Alg. 1.
    """


def march(profile, following, n):
    """(t, turn, why): rings from profile.start up, n rows or as many as fit (n = None).

    following(t) returns the next parameter and the turn towards it, or raises NoRow; NoRow
    passes when not even one row fits.  t, turn: arrays; why: the reason to stop, in words.

    Paper: Alg. 1.
    """
    t, turn, why = [profile.start], [0.0], "as many as asked for"
    while n is None or len(t) <= n:
        if profile.stop - t[-1] < FITS * (profile.stop - profile.start):
            why = meridian_ends(profile)
            break
        try:
            after, by = following(t[-1])
        except NoRow as reason:
            if len(t) == 1:
                raise
            why = str(reason)
            break
        t.append(after)
        turn.append(turn[-1] + by)
    return np.array(t), np.array(turn), why


def meridian_ends(profile):
    """The words for a row that does not fit below profile.stop.

    Paper: Alg. 1.
    """
    return f"a further one does not fit: the meridian ends at t = {profile.stop:.6g}"


def smooth_rings(profile, theta, theta0, m, n):
    """(t, turn, why) as from `march`, by equal steps of the Mercator coordinate: closed form."""
    w_of_t, t_of_w = surfaces.mercator(profile)
    step = 2 * np.pi / m * np.sin(theta0) / ratios(theta, theta0)[1]
    fit = int(w_of_t(profile.stop) / step * (1 + ties.TIE))
    if fit < 1:
        raise NoRow(meridian_ends(profile))
    rows = fit if n is None else min(n, fit)
    w = step * np.arange(rows + 1)
    why = "as many as asked for" if rows == n else meridian_ends(profile)
    return t_of_w(w), w / np.tan(theta0), why


def check_size(profile, theta, theta0, m, n):
    """ValueError for webs of more than ten million quads, before memory and time run out.

    Paper: Alg. 1.
    """
    t = np.linspace(profile.start, profile.stop, 257)
    radius, height = profile.radius(t) + 0 * t, profile.height(t) + 0 * t
    width = np.sum(np.hypot(np.diff(radius), np.diff(height)) / radius[1:])
    rows = width * m * ratios(theta, theta0)[1] / (2 * np.pi * np.sin(theta0))
    if m * min(rows, rows if n is None else n) > 1e7:
        raise ValueError(f"about {rows:.0f} rows of {m} quads fit: choose a smaller n or m")


# --- one quad: squared lengths from the turn and two points of the meridian ---------------


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


def exact_turn(profile, theta, theta0, m, t0, t):
    """The turn from the ring t0 to the ring t for which the quad's medial lines meet at theta0.

    t: number or array; NaN where no turn does it (the radii differ too much).  Holds together
    with |m13| = mu |m24|, see `residual`.
    """
    return _exact_turn(profile, _psi(theta, theta0, m), t0, t)


def _psi(theta, theta0, m):
    """Half the turn between two rings of the same radius."""
    return np.arctan(np.cos(theta0) / ratios(theta, theta0)[1] * np.tan(np.pi / m))


def _exact_turn(profile, psi, t0, t):
    ratio = profile.radius(t) / profile.radius(t0)
    sine = np.sin(psi) * (ratio + 1 / ratio) / 2
    return psi + np.arcsin(np.where(np.abs(sine) <= 1, sine, np.nan))


def residual(profile, theta, theta0, m, t0, t, equation="exact"):
    """The equation whose root t is the next ring above the ring at t0, as a function of t.

    equation "lam": log(|A-D| / (lam |B-C|)), "mu": log(|m13| / (mu |m24|)), both between points
    of the smooth loxodromes; "exact": |m13|^2 - mu^2 |m24|^2 with the turn of `exact_turn`.
    t: array of parameters above t0.  Draw it to see the two roots of "lam".

    Paper: Eq. (16), Alg. 1, App. A.3.
    """
    if equation == "exact":
        mu, psi = ratios(theta, theta0)[1], _psi(theta, theta0, m)
        return _exact_residual(profile, mu, psi, m, t0, t)
    _check_equation(equation)
    w_of_t, _ = surfaces.mercator(profile)
    return _paper_residual(profile, w_of_t, theta, theta0, m, t0, t, equation)


def _exact_residual(profile, mu, psi, m, t0, t):
    _, _, m13, m24 = _squares(profile, m, t0, t, _exact_turn(profile, psi, t0, t))
    return m13 - mu**2 * m24


def _paper_residual(profile, w_of_t, theta, theta0, m, t0, t, equation):
    lam, mu = ratios(theta, theta0)
    turn = (w_of_t(t) - w_of_t(t0)) / np.tan(theta0)
    d1, d2, m13, m24 = _squares(profile, m, t0, t, turn)
    if equation == "lam":
        return np.log(d2 / d1) / 2 - np.log(lam)
    return np.log(m13 / m24) / 2 - np.log(mu)


def _check_equation(equation):
    if equation not in ("lam", "mu"):
        raise ValueError(f'equation = {equation!r}: "lam" or "mu" is wanted')


# --- the next ring ------------------------------------------------------------------------


def exact_ring(profile, theta, theta0, m):
    """The step of the exact web: t0 -> (t, turn), at the first root of the equation "exact".

    The residual is positive at t0 itself, so that the first sign change is the shortest row.
    The step raises NoRow where there is none below profile.stop.

    Paper: Alg. 1, App. A.3 (straight distances; beyond the paper: B5).
    """
    mu, psi = ratios(theta, theta0)[1], _psi(theta, theta0, m)
    smooth, half = 2 * np.pi / m * np.sin(theta0) / mu, np.pi / m
    little = (profile.stop - profile.start) * 1e-5

    def following(t0):
        ends = np.array([t0, min(t0 + little, profile.stop)])
        moved = np.hypot(*(np.ptp(f(ends)) for f in (profile.radius, profile.height)))
        step = smooth * profile.radius(t0) * np.ptp(ends) / max(moved, 1e-300)

        def gap(t):
            return _exact_residual(profile, mu, psi, m, t0, t)

        t = _first_root(gap, t0, step, profile.stop)
        if t is None:
            if not gap(profile.stop) < FITS * (2 * profile.radius(t0) * np.sin(half)) ** 2:
                raise NoRow(meridian_ends(profile))
            t = profile.stop
        if np.isnan(t):
            raise NoRow(f"a further one does not fit: no such quad stands on t = {t0:.6g}")
        return t, float(_exact_turn(profile, psi, t0, t))

    return following


def _first_root(function, low, step, stop):
    """The first t in (low, stop] where the function, positive at low, vanishes; or None.

    NaN when the function turns into NaN before.  Scanned in stretches that double in length,
    2 * step at first.
    """
    length = 2 * step
    while low < stop:
        high = min(low + length, stop)
        bracket = _first_bracket(function, low, high, 3)
        if bracket is not None:
            return bracket[1] if np.isnan(bracket[1]) else _root(function, *bracket)
        low, length = high, 2 * length
    return None


def _first_bracket(function, low, high, depth):
    """(a, b) around the first root, None without one, (a, nan) where the function ends."""
    t = np.linspace(low, high, 33)
    value = function(t)
    out = np.flatnonzero(~(value > 0))
    first = out[0] if out.size else len(t)
    if first == 0:  # too thin for floating point
        return low, np.nan
    inner = value[1:-1]
    dips = 1 + np.flatnonzero((inner < value[:-2]) & (inner <= value[2:]))
    for k in dips[dips < first] if depth else []:  # two roots may hide between two samples
        if (bracket := _first_bracket(function, t[k - 1], t[k + 1], depth - 1)) is not None:
            return bracket
    if first == len(t):
        return None
    if np.isnan(value[first]):
        zoom = t[first - 1], t[first], depth - 1
        return _first_bracket(function, *zoom) if depth else (low, np.nan)
    return t[first - 1], t[first]


def _root(function, low, high):
    return brentq(function, low, high, xtol=1e-15 * (high - low), rtol=4 * np.finfo(float).eps)


def paper_ring(profile, theta, theta0, m, equation):
    """The published step: t0 -> (t, turn), on smooth loxodromes, by the equation "lam" or "mu".

    A and B lie on the ring t0; C and D on the same loxodromes, at one parallel.  D is C turned
    by 2 pi / m, so the chord |C-D| is 2 r sin(pi / m) on every parallel: the first printed
    equation decides nothing (and names the arc 2 pi r / m instead).  Left is
    |A-D| = lam |B-C|, "lam".  It is empty for theta0 = 90 degrees and has a double root for
    theta = 90 degrees: ValueError; else it has two roots, and the step takes the one on the
    smooth web's side of |m13| = |m24|, or raises NoRow.  "mu" is |m13| = mu |m24| instead.

    Paper: Alg. 1, Eq. (16), App. A.3.
    """
    _check_equation(equation)
    lam, mu = ratios(theta, theta0)
    if equation == "lam":
        _check_not_vacuous(lam, mu)
    w_of_t, t_of_w = surfaces.mercator(profile)
    end, unit = w_of_t(profile.stop), 2 * np.pi / m * np.sin(theta0)
    if equation == "mu":
        search = 1e-3 / mu, 4 / mu + 4
    else:  # log(|A-D| / |B-C|) is largest or smallest near 1, the other root is near mu
        search = (1e-3 / mu, 1) if mu > 1 else (1, 4 / mu + 4)

    def following(t0):
        def gap(t):
            return _paper_residual(profile, w_of_t, theta, theta0, m, t0, t, equation)

        # search is in units of the smooth row with |m13| = |m24|; the row wanted is 1 / mu
        low, high = (w_of_t(t0) + x * unit for x in search)
        ended = high >= end * (1 - FITS)
        low, high = t_of_w(min(low, end)), profile.stop if ended else t_of_w(high)
        if ended and abs(gap(high)) < FITS:
            return high, float((end - w_of_t(t0)) / np.tan(theta0))
        if not gap(low) * gap(high) < 0:
            none = f'the equation "{equation}" has no root where the next row should be'
            raise NoRow(meridian_ends(profile) if ended else none)
        t = _root(gap, low, high)
        return t, float((w_of_t(t) - w_of_t(t0)) / np.tan(theta0))

    return following


def _check_not_vacuous(lam, mu):
    use = 'use equation = "mu" or method = "exact"'
    if abs(np.log(lam)) < 1e-9:
        raise ValueError(
            "theta0 = 90 degrees: lam = 1, and |A-D| = lam |B-C| holds on every parallel, so it "
            f"finds none; {use}"
        )
    if abs(np.log(mu)) < 1e-9:
        raise ValueError(
            "theta = 90 degrees: |A-D| = lam |B-C| has a double root, where no sign changes and "
            f"no solver is safe; {use}"
        )


# --- Webs of loxodromes and parallels on surfaces of revolution: smooth, as published, exact. ---


class Net(NamedTuple):
    """A web: vertices, quads, the four families of curves, and how far it got.

    V        (m (rows + 1), 3), vertex i (rows + 1) + j is the i-th of ring j
    Q        (m rows, 4), closed around the axis, labelled as in `mesh`
    families `mesh.Families` of point arrays (k, 3): u parallels (closed), v loxodromes,
             d1 and d2 the diagonals, loxodromes too
    rows, t  number of rows of quads; the meridian parameters of the rings (rows + 1,)
    message  how many rows there are, and why no more
    theta, theta0  the angles the net was made for, radians
    """

    V: np.ndarray
    Q: np.ndarray
    families: Families
    rows: int
    t: np.ndarray
    message: str
    theta: float
    theta0: float


class Closing(NamedTuple):
    """A closed torus web: m quads around, n rows, ends `shift` quads further; smooth angles."""

    m: int
    n: int
    shift: int
    theta: float
    theta0: float


# --- one loxodrome ------------------------------------------------------------------------


def loxodrome(profile, theta0, angle=0.0, samples=201):
    """Points (samples, 3) of the loxodrome that meets every parallel at theta0.

    It starts at profile.start and the given angle around the axis (radians) and ends at
    profile.stop: alpha = angle + cot theta0 * w, with w = int ds / radius the Mercator
    coordinate; the points are evenly spaced in w.  ValueError for angles outside (0, pi).

    Paper: Eq. (15), Sec. 5.3.
    """
    theta0 = _scalar_angle("theta0", theta0)
    if not np.isfinite(angle):
        raise ValueError(f"angle = {angle}: a finite number is wanted")
    w_of_t, t_of_w = surfaces.mercator(profile)
    w = np.linspace(0, w_of_t(profile.stop), _whole("samples", samples, 2))
    return surfaces.revolve(profile, angle + w / np.tan(theta0), t_of_w(w))


# --- the web ------------------------------------------------------------------------------


def web(profile, theta, theta0, m, n=None, method="exact", equation="lam"):
    """A web of (theta, theta0)-quads on a surface of revolution, as `Net`.

    profile: `surfaces.Profile`; theta, theta0: radians in (0, pi); m >= 3 quads around the
    axis; n rows from profile.start upwards, or as many as fit (n = None).  Fewer rows than n
    are built when no more fit: `message` says so.  ValueError when not even one fits.

    method "exact"   straight-edged quads with the angles asked for, to round-off
           "smooth"  points of the smooth web, in closed form; angles off by O(1 / m^2)
           "paper"   the published algorithm, on the smooth loxodromes, with its own equation
                     for the next parallel, equation = "lam"; or the better "mu"

    Paper: Alg. 1, Eq. (16), App. A.3, Sec. 5.3 (beyond the paper: B4, B5).
    """
    surfaces.check_profile(profile)
    theta, theta0 = _scalar_angle("theta", theta), _scalar_angle("theta0", theta0)
    m = _whole("m", m, 3)
    n = None if n is None else _whole("n", n, 1)
    check_size(profile, theta, theta0, m, n)
    try:
        if method == "smooth":
            t, turn, why = smooth_rings(profile, theta, theta0, m, n)
        elif method == "exact":
            t, turn, why = march(profile, exact_ring(profile, theta, theta0, m), n)
        elif method == "paper":
            t, turn, why = march(profile, paper_ring(profile, theta, theta0, m, equation), n)
        else:
            raise ValueError(f'method = {method!r}: "exact", "smooth" or "paper" is wanted')
    except NoRow as reason:
        raise NoRow(f"not one row of {m} quads: {reason} (try a larger m)") from None
    asked = f" of {n}" if n is not None and len(t) <= n else ""
    message = f"{len(t) - 1}{asked} rows of {m} quads: {why}"
    return _net(profile, m, t, turn, message, theta, theta0)


def _net(profile, m, t, turn, message, theta, theta0):
    around = 2 * np.pi / m * np.arange(m)[:, None]
    V = surfaces.revolve(profile, around + turn, t).reshape(-1, 3)
    index = np.arange(len(V)).reshape(m, -1)
    right = np.roll(index, -1, axis=0)
    Q = np.stack([index[:, 1:], index[:, :-1], right[:, :-1], right[:, 1:]], axis=-1)
    rows = len(t) - 1
    up = np.arange(rows + 1)
    slanted = (np.arange(m)[:, None] + up) % m
    curves = (np.vstack([index, index[:1]]).T, index, index[slanted, rows - up], index[slanted, up])
    families = Families(*([V[line] for line in lines] for lines in curves))
    return Net(V, Q.reshape(-1, 4), families, rows, t, message, theta, theta0)


# --- other nets of the same web -----------------------------------------------------------


def subnet(net, first, second, mirror=False):
    """(V, Q): quads whose edges run along two of the four families of a web.

    first, second: two of "u", "v", "d1", "d2"; the quads' u-edges follow `first`, their
    v-edges `second`.  ("d1", "d2") takes every other vertex and so needs an even m.
    mirror=True reflects the net in the meridian plane y = 0: theta stays and theta0 becomes
    its supplement.  V keeps the vertices of the net, used or not.

    Paper: Sec. 5.3, Fig. 11 (other nets from the web).
    """
    for name in (first, second):
        if name not in _STEPS or first == second:
            raise ValueError(f"{first!r}, {second!r}: two of {', '.join(_STEPS)} are wanted")
    (a, b), (c, d) = _STEPS[first], _STEPS[second]
    sign = a * d - b * c
    if abs(sign) == 2:
        Q = mesh.diagonal_meshes(net.Q)[0]
        Q = Q if sign > 0 else np.roll(Q, 1, axis=1)
    else:
        walk = _walker(net)
        v2 = np.arange(len(net.V))
        v3, v1 = walk(v2, a, b), walk(v2, sign * c, sign * d)
        Q = np.stack([v1, v2, v3, walk(v1, a, b)], axis=1)
        Q = Q[(Q >= 0).all(axis=1)]
    if not len(Q):
        raise ValueError(f"{net.rows} rows of quads are too few for a quad along {first}, {second}")
    return (net.V * [1, -1, 1], Q[:, ::-1]) if mirror else (net.V, Q)


_STEPS = {"u": (1, 0), "v": (0, 1), "d1": (1, -1), "d2": (1, 1)}


def _walker(net):
    """walk(vertices, i, j): the vertices i edges along u and j along v further on, or -1."""
    v1, v2, v3, v4 = net.Q.T
    edges = {"right": (v2, v3), "up": (v2, v1)}, {"right": (v1, v4), "up": (v3, v4)}
    step = {}
    for name, back in (("right", "left"), ("up", "down")):
        step[name], step[back] = np.full((2, len(net.V) + 1), -1)  # the last one is for -1
        for pair in edges:
            one, two = pair[name]
            step[name][one], step[back][two] = two, one

    def walk(vertices, i, j):
        for count, ahead, back in ((i, "right", "left"), (j, "up", "down")):
            for _ in range(abs(count)):
                vertices = step[ahead if count > 0 else back][vertices]
        return vertices

    return walk


def mirror_angles(theta, theta0, first="v", second="v"):
    """(theta, theta0) of the web that has two families of another one, one of them mirrored.

    Its v-curves and d1-curves are the family `first` of the (theta, theta0)-web and the mirror
    image of `second` in a meridian plane, in the order that makes them meet on parallels:
    subnet(web(profile, *mirror_angles(theta, theta0), m), "v", "d1") are the rhombic quads
    between the loxodromes and their mirror images.  first, second: "v", "d1" or "d2".

    Paper: Sec. 5.3, Fig. 11 (reflections in the meridian planes).
    """
    theta, theta0 = _scalar_angle("theta", theta), _scalar_angle("theta0", theta0)
    apart = ratios(theta, theta0)[1] / np.sin(theta0)
    slope = {"v": 1 / np.tan(theta0)}  # of the angle over the Mercator coordinate
    slope |= {"d1": slope["v"] - apart, "d2": slope["v"] + apart}
    for name in (first, second):
        if name not in slope:
            raise ValueError(f"{name!r}: one of {', '.join(slope)} is wanted")
    one, two = slope[first], -slope[second]
    if abs(one - two) < 1e-9:
        raise ValueError(f"{first} and the mirror image of {second} are the same curves")
    shape = from_rho((max(one, two) + 1j) / abs(one - two))
    return float(shape.theta), float(shape.theta0)


# --- closed webs on the torus -------------------------------------------------------------


def closings(major, minor, theta, theta0, limit=96, count=10):
    """The closed torus webs nearest to (theta, theta0): a list of `Closing`, nearest first.

    major > minor > 0: the radii; m and n go up to `limit`; at most `count` are listed, nearest
    by the larger deviation of the two angles, of equals that with the smaller m.  The smooth
    web with m quads around and n rows closes with a shift of k quads exactly when X_v / X_u =
    (k + i m W / (2 pi)) / n, where W = 2 pi minor / sqrt(major^2 - minor^2) is the period of
    the Mercator coordinate.

    Paper: Sec. 5.3 (closed webs, beyond the paper: B4).
    """
    wide = _torus_width(major, minor)
    theta, theta0 = _scalar_angle("theta", theta), _scalar_angle("theta0", theta0)
    limit, count = _whole("limit", limit, 3), _whole("count", count, 1)
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
    surfaces.torus_profile(major, minor)
    check_positive("major", major)
    return minor / np.sqrt((major - minor) * (major + minor))


def torus_web(major, minor, m, n, shift):
    """The exact closed web of a torus, as `Net` with m n vertices, numbered i n + j.

    n rows of m quads; going once around the tube every loxodrome ends `shift` quads further
    around the axis.  All quads have the same two angles, net.theta and net.theta0, near those
    of the smooth web (see `closings`).  ValueError when no closed web is found.

    Paper: Sec. 5.3 (closed webs, beyond the paper: B4).
    """
    wide = _torus_width(major, minor)
    m, n = _whole("m", m, 3), _whole("n", n, 3)
    shift = _whole("shift", shift)
    profile = surfaces.torus_profile(major, minor, -np.pi, 3 * np.pi)
    smooth = from_rho((shift + 1j * m * wide) / n)

    def miss(angles):
        t, turn, _ = march(profile, exact_ring(profile, *angles, m), n)
        if len(t) <= n:
            raise NoRow(f"m = {m}, n = {n}, shift = {shift}: the rows do not fit on the torus")
        return t, turn, [t[-1] - np.pi, turn[-1] - 2 * np.pi / m * shift]

    found = root(lambda angles: miss(angles)[2], smooth[2:], tol=1e-15)
    theta, theta0 = found.x
    t, turn, gap = miss(found.x)
    if not np.abs(gap).max() < 1e-12:
        raise ValueError("no closed web near the smooth one: take more quads")
    message = f"{n} rows of {m} quads, closed with a shift of {shift}"
    net = _net(profile, m, t[:-1], turn[:-1], message, theta, theta0)
    index = np.arange(m * n).reshape(m, n)
    top = np.hstack([index[:, 1:], np.roll(index[:, :1], -shift, axis=0)])
    Q = np.stack([top, index, np.roll(index, -1, axis=0), np.roll(top, -1, axis=0)], axis=-1)
    Q = Q.reshape(-1, 4)
    families = Families(*([net.V[line] for line in lines] for lines in mesh.polylines(Q)))
    return net._replace(Q=Q, families=families, rows=n, t=t)


# --- checks -------------------------------------------------------------------------------


def _scalar_angle(name, value):
    if np.ndim(value):
        raise ValueError(f"{name}: one angle is wanted, not an array")
    return float(check_angle(name, value))


def _whole(name, value, least=None):
    whole = np.ndim(value) == 0 and np.isfinite(value) and value == int(value)
    if not whole or (least is not None and value < least):
        kind = "a whole number" if least is None else f"a whole number from {least} upwards"
        raise ValueError(f"{name} = {value}: {kind} is wanted")
    return int(value)
