"""Triangle meshes V (n, 3), F (f, 3) to cover, and small quad meshes that are hard to label."""

import numpy as np
import shapely
from scipy.sparse import coo_array, diags_array
from scipy.spatial import Delaunay

from . import mesh
from .parallelogram import check_whole


def wavy_roof(n: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """A roof of 3 by 2 with waves, about n by 2 n / 3 squares of two triangles; n >= 2."""
    n = check_whole("n", n, 2)
    m = max(2, round(2 * n / 3))
    x, y = np.meshgrid(np.linspace(0, 3, n + 1), np.linspace(0, 2, m + 1), indexing="ij")
    return mesh.triangles(
        np.stack([x, y, _waves(x, y)], axis=-1).reshape(-1, 3), mesh.grid_quads(n, m)
    )


def saddle_with_hole(n: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """The saddle z = 0.4 (x^2 - y^2) between the radii 0.35 and 1: a ring of n by 5 n squares."""
    n = check_whole("n", n, 2)
    radius = np.linspace(0.35, 1, n + 1)[:, None]
    angle = 2 * np.pi * np.arange(5 * n) / (5 * n)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    V = np.stack([x, y, 0.4 * (x**2 - y**2)], axis=-1).reshape(-1, 3)
    index = np.arange(len(V)).reshape(x.shape)
    return mesh.triangles(V, _cells(np.hstack([index, index[:, :1]])))


def hanging_shell(n: int = 30) -> tuple[np.ndarray, np.ndarray]:
    """A cloth that hangs from its corners, upside down: a net of springs, n by n squares."""
    from .solver import sparse  # slow to load

    n = check_whole("n", n, 2)
    Q = mesh.grid_quads(n, n)
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    V = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    graph = coo_array((np.ones(Q.size), mesh.half_edges(Q)), shape=(len(V), len(V))).tocsr()
    graph = graph + graph.T
    graph.data = np.where(graph.data == 1, n / 2, 1.0)  # an edge of one face, of two
    stiffness = (diags_array(graph.sum(axis=1)) - graph).tocsr()
    free = np.setdiff1d(np.arange(len(V)), [0, n, n * (n + 1), (n + 1) ** 2 - 1])
    right = ([0, 0, 5 / n**2] - stiffness @ V)[free]
    solve = sparse.factor(stiffness[free][:, free])
    V[free] += np.stack([solve(column) for column in right.T.copy()], axis=1)
    return mesh.triangles(V, Q)


def skylight(n: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """The wavy roof of 3 by 2 with a round opening, in triangles of sides of about 3 / n."""
    return _pierced(n, [_oval(n, 1.7, 1.1, 0.4, 0.4)], _waves)


def two_skylights(n: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """A barrel vault of 3 by 2 with a square opening and an oval one close to its edge."""

    def vault(x, y):
        return 0.5 * np.cos(1.1 * (y - 1)) + 0.03 * (x - 1.5) ** 2

    square = np.array([0.7 + 0.6j, 1.3 + 0.6j, 1.3 + 1.2j, 0.7 + 1.2j])
    return _pierced(n, [square, _oval(n, 2.2, 0.33, 0.35, 0.25)], vault)


def five_skylights(n: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """A dome over 3 by 2 with five openings: round, oval, and an L of six corners."""
    corner = np.array([0.4 + 0.4j, 1.1 + 0.4j, 1.1 + 0.7j, 0.7 + 0.7j, 0.7 + 1j, 0.4 + 1j])
    ovals = (
        (1.5, 1.35, 0.25, 0.25),
        (2.4, 0.5, 0.2, 0.3),
        (2.4, 1.4, 0.3, 0.2),
        (0.6, 1.6, 0.1, 0.1),
    )
    holes = [corner, *(_oval(n, *oval) for oval in ovals)]
    return _pierced(n, holes, lambda x, y: 0.2 * x * (3 - x) + 0.3 * y * (2 - y))


SURFACES = {
    "roof": wavy_roof,
    "saddle": saddle_with_hole,
    "shell": hanging_shell,
    "skylight": skylight,
    "two_skylights": two_skylights,
    "five_skylights": five_skylights,
}


def _waves(x, y):
    return 0.25 * np.sin(2.2 * x + 0.4) * np.cos(1.7 * y) + 0.08 * x * y


def _oval(n, x, y, a, b):
    """Corners of an ellipse in the plane, complex, n of them but at least eight."""
    n = check_whole("n", n, 2)
    around = 2 * np.pi * np.arange(max(n, 8)) / max(n, 8)
    return x + 1j * y + a * np.cos(around) + 1j * b * np.sin(around)


def _pierced(n, holes, height):
    """Triangles of the rectangle of 3 by 2 without holes (complex corners), lifted to a height."""
    step = 3 / check_whole("n", n, 2)
    outline = np.array([0, 3, 3 + 2j, 2j])
    rims = [_divided(rim, step) for rim in (outline, *holes)]
    inside = shapely.Polygon(_points(outline), [_points(hole) for hole in holes])
    x, y = np.mgrid[step : 3 : 0.87 * step, step:2:step]
    y[1::2] += step / 2
    inner = np.stack([x.ravel(), y.ravel()], axis=1)
    free = shapely.distance(inside.boundary, shapely.points(inner)) > 0.6 * step
    points = np.concatenate([_points(np.concatenate(rims)), inner[free]])
    F = Delaunay(points).simplices.astype(np.int64)
    a, b, c = (points[F] @ [1, 1j]).T
    area = np.imag(np.conj(b - a) * (c - a))
    F[area < 0] = F[area < 0, ::-1]
    F = F[shapely.contains_xy(inside, *points[F].mean(axis=1).T) & (np.abs(area) > 1e-3 * step**2)]
    used, F = np.unique(F, return_inverse=True)
    x, y = points[used].T
    return np.stack([x, y, height(x, y)], axis=1), F.reshape(-1, 3)


def _divided(rim, step):
    """The corners of a closed polygon, and points between them about a step apart."""
    sides = zip(rim, np.roll(rim, -1) - rim, strict=True)
    return np.concatenate(
        [a + way * np.linspace(0, 1, max(1, round(abs(way) / step)) + 1)[:-1] for a, way in sides]
    )


def _points(z):
    return np.stack([z.real, z.imag], axis=1)


def vertex(valence: int, rings: int) -> tuple[np.ndarray, np.ndarray]:
    """A vertex of any valence >= 3 in `rings` rings of quads: (V, Q), vertex 0 is the middle.

    V: z = 0, images of square lattices under z^(4/valence).  Q: oriented, not labelled.  Paper: B9.
    """
    valence, rings = check_whole("valence", valence, 3), check_whole("rings", rings)
    i, j = (x.ravel() for x in np.mgrid[1 : rings + 1, : rings + 1])  # the axis i = 0 is the next
    turns = np.exp(2j * np.pi * np.arange(valence) / valence)
    z = np.append(0, turns[:, None] * (i + 1j * j) ** (4 / valence))
    own = 1 + np.arange(valence * rings * (rings + 1)).reshape(valence, rings, rings + 1)
    axes = np.roll(own[:, :, 0], -1, axis=0)  # where j runs along
    Q = [_cells(np.vstack([np.append(0, axis), k])) for axis, k in zip(axes, own, strict=True)]
    V = np.stack([z.real, z.imag, np.zeros(z.size)], axis=1)
    return V / np.hypot(V[:, 0], V[:, 1]).max(), np.concatenate(Q)


def polar_cap(sides: int, rings: int) -> tuple[np.ndarray, np.ndarray]:
    """A polygon whose corners have valence 3, in `rings` rings of `sides` quads: (V, Q, polygon).

    u runs around, v inwards: labelled for any number of sides >= 3.  V: z = 0.  Paper: B9."""
    sides, rings = check_whole("sides", sides, 3), check_whole("rings", rings)
    around, step = 2 * np.pi / sides * np.arange(sides), min(2 * np.pi / sides, 0.5)
    z = np.exp(1j * around[:, None] + step * np.arange(-rings, 1))
    index = np.arange(z.size).reshape(z.shape)
    Q = _cells(np.vstack([index, index[:1]])[:, ::-1])  # v inwards is to the left of u
    V = np.stack([z.real.ravel(), z.imag.ravel(), np.zeros(z.size)], axis=1)
    return V, Q, index[:, 0]


def moebius_strip(length: int = 24, width: int = 3, reach: float = 0.45) -> tuple:
    """A strip of length x width quads around the unit circle, closed with half a twist: (V, Q).

    reach is half the width.  No orientation exists.  Paper: B9."""
    length, width = check_whole("length", length, 5), check_whole("width", width)
    angle = 2 * np.pi * np.arange(length)[:, None] / length
    across = reach * np.linspace(-1, 1, width + 1)
    x, z = 1 + across * np.cos(angle / 2), across * np.sin(angle / 2)
    V = np.stack([x * np.cos(angle), x * np.sin(angle), z], axis=-1)
    index = np.arange(z.size).reshape(z.shape)
    return V.reshape(-1, 3), _cells(np.vstack([index, index[:1, ::-1]]))


def _cells(index):
    """The quads of a rectangle of vertex numbers, i along u and j along v."""
    m, n = index.shape
    return index.ravel()[mesh.grid_quads(m - 1, n - 1)]


def seam(Q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(faces (f, 4), edges (k, 2)): Q with u and v named from face to face, and where they clash.

    The names start at face 0 and spread breadth first; the mesh can be labelled exactly when
    there is no edge across which they disagree.  Paper: B9."""
    Q = mesh.check_quads(Q).copy()
    start, end = np.array(mesh.half_edges(Q))
    across = {face: [] for face in range(len(Q))}
    for a, b in mesh.pairs(Q).tolist():
        across[a // 4].append((a, b))
        across[b // 4].append((b, a))
    names, queue, bad = {0: (False, False)}, [0], set()  # whether a face is mirrored and turned
    for face in queue:
        for a, b in across[face]:
            mirrored, turned = names[face]
            name = bool(mirrored ^ (start[a] == start[b])), bool(turned ^ ((a - b) % 2))
            if b // 4 not in names:
                names[b // 4] = name
                queue.append(b // 4)
            elif names[b // 4] != name:
                bad.add(tuple(sorted([int(start[a]), int(end[a])])))
    turned = [face for face in queue if names[face][1]]
    Q[turned] = np.roll(Q[turned], 1, axis=1)
    return Q, np.array(sorted(bad), dtype=np.int64).reshape(-1, 2)
