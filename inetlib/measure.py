"""The independent judge: ratios, angles and quality of a quad mesh, face by face.

V (n, 3) and Q (f, 4) as in `mesh`; results have one entry a face, angles in radians.  Nothing
here knows how a net was made or what it was made for."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import mesh, parallelogram


def vectors(V: ArrayLike, Q: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The diagonals d1, d2 and the medial lines m13, m24 of all faces: (f, 3).  Paper: Thm 11."""
    d1, d2 = _diagonals(V, Q)
    return d1, d2, (d1 + d2) / 2, (d2 - d1) / 2


def _vectors_and_lengths(V, Q):
    """The `vectors` and their lengths; ValueError where one of them is zero."""
    found = vectors(V, Q)
    lengths = [np.sqrt(_dot(a, a)) for a in found]
    for length, what in zip(lengths, ("diagonal",) * 2 + ("medial line",) * 2, strict=True):
        if not length.all():
            words = f"the face {{}} has a {what} of length zero: no ratio or angle there"
            raise mesh.Fault(words, np.asarray(Q)[np.argmin(length)])
    return found, lengths


def _diagonals(V, Q):
    """The diagonals d1, d2 of faces that are checked."""
    V, Q = mesh.check_arrays(V, Q)
    return V[Q[:, 2]] - V[Q[:, 0]], V[Q[:, 3]] - V[Q[:, 1]]


def _dot(a, b):
    return np.einsum("ij,ij->i", a, b)


def _cross(a, b):
    (a0, a1, a2), (b0, b1, b2) = a.T, b.T
    return np.stack([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0], axis=1)


def _angle(a, b):
    cross = _cross(a, b)
    return np.arctan2(np.sqrt(_dot(cross, cross)), _dot(a, b))


