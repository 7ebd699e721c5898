"""Meshes and analytic surfaces as references: closest points, and how the surface runs there."""

from collections.abc import Callable
from typing import NamedTuple, NoReturn

import igl
import numpy as np
from scipy.spatial import cKDTree

from . import repair, surfaces, ties
from .mesh import half_edges, opposites, triangles

CORNER = np.radians(30)  # a boundary that turns by more at a vertex has a corner there
# of the diagonal, no symmetry of any surface: of equally near triangles the one counts that is
# nearest when the point moves so far, not the one that rounding would choose
ASIDE = 1e-9 * np.array([0.2718, 0.5772, 0.7691])
SAME = 1e-11  # of the diagonal: distances that differ by less are equal
SAMPLES = 200  # a side of the domain; the nearest sample is where the search starts
MARGIN = 0.1  # how far an analytic surface goes on beyond its domain, as a part of the domain
STEP = 1 / 2000  # of the finite differences, as a part of the domain


def no_boundary(points: np.ndarray) -> NoReturn:
    """The `Reference.boundary` of a surface without one: ValueError."""
    raise ValueError("the reference has no boundary: it is closed, or no `reference.mesh`")


class Reference(NamedTuple):
    """A reference surface, made by `mesh` or `parametric`; points (k, 3), finite, else ValueError.

    closest(points)   closest points and unit normals of the surface there, each (k, 3)
    boundary(points)  closest points on the boundary and an orthonormal frame e1, e2, e3
                      there, each (k, 3): e1 along the boundary, e3 normal to the surface"""

    closest: Callable
    diagonal: float  # of the bounding box
    boundary: Callable = no_boundary
    V: np.ndarray | None = None  # None for a parametric reference
    F: np.ndarray | None = None  # triangles

    @property
    def has_boundary(self) -> bool:
        """Whether `boundary` may be asked."""
        return self.boundary is not no_boundary

    def distances(self, points: np.ndarray) -> np.ndarray:
        """Of points (k, 3) from the surface, in diagonals: (k,)."""
        return np.linalg.norm(self.closest(points)[0] - points, axis=1) / self.diagonal


