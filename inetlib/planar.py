"""Isogonal nets in the plane by linear algebra: they are discrete holomorphic functions.

In complex numbers both ratios and both angles of a face are one equation,
v4 - v2 = K (v3 - v1) with K = lam exp(i theta).  It is linear, so the nets on a mesh form a
vector space, from which `planar_net` picks the smoothest or the closest.

Paper: Sec. 3.3 (beyond the paper: B7).
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import bsr_array, coo_array, csr_array, diags_array, kron
from scipy.sparse.csgraph import connected_components

from . import mesh, parallelogram, ties
from .solver import sparse

SAMPLES = 1000  # of an outline given as a function


def points(given, name, count=None):
    """Points of the plane as complex (k,); (k, 2) and (k, 3) arrays are read without their z.

    ValueError that begins with `name` for other shapes, for numbers that are not finite and
    for another number of points than `count`.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    given = np.asarray(given)
    if given.dtype.kind not in "iufc":
        raise ValueError(f"{name} is of type {given.dtype}: numbers are wanted")
    if given.ndim == 2 and given.shape[1] in (2, 3) and given.dtype.kind != "c":
        given = given[:, 0] + 1j * given[:, 1]
    given = np.atleast_1d(given).astype(complex)
    if given.ndim != 1:
        raise ValueError(
            f"{name} has the shape {given.shape}: complex numbers, or rows of two or three "
            "coordinates are wanted"
        )
    if count is not None and len(given) != count:
        raise ValueError(f"{name}: {count} points are wanted, not {len(given)}")
    if not np.isfinite(given).all():
        raise ValueError(f"{name}: point {np.argmin(np.isfinite(given))} is not finite")
    return given


def closed(given, name="boundary"):
    """A closed outline without repeated points, counter-clockwise, complex (k,), k >= 3.

    given: points as for `points`, the first may be repeated at the end; or a function of an
    array of parameters in [0, 1].  ValueError for fewer than three points.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    z = points(given(np.arange(SAMPLES) / SAMPLES) if callable(given) else given, name)
    z = z[z != np.roll(z, -1)]
    if len(z) < 3:
        raise ValueError(f"{name} has {len(z)} different points: at least three are wanted")
    return z if np.sum((np.conj(z) * np.roll(z, -1)).imag) > 0 else z[::-1]


def read_handles(given, count):
    """Vertex numbers (k,) and complex points (k,) of handles, both empty for None.

    given: (vertex numbers, points); ValueError for numbers outside 0 ... count - 1, for one
    that stands twice, and as in `points`.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    if given is None:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=complex)
    if len(given) != 2:
        raise ValueError(f"handles has {len(given)} parts: (vertex numbers, points) is wanted")
    held = _check_vertices(given[0], "handles", count)
    return held, points(given[1], "handles", len(held))


def _check_vertices(numbers, name, count):
    numbers = np.atleast_1d(np.asarray(numbers))
    if numbers.ndim != 1 or numbers.dtype.kind not in "iu" or not numbers.size:
        raise ValueError(f"{name}: a list of vertex numbers is wanted")
    bad = numbers[(numbers < 0) | (numbers >= count)]
    if bad.size:
        raise ValueError(f"{name} name vertex {bad[0]}: 0 to {count - 1} are wanted")
    found, often = np.unique(numbers, return_counts=True)
    if (often > 1).any():
        raise ValueError(f"{name} name vertex {found[np.argmax(often)]} twice")
    return numbers.astype(np.int64)


def read_loops(boundary, Q, count):
    """The outlines as a list of (vertex numbers, closed polyline), empty for None.

    boundary: an outline as for `closed`, which goes to the longest boundary loop of the
    faces Q (f, 4); or a list of (vertex numbers, outline).

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    if boundary is None:
        return []
    if isinstance(boundary, list) and all(_is_pair(part) for part in boundary):
        return [
            (_check_vertices(numbers, "boundary", count), closed(curve))
            for numbers, curve in boundary
        ]
    found = mesh.boundary_loops(Q)
    if not found:
        raise ValueError("the mesh has no boundary to lay along an outline")
    return [(max(found, key=len), closed(boundary))]


def _is_pair(part):
    """Whether this is (vertex numbers, outline) and not the two coordinates of a point."""
    return isinstance(part, tuple) and len(part) == 2 and np.ndim(part[0]) == 1


def closest(z, outline):
    """The points of a closed polyline closest to z, and its unit tangents there: complex (k,).

    At a corner the tangent is perpendicular to the way from the closest point to z.  Of points
    equally close the one on the first side is taken.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    step = np.roll(outline, -1) - outline
    feet, tangents = np.empty((2, len(z)), dtype=complex)
    size = np.abs(outline - outline[0]).max()
    for k, point in enumerate(z):
        part = np.clip(((point - outline) / step).real, 0, 1)
        found = outline + part * step
        near = _nearest(found, np.abs(found - point), size)
        off, corner = point - found[near], part[near] in (0, 1)
        if corner and abs(off) > ties.TIE * abs(step[near]):
            along = 1j * off
        else:  # at a corner itself that of the side that leaves it
            along = step[(near + (part[near] > 1 - ties.TIE)) % len(step)]
        feet[k], tangents[k] = found[near], along / abs(along)
    return feet, tangents


