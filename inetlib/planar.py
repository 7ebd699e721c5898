"""Isogonal nets in the plane by linear algebra: they are discrete holomorphic functions.

In complex numbers both ratios and both angles of a face are one equation,
v4 - v2 = K (v3 - v1) with K = lam exp(i theta).  It is linear, so the nets on a mesh form a
vector space, from which `planar_net` picks the smoothest or the closest."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import bsr_array, coo_array, csr_array, diags_array, kron
from scipy.sparse.csgraph import connected_components

from . import measure, mesh, parallelogram, ties
from .solver import sparse

SAMPLES = 1000  # of an outline given as a function
PENALTY = 1e6  # of the equations; the multipliers make them exact
POWER = 1.5  # of the vertex count in the weight of smoothness: alike on fine meshes
STEPS = 30  # at most, of the multipliers and of the gliding boundary
EXACT = 1e-9  # residuals above this fraction of a diagonal mean: there is no such net
THIN = 1000  # the diagonals of a face differ by less than this factor
SLIDE = 0.01  # weight of the distance along the outline, beside 1 for that across it


class Planar(NamedTuple):
    """A planar net and what to know about it."""

    V: np.ndarray  # (n, 3) vertices, z = 0
    residual: float  # the largest |d2 - K d1| / |d1| of all faces
    freedom: int  # how many vertices may be chosen, in good places: vertices less faces
    distance: float  # the largest distance of a boundary vertex from its outline; nan without one
    flipped: np.ndarray  # faces whose edges cross
    wound: np.ndarray  # interior vertices around which the net winds more than once
    darts: int  # faces that are not convex, those whose edges cross too
    message: str  # all this in words


def planar_net(
    Q: np.ndarray,
    theta: float,
    theta0: float,
    handles: Sequence | None = None,
    boundary: object = None,
    start: np.ndarray | None = None,
    smooth: float = 0.01,
) -> Planar:
    """The smoothest isogonal net in the plane through given points, as a `Planar`.

    Q (f, 4): any consistently labelled connected mesh.  Points are complex numbers, (k, 2) or
    (k, 3) with z dropped.  At least one of these is wanted:

    handles   (vertex numbers, points): vertices held exactly, two or more (one with a start)
    boundary  a closed outline, points or a function on [0, 1]: the longest boundary loop
              glides along it as near as it can; or a list of (vertex numbers, outline)
    start     points of all vertices: the first guess for the boundary; the net is the one
              closest to it when there are neither a boundary nor two handles
    smooth    weight of the second differences beside squared distances to outline or start

    The equations hold to round-off.  Orientation is kept by them, but edges of a face may
    cross where too much is asked: see `faults`.  ValueError for bad input, for handles that no
    net passes through and for nets that collapse.  Paper: B7."""
    K = factor_k(theta, theta0)
    Q = _checked(Q)
    count = int(Q.max()) + 1
    held, places = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=complex)
    if handles is not None:
        if len(handles) != 2:
            raise ValueError(f"handles has {len(handles)} parts: (numbers, points) is wanted")
        held = _check_numbers(handles[0], "handles", count)
        places = _points(handles[1], "handles", len(held))
    rims = _read_outlines(boundary, Q, count)
    start = None if start is None else _points(start, "start", count)
    centre, size = _frame(places, rims, start, smooth)
    exact, places = places, (places - centre) / size
    rims = [(loop, (curve - centre) / size) for loop, curve in rims]
    start = None if start is None else (start - centre) / size
    alone = not rims and len(held) > 1
    solve = _solver(Q, K, held, places, 1.0 if alone else smooth * (count / 1000) ** POWER)
    z = _glide(solve, count, len(held) > 1, rims, start)
    residual = _check_net(z, Q, K, len(held))
    apart = [np.abs(closest(z[loop], curve)[0] - z[loop]).max() for loop, curve in rims]
    distance = float(size * max(apart, default=np.nan))
    flipped, wound = faults(z, Q)
    z = centre + size * z
    z[held] = exact
    V = np.stack([z.real, z.imag, np.zeros(count)], axis=1)
    words = f"{count - len(Q)} complex freedoms, equations off by {residual:.1g}"
    words += f", boundary off by {distance:.3g}" if rims else ""
    darts = len(measure.nonconvex(V, Q))
    if darts + len(wound):
        words += f"; {darts} faces are darts, {len(flipped)} of them cross themselves"
        words += f", {len(wound)} vertices are wound twice"
    return Planar(V, residual, count - len(Q), distance, flipped, wound, darts, words)


def factor_k(theta: float, theta0: float) -> complex:
    """K = lam exp(i theta) = d2 / d1 of a planar net.  Paper: B7."""
    if np.ndim(theta) or np.ndim(theta0):
        raise ValueError("theta and theta0 are one number each")
    lam, _ = parallelogram.ratios(theta, theta0)
    if not 1 / THIN < lam < THIN:
        words = f"lam = {lam:.3g}, and only 1/{THIN} to {THIN} can be told from zero here"
        raise ValueError(f"theta = {theta:.6g}, theta0 = {theta0:.6g}: {words}")
    return complex(lam * np.exp(1j * theta))


def equations(Q: ArrayLike, K: complex) -> csr_array:
    """The matrix A, complex (f, n), of v4 - v2 - K (v3 - v1): A z = 0 for every net.  Paper: B7."""
    Q = mesh.check_quads(Q)
    return _stencil([K, -1, -K, 1], Q, Q.max() + 1)


def _stencil(weights, index, count):
    """The sparse matrix with the same weights in each row, at the columns index (k, w)."""
    return sparse.rows(np.tile(np.array(weights), (len(index), 1, 1)), index, count)


def _checked(Q):
    """The faces, or a ValueError."""
    Q = mesh.check_quads(Q)
    mesh.require_labels(Q)
    unused = np.setdiff1d(np.arange(Q.max()), Q)
    if unused.size:
        raise ValueError(f"vertex {unused[0]} belongs to no face")
    parts, _ = connected_components(_graph(Q, Q.max() + 1), directed=False)
    if parts > 1:
        raise ValueError(f"the mesh has {parts} separate parts: give them one by one")
    return Q


def _points(given, name, count=None):
    """Points of the plane as complex (k,), or a ValueError that begins with the name."""
    given = np.asarray(given)
    if given.dtype.kind not in "iufc":
        raise ValueError(f"{name} is of type {given.dtype}: numbers are wanted")
    if given.ndim == 2 and given.shape[1] in (2, 3) and given.dtype.kind != "c":
        given = given[:, 0] + 1j * given[:, 1]
    given = np.atleast_1d(given).astype(complex)
    if given.ndim != 1:
        words = "complex numbers, or rows of two or three coordinates are wanted"
        raise ValueError(f"{name} has the shape {given.shape}: {words}")
    if count is not None and len(given) != count:
        raise ValueError(f"{name}: {count} points are wanted, not {len(given)}")
    if not np.isfinite(given).all():
        raise ValueError(f"{name}: point {np.argmin(np.isfinite(given))} is not finite")
    return given


def _check_numbers(numbers, name, count):
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


def _read_outlines(given, Q, count):
    """Outlines as a list of (vertex numbers, closed polyline), empty for None."""
    if given is None:
        return []
    if isinstance(given, list) and all(isinstance(x, tuple) and np.ndim(x[0]) == 1 for x in given):
        return [(_check_numbers(rim, "boundary", count), _closed(curve)) for rim, curve in given]
    found = mesh.boundary_loops(Q)
    if not found:
        raise ValueError("the mesh has no boundary to lay along an outline")
    return [(max(found, key=len), _closed(given))]


def _closed(given):
    """An outline, points or a function on [0, 1], without repeated points, counter-clockwise."""
    z = _points(given(np.arange(SAMPLES) / SAMPLES) if callable(given) else given, "boundary")
    z = z[z != np.roll(z, -1)]
    if len(z) < 3:
        raise ValueError(f"boundary has {len(z)} different points: at least three are wanted")
    return z if np.sum((np.conj(z) * np.roll(z, -1)).imag) > 0 else z[::-1]


def _frame(places, rims, start, smooth):
    """Centre and size of all the points given, or a ValueError if they are not enough.

    With these the numbers inside are about 1."""
    if not (np.isfinite(smooth) and smooth >= 0):
        raise ValueError(f"smooth = {smooth}: a number >= 0 is wanted")
    if len(places) < 2 and not rims and start is None:
        words = "do not fix size and position: two, a boundary or a start are wanted"
        raise ValueError(f"{len(places)} handles {words}")
    if smooth == 0 and (rims or len(places) > 1):
        raise ValueError("smooth = 0: only the net closest to a start is fixed without it")
    every = np.concatenate([places, *(curve for _, curve in rims), [] if start is None else start])
    centre = every.mean()
    size = np.abs(every - centre).max()
    if not size > 1e-12 * np.abs(every).max():
        raise ValueError("all the points given coincide: the net would collapse")
    return centre, size


def _solver(Q, K, held, places, smooth):
    """solve(W, targets), the net with the least smoothness + sum (z - target)^T W (z - target)."""
    A = equations(Q, K)  # complex; below there are two real coordinates a vertex
    count = A.shape[1]
    A = csr_array(kron(A.real, np.eye(2), "csr") + kron(A.imag, np.array([[0, -1], [1, 0]]), "csr"))
    along = _stencil([1.0, -2.0, 1.0], mesh.triples(Q), count)  # the polylines
    twist = _stencil([1.0, -1.0, 1.0, -1.0], Q, count)
    bends = along.T @ along + 2 * (twist.T @ twist)
    fairness = smooth * kron(bends, np.eye(2), format="csr")
    penalty = PENALTY * (A.T @ A)
    free = np.setdiff1d(np.arange(count), held)
    factor = sparse.Factor(_layout(Q, count)[free])
    free = (2 * free[:, None] + np.arange(2)).ravel()

    def solve(weights, targets):
        energy = fairness + csr_array(bsr_array((weights, np.arange(count), np.arange(count + 1))))
        slope = np.einsum("nij,nj->ni", weights, _pairs(targets)).ravel()
        z = np.zeros(count, dtype=complex)
        z[held] = places
        if not len(free):
            return z
        x = _pairs(z).ravel()
        inverse = factor((energy + penalty).tocsr()[free][:, free])
        force, before = np.zeros(A.shape[0]), np.inf
        for step in range(STEPS):  # multipliers, as long as the equations profit
            pull = A.T @ (force + PENALTY * (A @ x))
            x[free] -= inverse((energy @ x - slope + pull)[free])
            residual = A @ x
            force += PENALTY * residual
            if step > 2 and not np.abs(residual).max() < before / 2:
                break
            before = np.abs(residual).max()
        return x[::2] + 1j * x[1::2]

    return solve


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
    return coo_array((np.ones(Q.size), mesh.half_edges(Q)), shape=(count, count)).tocsr()


def _pairs(z):
    return np.stack([z.real, z.imag], axis=-1)


def _glide(solve, count, enough, rims, start):
    """The net whose rims slide along tangents of their outlines at the closest points."""
    weights, targets = np.zeros((count, 2, 2)), np.zeros(count, dtype=complex)
    if start is not None and (rims or not enough):  # where two handles are not enough
        weights[:], targets = np.eye(2), start
    elif not enough:
        for loop, curve in rims:
            ring = np.append(curve, curve[0])
            length = np.concatenate([[0], np.cumsum(np.abs(np.diff(ring)))])
            evenly = np.arange(len(loop)) / len(loop) * length[-1]
            weights[loop], targets[loop] = np.eye(2), np.interp(evenly, length, ring)
    z = solve(weights, targets)
    for _ in range(STEPS if rims else 0):
        weights, targets = np.zeros((count, 2, 2)), np.zeros(count, dtype=complex)
        for loop, curve in rims:
            targets[loop], tangent = closest(z[loop], curve)
            normal = _pairs(1j * tangent)
            weights[loop] = normal[:, :, None] * normal[:, None, :] + SLIDE * np.eye(2)
        before, z = z, solve(weights, targets)
        if np.abs(z - before).max() < 1e-7:
            break
    return z


def closest(z: np.ndarray, outline: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The points of a closed polyline closest to z, and its unit tangents there: complex (k,).

    At a corner the tangent is perpendicular to the way to z; of points equally close the one on
    the first side is taken.  Paper: B7."""
    step = np.roll(outline, -1) - outline
    size = np.abs(outline - outline[0]).max()
    part = np.clip(((z[:, None] - outline) / step).real, 0, 1)
    feet = outline + part * step
    away = np.abs(feet - z[:, None])
    least = away.min(axis=1, keepdims=True)
    first = np.argmax(ties.at_most(away, least + ties.TIE * size), axis=1)[:, None]
    around = np.abs(feet - np.take_along_axis(feet, first, axis=1)) < 1e-4 * size
    near = np.argmin(np.where(around, away, np.inf), axis=1)  # on this side, or the next one
    foot, part = feet[np.arange(len(z)), near], part[np.arange(len(z)), near]
    leaving = step[(near + (part > 1 - ties.TIE)) % len(step)]  # the side that leaves a corner
    beside = np.isin(part, (0, 1)) & (np.abs(z - foot) > ties.TIE * np.abs(step[near]))
    along = np.where(beside, 1j * (z - foot), leaving)
    return foot, along / np.abs(along)


