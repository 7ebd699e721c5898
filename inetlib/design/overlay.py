"""Sheared grids i u + j v over a flattened surface: the whole cells inside, lifted to space."""

from collections.abc import Callable
from typing import NamedTuple

import igl
import numpy as np
import shapely

from .. import mesh, parallelogram, ties
from ..repair import components
from . import opening

INSIDE = 1e-7  # of the size of the domain: points this close to it are inside, far above rounding
TINY = 1e-9  # of a cell: a part this small of it is none
TRIES = 30  # sizes that are tried for a wanted number of quads
CLOSE = 0.004  # of the wanted number: close enough
MANY = 5000  # quads: for more, a small layer tells how many cells the boundary cuts
MOST = 20_000_000  # grid points that are tried


class Layer(NamedTuple):
    """A net: V (n, 3) lifted, Q (f, 4), winding (k, l): a ring's period is k u + l v."""

    V: np.ndarray
    Q: np.ndarray
    winding: tuple
    u: complex
    v: complex
    ij: np.ndarray  # (n, 2) integers: in the plane, vertices lie at i u + j v

    def kept(self, Q: np.ndarray) -> "Layer":
        """The layer with the quads Q (f, 4) only, and their vertices."""
        used, Q = np.unique(Q, return_inverse=True)
        return self._replace(V=self.V[used], Q=Q.reshape(-1, 4), ij=self.ij[used])


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
        loops = opening.outlines(flat)[1] if flat.period is None else []
        self.openings = [shapely.make_valid(shapely.Polygon(self.plane[x, :2])) for x in loops]

    def lift(self, z: np.ndarray):
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

    def raised(self, z: np.ndarray) -> np.ndarray:
        """The points (k, 3) of the surface at z, which may be some periods off around a ring."""
        inside, points = self.lift(z)
        for turn in (1, -1, 2, -2, 3, -3) if self.flat.period else ():
            there, others = self.lift(z + turn * self.flat.period)
            points[there & ~inside], inside = others[there & ~inside], inside | there
        return points


def cover(
    domain: Domain,
    theta: float,
    theta0: float,
    count: int | None = None,
    size: float | None = None,
    direction: float = 0.0,
    ask: Callable = lambda: None,
) -> Layer:
    """The `Layer` of about `count` quads, or of edges of mean length `size`, over a `Domain`.

    direction: of the u-lines against the real axis, radians; ask() is called before every size
    that is tried, and may raise.  Over a ring size and direction change as little as it takes to
    close.  ValueError if not one whole quad fits inside."""
    lam, mu = parallelogram.ratios(theta, theta0)
    rho, turn = parallelogram.rho(lam, mu), np.exp(1j * direction)
    if size is None:
        layer = _counted(domain, turn, rho, count, ask)
    else:
        layer = _layer(domain, *_fit(domain, 2 * size / (1 + 1 / mu) * turn, rho))
    if layer is None:
        wanted = f"count = {count}" if size is None else f"size = {size:.6g}"
        raise ValueError(f"{wanted}: not one whole quad fits on the surface, ask for smaller ones")
    return layer


def _counted(domain, turn, rho, count, ask):
    """The layer whose number of quads is nearest to the wanted one; sizes go by trial."""
    edge, best, tried = _edge(domain, turn, rho, count), None, set()
    for _ in range(TRIES):
        ask()
        fit = _fit(domain, edge * turn, rho)
        if fit in tried:
            break  # the next grid that closes around a ring is not closer
        tried.add(fit)
        layer = _layer(domain, *fit)
        found = len(layer.Q) if layer else 0
        if layer and (not best or abs(found - count) < abs(len(best.Q) - count)):
            best = layer
        if abs(found - count) <= CLOSE * count:
            break
        edge *= np.clip(np.sqrt(found / count), 0.7, 1.4)
    return best


