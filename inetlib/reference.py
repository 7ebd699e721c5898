"""Reference surfaces: closest points on them, and how the surface and its boundary run there.

The constraints ask a `Reference` for closest points, normals and boundary frames only, so a
mesh and an analytic surface look the same to them.

Paper: Sec. 6.3 (approximation, boundary gliding).
"""

from collections.abc import Callable
from typing import NamedTuple

import igl
import numpy as np

from . import nearest, ties
from .adjacency import opposites
from .mesh import triangles

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

    Paper: Sec. 6.3 (approximation).
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

    Paper: Sec. 6.3 (approximation).
    """
    surface = nearest.patch(point, u, v, tangents)

    def closest(points):
        return nearest.closest(surface, _points(points))

    words = "a parametric reference knows no boundary: use reference.mesh for boundary gliding"
    return Reference(closest, _no_boundary(words), surface.size)