def ratios(V: ArrayLike, Q: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """(lam, mu) = (|d2| / |d1|, |m13| / |m24|) of every face; ValueError where one collapses.

    Paper: Eq. (11), Eq. (12), Prop. 4, Def. 14."""
    _, (d1, d2, m13, m24) = _vectors_and_lengths(V, Q)
    return d2 / d1, m13 / m24


def angles(V: ArrayLike, Q: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """(theta, theta0) of every face: angle(d1, d2) and angle(m13, m24); ValueError as `ratios`.

    Paper: Def. 3, Prop. 13."""
    (d1, d2, m13, m24), _ = _vectors_and_lengths(V, Q)
    return _angle(d1, d2), _angle(m13, m24)


def faces(V: ArrayLike, Q: ArrayLike) -> np.ndarray:
    """lam, mu, theta, theta0 of every face, (4, f): `ratios` and `angles` at once."""
    (d1, d2, m13, m24), (one, two, three, four) = _vectors_and_lengths(V, Q)
    return np.stack([two / one, three / four, _angle(d1, d2), _angle(m13, m24)])


class WebAngles(NamedTuple):
    """The six angles between d1, d2, m13 and m24, in (0, pi), each of shape (f,)."""

    d1_d2: np.ndarray  # theta
    m13_m24: np.ndarray  # theta0
    m13_d2: np.ndarray  # alpha
    m13_d1: np.ndarray  # beta
    m24_d2: np.ndarray  # theta0 - alpha in a planar parallelogram
    m24_d1: np.ndarray  # theta0 + beta in a planar parallelogram


def web_angles(V: ArrayLike, Q: ArrayLike) -> WebAngles:
    """All six angles between the directions of the web.  Paper: Eq. (5), Thm 12."""
    (d1, d2, m13, m24), _ = _vectors_and_lengths(V, Q)
    pairs = [(d1, d2), (m13, m24), (m13, d2), (m13, d1), (m24, d2), (m24, d1)]
    return WebAngles(*(_angle(a, b) for a, b in pairs))


def theta_defect(V: ArrayLike, Q: ArrayLike) -> np.ndarray:
    """(d2^2 - d1^2 - 2 d1 . d2) / (d1^2 + d2^2): zero just where theta = theta0, lam = mu.

    Paper: Eq. (13), Def. 5, Prop. 6."""
    (d1, d2, _, _), _ = _vectors_and_lengths(V, Q)
    one, two = _dot(d1, d1), _dot(d2, d2)
    return (two - one - 2 * _dot(d1, d2)) / (one + two)


class Star(NamedTuple):
    """Angles at vertices: `vertex` (k,) numbers, theta and theta0 (k,) in (0, pi)."""

    vertex: np.ndarray
    theta: np.ndarray
    theta0: np.ndarray


def star_angles(V: ArrayLike, Q: ArrayLike, unit: bool = False) -> Star:
    """The angles of the web at interior vertices of valence 4; ValueError unless Q is labelled.

    theta0 lies between the chords right - left and up - down, theta between those of the face
    corners opposite to the vertex; unit=True: chords of the unit vectors to these points.
    Paper: Thm 12."""
    V, Q = mesh.check_arrays(V, Q)
    face, slot = np.divmod(mesh.crossings(Q), 4)  # along u or against it
    vertex = Q[face, slot][:, 0]
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


class Spread(NamedTuple):
    """Mean, extremes, and the largest and mean absolute deviation from a target."""

    mean: float
    low: float
    high: float
    max_deviation: float
    mean_deviation: float


def spread(values: ArrayLike, target: ArrayLike | None = None) -> Spread:
    """`Spread` of an array; deviations are from `target`, or from the mean when it is None."""
    values = np.asarray(values, dtype=float)
    if values.size == 0 or not np.isfinite(values).all():
        raise ValueError("spread needs at least one value, all of them finite")
    if target is not None and not np.isfinite(target).all():
        raise ValueError(f"target = {target}: a finite number is wanted")
    mean = values.mean()
    off = np.abs(values - (mean if target is None else target))
    return Spread(*map(float, (mean, values.min(), values.max(), off.max(), off.mean())))


def deviations(
    V: ArrayLike, Q: ArrayLike, theta: float | None = None, theta0: float | None = None
) -> np.ndarray:
    """|theta - wanted| and |theta0 - wanted| of every face, (2, f); for None from the mean."""
    found, wanted = np.stack(angles(V, Q)), (theta, theta0)
    means = [x.mean() if a is None else a for x, a in zip(found, wanted, strict=True)]
    return np.abs(found - np.array(means)[:, None])


class Quality(NamedTuple):
    """Shape of the faces."""

    flips: int  # how many faces are flipped
    flipped: np.ndarray  # their normal d1 x d2 points against the mean one of their neighbours
    darts: int  # how many faces are not convex
    nonconvex: np.ndarray  # seen along d1 x d2 one of their corners turns the wrong way
    corner: float  # the smallest angle at a corner, radians
    area_ratio: float  # smallest / largest area |d1 x d2| / 2
    aspect: float  # the largest ratio of the longer to the shorter medial line
    planarity: float  # the largest distance between the diagonals over their mean length


def quality(V: ArrayLike, Q: ArrayLike) -> Quality:
    """The `Quality` of a mesh; ValueError where a face has no area."""
    (d1, d2, _, _), (_, _, length13, length24) = _vectors_and_lengths(V, Q)
    normal, twice_area = _normals(d1, d2, Q)
    turned = _against(normal, mesh.face_neighbours(Q))
    aspect = np.maximum(length13 / length24, length24 / length13).max()
    numbers = twice_area.min() / twice_area.max(), aspect, planarity(V, Q).max()
    bent = nonconvex(V, Q)
    corner = float(np.min(corners(V, Q)))
    return Quality(len(turned), turned, len(bent), bent, corner, *map(float, numbers))


def planarity(V: ArrayLike, Q: ArrayLike) -> np.ndarray:
    """The distance between the diagonals of every face over their mean length: (f,).

    0 is flat; ValueError where a face has no area."""
    (d1, d2, _, _), (one, two, _, _) = _vectors_and_lengths(V, Q)
    v1, v2 = np.asarray(V, dtype=float)[np.asarray(Q)[:, :2].T]
    return np.abs(_dot(v2 - v1, _normals(d1, d2, Q)[0])) / ((one + two) / 2)


def corners(V: ArrayLike, Q: ArrayLike) -> np.ndarray:
    """The angles between the edges at the corners v1 ... v4 of every face: (f, 4), in [0, pi]."""
    V, Q = mesh.check_arrays(V, Q)
    edges = [V[Q[:, k - 3]] - V[Q[:, k]] for k in range(4)]
    return np.stack([_angle(-edges[k - 1], edges[k]) for k in range(4)], axis=1)


def nonconvex(V: ArrayLike, Q: ArrayLike) -> np.ndarray:
    """The faces that are darts: seen along d1 x d2, their diagonals do not cross.

    The angles know nothing of them, as they do not see where the diagonals lie.

    Paper: B11."""
    d1, d2 = _diagonals(V, Q)
    v1, v2 = np.asarray(V, dtype=float)[np.asarray(Q)[:, :2].T]
    apart = v2 - v1 + (d2 - d1) / 2  # from the middle of v1 v3 to the middle of v2 v4
    one, two, both = _dot(d1, d1), _dot(d2, d2), _dot(d1, d2)
    along, across = _dot(apart, d1), _dot(apart, d2)
    # They cross at these parts of d1 and d2 from their middles, times |d1 x d2|^2.
    parts = np.abs(along * two - across * both), np.abs(along * both - across * one)
    return np.flatnonzero(np.maximum(*parts) > (0.5 + 1e-9) * (one * two - both**2))


def flipped(V: ArrayLike, Q: ArrayLike, neighbours: np.ndarray | None = None) -> np.ndarray:
    """The flipped faces (see `quality`); neighbours: `mesh.face_neighbours(Q)` if known."""
    d1, d2 = _diagonals(V, Q)
    neighbours = mesh.face_neighbours(Q) if neighbours is None else neighbours
    return _against(_normals(d1, d2, Q)[0], neighbours)


def _normals(d1, d2, Q):
    """Unit normals of the faces and twice their areas."""
    normal = _cross(d1, d2)
    twice_area = np.sqrt(_dot(normal, normal))
    if not twice_area.all():
        face = np.asarray(Q)[np.argmin(twice_area)]
        raise mesh.Fault("the face {} has no area: its diagonals are parallel", face)
    return normal / twice_area[:, None], twice_area


def _against(normal, neighbours):
    """The faces whose normals point against the sum of those of their neighbours."""
    or_zero = np.concatenate([normal, np.zeros((1, 3))])  # number -1 is no neighbour
    around = sum(or_zero[faces] for faces in neighbours.T)
    rounding = 1e-12  # where two neighbours point against each other, their sum says nothing
    return np.flatnonzero(_dot(normal, around) < -rounding)


class Hausdorff(NamedTuple):
    """The largest distances from the first mesh to the second, and from the second back."""

    there: float
    back: float


def hausdorff(V: ArrayLike, Q: ArrayLike, W: ArrayLike, R: ArrayLike, refine: int = 1) -> Hausdorff:
    """The largest distance of a vertex of V, Q from the surface W, R, and the other way.

    The faces are cut into triangles, or are triangles.  Both are lower bounds of the distances
    of the surfaces, which need not be at a vertex; refine = k > 1 measures all points of a
    lattice that divides the edges of the triangles into k parts."""
    refine = parallelogram.check_whole("refine", refine)
    one, two = mesh.triangles(V, Q), mesh.triangles(W, R)
    return Hausdorff(_farthest(*one, *two, refine), _farthest(*two, *one, refine))


def _farthest(V, F, W, G, parts):
    """The largest distance of the sample points of the triangles V, F to the triangles W, G."""
    import igl

    i, j = np.divmod(np.arange((parts + 1) ** 2), parts + 1)
    weights = (np.stack([parts - i - j, i, j], axis=1) / parts)[i + j <= parts]
    samples = V[np.unique(F)] if parts == 1 else (weights @ V[F]).reshape(-1, 3)
    squares, _, _ = igl.point_mesh_squared_distance(samples, W, G)
    return float(np.sqrt(squares.max()))
