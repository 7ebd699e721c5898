"""Which faces, edges and vertices of a quad mesh touch, as plain integer arrays.

A half-edge is the number 4 f + slot; it runs from corner `slot` of face f to the next one.

Paper: Sec. 2 (adjacency).
"""

from itertools import combinations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components


def check_quads(Q):
    """The faces as int64 (f, 4), or a ValueError that says why they are no quads.

    Paper: Sec. 4.1.
    """
    Q = np.asarray(Q)
    if Q.size > 0 and (Q.ndim != 2 or Q.shape[1] != 4):
        what = "triangles" if Q.ndim == 2 and Q.shape[1] == 3 else f"an array of shape {Q.shape}"
        raise ValueError(f"the faces are {what}: quads are wanted, one row of four vertices each")
    return check_faces(Q)


def check_faces(Q):
    """The faces, triangles (f, 3) or quads (f, 4), as int64, or a ValueError that says why not.

    Paper: Sec. 4.1.
    """
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
    """Pairs of half-edges on the same edge: (k, 2); ValueError for non-manifold edges.

    Paper: Sec. 2 (adjacency).
    """
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

    Paper: Sec. 2 (adjacency).
    """
    return opposites(check_quads(Q))


def opposites(F):
    """`twins` of checked faces of any kind, triangles (f, 3) or quads (f, 4): int64.

    Paper: Sec. 2 (adjacency).
    """
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
    """The faces across the four edges of each face, -1 at the boundary: (f, 4).

    Paper: Sec. 2 (adjacency).
    """
    twin = twins(Q)
    return np.where(twin >= 0, twin // 4, -1).reshape(-1, 4)


def boundary_loops(Q):
    """The boundary as a list of closed loops of vertex indices, the mesh on their left.

    Q: quads (f, 4) or triangles (f, 3).  The first vertex is not repeated.  A hole (a
    removed face) gives a loop of its own.

    Paper: Sec. 6.3 (boundary).
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

    Paper: Sec. 2 (adjacency).
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

    Paper: Sec. 2 (adjacency).
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

    Paper: Sec. 4.3 (curves).
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

    Paper: Sec. 6.3 (fairness).
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
