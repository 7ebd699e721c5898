"""Sheared grids laid over a flattened surface: the whole cells inside, lifted to the surface.

A grid point is z = i u + j v with integers i, j.  Over a ring two points are the same when
they differ by a multiple of the period, and the period must be a grid vector k u + l v.
"""

from typing import NamedTuple

import igl
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .. import mesh, parallelogram, ties

INSIDE = 1e-7  # of the size of the domain: points this close to it are inside, far above rounding
TRIES = 30  # sizes that are tried for a wanted number of quads
CLOSE = 0.004  # of the wanted number: close enough
MOST = 20_000_000  # grid points that are tried


class Layer(NamedTuple):
    """A net over a flattened surface: V (n, 3) lifted, Q (f, 4), edge of the grid.

    winding: (k, l) of the period of a ring, (0, 0) for a disk.
    """

    V: np.ndarray
    Q: np.ndarray
    edge: float
    winding: tuple


class Domain:
    """A flattened surface (see `flatten.Flat`) with vertices V in space, ready for searches."""

    def __init__(self, flat, V):
        self.flat, self.space = flat, V[flat.origin]
        self.plane = np.stack([flat.z.real, flat.z.imag, 0 * flat.z.real], axis=1)
        self.tree = igl.AABB()
        self.tree.init(self.plane, flat.F)
        a, b, c = flat.z[flat.F].T
        self.area = float(np.sum(np.imag(np.conj(b - a) * (c - a))) / 2)
        self.size = float(np.linalg.norm(np.ptp(self.plane, axis=0)))

    def lift(self, z):
        """(inside (k,) booleans, points (k, 3) on the surface) of points z of the plane."""
        points = np.stack([z.real, z.imag, 0 * z.real], axis=1)
        squares, face, _ = self.tree.squared_distance(self.plane, self.flat.F, points)
        a, b, c = self.flat.z[self.flat.F[face]].T
        area = np.imag(np.conj(b - a) * (c - a))
        second = np.imag(np.conj(z - a) * (c - a)) / area
        third = np.imag(np.conj(b - a) * (z - a)) / area
        weights = np.stack([1 - second - third, second, third], axis=1)
        inside = squares <= (INSIDE * self.size) ** 2
        return inside, np.einsum("kc,kcx->kx", weights, self.space[self.flat.F[face]])


def cover(domain, theta, theta0, count=None, size=None, direction=0.0):
    """The `Layer` of about `count` quads, or of edges of mean length `size`, over a `Domain`.

    direction: angle of the u-lines against the real axis of the flat surface, radians.  Over
    a ring edge and direction are those nearest to the wanted ones that close up around it.
    ValueError if not one whole quad fits inside.
    """
    lam, mu = parallelogram.ratios(theta, theta0)
    rho = parallelogram.rho(lam, mu)
    turn = np.exp(1j * direction)
    if size is not None:
        layer = _layer(domain, *_fit(domain, 2 * size / (1 + 1 / mu) * turn, rho))
    else:
        layer = _counted(domain, turn, rho, count)
    if layer is None:
        wanted = f"size = {size:.6g}" if size is not None else f"count = {count}"
        raise ValueError(f"{wanted}: not one whole quad of that size fits on the surface")
    return layer


def _counted(domain, turn, rho, count):
    """The layer whose number of quads is nearest to the wanted one; sizes go by trial."""
    edge, best, tried = np.sqrt(domain.area / (count * rho.imag)), None, set()
    for _ in range(TRIES):
        fit = _fit(domain, edge * turn, rho)
        if fit in tried:
            break  # the next grid that closes around a ring is not closer
        tried.add(fit)
        layer = _layer(domain, *fit)
        found = len(layer.Q) if layer else 0
        if layer and (best is None or abs(found - count) < abs(len(best.Q) - count)):
            best = layer
        if abs(found - count) <= CLOSE * count:
            break
        edge *= np.clip(np.sqrt(found / count), 0.7, 1.4)
    return best


