"""Quad meshes as plain arrays: V (n, 3) float64 and Q (f, 4) int64, counter-clockwise.

The corners of every quad are labelled from the top left, u running along i and v along j:

     v1 = (i, j+1) ------- v4 = (i+1, j+1)      edge slots 0: v1 v2 (a v-edge)
          |                     |                          1: v2 v3 (a u-edge)
       v  |     d1 = v3 - v1    |                          2: v3 v4 (a v-edge)
          |     d2 = v4 - v2    |                          3: v4 v1 (a u-edge)
     v2 = (i, j) --------- v3 = (i+1, j)
                    u

A quarter turn of the labels turns both ratios into their reciprocals, so a mesh is usable
only when all faces agree (`is_labelled`); a half turn changes nothing.
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from . import ties


def check_quads(Q):
    """The faces as int64 (f, 4), or a ValueError that says why they are no quads."""
    Q = np.asarray(Q)
    if Q.size > 0 and (Q.ndim != 2 or Q.shape[1] != 4):
        what = "triangles" if Q.ndim == 2 and Q.shape[1] == 3 else f"an array of shape {Q.shape}"
        raise ValueError(f"the faces are {what}: quads are wanted, one row of four vertices each")
    return check_faces(Q)


def check_faces(Q):
    """The faces, triangles (f, 3) or quads (f, 4), as int64, or a ValueError that says why not."""
    Q = np.asarray(Q)
    if Q.size == 0:
        raise ValueError("the mesh has no faces")
    if Q.ndim != 2 or Q.shape[1] not in (3, 4):
        raise ValueError(
            f"the faces are an array of shape {Q.shape}: rows of three or four vertices are wanted"
        )
    if not np.issubdtype(Q.dtype, np.integer):
        raise ValueError(f"the faces are of type {Q.dtype}: integers are wanted")
    if Q.min() < 0:
        raise ValueError(
            f"face {np.argmin(Q.min(axis=1))} names vertex {Q.min()}: counting starts at 0"
        )
    repeated = np.any([a == b for a, b in combinations(Q.T, 2)], axis=0)
    if repeated.any():
        face = np.argmax(repeated)
        raise ValueError(f"face {face} uses a vertex twice: {Q[face].tolist()}")
    return Q.astype(np.int64, copy=False)


def pairs(Q):
    """Pairs of half-edges on the same edge: (k, 2); ValueError for non-manifold edges."""
    start, end = Q.ravel(), np.roll(Q, -1, axis=1).ravel()
    key = np.minimum(start, end) * (Q.max() + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    same = key[order][1:] == key[order][:-1]
    three = np.flatnonzero(same[1:] & same[:-1])
    if three.size:
        h = order[three[0]]
        raise ValueError(f"edge {start[h]}-{end[h]} belongs to more than two faces: not a manifold")
    first = np.flatnonzero(same)
    return np.stack([order[first], order[first + 1]], axis=1)


def twins(Q):
    """The opposite half-edge of each half-edge, -1 on the boundary: int64 (4 f,).

    Q: (f, 4).  Half-edge 4 f + k runs from Q[f, k] to Q[f, (k+1) % 4].  ValueError for
    non-manifold edges and for neighbouring faces of opposite orientation.
    """
    return opposites(check_quads(Q))


def opposites(F):
    """`twins` of checked faces of any kind, triangles (f, 3) or quads (f, 4): int64."""
    one, two = pairs(F).T
    start, sides = F.ravel(), F.shape[1]
    clash = np.flatnonzero(start[one] == start[two])
    if clash.size:
        faces = one[clash[0]] // sides, two[clash[0]] // sides
        raise ValueError(
            f"faces {faces[0]} and {faces[1]} are oriented against each other"
            + (": see mesh.label" if sides == 4 else "")
        )
    twin = np.full(F.size, -1)
    twin[one], twin[two] = two, one
    return twin


def face_neighbours(Q):
    """The faces across the four edges of each face, -1 at the boundary: (f, 4)."""
    twin = twins(Q)
    return np.where(twin >= 0, twin // 4, -1).reshape(-1, 4)


def boundary_loops(Q):
    """The boundary as a list of closed loops of vertex indices, the mesh on their left.

    Q: quads (f, 4) or triangles (f, 3).  The first vertex is not repeated.  A hole (a
    removed face) gives a loop of its own.
    """
    Q = check_faces(Q)
    half = np.flatnonzero(opposites(Q) < 0)
    start, end = Q.ravel()[half], np.roll(Q, -1, axis=1).ravel()[half]
    vertex, count = np.unique(start, return_counts=True)
    if (count > 1).any():
        raise ValueError(
            f"two boundary loops touch at vertex {vertex[count > 1][0]}: not a manifold"
        )
    following = dict(zip(start.tolist(), end.tolist(), strict=True))
    loops = []
    while following:
        loop = [next(iter(following))]
        while (after := following.pop(loop[-1])) != loop[0]:
            loop.append(after)
        loops.append(np.array(loop))
    return loops


def two_colour(count, a, b, differ):
    """Booleans x with x[a] xor x[b] = differ, and None; or (None, a loop that forbids it).

    count: how many nodes; a, b: node indices (k,); differ: booleans (k,).  Solvable exactly
    when the double cover with the nodes i and i + count is disconnected.
    """
    rows = np.concatenate([a, a + count])
    cols = np.concatenate([b + count * differ, b + count * ~differ])
    graph = coo_array((np.ones(rows.size, dtype=np.int8), (rows, cols)), shape=(2 * count,) * 2)
    _, cover = connected_components(graph, directed=False)
    stuck = np.flatnonzero(cover[:count] == cover[count:])
    if stuck.size:
        _, parent = breadth_first_order(graph.tocsr(), stuck[0], directed=False)
        path = [int(stuck[0] + count)]
        while path[-1] != stuck[0]:
            path.append(int(parent[path[-1]]))
        return None, [node % count for node in path[:-1]]
    return cover[:count] > cover[count:], None


def fans(Q):
    """The outgoing half-edges of interior vertices, counter-clockwise: {valence: (k, valence)}.

    Q: (f, 4).  ValueError where two surfaces share only a vertex.
    """
    twin = twins(Q)
    turn = twin[np.arange(twin.size).reshape(-1, 4)[:, [3, 0, 1, 2]].ravel()]
    valence = np.bincount(Q.ravel())
    inner = valence > 0
    inner[Q.ravel()[twin < 0]] = inner[np.roll(Q, -1, axis=1).ravel()[twin < 0]] = False
    start = np.full(valence.size, -1)
    start[Q.ravel()[::-1]] = np.arange(Q.size)[::-1]
    found = {}
    for k in np.unique(valence[inner]):
        fan = [start[np.flatnonzero(inner & (valence == k))]]
        for _ in range(k - 1):
            fan.append(turn[fan[-1]])
            if (again := fan[-1] == fan[0]).any():
                vertex = Q.ravel()[fan[0][np.argmax(again)]]
                raise ValueError(f"the faces at vertex {vertex} form two fans: not a manifold")
        found[int(k)] = np.stack(fan, axis=1)
    return found


def chains(edges):
    """Curves along the edges, passing through vertices that exactly two of the edges share.

    edges: (k, 2) vertex indices.  A list of index arrays; closed curves repeat the first.
    """
    degree = np.bincount(edges.ravel())
    at = {}
    for number, (a, b) in enumerate(edges.tolist()):
        at.setdefault(a, []).append(number)
        at.setdefault(b, []).append(number)
    left = np.ones(len(edges), dtype=bool)

    def walk(vertex, number):
        chain = [vertex]
        while number is not None:
            left[number] = False
            a, b = edges[number]
            chain.append(int(b if a == chain[-1] else a))
            onward = [k for k in at[chain[-1]] if left[k]] if degree[chain[-1]] == 2 else []
            number = onward[0] if onward else None
        return np.array(chain)

    ends = np.flatnonzero((degree > 0) & (degree != 2)).tolist()
    open_ones = [walk(end, k) for end in ends for k in at[end] if left[k]]
    return open_ones + [walk(int(a), k) for k, (a, _) in enumerate(edges) if left[k]]


def triples(Q):
    """Three neighbouring vertices (left, middle, right) along the mesh polylines: (k, 3).

    Q: (f, 4), consistently labelled.  Along u-edges and along v-edges, wherever exactly two
    edges of the family meet: not at singular vertices and not at the ends of polylines.
    """
    Q = check_quads(Q)
    v1, v2, v3, v4 = Q.T
    found = []
    for start, end in (((v2, v1), (v3, v4)), ((v2, v3), (v1, v4))):
        one, two = np.concatenate(start), np.concatenate(end)
        count = Q.max() + 1
        key = np.unique(np.minimum(one, two) * count + np.maximum(one, two))
        low, high = np.divmod(key, count)
        at, other = np.concatenate([low, high]), np.concatenate([high, low])
        order = np.argsort(at, kind="stable")
        degree = np.bincount(at)
        first = np.concatenate([[0], np.cumsum(degree)[:-1]])[degree == 2]
        left, right = other[order[first]], other[order[first + 1]]
        found.append(np.stack([left, at[order[first]], right], axis=1))
    return np.concatenate(found)


# --- Quad meshes as plain arrays: V (n, 3) float64 and Q (f, 4) int64, counter-clockwise. ---


class Checkerboard(NamedTuple):
    """A checkerboard pattern: V (e, 3) edge midpoints, black (f, 4), white (w, 4), others."""

    V: np.ndarray
    black: np.ndarray
    white: np.ndarray
    others: list


class Families(NamedTuple):
    """Four families of curves: lists of vertex index arrays, closed ones repeat the first."""

    u: list
    v: list
    d1: list
    d2: list


# --- building ---------------------------------------------------------------------------


def grid_quads(m, n):
    """Quads (m n, 4) of a grid of (m+1)(n+1) vertices, vertex (i, j) numbered i (n+1) + j.

    m, n: positive integers, the numbers of quads along u (i) and v (j); else ValueError.
    """
    m, n = check_counts(m, n)
    i, j = np.meshgrid(np.arange(m), np.arange(n), indexing="ij")
    v2 = (i * (n + 1) + j).ravel()
    return np.stack([v2 + 1, v2, v2 + n + 1, v2 + n + 2], axis=1)


def check_counts(m, n):
    """(m, n) as ints, or ValueError unless both are whole numbers from 1 upwards."""
    if not (m >= 1 and n >= 1):
        raise ValueError(f"m = {m}, n = {n}: a grid needs at least one quad each way")
    if int(m) != m or int(n) != n:
        raise ValueError(f"m = {m}, n = {n}: whole numbers of quads are wanted")
    return int(m), int(n)


def polygon_rings(sides, rings):
    """A polygon with `sides` corners of valence 4, surrounded by rings of quads.

    Returns (V, Q, polygon): vertices in the plane z = 0, quads and the polygon's corners
    counter-clockwise.  Ring k has 2 sides k quads.  The vertices lie on the image of square
    lattices under z^(4/sides), so the faces are nearly square.  For even `sides` the quads
    are labelled consistently; for odd ones no labelling exists (see `label`).
    """
    if sides < 3 or rings < 1:
        raise ValueError(f"sides = {sides}, rings = {rings}: needs sides >= 3 and rings >= 1")
    size = rings + 1  # one sector is a size x size lattice, the polygon's corner at (0, 0)
    lattice = np.arange(size) + 0.5
    z = (lattice[:, None] + 1j * lattice[None, :]) ** (4 / sides)
    turns = np.exp(2j * np.pi * np.arange(sides) / sides)
    z = (turns[:, None, None] * z).ravel()
    index = np.arange(sides * size**2).reshape(sides, size, size)
    before = np.roll(index, 1, axis=0)
    quads = []
    for s in range(sides):
        a, b = index[s], before[s]
        corner = np.stack([a[:-1, 1:], a[:-1, :-1], a[1:, :-1], a[1:, 1:]], axis=-1)
        strip = np.stack([a[:-1, 0], b[0, :-1], b[0, 1:], a[1:, 0]], axis=-1)
        both = np.concatenate([corner.reshape(-1, 4), strip])
        quads.append(np.roll(both, s % 2, axis=1))  # u and v change places in each sector
    V = np.stack([z.real, z.imag, np.zeros(z.size)], axis=1)
    return V, np.concatenate(quads), index[:, 0, 0]


# --- checking and adjacency -------------------------------------------------------------


def check(V, Q):
    """The mesh as float64 and int64 arrays, or a ValueError that says what is wrong with it.

    Checks shapes, indices, NaN, repeated corners, non-manifold and inconsistently oriented
    edges.  V: (n, 3), Q: (f, 4).
    """
    V, Q = check_arrays(V, Q)
    twins(Q)
    return V, Q


def check_arrays(V, Q):
    """The part of `check` that needs no adjacency: shapes, indices, NaN, repeated corners."""
    Q = check_quads(Q)
    return _check_vertices(V, Q), Q


def _check_vertices(V, F):
    V = np.asarray(V)
    if V.ndim != 2 or V.shape[1] != 3 or V.dtype.kind not in "iuf":
        raise ValueError(
            f"V has the shape {V.shape} and type {V.dtype}: "
            "one row of three real coordinates a vertex is wanted"
        )
    V = V.astype(np.float64, copy=False)
    if F.max() >= len(V):
        face = np.argmax(F.max(axis=1))
        raise ValueError(
            f"face {face} names vertex {F.max()}, but there are only {len(V)} vertices"
        )
    if not np.isfinite(V).all():
        bad = np.flatnonzero(~np.isfinite(V).all(axis=1))[0]
        raise ValueError(f"vertex {bad} has a coordinate that is not a finite number")
    return V


# --- labelling --------------------------------------------------------------------------


def is_labelled(Q):
    """Whether all faces agree on which edges run along u and which along v.

    Q: (f, 4), consistently oriented, else ValueError.
    """
    twin = twins(Q)
    inner = np.flatnonzero(twin >= 0)
    return bool(np.all((inner - twin[inner]) % 2 == 0))


def require_labels(Q):
    """ValueError unless the faces agree on u and v."""
    if not is_labelled(Q):
        raise ValueError("the faces do not agree on u and v: call mesh.label first")


def label(Q):
    """The same faces, oriented alike and labelled alike; each component keeps its first face.

    Q: (f, 4), a manifold with any orientation and labels.  ValueError names the vertex, the
    boundary loop or the loop of faces that forbids a labelling: an interior vertex of odd
    valence, a hole with an odd sum of (corner valence - 1), a twisted closed strip.

    Paper: Sec. 4.1 (labels; beyond the paper: B9).
    """
    Q = check_quads(Q).copy()
    one, two = pairs(Q).T
    start = Q.ravel()
    swap, loop = two_colour(len(Q), one // 4, two // 4, start[one] == start[two])
    if loop is not None:
        raise ValueError(f"the mesh is not orientable: see the loop of faces {loop}")
    Q[swap] = Q[swap][:, [0, 3, 2, 1]]
    twin = twins(Q)
    one = np.flatnonzero(twin >= 0)
    turn, loop = two_colour(len(Q), one // 4, twin[one] // 4, (one - twin[one]) % 2 == 1)
    if loop is not None:
        raise ValueError("no consistent u/v labelling: " + _obstruction(Q, loop))
    Q[turn] = np.roll(Q[turn], 1, axis=1)
    return Q


def _obstruction(Q, loop):
    """Why no labelling exists, in words: a vertex, a boundary loop, or the given face loop."""
    faces = np.bincount(Q.ravel())
    edge = np.zeros(faces.size, dtype=bool)
    loops = sorted(boundary_loops(Q), key=len)  # a hole says more than the outline
    for ring in loops:
        edge[ring] = True
    odd = np.flatnonzero(~edge & (faces % 2 == 1))
    if odd.size:
        return f"interior vertex {odd[0]} has the odd valence {faces[odd[0]]}"
    for ring in loops:
        if faces[ring].sum() % 2:
            total = faces[ring].sum()
            return (
                f"the boundary loop through the vertices {ring[:6].tolist()}"
                f"{' ...' if len(ring) > 6 else ''} has an odd sum of (valence - 1), {total}"
            )
    return f"u and v change places along the closed loop of faces {loop}"


# --- curves -----------------------------------------------------------------------------


def polylines(Q):
    """The four families of mesh curves: `Families(u, v, d1, d2)`.

    Q: (f, 4), consistently labelled, else ValueError.  Family u follows the u-edges (the
    discrete X_u, v = const), v the v-edges, d1 the diagonals v1 v3 (Y_u), d2 the diagonals
    v2 v4 (Y_v).  Curves end at the boundary and at singular vertices.

    Paper: Thm 8, Sec. 4.3 (4-web).
    """
    if not is_labelled(Q):
        raise ValueError("the faces do not agree on u and v: call mesh.label first")
    v1, v2, v3, v4 = np.asarray(Q).T
    u_edges = np.concatenate([np.stack([v2, v3], 1), np.stack([v1, v4], 1)])
    v_edges = np.concatenate([np.stack([v2, v1], 1), np.stack([v3, v4], 1)])
    families = [np.unique(np.sort(e, axis=1), axis=0) for e in (u_edges, v_edges)]
    families += [np.stack([v1, v3], 1), np.stack([v2, v4], 1)]
    return Families(*(chains(edges) for edges in families))


# --- derived meshes ---------------------------------------------------------------------


def triangles(V, F):
    """The mesh as triangles: (V float64, T (t, 3) int64); a quad is cut along its shorter diagonal.

    V: (n, 3); F: quads (f, 4), or triangles (f, 3), which stay; ValueError as in `check_arrays`.
    Quad k becomes the rows 2 k and 2 k + 1; diagonals of equal length (see `ties`): along v1 v3.
    """
    F = check_faces(F)
    V = _check_vertices(V, F)
    if F.shape[1] == 3:
        return V, F
    d1, d2 = (np.linalg.norm(V[F[:, k + 2]] - V[F[:, k]], axis=1) for k in (0, 1))
    corners = np.where(ties.at_most(d1, d2)[:, None], [0, 1, 2, 0, 2, 3], [0, 1, 3, 1, 2, 3])
    return V, np.take_along_axis(F, corners, axis=1).reshape(-1, 3)


def checkerboard(V, Q):
    """The checkerboard pattern of a quad mesh by mid-edge subdivision: `Checkerboard`.

    V: (n, 3), Q: (f, 4).  `black` (f, 4) are the inscribed parallelograms, corners on the
    edges v1 v2, v2 v3, v3 v4, v4 v1 in that order; `white` (w, 4) the quads around interior
    vertices of valence 4; `others` the polygons around the remaining interior vertices.

    Paper: Sec. 2, Cor. 9, Cor. 15, Cor. 16, Cor. 17, Cor. 18.
    """
    V, Q = check_arrays(V, Q)
    twin = twins(Q)
    half = np.arange(Q.size)
    owner = np.where((twin >= 0) & (twin < half), twin, half)
    kept, edge = np.unique(owner, return_inverse=True)
    ends = np.stack([Q.ravel(), np.roll(Q, -1, axis=1).ravel()], axis=1)[kept]
    around = fans(Q)
    white = edge[around.pop(4)] if 4 in around else np.empty((0, 4), dtype=np.int64)
    others = [polygon for fan in around.values() for polygon in edge[fan]]
    return Checkerboard(V[ends].mean(axis=1), edge.reshape(-1, 4), white, others)


def diagonal_meshes(Q):
    """The two diagonal meshes (Qa, Qb), on the vertices of Q.

    The vertices are coloured like a chessboard; around each interior vertex of valence 4 of
    one colour its four neighbours, of the other colour, form a face, whose edges are face
    diagonals of Q.  Qa has the corners that share the colour of vertex Q[0, 0].  The labels
    follow the diagonal parametrisation: u along d1, v along d2.  ValueError when the mesh
    has no such colouring.
    """
    if not is_labelled(Q):
        raise ValueError("the faces do not agree on u and v: call mesh.label first")
    Q = np.asarray(Q)
    start, end = Q.ravel(), np.roll(Q, -1, axis=1).ravel()
    colour, loop = two_colour(Q.max() + 1, start, end, np.ones(start.size, dtype=bool))
    if loop is not None:
        raise ValueError(f"the vertices have no chessboard colouring: see the odd loop {loop}")
    fan = fans(Q).get(4, np.empty((0, 4), dtype=np.int64))
    # Start where the outgoing edge is a u-edge that leaves v1 or v2, i.e. points along +u or -u:
    first = np.argmax(fan % 2 == 1, axis=1)
    fan = np.take_along_axis(fan, (first[:, None] + np.arange(4)) % 4, axis=1)
    tips = np.roll(end[fan], -1, axis=1)
    odd = colour[start[fan[:, 0]]] if len(fan) else np.zeros(0, dtype=bool)
    same = colour[Q[0, 0]]
    return tips[odd != same], tips[odd == same]