def _nearest(feet, away, size):
    """The index of the nearest foot; of feet apart that are equally near, that of the first."""
    first = ties.first_smallest(away, size)
    around = np.abs(feet - feet[first]) < 1e-4 * size  # on the same side, or the next one
    return np.argmin(np.where(around, away, np.inf))


def spread(outline, count):
    """`count` points at equal distances along a closed polyline, from its first point on.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    ring = np.append(outline, outline[0])
    length = np.concatenate([[0], np.cumsum(np.abs(np.diff(ring)))])
    return np.interp(np.arange(count) / count * length[-1], length, ring)


# --- Isogonal nets in the plane by linear algebra: they are discrete holomorphic functions. ---

PENALTY = 1e6  # of the equations; the multipliers make them exact
POWER = 1.5  # of the vertex count in the weight of smoothness: alike on fine meshes
STEPS = 30  # at most, of the multipliers and of the gliding boundary
EXACT = 1e-9  # residuals above this fraction of a diagonal mean: there is no such net
SLIDE = 0.01  # weight of the distance along the outline, beside 1 for that across it


class Planar(NamedTuple):
    """A planar net and what to know about it.

    V         (n, 3) vertices, z = 0
    residual  the largest |d2 - K d1| / |d1| of all faces
    freedom   how many vertices may be chosen, in good places: vertices less faces
    distance  the largest distance of a boundary vertex from its outline; nan without one
    flipped   faces whose edges cross
    wound     interior vertices around which the net winds more than once
    message   all this in words
    """

    V: np.ndarray
    residual: float
    freedom: int
    distance: float
    flipped: np.ndarray
    wound: np.ndarray
    message: str


def planar_net(Q, theta, theta0, handles=None, boundary=None, start=None, smooth=0.01):
    """The smoothest isogonal net in the plane through given points, as a `Planar`.

    Q (f, 4): any consistently labelled connected mesh; theta, theta0: radians.  Points are
    complex numbers, (k, 2) or (k, 3) with z dropped.  At least one of these is wanted:

    handles   (vertex numbers, points): vertices held exactly, two or more (one with a start)
    boundary  a closed outline, points or a function on [0, 1]: the longest boundary loop
              glides along it as near as it can; or a list of (vertex numbers, outline)
    start     points of all vertices: the first guess for the boundary; the net is the one
              closest to it when there are neither a boundary nor two handles
    smooth    weight of the second differences beside squared distances to outline or start

    The equations hold to round-off.  Orientation is kept by them, but edges of a face may
    cross where too much is asked: see `flipped` and `wound`.  ValueError for bad input, for
    handles that no net passes through and for nets that collapse.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    K = factor_k(theta, theta0)
    Q, count = _check_mesh(Q)
    held, places = read_handles(handles, count)
    rims = read_loops(boundary, Q, count)
    start = None if start is None else points(start, "start", count)
    _check_enough(held, rims, start, smooth)
    centre, size = _frame(places, *(curve for _, curve in rims), start)
    places = (places - centre) / size
    rims = [(loop, (curve - centre) / size) for loop, curve in rims]
    start = None if start is None else (start - centre) / size
    alone = not rims and len(held) > 1
    weight = 1.0 if alone else smooth * (count / 1000) ** POWER
    task = _Task(Q, K, held, places, weight)
    z = _first(task, rims, start)
    if rims:
        z = _glide(task, rims, z)
    return _report(task, rims, z, centre, size)


