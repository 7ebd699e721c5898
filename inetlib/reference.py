"""Reference surfaces: closest points on them, and how the surface and its boundary run there.

The constraints ask a `Reference` for closest points, normals and boundary frames only, so a
mesh and an analytic surface look the same to them.
"""

from collections.abc import Callable
from typing import NamedTuple

import igl
import numpy as np
from scipy.spatial import cKDTree

from . import surfaces, ties
from .mesh import opposites, triangles
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


def closest_on_patch(surface, points):
    """The closest points (k, 3) on a `Patch` and the unit normals (k, 3) there."""
    _, start = surface.samples.query(points)
    st = np.stack(np.divmod(start, SAMPLES + 1), axis=1) / SAMPLES
    st = _project(surface, points, st)
    return surface.point(*st.T), _normals(surface, st)


def patch(point, u, v, tangents=None):
    """The surface point(u, v) as a `Patch`; the arguments are those of `reference.parametric`.

    ValueError for an empty domain, and for points that are not finite, have not three
    coordinates or make no surface.
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
            return tuple(x.T for x in surfaces.tangents(surface, s, t, STEP))
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


# --- reference surfaces ---

CORNER = np.radians(30)  # a boundary that turns by more at a vertex has a corner there
ASIDE = 1e-9 * np.array([0.2718, 0.5772, 0.7691])  # of the diagonal: no symmetry of any surface
SAME = 1e-11  # of the diagonal: distances that differ by less are equal


class Reference(NamedTuple):
    """A reference surface, made by `mesh` or `parametric`.

    closest(points)   closest points and unit normals of the surface there, each (k, 3)
    boundary(points)  closest points on the boundary and an orthonormal frame e1, e2, e3
                      there, each (k, 3): e1 along the boundary, e3 normal to the surface.
                      It stands for the Frenet frame, which a straight boundary does not
                      have; the energies depend on the plane of e2 and e3 only.
    diagonal          the diagonal of the bounding box
    V, F              the triangles, None for a parametric reference
    has_boundary      whether there is a boundary to ask for

    points: (k, 3), finite, else ValueError.
    """

    closest: Callable
    boundary: Callable
    diagonal: float
    V: np.ndarray | None = None
    F: np.ndarray | None = None
    has_boundary: bool = False


# --- meshes -------------------------------------------------------------------------------


def mesh(V, F):
    """The `Reference` of a mesh of triangles (f, 3) or quads (f, 4) with vertices V (n, 3).

    A quad is two triangles, cut along its shorter diagonal.  Closest points are exact points
    of the triangles; normals are interpolated between the vertex normals (weighted by the
    angles of the faces), so that they have no jump at an edge, and are those of the face
    where that degenerates.  Along the boundary e1 is interpolated in the same way, with the
    mesh on its left; at corners, where the boundary turns by more than 30 degrees, it is the
    direction of the segment hit (at the corner itself, of the one that leaves it).  A closed
    surface has no boundary: asking is a ValueError.

    ValueError for faces that are no oriented manifold, and for triangles without area.
    """
    sides = np.shape(F)[-1] if np.ndim(F) else 0
    V, F = (a.copy() for a in triangles(V, F))  # later changes of V do not change the tree
    face = _face_normals(V, F, per=2 if sides == 4 else 1)
    open_edges = np.flatnonzero(opposites(F) < 0)
    _refuse_fans(F)
    smooth = igl.per_vertex_normals(V, F, igl.PER_VERTEX_NORMALS_WEIGHTING_TYPE_ANGLE)
    smooth = np.nan_to_num(smooth)  # unused vertices, and normals that cancel
    diagonal = float(np.linalg.norm(np.ptp(V[np.unique(F)], axis=0)))
    tree = igl.AABB()
    tree.init(V, F)

    def closest(points):
        hit, feet = _nearest(tree, V, F, _points(points), diagonal)
        weights = np.clip(_barycentric(feet, *np.moveaxis(V[F[hit]], 1, 0)), 0, 1)
        normals = np.einsum("kc,kcx->kx", weights, smooth[F[hit]])
        return feet, _unit_or(normals, face[hit])

    rim = _boundary(V, F, open_edges, smooth, face, diagonal)
    return Reference(closest, rim, diagonal, V, F, bool(open_edges.size))


def _face_normals(V, F, per):
    """Unit normals of the triangles; ValueError names a face, of `per` triangles, without area."""
    a, b, c = np.moveaxis(V[F], 1, 0)
    normals = np.cross(b - a, c - a)
    area = np.linalg.norm(normals, axis=1)
    longest = np.max([np.sum((p - q) ** 2, axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    flat = ~(area > 1e-12 * longest)
    if flat.any():
        what = "its triangle" if per == 2 else "the triangle"
        where = np.argmax(flat)
        raise ValueError(
            f"face {where // per} has no area: {what} {F[where].tolist()} is a line or a point"
        )
    return normals / area[:, None]


def _refuse_fans(F):
    pinched = ~igl.is_vertex_manifold(F)
    pinched = np.intersect1d(np.flatnonzero(pinched), F)  # igl counts unused vertices too
    if pinched.size:
        raise ValueError(f"the faces at vertex {pinched[0]} form two fans: not a manifold")


def _nearest(tree, V, F, points, diagonal):
    """(k,) the triangle or segment of F nearest to each point, and (k, 3) the foot there.

    Over a valley several are equally near, which of them would hang on rounding: there it is
    the one that is nearest when the point moves a little ASIDE.
    """
    squares, hit, feet = tree.squared_distance(V, F, points)
    away = np.flatnonzero(squares > (SAME * diagonal) ** 2)
    if away.size:
        other = tree.squared_distance(V, F, points[away] + ASIDE * diagonal)[1]
        away, other = away[other != hit[away]], other[other != hit[away]]
        feet_there = _feet(points[away], V[F[other]])
        far = np.linalg.norm(feet_there - points[away], axis=1)
        tied = far <= np.sqrt(squares[away]) + SAME * diagonal
        hit[away[tied]], feet[away[tied]] = other[tied], feet_there[tied]
    return hit, feet


def _feet(p, corners):
    """The closest points (k, 3) of segments (k, 2, 3) or triangles (k, 3, 3) to points p (k, 3)."""
    a, b = corners, np.roll(corners, -1, axis=1)
    along = np.einsum("kcx,kcx->kc", p[:, None] - a, b - a) / np.sum((b - a) ** 2, axis=2)
    feet = a + np.clip(along, 0, 1)[..., None] * (b - a)
    reference = np.argmin(np.linalg.norm(feet - p[:, None], axis=2), axis=1)
    feet = feet[np.arange(len(p)), reference]
    if corners.shape[1] == 2:
        return feet
    weights = _barycentric(p, *np.moveaxis(corners, 1, 0))
    inside = (weights >= 0).all(axis=1)[:, None]
    return np.where(inside, np.einsum("kc,kcx->kx", weights, corners), feet)


def _barycentric(p, a, b, c):
    """Barycentric coordinates (k, 3) of the feet of points p in planes a, b, c, each (k, 3)."""
    u, v, w = b - a, c - a, p - a
    products = ((u, u), (u, v), (v, v), (w, u), (w, v))
    uu, uv, vv, wu, wv = (np.einsum("ij,ij->i", x, y) for x, y in products)
    area = uu * vv - uv * uv
    second, third = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    return np.stack([1 - second - third, second, third], axis=1)


def _unit_or(vectors, other):
    """The vectors at unit length, or the other ones where they vanish or point against those."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    good = (np.einsum("ij,ij->i", vectors, other) > 1e-6)[:, None]
    return np.where(good, vectors / np.where(good, length, 1), other)


