"""The closest points of an analytic surface, by Newton steps from a grid of samples.

Inside this module the domain of every surface is the unit square, with parameters s and t.

Paper: Sec. 6.3 (approximation).
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from . import forms
from .surfaces import Surface

SAMPLES = 200  # a side of the domain; the nearest sample is where the search starts
MARGIN = 0.1  # how far the surface goes on beyond its domain, as a part of the domain
STEP = 1 / 2000  # of the finite differences, as a part of the domain


class Patch(NamedTuple):
    """A surface over the unit square, made by `patch`.

    point(s, t), tangents(s, t)  points (k, 3), and both derivatives, each (k, 3)
    exact                        whether the tangents need no finite differences
    beyond                       how far the surface goes on beyond the unit square
    samples                      the points at (i, j) / SAMPLES, in a k-d tree
    size, area                   the bounding box's diagonal, the median of |X_s x X_t|
    """

    point: Callable
    tangents: Callable
    exact: bool
    beyond: float
    samples: cKDTree
    size: float
    area: float


def closest(surface, points):
    """The closest points (k, 3) on a `Patch` and the unit normals (k, 3) there.

    Paper: Sec. 6.3 (approximation).
    """
    _, start = surface.samples.query(points)
    st = np.stack(np.divmod(start, SAMPLES + 1), axis=1) / SAMPLES
    st = _project(surface, points, st)
    return surface.point(*st.T), _normals(surface, st)


def patch(point, u, v, tangents=None):
    """The surface point(u, v) as a `Patch`; the arguments are those of `reference.parametric`.

    ValueError for an empty domain, and for points that are not finite, have not three
    coordinates or make no surface.

    Paper: Sec. 6.3 (approximation).
    """
    for name, pair in (("u", u), ("v", v)):
        if np.shape(pair) != (2,) or not (np.isfinite(pair).all() and pair[0] < pair[1]):
            raise ValueError(f"{name} = {pair}: two finite numbers, the lower first, are wanted")
    (u0, u1), (v0, v1) = u, v

    def scaled(s, t):
        return np.asarray(point(u0 + s * (u1 - u0), v0 + t * (v1 - v0)), dtype=float)

    def derivatives(s, t):
        if tangents is None:
            surface = Surface("reference", lambda *st: tuple(np.moveaxis(scaled(*st), -1, 0)))
            return tuple(x.T for x in forms.tangents(surface, s, t, STEP))
        Xu, Xv = tangents(u0 + s * (u1 - u0), v0 + t * (v1 - v0))
        return np.asarray(Xu) * (u1 - u0), np.asarray(Xv) * (v1 - v0)

    samples = _samples(scaled, 0)
    if samples.shape != (SAMPLES + 1, SAMPLES + 1, 3):
        raise ValueError(
            f"point returns an array of shape {samples.shape} for (201, 201) parameters: "
            "points (..., 3) are wanted"
        )
    bad = np.argwhere(~np.isfinite(samples).all(axis=2))
    if bad.size:
        s, t = bad[0] / SAMPLES
        where = f"u = {u0 + s * (u1 - u0):.6g}, v = {v0 + t * (v1 - v0):.6g}"
        raise ValueError(f"the surface is not finite at {where}")
    area = np.median(_areas(samples)) * SAMPLES**2
    if not area > 0:
        raise ValueError("the surface is a curve or a point: no part of it has an area")
    beyond = MARGIN if _goes_on(scaled) else 0.0
    tree = cKDTree(samples.reshape(-1, 3))
    size = float(np.linalg.norm(tree.maxes - tree.mins))
    return Patch(scaled, derivatives, tangents is not None, beyond, tree, size, float(area))


def _samples(scaled, extra):
    """Points on the domain and `extra` samples beyond it on all sides."""
    s = np.arange(-extra, SAMPLES + extra + 1) / SAMPLES
    return scaled(*np.meshgrid(s, s, indexing="ij"))


def _areas(X):
    """The areas of the cells of a grid of points."""
    cross = np.cross(X[1:, 1:] - X[:-1, :-1], X[:-1, 1:] - X[1:, :-1])
    return np.linalg.norm(cross, axis=2) / 2


def _goes_on(scaled):
    """Whether the surface is finite, and is a surface, a little beyond its domain."""
    extra = int(SAMPLES * MARGIN) + 2
    try:
        with np.errstate(all="ignore"):
            X = _samples(scaled, extra)
    except (ValueError, ArithmeticError):
        return False
    if not np.isfinite(X).all():
        return False
    area = _areas(X)
    outside = np.ones(area.shape, dtype=bool)
    outside[extra:-extra, extra:-extra] = False
    return bool(area[outside].min() > 1e-9 * np.median(area))


def _project(surface, points, st):
    """Parameters (k, 2) of the closest points, by damped Newton steps from st."""
    st, busy = st.copy(), np.arange(len(points))
    for _ in range(50):
        if not busy.size:
            break
        st[busy], moved = _line_search(surface, points[busy], st[busy])
        busy = busy[moved > 1e-12 * surface.size]  # the next step would be far smaller still
    return st


def _line_search(surface, points, old):
    """New parameters, no farther from the points than before, and how far the feet moved."""
    start = surface.point(*old.T)
    limit = np.linalg.norm(start - points, axis=1) + 1e-14 * surface.size
    new = old + _newton_step(surface, start - points, old)
    for _ in range(12):
        new = np.clip(new, -surface.beyond, 1 + surface.beyond)
        feet = surface.point(*new.T)
        far = np.linalg.norm(feet - points, axis=1) > limit
        if not far.any():
            break
        new[far] = (old[far] + new[far]) / 2
    new[far] = old[far]
    return new, np.where(far, 0, np.linalg.norm(feet - start, axis=1))


def _newton_step(surface, off, st):
    """The step (k, 2) towards the minimum of off^2 / 2, off = foot - point.

    Newton's, or Gauss-Newton's where the second derivatives give no minimum; a parameter that
    would leave the domain stays.
    """
    first, second = _derivatives(surface, st)
    g = np.einsum("kx,ikx->ki", off, first)
    gram = np.einsum("ikx,jkx->kij", first, first)
    hessian = gram + np.einsum("kx,ijkx->kij", off, second)
    trace = np.trace(gram, axis1=1, axis2=2)
    stuck = ((st <= -surface.beyond) & (g > 0)) | ((st >= 1 + surface.beyond) & (g < 0))
    g = np.where(stuck, 0, g)
    convex = (np.linalg.det(hessian) > 1e-6 * trace**2) & (np.trace(hessian, axis1=1, axis2=2) > 0)
    matrix = np.where(convex[:, None, None], hessian, gram)
    cut = stuck.any(axis=1)  # only one parameter is left, if any
    hessian, gram = hessian[cut] * np.eye(2), gram[cut] * np.eye(2)
    matrix[cut] = np.where(hessian > 1e-3 * gram, hessian, gram)
    matrix += (1e-14 * trace)[:, None, None] * np.eye(2)
    return np.clip(-np.linalg.solve(matrix, g[..., None])[..., 0], -0.05, 0.05)


def _derivatives(surface, st):
    """First (2, k, 3) and second (2, 2, k, 3) derivatives; the second ones are rough.

    Near the end of a surface that ends the stencils stay inside, and the first derivatives
    are continued by the second ones.
    """
    c = st if surface.beyond else np.clip(st, 3 * STEP, 1 - 3 * STEP)
    s, t = c.T
    h, X = STEP, surface.point
    middle = X(s, t)
    uu = (X(s + h, t) - 2 * middle + X(s - h, t)) / h**2
    vv = (X(s, t + h) - 2 * middle + X(s, t - h)) / h**2
    uv = X(s + h, t + h) - X(s + h, t - h) - X(s - h, t + h) + X(s - h, t - h)
    second = np.array([[uu, uv / (4 * h**2)], [uv / (4 * h**2), vv]])
    if surface.exact:
        return np.stack(surface.tangents(*st.T)), second
    return np.stack(surface.tangents(s, t)) + np.einsum("ijkx,kj->ikx", second, st - c), second


def _normals(surface, st):
    """Unit normals (k, 3); those at a pole of the parametrisation are taken a little inside."""
    normals = np.cross(*_derivatives(surface, st)[0])
    length = np.linalg.norm(normals, axis=1)
    pole = length < 1e-7 * surface.area
    if pole.any():
        inside = st[pole] + 1e-5 * (0.5 - st[pole])
        normals[pole] = np.cross(*_derivatives(surface, inside)[0])
        length = np.linalg.norm(normals, axis=1)
    return normals / length[:, None]
