"""Quad meshes as plain arrays: V (n, 3) float64 and Q (f, 4) int64, counter-clockwise.

The corners of every quad are labelled from the top left, u running along i and v along j:

     v1 = (i, j+1) ------- v4 = (i+1, j+1)      edge slots 0: v1 v2 (a v-edge)
          |                     |                          1: v2 v3 (a u-edge)
       v  |     d1 = v3 - v1    |                          2: v3 v4 (a v-edge)
          |     d2 = v4 - v2    |                          3: v4 v1 (a u-edge)
     v2 = (i, j) --------- v3 = (i+1, j)
                    u

A quarter turn of the labels turns both ratios into their reciprocals, so a mesh is usable
only when all faces agree (`is_labelled`); a half turn changes nothing."""

from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from . import ties
from .parallelogram import check_whole


class Fault(ValueError):
    """What is wrong with a mesh at some of its vertices, in a sentence that has {} for where.

    >>> Fault("the edge {} belongs to more than two faces", [7, 2])
    Fault('the edge 7-2 belongs to more than two faces')"""

    def __init__(self, words: str, vertices: ArrayLike, V: np.ndarray | None = None):
        self.words, self.vertices, self.V = words, np.ravel(vertices), V
        super().__init__(self.told())

    def told(self, V: np.ndarray | None = None, first: int | None = 0) -> str:
        """The sentence: numbers from `first` on (None: without), and with V (n, 3) a point."""
        V, where = self.V if V is None else V, []
        if first is not None:
            some = "-".join(str(k + first) for k in self.vertices[:6])
            where.append(some + "-..." * (len(self.vertices) > 6))
        if V is not None:
            where.append(f"near {place(V[self.vertices[0]])}")
        return self.words.format(" ".join(where))


def place(point: np.ndarray) -> str:
    """A point in words."""
    return "(" + ", ".join(f"{x + 0.0:.6g}" for x in point) + ")"


def grid_quads(m: int, n: int) -> np.ndarray:
    """Quads (m n, 4) of a grid of (m+1)(n+1) vertices, vertex (i, j) numbered i (n+1) + j.

    >>> grid_quads(2, 1).tolist()
    [[1, 0, 2, 3], [3, 2, 4, 5]]"""
    m, n = check_whole("m", m), check_whole("n", n)
    i, j = np.meshgrid(np.arange(m), np.arange(n), indexing="ij")
    v2 = (i * (n + 1) + j).ravel()
    return np.stack([v2 + 1, v2, v2 + n + 1, v2 + n + 2], axis=1)