def _boundary(V, F, half, smooth, face, diagonal):
    """The callable `Reference.boundary` for the boundary half-edges `half` of the triangles."""
    if not half.size:
        return _no_boundary("the reference is a closed surface: it has no boundary")
    edges = np.stack([F.ravel()[half], np.roll(F, -1, axis=1).ravel()[half]], axis=1)
    owner = face[half // 3]
    along = V[edges[:, 1]] - V[edges[:, 0]]
    length = np.linalg.norm(along, axis=1)
    along /= length[:, None]
    after = np.empty(len(V), dtype=np.int64)
    after[edges[:, 0]] = np.arange(len(edges))
    after = after[edges[:, 1]]
    tangents = _vertex_tangents(along, after)
    tree = igl.AABB()
    tree.init(V, edges)

    def boundary(points):
        hit, feet = _nearest(tree, V, edges, _points(points), diagonal)
        t = np.einsum("ij,ij->i", feet - V[edges[hit, 0]], along[hit]) / length[hit]
        end = t > 1 - ties.TIE  # as near to the next segment
        hit, t = np.where(end, after[hit], hit), np.where(end, 0, t)
        weights = np.clip(np.stack([1 - t, t], axis=1), 0, 1)[..., None]
        e1 = _unit_or(np.sum(weights * tangents[hit], axis=1), along[hit])
        plain = _across(owner[hit], e1)  # never short: e1 is close to the edge
        plain /= np.linalg.norm(plain, axis=1, keepdims=True)
        e3 = _unit_or(_across(np.sum(weights * smooth[edges[hit]], axis=1), e1), plain)
        return feet, e1, np.cross(e3, e1), e3

    return boundary


def _across(vectors, e1):
    """The parts of the vectors that are orthogonal to the unit vectors e1."""
    return vectors - np.sum(vectors * e1, axis=1, keepdims=True) * e1


def _vertex_tangents(along, after):
    """Tangents (e, 2, 3) at both ends of the boundary edges, the edge's own at corners.

    after (e,): the edge that begins where each one ends.
    """
    before, here = np.argsort(after), np.arange(len(after))
    one, two = along[np.stack([before, here], axis=1)], along[np.stack([here, after], axis=1)]
    smooth = np.einsum("ecx,ecx->ec", one, two) > np.cos(CORNER) - 1e-9  # 30 degrees are no more
    mean = one + two
    mean /= np.maximum(np.linalg.norm(mean, axis=2, keepdims=True), 1e-300)
    return np.where(smooth[..., None], mean, along[:, None])


def _no_boundary(words):
    def boundary(points):
        raise ValueError(words)

    return boundary


def _points(points):
    points = np.ascontiguousarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points have the shape {points.shape}: rows of three are wanted")
    if not np.isfinite(points).all():
        bad = np.argmin(np.isfinite(points).all(axis=1))
        raise ValueError(f"point {bad} has a coordinate that is not a finite number")
    return points


# --- analytic surfaces --------------------------------------------------------------------


def parametric(point, u, v, tangents=None):
    """The `Reference` of the surface point(u, v) over u[0] <= u <= u[1], v[0] <= v <= v[1].

    point     takes two arrays of one shape, returns points (..., 3), smooth in u and v
    u, v      the domain, two numbers each
    tangents  takes the same, returns the pair (X_u, X_v), each (..., 3); default: finite
              differences, for features of the surface wider than a tenth of the domain

    The closest point is searched by Newton steps from the nearest of 201 x 201 samples, to
    about 1e-12 of the surface's size; of sheets that come closer to each other than the
    samples are apart, another than the nearest may be found.  The surface goes on for a
    tenth of the domain on all sides, if `point` does, else it ends with the domain, and its
    last 0.15 % know their tangents to about 1e-6 only.  Where the parametrisation has a pole,
    the normal of a point close by is taken.  Parametric references know no boundary: asking
    is a ValueError.
    """
    surface = patch(point, u, v, tangents)

    def closest(points):
        return closest_on_patch(surface, _points(points))

    words = "a parametric reference knows no boundary: use reference.mesh for boundary gliding"
    return Reference(closest, _no_boundary(words), surface.size)