def _fit(domain, u, rho):
    """(u, v, winding): the grid vector u, over a ring changed so that the period is k u + l v."""
    period = domain.flat.period
    if period is None:
        return complex(u), complex(u * rho), (0, 0)
    ratio = period / u
    along_v = int(ties.nearest_whole(ratio.imag / rho.imag))
    along_u = int(ties.nearest_whole(ratio.real - along_v * rho.real))
    along_u = along_u if along_u or along_v else 1
    u = complex(period / (along_u + along_v * rho))
    return u, u * rho, (along_u, along_v)


def _layer(domain, u, v, winding):
    """The `Layer` of the grid u, v, or None if no whole quad is inside."""
    if winding != (0, 0) and abs(winding[0]) + abs(winding[1]) < 3:
        return None  # too few quads around
    i, j = _points(domain, u, v)
    inside, V = domain.lift(i * u + j * v)
    i, j, V = i[inside], j[inside], V[inside]
    key, shift = _keys(domain, u, v, winding, i, j)
    key, first = np.unique(key, return_index=True)
    i, j, V = i[first], j[first], V[first]
    corners = [shift(i + a, j + b) for a, b in ((0, 1), (0, 0), (1, 0), (1, 1))]
    Q = np.searchsorted(key, np.stack(corners, axis=1)) if len(key) else np.zeros((0, 4), int)
    whole = (key[np.minimum(Q, len(key) - 1)] == np.stack(corners, axis=1)).all(axis=1)
    whole &= _reaches(domain, (i + 0.5) * u + (j + 0.5) * v)
    Q = _largest_piece(Q[whole])
    if not len(Q):
        return None
    used, Q = np.unique(Q, return_inverse=True)
    return Layer(V[used], Q.reshape(-1, 4), abs(u), winding)


def _points(domain, u, v):
    """Integers i, j of all grid points in a box around the domain, each (k,)."""
    z = domain.flat.z
    area = np.imag(np.conj(u) * v)
    ranges = []
    for x in (np.imag(z * np.conj(v)) / -area, np.imag(np.conj(u) * z) / area):
        ranges.append((np.floor(x.min()), np.ceil(x.max()) + 1))
    number = np.prod([high - low for low, high in ranges])
    if number > MOST:
        raise ValueError(f"{number:.3g} grid points are too many: ask for fewer or larger quads")
    i, j = np.meshgrid(*(np.arange(*pair, dtype=np.int64) for pair in ranges), indexing="ij")
    return i.ravel(), j.ravel()


def _keys(domain, u, v, winding, i, j):
    """(key (k,), function of (i, j)): one number for all grid points that are the same."""
    reach = 4 * int(max(np.abs(i).max(initial=1), np.abs(j).max(initial=1), *map(abs, winding))) + 9

    def key(i, j):
        if winding != (0, 0):
            turns = np.floor(np.real((i * u + j * v) / domain.flat.period) + 1e-9).astype(np.int64)
            i, j = i - turns * winding[0], j - turns * winding[1]
        return (i + reach) * (2 * reach + 1) + (j + reach)

    return key(i, j), key


def _reaches(domain, z):
    """Whether the points z are inside, or their copies around a ring."""
    period = domain.flat.period
    copies = (0,) if period is None else (0, period, -period)
    return np.any([domain.lift(z + shift)[0] for shift in copies], axis=0)


def _largest_piece(Q):
    """The quads connected by edges to the most others, no two of them touching at a vertex only."""
    while len(Q):
        one, two = mesh.pairs(Q).T // 4
        graph = coo_array((np.ones(len(one)), (one, two)), shape=(len(Q), len(Q)))
        label = connected_components(graph, directed=False)[1]
        Q = Q[label == np.argmax(np.bincount(label))]
        ends = Q.ravel()[mesh.twins(Q) < 0]  # a vertex twice on the boundary is pinched
        number, count = np.unique(ends, return_counts=True)
        pinched = np.isin(Q, number[count > 1]).any(axis=1)
        if not pinched.any():
            break
        Q = Q[~pinched]
    return Q
