"""The independent judge: ratios, angles and quality of a quad mesh, face by face.

V (n, 3) and Q (f, 4) as in `mesh`; every result has one entry a face.  Nothing here knows
how a net was made or what it was made for.

Paper: Sec. 4.1, Thm 11, Thm 12.
"""

from typing import NamedTuple

import igl
import numpy as np

from . import mesh


class WebAngles(NamedTuple):
    """The six angles between d1, d2, m13 and m24, radians in (0, pi), each of shape (f,)."""

    d1_d2: np.ndarray
    m13_m24: np.ndarray
    m13_d2: np.ndarray
    m13_d1: np.ndarray
    m24_d2: np.ndarray
    m24_d1: np.ndarray


class Spread(NamedTuple):
    """Mean, extremes, and the largest and mean absolute deviation from a target."""

    mean: float
    low: float
    high: float
    max_deviation: float
    mean_deviation: float


class Quality(NamedTuple):
    """Shape of the faces: `flips` counts those of `flipped`; see `quality`."""

    flips: int
    flipped: np.ndarray
    area_ratio: float
    aspect: float
    planarity: float


class Hausdorff(NamedTuple):
    """The largest distances from the first mesh to the second, and from the second back."""

    there: float
    back: float


def vectors(V, Q):
    """The diagonals and medial lines (d1, d2, m13, m24) of all faces, each (f, 3).

    d1 = v3 - v1, d2 = v4 - v2, m13 = (d1 + d2) / 2, m24 = (d2 - d1) / 2.

    Paper: Thm 11.
    """
    V, Q = mesh.check_arrays(V, Q)
    d1 = V[Q[:, 2]] - V[Q[:, 0]]
    d2 = V[Q[:, 3]] - V[Q[:, 1]]
    return d1, d2, (d1 + d2) / 2, (d2 - d1) / 2


def _length(a, what):
    length = np.sqrt(np.einsum("ij,ij->i", a, a))
    if not length.all():
        raise ValueError(
            f"face {np.argmin(length)} has {what} of length zero: no ratio or angle there"
        )
    return length


def _cross(a, b):
    (a0, a1, a2), (b0, b1, b2) = a.T, b.T
    return np.stack([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0], axis=1)


def _angle(a, b):
    cross = _cross(a, b)
    return np.arctan2(np.sqrt(np.einsum("ij,ij->i", cross, cross)), np.einsum("ij,ij->i", a, b))


def ratios(V, Q):
    """(lam, mu) = (|d2| / |d1|, |m13| / |m24|) of every face; ValueError where one collapses.

    Paper: Eq. (11), Eq. (12), Prop. 4, Def. 14.
    """
    d1, d2, m13, m24 = vectors(V, Q)
    lam = _length(d2, "a diagonal") / _length(d1, "a diagonal")
    return lam, _length(m13, "a medial line") / _length(m24, "a medial line")


def angles(V, Q):
    """(theta, theta0) of every face, radians: angle(d1, d2) and angle(m13, m24).

    Faces that collapse to a line give 0 or pi; a diagonal or medial line of length zero is
    a ValueError.

    Paper: Def. 3, Prop. 13.
    """
    d1, d2, m13, m24 = vectors(V, Q)
    _require_lengths(d1, d2, m13, m24)
    return _angle(d1, d2), _angle(m13, m24)


def web_angles(V, Q):
    """All six angles between the four directions of the web, as `WebAngles`.

    d1_d2 is theta, m13_m24 theta0, m13_d2 alpha, m13_d1 beta; in a planar parallelogram
    m24_d2 = theta0 - alpha and m24_d1 = theta0 + beta.

    Paper: Eq. (5), Thm 12.
    """
    d1, d2, m13, m24 = vectors(V, Q)
    _require_lengths(d1, d2, m13, m24)
    pairs = [(d1, d2), (m13, m24), (m13, d2), (m13, d1), (m24, d2), (m24, d1)]
    return WebAngles(*(_angle(a, b) for a, b in pairs))