def mesh(V: np.ndarray, F: np.ndarray) -> Reference:
    """The `Reference` of a mesh of triangles (f, 3) or quads (f, 4) with vertices V (n, 3).

    A quad is two triangles, cut along its shorter diagonal.  Closest points are exact; normals
    are interpolated between the vertex normals (weighted by the angles of the faces), and those
    of the face where that degenerates.  So is e1 along the boundary, with the mesh on its left;
    at corners, where the boundary turns by more than 30 degrees, it is the direction of the
    segment hit (at the corner itself, of the one that leaves it).  ValueError for faces that
    are no oriented manifold, and for triangles without area."""
    V, F = (a.copy() for a in triangles(V, F))  # later changes of V do not change the tree
    face, twin = repair.normals(V, F), opposites(F)
    repair.require_single_fans(V, F, twin)
    by_angle = igl.PER_VERTEX_NORMALS_WEIGHTING_TYPE_ANGLE
    smooth = np.nan_to_num(igl.per_vertex_normals(V, F, by_angle))  # unused; normals that cancel
    diagonal = float(np.linalg.norm(np.ptp(V[np.unique(F)], axis=0)))
    nearest = _search(V, F, diagonal)

    def closest(points):
        hit, feet = nearest(points)
        weights = np.clip(_barycentric(feet, *np.moveaxis(V[F[hit]], 1, 0)), 0, 1)
        normals = np.einsum("kc,kcx->kx", weights, smooth[F[hit]])
        return feet, _unit_or(normals, face[hit])

    half = np.flatnonzero(twin < 0)
    edges = np.stack(half_edges(F), axis=1)[half]
    rim = _boundary(V, edges, smooth, face[half // 3], diagonal) if half.size else no_boundary
    return Reference(closest, diagonal, rim, V, F)


def _boundary(V, edges, smooth, face, diagonal):
    """The callable `Reference.boundary`; edges (e, 2), face (e, 3): the normals beside them."""
    along = V[edges[:, 1]] - V[edges[:, 0]]
    length = np.linalg.norm(along, axis=1)
    along /= length[:, None]
    order = np.argsort(edges[:, 0])  # after: the edge that begins where each one ends
    after = order[np.searchsorted(edges[:, 0], edges[:, 1], sorter=order)]
    tangents = _vertex_tangents(along, after)
    nearest = _search(V, edges, diagonal)

    def boundary(points):
        hit, feet = nearest(points)
        t = np.einsum("ij,ij->i", feet - V[edges[hit, 0]], along[hit]) / length[hit]
        end = t > 1 - ties.TIE  # as near to the next segment
        hit, t = np.where(end, after[hit], hit), np.where(end, 0, np.clip(t, 0, 1))
        weights = np.stack([1 - t, t], axis=1)[..., None]
        e1 = _unit_or(np.sum(weights * tangents[hit], axis=1), along[hit])
        plain = _across(face[hit], e1)
        plain /= np.linalg.norm(plain, axis=1, keepdims=True)  # never short: e1 is near the edge
        e3 = _unit_or(_across(np.sum(weights * smooth[edges[hit]], axis=1), e1), plain)
        return feet, e1, np.cross(e3, e1), e3

    return boundary


def _vertex_tangents(along, after):
    """Tangents (e, 2, 3) at both ends of the boundary edges, the edge's own at corners."""
    one = np.stack([along[np.argsort(after)], along], axis=1)
    two = np.stack([along, along[after]], axis=1)
    smooth = np.einsum("ecx,ecx->ec", one, two) > np.cos(CORNER) - 1e-9  # 30 degrees are no more
    mean = one + two
    mean /= np.maximum(np.linalg.norm(mean, axis=2, keepdims=True), 1e-300)
    return np.where(smooth[..., None], mean, along[:, None])


def _across(vectors, e1):
    """The parts of the vectors that are orthogonal to the unit vectors e1."""
    return vectors - np.sum(vectors * e1, axis=1, keepdims=True) * e1


def _unit_or(vectors, other):
    """The vectors at unit length, or the other ones where they vanish or point against those."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    good = (np.einsum("ij,ij->i", vectors, other) > 1e-6)[:, None]
    return np.where(good, vectors / np.where(good, length, 1), other)


def _search(V, F, diagonal):
    """A function of points (k, 3): the nearest triangle or segment of F (k,), the foot (k, 3)."""
    tree = igl.AABB()
    tree.init(V, F)

    def nearest(points):
        points = _points(points)  # over a valley several are equally near: see ASIDE
        squares, hit, feet = tree.squared_distance(V, F, points)
        away = np.flatnonzero(squares > (SAME * diagonal) ** 2)
        other = tree.squared_distance(V, F, points[away] + ASIDE * diagonal)[1]
        away, other = away[other != hit[away]], other[other != hit[away]]
        there = _feet(points[away], V[F[other]])
        far = np.linalg.norm(there - points[away], axis=1)
        tied = far <= np.sqrt(squares[away]) + SAME * diagonal
        hit[away[tied]], feet[away[tied]] = other[tied], there[tied]
        return hit, feet

    return nearest


def _points(points):
    points = np.ascontiguousarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points have the shape {points.shape}: rows of three are wanted")
    if not np.isfinite(points).all():
        bad = np.argmin(np.isfinite(points).all(axis=1))
        raise ValueError(f"point {bad} has a coordinate that is not a finite number")
    return points


def _feet(p, corners):
    """The closest points (k, 3) of segments (k, 2, 3) or triangles (k, 3, 3) to points p (k, 3)."""
    a, b = corners, np.roll(corners, -1, axis=1)
    along = np.einsum("kcx,kcx->kc", p[:, None] - a, b - a) / np.sum((b - a) ** 2, axis=2)
    feet = a + np.clip(along, 0, 1)[..., None] * (b - a)
    nearest = np.argmin(np.linalg.norm(feet - p[:, None], axis=2), axis=1)
    feet = feet[np.arange(len(p)), nearest]
    if corners.shape[1] == 2:
        return feet
    weights = _barycentric(p, *np.moveaxis(corners, 1, 0))
    inside = (weights >= 0).all(axis=1)[:, None]
    return np.where(inside, np.einsum("kc,kcx->kx", weights, corners), feet)


def _barycentric(p, a, b, c):
    """Barycentric coordinates (k, 3) of the feet of points p in planes a, b, c, each (k, 3)."""
    u, v, w = b - a, c - a, p - a
    pairs = (u, u), (u, v), (v, v), (w, u), (w, v)
    uu, uv, vv, wu, wv = (np.einsum("ij,ij->i", *pair) for pair in pairs)
    area = uu * vv - uv * uv
    second, third = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    return np.stack([1 - second - third, second, third], axis=1)


def parametric(point: Callable, u: tuple, v: tuple, tangents: Callable | None = None) -> Reference:
    """The `Reference` of the surface point(u, v) over u[0] <= u <= u[1], v[0] <= v <= v[1].

    point     takes two arrays of one shape, returns points (..., 3), smooth in u and v
    tangents  takes the same, returns the pair (X_u, X_v), each (..., 3); default: finite
              differences, for features of the surface wider than a tenth of the domain

    Closest points are found by Newton steps from the nearest of 201 x 201 samples, to about
    1e-12 of the surface's size; of sheets closer to each other than the samples, another than
    the nearest may be hit.  The surface goes on for a tenth of the domain on all sides, if
    `point` does, else its last 0.15 % know their tangents to about 1e-6 only.  The normal at
    a pole is that of a point close by.  ValueError for an empty domain, and for points that are
    not finite or make no surface."""
    for name, pair in (("u", u), ("v", v)):
        if np.shape(pair) != (2,) or not (np.isfinite(pair).all() and pair[0] < pair[1]):
            raise ValueError(f"{name} = {pair}: two finite numbers, the lower first, are wanted")
    surface = _Patch(point, u, v, tangents)
    return Reference(surface.closest, surface.size)


class _Patch:
    """An analytic surface over the unit square, and a little `beyond` it where it goes on."""

    def __init__(self, point, u, v, tangents):
        self.given, self.domain, self.exact = point, (*u, *v), tangents
        samples, areas = self._samples(0)
        bad = np.argwhere(~np.isfinite(samples).all(axis=2))
        if bad.size:
            where = "u = {:.6g}, v = {:.6g}".format(*self._parameters(*bad[0] / SAMPLES))
            raise ValueError(f"the surface is not finite at {where}")
        self.area = float(np.median(areas) * SAMPLES**2)  # the median of |X_s x X_t|
        if not self.area > 0:
            raise ValueError("the surface is a curve or a point: no part of it has an area")
        self.beyond = MARGIN if self._goes_on() else 0.0
        self.tree = cKDTree(samples.reshape(-1, 3))
        self.size = float(np.linalg.norm(self.tree.maxes - self.tree.mins))

    def _parameters(self, s, t):
        u0, u1, v0, v1 = self.domain
        return u0 + s * (u1 - u0), v0 + t * (v1 - v0)

    def point(self, s, t):
        """Points (..., 3) at parameters of the unit square."""
        return np.asarray(self.given(*self._parameters(s, t)), dtype=float)

    def _samples(self, extra):
        """Points on the domain and `extra` samples beyond on all sides, and the cells' areas."""
        s = np.arange(-extra, SAMPLES + extra + 1) / SAMPLES
        X = self.point(*np.meshgrid(s, s, indexing="ij"))
        if X.shape != (wanted := (len(s), len(s), 3)):
            raise ValueError(f"point returns {X.shape}, not {wanted}: points (..., 3) are wanted")
        with np.errstate(all="ignore"):  # of what is not finite
            cross = np.cross(X[1:, 1:] - X[:-1, :-1], X[:-1, 1:] - X[1:, :-1])
        return X, np.linalg.norm(cross, axis=2) / 2

    def _goes_on(self):
        """Whether the surface is finite, and is a surface, a little beyond its domain."""
        extra = int(SAMPLES * MARGIN) + 2
        try:
            with np.errstate(all="ignore"):
                X, area = self._samples(extra)
        except (ValueError, ArithmeticError):
            return False
        if not np.isfinite(X).all():
            return False
        little = 1e-9 * np.median(area)
        area[extra:-extra, extra:-extra] = np.inf
        return bool(area.min() > little)

    def closest(self, points):
        """`Reference.closest`, by damped Newton steps from the nearest sample."""
        points = _points(points)
        st = np.stack(np.divmod(self.tree.query(points)[1], SAMPLES + 1), axis=1) / SAMPLES
        busy = np.arange(len(points))
        for _ in range(50):
            if busy.size:
                st[busy], moved = self._line_search(points[busy], st[busy])
                busy = busy[moved > 1e-12 * self.size]  # the next step would be far smaller still
        normals = np.cross(*self._derivatives(st)[0])
        pole = np.linalg.norm(normals, axis=1) < 1e-7 * self.area
        inside = st[pole] + 1e-5 * (0.5 - st[pole])  # at a pole the normal of a point close by
        normals[pole] = np.cross(*self._derivatives(inside)[0])
        return self.point(*st.T), normals / np.linalg.norm(normals, axis=1)[:, None]

    def _line_search(self, points, old):
        """New parameters, no farther from the points than before, and how far the feet moved."""
        start = self.point(*old.T)
        limit = np.linalg.norm(start - points, axis=1) + 1e-14 * self.size
        new = old + self._newton_step(start - points, old)
        for _ in range(12):
            new = np.clip(new, -self.beyond, 1 + self.beyond)
            feet = self.point(*new.T)
            far = np.linalg.norm(feet - points, axis=1) > limit
            if not far.any():
                break
            new[far] = (old[far] + new[far]) / 2
        new[far] = old[far]
        return new, np.where(far, 0, np.linalg.norm(feet - start, axis=1))

    def _newton_step(self, off, st):
        """The step (k, 2) to the minimum of off^2 / 2, off = foot - point, inside the domain."""
        first, second = self._derivatives(st)
        g = np.einsum("kx,ikx->ki", off, first)
        gram = np.einsum("ikx,jkx->kij", first, first)
        hessian = gram + np.einsum("kx,ijkx->kij", off, second)
        trace, bend = np.einsum("kii->k", gram), np.einsum("kii->k", hessian)
        stuck = ((st <= -self.beyond) & (g > 0)) | ((st >= 1 + self.beyond) & (g < 0))
        g = np.where(stuck, 0, g)
        convex = (np.linalg.det(hessian) > 1e-6 * trace**2) & (bend > 0)
        matrix = np.where(convex[:, None, None], hessian, gram)  # else Gauss-Newton's step
        cut = stuck.any(axis=1)  # only one parameter is left, if any
        hessian, gram = hessian[cut] * np.eye(2), gram[cut] * np.eye(2)
        matrix[cut] = np.where(hessian > 1e-3 * gram, hessian, gram)
        matrix += (1e-14 * trace)[:, None, None] * np.eye(2)
        return np.clip(-np.linalg.solve(matrix, g[..., None])[..., 0], -0.05, 0.05)

    def _derivatives(self, st):
        """First (2, k, 3) and second (2, 2, k, 3) derivatives; the second ones are rough."""
        # where the surface ends the stencils stay inside, and the second ones continue the first
        c = st if self.beyond else np.clip(st, 3 * STEP, 1 - 3 * STEP)
        (s, t), h, X = c.T, STEP, self.point
        middle = X(s, t)
        uu = (X(s + h, t) - 2 * middle + X(s - h, t)) / h**2
        vv = (X(s, t + h) - 2 * middle + X(s, t - h)) / h**2
        uv = X(s + h, t + h) - X(s + h, t - h) - X(s - h, t + h) + X(s - h, t - h)
        second = np.array([[uu, uv / (4 * h**2)], [uv / (4 * h**2), vv]])
        if self.exact is None:
            first = np.stack([x.T for x in surfaces.tangents(self, s, t, h)])
            return first + np.einsum("ijkx,kj->ikx", second, st - c), second
        u0, u1, v0, v1 = self.domain
        Xu, Xv = self.exact(*self._parameters(*st.T))
        return np.stack([np.asarray(Xu) * (u1 - u0), np.asarray(Xv) * (v1 - v0)]), second