def _check_net(z, Q, K, handles):
    """The largest |d2 - K d1| / |d1|; ValueError for nets that collapse or do not exist."""
    d1, d2 = z[Q[:, 2]] - z[Q[:, 0]], z[Q[:, 3]] - z[Q[:, 1]]
    off, long = np.abs(d2 - K * d1), np.abs(d1)
    if not long.max() > 1e-10:
        raise ValueError("the net collapses to a point: no other fits this mesh and these angles")
    if off.max() > EXACT * long.mean():
        far = f"{off.max() / long.mean():.2g} of a diagonal"
        spare = f"{len(z) - len(Q)} complex freedoms, best spent on every second boundary vertex"
        words = f"no net with these angles passes through the {handles} handles: off by {far}"
        raise ValueError(f"{words}; there are {spare}")
    if long.min() <= 1e-9 * long.max():
        raise ValueError(f"the net collapses at face {np.argmin(long)}: ask for less")
    return float((off / long).max())


def faults(z: np.ndarray, Q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(flipped, wound): faces whose edges cross, interior vertices wound more than once.

    z: complex (n,).  Such a face has two corners of negative angle, such a vertex more than
    2 pi of angles around it.  Paper: B7."""
    corner = z[Q]
    angle = np.angle((np.roll(corner, 1, 1) - corner) / (np.roll(corner, -1, 1) - corner))
    around = np.bincount(Q.ravel(), (angle % (2 * np.pi)).ravel())
    around[np.concatenate([np.zeros(0, dtype=int), *mesh.boundary_loops(Q)])] = 0
    return np.flatnonzero((angle < 0).sum(axis=1) > 1), np.flatnonzero(around > 3 * np.pi)