def _require_lengths(d1, d2, m13, m24):
    for diagonal in (d1, d2):
        _length(diagonal, "a diagonal")
    for medial in (m13, m24):
        _length(medial, "a medial line")


class Star(NamedTuple):
    """Angles at vertices, radians: `vertex` (k,) numbers, theta and theta0 (k,) in (0, pi)."""

    vertex: np.ndarray
    theta: np.ndarray
    theta0: np.ndarray


def star_angles(V, Q, unit=False):
    """The angles at which the four polylines of the web cross at the vertices, as `Star`.

    Q labelled.  For interior vertices of valence 4, in increasing order: theta0 is the angle
    between (right - left) and (up - down), theta that between the same chords of the two
    diagonals, from the face corners opposite to the vertex.  unit=True takes chords of the
    unit vectors from the vertex to its neighbours instead.

    Paper: Thm 12 (angles at vertices).
    """
    V, Q = mesh.check_arrays(V, Q)
    if not mesh.is_labelled(Q):
        raise ValueError("the faces do not agree on u and v: call mesh.label first")
    fan = mesh.fans(Q).get(4, np.empty((0, 4), dtype=np.int64))
    first = np.argmax(fan % 2 == 1, axis=1)  # a u-edge leaves v2 or v4: along u or against it
    fan = np.take_along_axis(fan, (first[:, None] + np.arange(4)) % 4, axis=1)
    face, slot = np.divmod(fan, 4)
    vertex = Q.ravel()[fan[:, 0]]
    right, up = _chords(V, vertex, Q[face, (slot + 1) % 4], unit)
    d2, d1 = _chords(V, vertex, Q[face, (slot + 2) % 4], unit)
    order = np.argsort(vertex)
    return Star(vertex[order], _angle(-d1, d2)[order], _angle(right, up)[order])


def _chords(V, vertex, around, unit):
    """Neighbour 0 minus neighbour 2, and 1 minus 3; around: (k, 4) vertex numbers."""
    rays = V[around] - V[vertex][:, None]
    if unit:
        rays = rays / np.linalg.norm(rays, axis=2, keepdims=True)
    return rays[:, 0] - rays[:, 2], rays[:, 1] - rays[:, 3]


def theta_defect(V, Q):
    """How far each face is from a theta-quad: (d2^2 - d1^2 - 2 d1 . d2) / (d1^2 + d2^2).

    Zero exactly where theta = theta0, that is lam = mu; free of scale.

    Paper: Eq. (13), Def. 5, Prop. 6.
    """
    d1, d2, _, _ = vectors(V, Q)
    one, two = (np.einsum("ij,ij->i", d, d) for d in (d1, d2))
    _length(d1, "a diagonal"), _length(d2, "a diagonal")
    return (two - one - 2 * np.einsum("ij,ij->i", d1, d2)) / (one + two)


def spread(values, target=None):
    """`Spread` of an array; deviations are from `target`, or from the mean when it is None."""
    values = np.asarray(values, dtype=float)
    if values.size == 0 or not np.isfinite(values).all():
        raise ValueError("spread needs at least one value, all of them finite")
    mean = float(values.mean())
    if target is not None and not np.isfinite(target).all():
        raise ValueError(f"target = {target}: a finite number is wanted")
    off = np.abs(values - (mean if target is None else target))
    return Spread(
        mean, float(values.min()), float(values.max()), float(off.max()), float(off.mean())
    )


def deviations(V, Q, theta=None, theta0=None):
    """|theta - wanted| and |theta0 - wanted| of every face, (2, f), radians.

    What is wanted is the given angle, or the mean over the net where it is None.
    """
    found, wanted = np.stack(angles(V, Q)), (theta, theta0)
    means = [x.mean() if a is None else a for x, a in zip(found, wanted, strict=True)]
    return np.abs(found - np.array(means)[:, None])


