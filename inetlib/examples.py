"""Surfaces to cover, as triangle meshes V (n, 3), F (f, 3): a roof, a saddle, a hanging shell."""

import numpy as np
from scipy.sparse import coo_array, diags_array

from . import mesh
from .solver import sparse


def wavy_roof(n=40):
    """A roof of 3 by 2 with waves, about n by 2 n / 3 squares of two triangles; n >= 2."""
    n, m = _at_least(n, 2), max(2, round(2 * n / 3))
    x, y = np.meshgrid(np.linspace(0, 3, n + 1), np.linspace(0, 2, m + 1), indexing="ij")
    z = 0.25 * np.sin(2.2 * x + 0.4) * np.cos(1.7 * y) + 0.08 * x * y
    return mesh.triangles(np.stack([x, y, z], axis=-1).reshape(-1, 3), mesh.grid_quads(n, m))


def saddle_with_hole(n=20):
    """The saddle z = 0.4 (x^2 - y^2) between the radii 0.35 and 1: a ring of n by 5 n squares."""
    n = _at_least(n, 2)
    radius = np.linspace(0.35, 1, n + 1)[:, None]
    angle = 2 * np.pi * np.arange(5 * n)[None, :] / (5 * n)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    V = np.stack([x, y, 0.4 * (x**2 - y**2)], axis=-1).reshape(-1, 3)
    i, j = np.divmod(mesh.grid_quads(n, 5 * n), 5 * n + 1)
    return mesh.triangles(V, 5 * n * i + j % (5 * n))


def hanging_shell(n=30):
    """A square cloth that hangs from its four corners, turned upside down: n by n squares.

    The edges are springs of no length, those of the border four times as strong, all vertices
    have the same weight: equilibrium is one linear system.
    """
    n = _at_least(n, 2)
    Q = mesh.grid_quads(n, n)
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    V = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    pairs = np.sort(np.stack([Q.ravel(), np.roll(Q, -1, axis=1).ravel()], axis=1), axis=1)
    pairs, faces = np.unique(pairs, axis=0, return_counts=True)
    strength = np.where(faces == 1, 4.0 * n / 8, 1.0)
    graph = coo_array((strength, tuple(pairs.T)), shape=(len(V), len(V))).tocsr()
    graph = graph + graph.T
    stiffness = (diags_array(graph.sum(axis=1)) - graph).tocsr()
    free = np.setdiff1d(np.arange(len(V)), [0, n, n * (n + 1), (n + 1) ** 2 - 1])
    load = np.zeros_like(V)
    load[:, 2] = 5 / n**2
    right = (load - stiffness @ V)[free]
    solve = sparse.factor(stiffness[free][:, free])
    V[free] += np.stack([solve(column) for column in right.T.copy()], axis=1)
    return mesh.triangles(V, Q)


SURFACES = {"roof": wavy_roof, "saddle": saddle_with_hole, "shell": hanging_shell}


def _at_least(n, low):
    if not (n >= low and int(n) == n):
        raise ValueError(f"n = {n}: a whole number of at least {low} is wanted")
    return int(n)


# --- Small meshes with one singular vertex, face or twist: which of them can be labelled? ---


def vertex(valence, rings):
    """A vertex of any valence >= 3 in `rings` rings of quads: (V, Q), vertex 0 is the middle.

    V: plane, z = 0, on the images of square lattices under z^(4/valence).  Q is oriented, but
    not labelled: see `mesh.label`, which refuses odd valences.

    Paper: Sec. 4.1 (labels; beyond the paper: B9).
    """
    _check("valence", valence, 3), _check("rings", rings, 1)
    i, j = (x.ravel() for x in np.mgrid[1 : rings + 1, : rings + 1])  # the axis i = 0 is the next
    z = (i + 1j * j) ** (4 / valence)
    turns = np.exp(2j * np.pi * np.arange(valence) / valence)
    z = np.append(0, (turns[:, None] * z).ravel())
    own = 1 + np.arange(valence * rings * (rings + 1)).reshape(valence, rings, rings + 1)
    quads = []
    for k in range(valence):
        axis = np.append(0, own[(k + 1) % valence, :, 0])  # where j runs along
        sector = np.vstack([axis, own[k]])
        quads.append(_cells(sector))
    V = np.stack([z.real, z.imag, np.zeros(z.size)], axis=1)
    return V / np.hypot(V[:, 0], V[:, 1]).max(), np.concatenate(quads)


