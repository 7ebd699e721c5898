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

from . import adjacency, linear, mesh, outline, parallelogram

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
    held, places = outline.handles(handles, count)
    loops = outline.loops(boundary, Q, count)
    start = None if start is None else outline.points(start, "start", count)
    _check_enough(held, loops, start, smooth)
    centre, size = _frame(places, *(curve for _, curve in loops), start)
    places = (places - centre) / size
    loops = [(loop, (curve - centre) / size) for loop, curve in loops]
    start = None if start is None else (start - centre) / size
    alone = not loops and len(held) > 1
    weight = 1.0 if alone else smooth * (count / 1000) ** POWER
    task = _Task(Q, K, held, places, weight)
    z = _first(task, loops, start)
    if loops:
        z = _glide(task, loops, z)
    return _report(task, loops, z, centre, size)


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
    Q = adjacency.check_quads(Q)
    row = np.tile(np.array([[[K, -1, -K, 1]]], dtype=complex), (len(Q), 1, 1))
    return linear.rows(row, Q, Q.max() + 1)


# --- input --------------------------------------------------------------------------------


def _check_mesh(Q):
    Q = adjacency.check_quads(Q)
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
        self.factor = linear.Factor(_layout(Q, self.count)[self.free])

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
    triples = adjacency.triples(Q)
    along = linear.rows(np.tile([[[1.0, -2.0, 1.0]]], (len(triples), 1, 1)), triples, count)
    twist = linear.rows(np.tile([[[1.0, -1.0, 1.0, -1.0]]], (len(Q), 1, 1)), Q, count)
    return along.T @ along + 2 * (twist.T @ twist)


def _layout(Q, count):
    """Places of the vertices for the ordering: the longest boundary on a circle (Tutte)."""
    graph = _graph(Q, count)
    graph = graph.maximum(graph.T)
    rim = max(adjacency.boundary_loops(Q), key=len, default=np.arange(3))
    z = np.zeros(count, dtype=complex)
    z[rim] = np.exp(2j * np.pi * np.arange(len(rim)) / len(rim))
    inner = np.setdiff1d(np.arange(count), rim)
    if len(inner):
        laplacian = (diags_array(graph.sum(axis=1)) - graph).tocsr()[inner]
        inverse = linear.factor(laplacian[:, inner].tocsr())
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
            targets[loop] = outline.spread(curve, len(loop))
    return task.solve(weights, targets)


def _glide(task, loops, z):
    """Boundary vertices slide along their outlines: tangent lines at the closest points."""
    for _ in range(STEPS):
        weights, targets = np.zeros((task.count, 2, 2)), np.zeros(task.count, dtype=complex)
        for loop, curve in loops:
            targets[loop], tangent = outline.closest(z[loop], curve)
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
    apart = [np.abs(outline.closest(z[loop], curve)[0] - z[loop]).max() for loop, curve in loops]
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
    around[np.concatenate([np.zeros(0, dtype=int), *adjacency.boundary_loops(Q)])] = 0
    return np.flatnonzero((angle < 0).sum(axis=1) > 1), np.flatnonzero(around > 3 * np.pi)