def _normals(d1, d2):
    """Unit normals of the faces and twice their areas."""
    normal = _cross(d1, d2)
    twice_area = np.sqrt(np.einsum("ij,ij->i", normal, normal))
    if not twice_area.all():
        raise ValueError(f"face {np.argmin(twice_area)} has no area: its diagonals are parallel")
    return normal / twice_area[:, None], twice_area


def _against(normal, neighbours):
    """The faces whose normals point against the sum of those of their neighbours.

    Two neighbours may point against each other: their sum is zero, and says nothing.
    """
    or_zero = np.concatenate([normal, np.zeros((1, 3))])  # number -1 is no neighbour
    around = sum(or_zero[faces] for faces in neighbours.T)
    rounding = 1e-12  # of a sum of up to four unit normals, well below any true cosine
    return np.flatnonzero(np.einsum("ij,ij->i", normal, around) < -rounding)


def flipped(V, Q, neighbours=None):
    """The flipped faces (see `quality`); neighbours: `mesh.face_neighbours(Q)` if known."""
    d1, d2, _, _ = vectors(V, Q)
    neighbours = mesh.face_neighbours(Q) if neighbours is None else neighbours
    return _against(_normals(d1, d2)[0], neighbours)


def quality(V, Q):
    """`Quality` of a mesh: flipped faces, size, aspect and planarity.

    flipped     faces whose normal d1 x d2 points against the mean normal of their edge
                neighbours (int64 array), flips their number
    area_ratio  smallest / largest area of a face, area = |d1 x d2| / 2
    aspect      the largest ratio of the longer to the shorter medial line
    planarity   the largest distance between the diagonals over their mean length
                (0 for planar faces)
    """
    d1, d2, m13, m24 = vectors(V, Q)
    normal, twice_area = _normals(d1, d2)
    flipped = _against(normal, mesh.face_neighbours(Q))
    one, two = _length(m13, "a medial line"), _length(m24, "a medial line")
    V, Q = np.asarray(V, dtype=float), np.asarray(Q)
    apart = np.abs(np.einsum("ij,ij->i", V[Q[:, 1]] - V[Q[:, 0]], normal))
    size = (_length(d1, "a diagonal") + _length(d2, "a diagonal")) / 2
    return Quality(
        flips=len(flipped),
        flipped=flipped,
        area_ratio=float(twice_area.min() / twice_area.max()),
        aspect=float(np.maximum(one / two, two / one).max()),
        planarity=float((apart / size).max()),
    )


def hausdorff(V, Q, W, R, refine=1):
    """One-sided distances between the meshes V, Q and W, R, as `Hausdorff(there, back)`.

    there is the largest distance from a vertex of V, Q to the surface W, R, back that from a
    vertex of W, R to the surface V, Q.  Distances to a surface are true distances to its
    triangles; quads are cut along their shorter diagonals, triangles (f, 3) are welcome too.
    The largest distance need not sit at a vertex, so both are lower bounds of the Hausdorff
    distances of the surfaces.  `refine` = k > 1 improves them: the edges of the triangles are
    divided into k parts and all points of this lattice measured, (k + 1)^2 a quad.  The unit
    is that of the coordinates; vertices of no face do not count.
    """
    if not (refine >= 1 and int(refine) == refine):
        raise ValueError(f"refine = {refine}: a whole number of at least 1 is wanted")
    one, two = mesh.triangles(V, Q), mesh.triangles(W, R)
    return Hausdorff(_farthest(*one, *two, int(refine)), _farthest(*two, *one, int(refine)))


def _farthest(V, F, W, G, parts):
    """The largest distance of the sample points of the triangles V, F to the triangles W, G."""
    i, j = np.divmod(np.arange((parts + 1) ** 2), parts + 1)
    weights = (np.stack([parts - i - j, i, j], axis=1) / parts)[i + j <= parts]
    samples = V[np.unique(F)] if parts == 1 else (weights @ V[F]).reshape(-1, 3)
    squares, _, _ = igl.point_mesh_squared_distance(samples, W, G)
    return float(np.sqrt(squares.max()))