def polar_cap(sides, rings):
    """A polygon whose corners have valence 3, in `rings` rings of `sides` quads: (V, Q, polygon).

    u runs around, v inwards: labelled for any number of sides >= 3.  V: plane, z = 0, the
    radii in a geometric series that makes the faces nearly square (from 12 sides on).

    Paper: Sec. 4.1 (labels; beyond the paper: B9).
    """
    _check("sides", sides, 3), _check("rings", rings, 1)
    around, step = 2 * np.pi / sides * np.arange(sides), min(2 * np.pi / sides, 0.5)
    z = np.exp(1j * around[:, None] + step * np.arange(-rings, 1))
    index = np.arange(z.size).reshape(z.shape)
    Q = _cells(np.vstack([index, index[:1]])[:, ::-1])  # v inwards is to the left of u
    V = np.stack([z.real.ravel(), z.imag.ravel(), np.zeros(z.size)], axis=1)
    return V, Q, index[:, 0]


def moebius_strip(length=24, width=3, reach=0.45):
    """A strip of length x width quads, closed with half a twist: (V, Q), `width` rows.

    The middle curve is the unit circle, reach is half the width.  The faces are oriented alike
    along the strip, but not across the seam: no orientation exists.

    Paper: Sec. 4.1 (labels; beyond the paper: B9).
    """
    _check("length", length, 5), _check("width", width, 1)
    angle = 2 * np.pi * np.arange(length)[:, None] / length
    across = reach * np.linspace(-1, 1, width + 1)
    radius = 1 + across * np.cos(angle / 2)
    V = np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), across * np.sin(angle / 2)], axis=-1
    )
    index = np.arange(length * (width + 1)).reshape(length, width + 1)
    return V.reshape(-1, 3), _cells(np.vstack([index, index[:1, ::-1]]))


def seam(Q):
    """Edges (k, 2) across which the names u and v, spread from face to face, do not agree.

    Q: (f, 4).  The names start at face 0 and spread breadth first.  Returns (faces, edges):
    the faces as labelled by this spreading (f, 4) and the edges of disagreement, none exactly
    when the mesh can be labelled.

    Paper: Sec. 4.1 (labels; beyond the paper: B9).
    """
    Q = mesh.check_quads(Q).copy()
    both = mesh.pairs(Q)
    across = {}
    for a, b in both.tolist():
        across.setdefault(a // 4, []).append((a, b))
        across.setdefault(b // 4, []).append((b, a))
    ends = np.stack([Q.ravel(), np.roll(Q, -1, axis=1).ravel()], axis=1)
    odd = np.arange(Q.size) % 2 == 1  # u-edges
    mirrored, turned = np.zeros(len(Q), dtype=bool), np.zeros(len(Q), dtype=bool)
    queue, seen, bad = [0], {0}, set()
    for face in queue:
        for a, b in across.get(face, ()):
            other = b // 4
            mirror = mirrored[face] ^ (ends[a, 0] == ends[b, 0])
            turn = turned[face] ^ odd[a] ^ odd[b]
            if other not in seen:
                seen.add(other), queue.append(other)
                mirrored[other], turned[other] = mirror, turn
            elif (mirrored[other], turned[other]) != (mirror, turn):
                bad.add(tuple(sorted(ends[a].tolist())))
    Q[turned] = np.roll(Q[turned], 1, axis=1)
    return Q, np.array(sorted(bad), dtype=np.int64).reshape(-1, 2)


def _cells(index):
    """The quads of a rectangle of vertex numbers, i along u and j along v."""
    corners = index[:-1, 1:], index[:-1, :-1], index[1:, :-1], index[1:, 1:]
    return np.stack(corners, axis=-1).reshape(-1, 4)


def _check(name, value, least):
    if not (value >= least and int(value) == value):
        raise ValueError(f"{name} = {value}: a whole number from {least} upwards is wanted")