def factor_k(theta, theta0):
    """K = lam exp(i theta) = d2 / d1 of a planar net; ValueError for angles out of range.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    if np.ndim(theta) or np.ndim(theta0):
        raise ValueError("theta and theta0 are one number each")
    lam, _ = parallelogram.ratios(theta, theta0)
    return complex(lam * np.exp(1j * theta))


def equations(Q, K):
    """The sparse matrix A, complex (f, n), of v4 - v2 - K (v3 - v1): A z = 0 for every net.

    Its null space holds all nets on the mesh; n = Q.max() + 1.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    Q = mesh.check_quads(Q)
    row = np.tile(np.array([[[K, -1, -K, 1]]], dtype=complex), (len(Q), 1, 1))
    return sparse.rows(row, Q, Q.max() + 1)


# --- input --------------------------------------------------------------------------------


def _check_mesh(Q):
    Q = mesh.check_quads(Q)
    if not mesh.is_labelled(Q):
        raise ValueError("the faces do not agree on u and v: call mesh.label first")
    count = int(Q.max()) + 1
    parts, _ = connected_components(_graph(Q, count), directed=False)
    if parts > 1:
        unused = np.setdiff1d(np.arange(count), Q)
        if unused.size:
            raise ValueError(f"vertex {unused[0]} belongs to no face")
        raise ValueError(f"the mesh has {parts} separate parts: give them one by one")
    return Q, count


def _check_enough(held, loops, start, smooth):
    if not (np.isfinite(smooth) and smooth >= 0):
        raise ValueError(f"smooth = {smooth}: a number >= 0 is wanted")
    if len(held) < 2 and not loops and start is None:
        raise ValueError(
            f"{len(held)} handles do not fix size and position: two of them, a boundary or a "
            "start is wanted"
        )
    if smooth == 0 and (loops or len(held) > 1):
        raise ValueError("smooth = 0: only the net closest to a start is fixed without it")


def _frame(*points):
    """Centre and size of all the points given, so that the numbers inside are about 1."""
    every = np.concatenate([z for z in points if z is not None])
    centre = every.mean()
    size = np.abs(every - centre).max()
    if not size > 1e-12 * np.abs(every).max():
        raise ValueError("all the points given coincide: the net would collapse")
    return centre, size


# --- the linear problem -------------------------------------------------------------------


class _Task:
    """What stays the same while the boundary glides; x are real coordinates, two a vertex."""

    def __init__(self, Q, K, held, places, smooth):
        self.Q, self.K, self.held, self.places = Q, K, held, places
        A = equations(Q, K)
        self.count = A.shape[1]
        self.A = csr_array(
            kron(A.real, np.eye(2), "csr") + kron(A.imag, np.array([[0, -1], [1, 0]]), "csr")
        )
        self.fairness = smooth * kron(_fairness(Q, self.count), np.eye(2), format="csr")
        self.penalty = PENALTY * (self.A.T @ self.A)
        self.free = np.setdiff1d(np.arange(self.count), held)
        self.factor = sparse.Factor(_layout(Q, self.count)[self.free])

    def solve(self, weights, targets):
        """The net that minimises smoothness + sum (z - target)^T W (z - target).

        weights (n, 2, 2), targets complex (n,).  Multipliers are improved, by solving with
        the same factors, as long as the equations profit.
        """
        blocks = weights, np.arange(self.count), np.arange(self.count + 1)
        energy = self.fairness + csr_array(bsr_array(blocks))
        slope = np.einsum("nij,nj->ni", weights, _pairs(targets)).ravel()
        z = np.zeros(self.count, dtype=complex)
        z[self.held] = self.places
        if not len(self.free):
            return z
        x, free = _pairs(z).ravel(), (2 * self.free[:, None] + np.arange(2)).ravel()
        inverse = self.factor((energy + self.penalty).tocsr()[free][:, free])
        force, before = np.zeros(self.A.shape[0]), np.inf
        for step in range(STEPS):
            pull = self.A.T @ (force + PENALTY * (self.A @ x))
            x[free] -= inverse((energy @ x - slope + pull)[free])
            residual = self.A @ x
            force += PENALTY * residual
            if step > 2 and not np.abs(residual).max() < before / 2:
                break
            before = np.abs(residual).max()
        return x[::2] + 1j * x[1::2]


def _fairness(Q, count):
    """Squared second differences along the polylines, and the twist of the faces: (n, n)."""
    triples = mesh.triples(Q)
    along = sparse.rows(np.tile([[[1.0, -2.0, 1.0]]], (len(triples), 1, 1)), triples, count)
    twist = sparse.rows(np.tile([[[1.0, -1.0, 1.0, -1.0]]], (len(Q), 1, 1)), Q, count)
    return along.T @ along + 2 * (twist.T @ twist)


