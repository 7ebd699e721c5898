"""Triangle meshes V (n, 3), F (f, 3) to cover, and small quad meshes that are hard to label."""

import numpy as np
from scipy.sparse import coo_array, diags_array

from . import mesh
from .parallelogram import check_whole


def wavy_roof(n: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """A roof of 3 by 2 with waves, about n by 2 n / 3 squares of two triangles; n >= 2."""
    n = check_whole("n", n, 2)
    m = max(2, round(2 * n / 3))
    x, y = np.meshgrid(np.linspace(0, 3, n + 1), np.linspace(0, 2, m + 1), indexing="ij")
    z = 0.25 * np.sin(2.2 * x + 0.4) * np.cos(1.7 * y) + 0.08 * x * y
    return mesh.triangles(np.stack([x, y, z], axis=-1).reshape(-1, 3), mesh.grid_quads(n, m))


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
    """A cloth of n by n squares, a net of springs, that hangs from its corners, upside down."""
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


SURFACES = {"roof": wavy_roof, "saddle": saddle_with_hole, "shell": hanging_shell}


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
