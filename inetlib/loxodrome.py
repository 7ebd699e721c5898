"""Webs of loxodromes and parallels on surfaces of revolution: smooth, as published, exact.

A web has m quads around the axis.  Ring j lies at the meridian parameter t[j] and is turned by
turn[j]; its vertices are (angle, parameter) = (i delta + turn[j], t[j]) with delta = 2 pi / m.
One strip of quads, turned m times, is the whole net.  `rings` finds the next ring.

Paper: Sec. 5.3, Alg. 1, App. A.3.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import root

from . import mesh, surfaces, ties
from .mesh import Families
from .parallelogram import _require_angle, _require_positive, from_rho, ratios
from .rings import NoRow, check_size, exact_ring, march, paper_ring, smooth_rings


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
    _require_positive("major", major)
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
    return float(_require_angle(name, value))


def _whole(name, value, least=None):
    whole = np.ndim(value) == 0 and np.isfinite(value) and value == int(value)
    if not whole or (least is not None and value < least):
        kind = "a whole number" if least is None else f"a whole number from {least} upwards"
        raise ValueError(f"{name} = {value}: {kind} is wanted")
    return int(value)