def _layout(Q, count):
    """Places of the vertices for the ordering: the longest boundary on a circle (Tutte)."""
    graph = _graph(Q, count)
    graph = graph.maximum(graph.T)
    rim = max(mesh.boundary_loops(Q), key=len, default=np.arange(3))
    z = np.zeros(count, dtype=complex)
    z[rim] = np.exp(2j * np.pi * np.arange(len(rim)) / len(rim))
    inner = np.setdiff1d(np.arange(count), rim)
    if len(inner):
        laplacian = (diags_array(graph.sum(axis=1)) - graph).tocsr()[inner]
        inverse = sparse.factor(laplacian[:, inner].tocsr())
        z[inner] = [1, 1j] @ np.stack([inverse(x) for x in _pairs(-laplacian @ z).T.copy()])
    return _pairs(z)


def _graph(Q, count):
    ends = Q.ravel(), np.roll(Q, -1, axis=1).ravel()
    return coo_array((np.ones(Q.size), ends), shape=(count, count)).tocsr()


def _pairs(z):
    return np.stack([z.real, z.imag], axis=-1)


# --- start and boundary -------------------------------------------------------------------


def _first(task, loops, start):
    """The net before the boundary glides: from the handles, the start or an even spread."""
    weights, targets = np.zeros((task.count, 2, 2)), np.zeros(task.count, dtype=complex)
    enough = len(task.held) > 1
    if start is not None and (loops or not enough):
        weights[:], targets = np.eye(2), start
    elif not enough:
        for loop, curve in loops:
            weights[loop] = np.eye(2)
            targets[loop] = spread(curve, len(loop))
    return task.solve(weights, targets)


def _glide(task, loops, z):
    """Boundary vertices slide along their outlines: tangent lines at the closest points."""
    for _ in range(STEPS):
        weights, targets = np.zeros((task.count, 2, 2)), np.zeros(task.count, dtype=complex)
        for loop, curve in loops:
            targets[loop], tangent = closest(z[loop], curve)
            normal = _pairs(1j * tangent)
            weights[loop] = normal[:, :, None] * normal[:, None, :] + SLIDE * np.eye(2)
        moved, z = z, task.solve(weights, targets)
        if np.abs(z - moved).max() < 1e-7:
            break
    return z


# --- report -------------------------------------------------------------------------------


def _report(task, loops, z, centre, size):
    d1, d2 = z[task.Q[:, 2]] - z[task.Q[:, 0]], z[task.Q[:, 3]] - z[task.Q[:, 1]]
    off, long = np.abs(d2 - task.K * d1), np.abs(d1)
    freedom = task.count - len(task.Q)
    if not long.max() > 1e-10:
        raise ValueError("the net collapses to a point: no other fits this mesh and these angles")
    if off.max() > EXACT * long.mean():
        raise ValueError(
            f"no net with these angles passes through the {len(task.held)} handles: the equations "
            f"stay off by {off.max() / long.mean():.2g} of a diagonal; there are {freedom} complex "
            "freedoms, best spent on every second boundary vertex"
        )
    if long.min() <= 1e-9 * long.max():
        raise ValueError(f"the net collapses at face {np.argmin(long)}: ask for less")
    residual = float((off / long).max())
    apart = [np.abs(closest(z[loop], curve)[0] - z[loop]).max() for loop, curve in loops]
    distance = float(size * max(apart)) if loops else np.nan
    flipped, wound = faults(z, task.Q)
    z = centre + size * z
    z[task.held] = centre + size * task.places
    V = np.stack([z.real, z.imag, np.zeros(len(z))], axis=1)
    words = f"{freedom} complex freedoms, equations off by {residual:.1g}"
    words += f", boundary off by {distance:.3g}" if loops else ""
    if len(flipped) + len(wound):
        words += f"; {len(flipped)} faces cross themselves, {len(wound)} vertices are wound twice"
    return Planar(V, residual, freedom, distance, flipped, wound, words)


def faults(z, Q):
    """(flipped, wound) of a planar net: faces whose edges cross, vertices wound more than once.

    z: complex (n,), Q: (f, 4).  A face with two corners of negative angle crosses itself;
    the angles around an interior vertex add up to 2 pi unless the net covers it twice.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    corner = z[Q]
    angle = np.angle((np.roll(corner, 1, 1) - corner) / (np.roll(corner, -1, 1) - corner))
    around = np.bincount(Q.ravel(), (angle % (2 * np.pi)).ravel())
    around[np.concatenate([np.zeros(0, dtype=int), *mesh.boundary_loops(Q)])] = 0
    return np.flatnonzero((angle < 0).sum(axis=1) > 1), np.flatnonzero(around > 3 * np.pi)