def polygon_rings(sides: int, rings: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A polygon with 3 or more corners of valence 4, surrounded by rings of nearly square quads.

    Returns (V, Q, polygon): vertices in the plane z = 0, quads, labelled for even `sides`, and
    the polygon's corners counter-clockwise.  Ring k has 2 sides k quads."""
    sides, rings = check_whole("sides", sides, 3), check_whole("rings", rings)
    size = rings + 1  # one sector is a size x size lattice, the polygon's corner at (0, 0)
    lattice = np.arange(size) + 0.5
    z = (lattice[:, None] + 1j * lattice[None, :]) ** (4 / sides)
    turns = np.exp(2j * np.pi * np.arange(sides) / sides)
    z = (turns[:, None, None] * z).ravel()
    index = np.arange(sides * size**2).reshape(sides, size, size)
    quads = []
    for s in range(sides):
        a, b = index[s], index[s - 1]
        corner = np.stack([a[:-1, 1:], a[:-1, :-1], a[1:, :-1], a[1:, 1:]], axis=-1)
        strip = np.stack([a[:-1, 0], b[0, :-1], b[0, 1:], a[1:, 0]], axis=-1)
        both = np.concatenate([corner.reshape(-1, 4), strip])
        quads.append(np.roll(both, s % 2, axis=1))  # u and v change places in each sector
    V = np.stack([z.real, z.imag, np.zeros(z.size)], axis=1)
    return V, np.concatenate(quads), index[:, 0, 0]


def check_faces(F: ArrayLike) -> np.ndarray:
    """The faces, triangles (f, 3) or quads (f, 4), as int64, or a ValueError that says why not."""
    F = np.asarray(F)
    if F.size == 0:
        raise ValueError("the mesh has no faces")
    if F.ndim != 2 or F.shape[1] not in (3, 4):
        raise ValueError(f"faces of shape {F.shape}: rows of three or four vertices are wanted")
    if not np.issubdtype(F.dtype, np.integer):
        raise ValueError(f"the faces are of type {F.dtype}: integers are wanted")
    if F.min() < 0:
        face = np.argmin(F.min(axis=1))
        raise ValueError(f"face {face} names vertex {F.min()}: counting starts at 0")
    repeated = np.any([a == b for a, b in combinations(F.T, 2)], axis=0)
    if repeated.any():
        raise Fault("the face {} uses a vertex twice", F[np.argmax(repeated)])
    return F.astype(np.int64, copy=False)


def check_quads(Q: ArrayLike) -> np.ndarray:
    """`check_faces` for quads only."""
    Q = check_faces(Q)
    if Q.shape[1] != 4:
        raise ValueError("the faces are triangles: quads are wanted, one row of four vertices each")
    return Q


def check_arrays(V: ArrayLike, Q: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """V as float64 and Q as int64; ValueError for shapes, indices, NaN and repeated corners."""
    Q = check_quads(Q)
    return _check_vertices(V, Q), Q


def check(V: ArrayLike, Q: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """`check_arrays`; ValueError for non-manifold and inconsistently oriented edges, too."""
    V, Q = check_arrays(V, Q)
    twins(Q)
    return V, Q


def _check_vertices(V, F):
    V = np.asarray(V)
    if V.ndim != 2 or V.shape[1] != 3 or V.dtype.kind not in "iuf":
        words = f"V has the shape {V.shape} and type {V.dtype}"
        raise ValueError(f"{words}: rows of three real coordinates are wanted")
    if F.max() >= len(V):
        face = np.argmax(F.max(axis=1))
        raise ValueError(f"face {face} names vertex {F.max()}: there are only {len(V)} vertices")
    finite = np.isfinite(V).all(axis=1)
    if not finite.all():
        raise Fault("vertex {} has a coordinate that is not a finite number", np.argmin(finite))
    return V.astype(np.float64, copy=False)


def half_edges(F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(start, end) of the half-edges: number 4 f + k (3 f + k) runs from F[f, k] to the next."""
    return F.ravel(), np.roll(F, -1, axis=1).ravel()


def pairs(F: np.ndarray) -> np.ndarray:
    """Pairs of half-edges on the same edge: (k, 2); ValueError for non-manifold edges."""
    start, end = half_edges(F)
    key = np.minimum(start, end) * (F.max() + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    same = key[order][1:] == key[order][:-1]
    three = np.flatnonzero(same[1:] & same[:-1])
    if three.size:
        h = order[three[0]]
        words = "the edge {} belongs to more than two faces: not a manifold, part them"
        raise Fault(words, [start[h], end[h]])
    first = np.flatnonzero(same)
    return np.stack([order[first], order[first + 1]], axis=1)


def twins(Q: ArrayLike) -> np.ndarray:
    """`opposites` of quads that are checked first: int64 (4 f,)."""
    return opposites(check_quads(Q))


def opposites(F: np.ndarray) -> np.ndarray:
    """The opposite half-edge of each half-edge, -1 on the boundary: int64, shape of F.ravel().

    ValueError for non-manifold edges and for neighbouring faces of opposite orientation."""
    one, two = pairs(F).T
    start, end = half_edges(F)
    clash = one[start[one] == start[two]]
    if clash.size:
        hint = ": see mesh.label" if F.shape[1] == 4 else ""
        words = "the faces at the edge {} are oriented against each other" + hint
        raise Fault(words, [start[clash[0]], end[clash[0]]])
    twin = np.full(F.size, -1)
    twin[one], twin[two] = two, one
    return twin


def face_neighbours(Q: ArrayLike) -> np.ndarray:
    """The faces across the four edges of each face, -1 at the boundary: (f, 4)."""
    return twins(Q).reshape(-1, 4) // 4


def boundary_loops(F: ArrayLike) -> list[np.ndarray]:
    """The boundary of quads or triangles as loops of vertices, the mesh on their left."""
    F = check_faces(F)
    start, end = np.array(half_edges(F))[:, opposites(F) < 0]
    touching = np.flatnonzero(np.bincount(start) > 1)
    if touching.size:
        raise Fault("two boundary loops touch at vertex {}: not a manifold", touching[0])
    following = dict(zip(start.tolist(), end.tolist(), strict=True))
    loops = []
    while following:
        loop = [next(iter(following))]
        while (after := following.pop(loop[-1])) != loop[0]:
            loop.append(after)
        loops.append(np.array(loop))
    return loops


def fans(Q: ArrayLike) -> dict[int, np.ndarray]:
    """The half-edges out of interior vertices, counter-clockwise: {valence: (k, valence)}."""
    twin = twins(Q)
    start, end = half_edges(np.asarray(Q))
    turn = np.roll(twin.reshape(-1, 4), 1, axis=1).ravel()
    vertex, leaving, valence = np.unique(start, return_index=True, return_counts=True)
    inner = ~np.isin(vertex, [start[twin < 0], end[twin < 0]])
    found = {}
    for k in np.unique(valence[inner]):
        fan = [leaving[inner & (valence == k)]]
        for _ in range(k - 1):
            fan.append(turn[fan[-1]])
            if (again := fan[-1] == fan[0]).any():
                at = start[fan[0][np.argmax(again)]]
                raise Fault("the faces at vertex {} form two fans: not a manifold", at)
        found[int(k)] = np.stack(fan, axis=1)
    return found


def crossings(Q: np.ndarray) -> np.ndarray:
    """The `fans` of valence 4 of a labelled mesh, beginning along a u-edge: (k, 4)."""
    require_labels(Q)
    fan = fans(Q).get(4, np.empty((0, 4), dtype=np.int64))
    first = np.argmax(fan % 2 == 1, axis=1)
    return np.take_along_axis(fan, (first[:, None] + np.arange(4)) % 4, axis=1)


def two_colour(count: int, a: np.ndarray, b: np.ndarray, differ: np.ndarray) -> tuple:
    """Booleans x with x[a] xor x[b] = differ, and None; or (None, a loop that forbids it).

    a, b (k,) of count nodes.  Solvable when the double cover i, i + count is disconnected."""
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


def is_labelled(Q: ArrayLike) -> bool:
    """Whether all faces agree on u and v; ValueError unless they are oriented alike."""
    twin = twins(Q)
    return not np.any((twin >= 0) & ((twin - np.arange(twin.size)) % 2 == 1))


def require_labels(Q: np.ndarray) -> None:
    """ValueError unless the faces agree on u and v."""
    if not is_labelled(Q):
        raise ValueError("the faces do not agree on u and v: call mesh.label first")


def label(Q: ArrayLike) -> np.ndarray:
    """The same faces, oriented alike and labelled alike; each component keeps its first face.

    ValueError names what forbids it: an odd interior vertex, a boundary loop with an odd sum of
    (valence - 1), or a loop of faces.  Paper: B9."""
    Q = check_quads(Q).copy()
    one, two = pairs(Q).T
    start = Q.ravel()
    swap, loop = two_colour(len(Q), one // 4, two // 4, start[one] == start[two])
    if loop is not None:
        words = "the mesh is not orientable: see the loop of faces that begin with the vertices {}"
        raise Fault(words, Q[loop, 0])
    Q[swap] = Q[swap][:, [0, 3, 2, 1]]
    twin = twins(Q)
    one = np.flatnonzero(twin >= 0)
    turn, loop = two_colour(len(Q), one // 4, twin[one] // 4, (one - twin[one]) % 2 == 1)
    if loop is not None:
        words, vertices = _obstruction(Q, loop)
        raise Fault("no consistent u/v labelling: " + words, vertices)
    Q[turn] = np.roll(Q[turn], 1, axis=1)
    return Q


def _obstruction(Q, loop):
    """Why no labelling exists, and where: a vertex, a boundary loop, or the given face loop."""
    faces = np.bincount(Q.ravel())
    loops = sorted(boundary_loops(Q), key=len)  # a hole says more than the outline
    inner = np.setdiff1d(np.flatnonzero(faces % 2 == 1), np.concatenate([[], *loops]))
    if inner.size:
        return f"interior vertex {{}} has the odd valence {faces[inner[0]]}", inner[0]
    for ring in loops:
        if (total := faces[ring].sum()) % 2:
            words = "the boundary loop through the vertices {} has an odd sum of (valence - 1)"
            return f"{words}, {total}", ring
    words = "u and v change places along the closed loop of faces that begin with the vertices {}"
    return words, Q[loop, 0]


class Families(NamedTuple):
    """Four families of curves: lists of vertex index arrays, closed ones repeat the first."""

    u: list
    v: list
    d1: list
    d2: list


def polylines(Q: ArrayLike, further: dict | None = None) -> Families:
    """The mesh curves along u-edges, v-edges, diagonals v1 v3 (Y_u) and diagonals v2 v4 (Y_v).

    further: more edges {"u": (k, 2), "v": (k, 2)}, of `design.Cover.edges`.
    Q labelled, else ValueError.  They end at boundary and singular vertices."""
    require_labels(Q)
    Q, further = check_quads(Q), further or {}
    none = np.empty((0, 2), dtype=np.int64)
    grid = [np.concatenate([e, further.get(k, none)]) for e, k in zip(_edges(Q), "uv", strict=True)]
    return Families(*(chains(edges) for edges in (*grid, Q[:, ::2], Q[:, 1::2])))


def _edges(Q):
    """The u-edges and the v-edges, each once and sorted: two arrays (k, 2)."""
    low, high = np.sort(half_edges(Q), axis=0).reshape(2, -1, 4)
    count = Q.max() + 1
    for slot in (1, 0):
        key = np.unique(low[:, slot::2] * count + high[:, slot::2])
        yield np.stack(np.divmod(key, count), axis=1)


def chains(edges: np.ndarray) -> list[np.ndarray]:
    """Curves along edges (k, 2), through vertices that two of them share; see `Families`."""
    ends = edges.tolist()
    left = set(range(len(ends)))
    at = {}
    for number, pair in enumerate(ends):
        for vertex in pair:
            at.setdefault(vertex, []).append(number)

    def walk(vertex, number):
        chain = [vertex]
        while number in left:
            left.remove(number)
            chain.append(sum(ends[number]) - chain[-1])  # the other end, then the other edge
            number = sum(at[chain[-1]]) - number if len(at[chain[-1]]) == 2 else None
        return np.array(chain)

    tips = [vertex for vertex in sorted(at) if len(at[vertex]) != 2]
    open_ones = [walk(tip, k) for tip in tips for k in at[tip] if k in left]
    return open_ones + [walk(a, k) for k, (a, _) in enumerate(ends) if k in left]


def triples(Q: ArrayLike) -> np.ndarray:
    """Neighbours (left, middle, right) on the u- and v-polylines of a labelled mesh: (k, 3)."""
    found = []
    for edges in _edges(check_quads(Q)):
        at, other = edges.T.ravel(), edges[:, ::-1].T.ravel()
        order = np.argsort(at, kind="stable")
        degree = np.bincount(at)
        first = (np.cumsum(degree) - degree)[degree == 2]
        found.append(np.stack([other[order[first]], at[order[first]], other[order[first + 1]]], 1))
    return np.concatenate(found)


def triangles(V: ArrayLike, F: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """The mesh as triangles: (V float64, T (t, 3) int64); a quad is cut along its shorter diagonal.

    Triangles stay.  Quad k becomes the rows 2 k and 2 k + 1; equal diagonals (see `ties`): v1 v3.
    Where only one diagonal lies inside, as in a dart, the quad is cut along that.
    """
    F = check_faces(F)
    V = _check_vertices(V, F)
    if F.shape[1] == 3:
        return V, F
    v1, v2, v3, v4 = V[F].transpose(1, 0, 2)
    d1, d2 = v3 - v1, v4 - v2
    normal = np.cross(d1, d2)
    first = ties.at_most(np.linalg.norm(d1, axis=1), np.linalg.norm(d2, axis=1))
    halves = ((v2 - v1, d1), (d1, v4 - v1)), ((v3 - v2, d2), (d2, v1 - v2))
    areas = [[np.sum(np.cross(*half) * normal, axis=1) for half in both] for both in halves]
    one, two = np.min(areas, axis=1) > 1e-9 * np.sum(normal**2, axis=1)  # lie inside
    first = np.where(one == two, first, one)
    corners = np.where(first[:, None], [0, 1, 2, 0, 2, 3], [0, 1, 3, 1, 2, 3])
    return V, np.take_along_axis(F, corners, axis=1).reshape(-1, 3)


class Checkerboard(NamedTuple):
    """A checkerboard pattern, by mid-edge subdivision."""

    V: np.ndarray  # (e, 3) midpoints of the edges
    black: np.ndarray  # (f, 4) parallelograms, corners on the edges v1 v2, v2 v3, v3 v4, v4 v1
    white: np.ndarray  # (w, 4) quads around interior vertices of valence 4
    others: list  # polygons around the other interior vertices


def checkerboard(V: ArrayLike, Q: ArrayLike) -> Checkerboard:
    """The pattern of a quad mesh.  Paper: Cor. 9, Cor. 15, Cor. 16, Cor. 17, Cor. 18."""
    V, Q = check_arrays(V, Q)
    twin, half = twins(Q), np.arange(Q.size)
    owner = np.where((twin >= 0) & (twin < half), twin, half)
    kept, edge = np.unique(owner, return_inverse=True)
    ends = np.stack(half_edges(Q), axis=1)[kept]
    around = fans(Q)
    white = edge[around.pop(4, np.empty((0, 4), dtype=np.int64))]
    others = [polygon for fan in around.values() for polygon in edge[fan]]
    return Checkerboard(V[ends].mean(axis=1), edge.reshape(-1, 4), white, others)


def diagonal_meshes(Q: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """The two diagonal meshes (Qa, Qb), on the vertices of a labelled mesh Q.

    The four neighbours of an interior vertex of valence 4 form a face, u along d1, v along d2.
    On a chessboard colouring, ValueError without one, Qa has the colour of vertex Q[0, 0]."""
    fan, Q = crossings(Q), check_quads(Q)
    start, end = half_edges(Q)
    colour, loop = two_colour(int(Q.max()) + 1, start, end, np.ones(start.size, dtype=bool))
    if loop is not None:
        raise ValueError(f"the vertices have no chessboard colouring: see the odd loop {loop}")
    tips = np.roll(end[fan], -1, axis=1)
    other = colour[start[fan[:, 0]]] != colour[Q[0, 0]]
    return tips[other], tips[~other]