def _edge(domain, turn, rho, count):
    """The length |u| to try first; cells cut by the boundary grow with the root of the number."""
    if count > MANY:
        fit = _fit(domain, _edge(domain, turn, rho, count // 16) * turn, rho)
        layer, cells = _layer(domain, *fit), domain.area / (abs(fit[0]) ** 2 * rho.imag)
        cut = (cells - len(layer.Q)) / np.sqrt(cells) if layer else 0
        count = (cut + np.sqrt(cut**2 + 4 * count)) ** 2 / 4
    return np.sqrt(domain.area / (count * rho.imag))


def _fit(domain, u, rho):
    """(u, v, winding): the grid vector u, over a ring changed so that the period is k u + l v."""
    period = domain.flat.period
    if period is None:
        return complex(u), complex(u * rho), (0, 0)
    ratio = period / u
    along_v = int(ties.nearest_whole(ratio.imag / rho.imag))
    along_u = int(ties.nearest_whole(ratio.real - along_v * rho.real)) or int(not along_v)
    u = complex(period / (along_u + along_v * rho))
    return u, u * rho, (along_u, along_v)


def _layer(domain, u, v, winding):
    """The `Layer` of the grid u, v, or None if no whole quad is inside."""
    if 0 < sum(map(abs, winding)) < 3:
        return None  # too few quads around
    i, j = points(domain, u, v)
    inside, V = domain.lift(i * u + j * v)
    i, j, V = i[inside], j[inside], V[inside]
    key, first = np.unique(keys(*turned(domain, u, v, winding, i, j)), return_index=True)
    i, j, V = i[first], j[first], V[first]
    corners = [(i, j + 1), (i, j), (i + 1, j), (i + 1, j + 1)]
    corners = [keys(*turned(domain, u, v, winding, *corner)) for corner in corners]
    corners = np.stack(corners, axis=1)
    Q = np.searchsorted(key, corners)
    whole = (np.append(key, np.iinfo(np.int64).min)[Q] == corners).all(axis=1)
    centre, period = (i[whole] + 0.5) * u + (j[whole] + 0.5) * v, domain.flat.period or 0
    copies = [domain.lift(centre + copy)[0] for copy in {0, period, -period}]
    whole[whole] = np.any(copies, axis=0)
    for hole in domain.openings:
        near = np.flatnonzero(whole)[_near(i[whole], j[whole], u, v, hole)]
        whole[near] = ~_meet(cells(i[near], j[near], u, v), hole)
    if not whole.any():
        return None
    ij = np.stack(turned(domain, u, v, winding, i, j), axis=1)
    Q = Q[whole]
    layer = Layer(V, Q[largest_piece(Q)], winding, u, v, ij)
    return layer.kept(layer.Q) if len(layer.Q) else None


def cells(i: np.ndarray, j: np.ndarray, u: complex, v: complex) -> np.ndarray:
    """The cells (k,) of the grid from i u + j v to (i + 1) u + (j + 1) v, as polygons."""
    corners = np.stack([(i + a) * u + (j + b) * v for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))], 1)
    return shapely.polygons(np.stack([corners.real, corners.imag], axis=2))


def _near(i, j, u, v, hole):
    """Whether the cells from i, j on are close to the hole's box."""
    left, low, right, high = hole.bounds
    z, reach = i * u + j * v, abs(u) + abs(v)
    beside = np.maximum(left - z.real, z.real - right), np.maximum(low - z.imag, z.imag - high)
    return np.maximum(*beside) <= reach


def _meet(cells, hole):
    """Whether each of the cells has a part in common with the hole."""
    shapely.prepare(hole)
    found = shapely.intersects(hole, cells)
    area = shapely.area(shapely.intersection(cells[found], hole))
    found[found] = area > TINY * shapely.area(cells[found])
    return found


def points(domain: Domain, u: complex, v: complex) -> tuple[np.ndarray, np.ndarray]:
    """Integers i, j, each (k,), of all grid points less than a cell from a box of the domain."""
    z, area = domain.flat.z, np.imag(np.conj(u) * v)
    along = np.imag(z * np.conj(v)) / -area
    i = np.arange(*_few(np.floor(along.min()), np.ceil(along.max()) + 1))
    reach, first, last = abs(u) + abs(v), np.full(len(i), -np.inf), np.full(len(i), np.inf)
    for one, start, step in ((z.real, i * u.real, v.real), (z.imag, i * u.imag, v.imag)):
        if abs(step) > TINY * abs(v):  # where the line i u + j v enters the box, and leaves it
            ends = np.sort([(x - start) / step for x in (one.min() - reach, one.max() + reach)], 0)
            first, last = np.maximum(first, ends[0]), np.minimum(last, ends[1])
    first = np.ceil(first)
    counts = np.maximum(np.floor(last) - first + 1, 0)
    before = np.cumsum(counts) - counts
    j = np.arange(*_few(0, counts.sum())) + np.repeat(first - before, counts.astype(np.int64))
    return np.repeat(i, counts.astype(np.int64)).astype(np.int64), j.astype(np.int64)


def _few(low, high):
    """The same numbers; ValueError where there are too many between them."""
    if high - low > MOST:
        number = f"{high - low:.3g} grid points are too many"
        raise ValueError(f"{number}: ask for fewer quads, or less extreme angles")
    return low, high


def turned(
    domain: Domain, u: complex, v: complex, winding: tuple, i: np.ndarray, j: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Integers i, j of the same grid points, each (k,), within the first period of a ring."""
    if winding != (0, 0):
        turns = np.floor(np.real((i * u + j * v) / domain.flat.period) + 1e-9).astype(np.int64)
        i, j = i - turns * winding[0], j - turns * winding[1]
    return i, j


def keys(i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """One number (k,) for each of the grid points, in the order of i, then of j."""
    return (i << 32) + j


def largest_piece(Q: np.ndarray) -> np.ndarray:
    """Which quads (f,) are connected by edges to the most others; no two touch at a vertex only."""
    pairs, kept = mesh.pairs(Q), np.ones(len(Q), dtype=bool)
    while kept.any():
        inner = pairs[kept[pairs // 4].all(axis=1)]
        label = components(len(Q), *inner.T // 4)
        kept &= label == np.argmax(np.bincount(label[kept]))
        rim = np.repeat(kept, 4)
        rim[inner] = False
        twice = np.bincount(Q.ravel()[rim], minlength=Q.max() + 1) > 1  # on the boundary
        pinched = kept & twice[Q].any(axis=1)
        if not pinched.any():
            break
        kept &= ~pinched
    return kept
