"""Making a triangle surface out of a mesh from a file, and saying what had to be done."""

import igl
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from . import mesh, ties
from .mesh import pairs, two_colour

FLAT = 1e-12  # of the bounding box: an area this small is none
NEAR = 1e-6  # of the bounding box: vertices closer than this are meant to be one


def clean(V, F, merge=True):
    """Triangles that form an oriented manifold: (V (n, 3), T (t, 3), sentences on the repairs).

    V: (n, 3); F: (f, k), or a list of faces of any sizes.  Polygons are cut into triangles;
    with `merge`, vertices at one place become one where the surface stays a manifold;
    collapsed and double triangles go; triangles are turned round where neighbours disagree
    (the more frequent side of each piece wins); unused vertices go.  ValueError for edges of
    more than two triangles, vertices where two fans meet, one-sided surfaces, triangles
    without area, and when nothing is left.  Vertex numbers count from 0.
    """
    T, said = triangulate(V, F), []
    if many := sum(len(face) > 3 for face in F):
        said.append(_count(many, "face with more than three corners", "cut into triangles"))
    T, dropped = _extended(T)
    dropped += sum(len(_once(face)) < 3 for face in F)
    lost = len(T) == 0
    for tolerance in (NEAR, 0.0, None) if merge and not lost else (None,):
        try:
            T, merged, more, turned = _manifold(V, T, tolerance)
            break
        except ValueError as error:
            reason = error
    else:
        raise reason
    if merge and tolerance is None and not lost:
        said.append(f"duplicate vertices were not merged: {reason}")
    for number, kind, done in (
        (merged, "duplicate vertex", "merged"),
        (dropped + more, "collapsed or double triangle", "dropped"),
        (turned, "triangle", "turned round, so that all are oriented alike"),
        (len(V) - merged - len(np.unique(T)), "unused vertex", "dropped"),
    ):
        said += [_count(number, kind, done)] if number else []
    used, T = np.unique(T, return_inverse=True)
    V, T = V[used], T.reshape(-1, 3)
    _refuse_flat(V, T)
    return V, T, said


def _count(number, kind, done):
    """`1 face was cut` or `2 faces were cut`."""
    for one, many in (("vertex", "vertices"), ("triangle", "triangles"), ("face", "faces")):
        if number != 1 and one in kind:
            return f"{number} {kind.replace(one, many)} were {done}"
    return f"{number} {kind} was {done}"


def _manifold(V, T, tolerance):
    """Triangles oriented alike, and how many vertices were merged, triangles dropped, turned."""
    dropped = merged = 0
    if tolerance is not None:
        same = same_place(V, T, tolerance)
        merged = len(np.unique(T)) - len(np.unique(same[T]))
        T, dropped = _extended(same[T])
        if tolerance and dropped:
            raise ValueError("the tolerance is too large for this mesh")
    if not len(T):
        raise ValueError("no face has three different corners")
    one, two = pairs(T).T
    differ = T.ravel()[one] == T.ravel()[two]
    turn, loop = two_colour(len(T), one // 3, two // 3, differ)
    if loop is not None:
        raise ValueError(f"the surface has only one side (see the triangles {loop[:6]} ...)")
    graph = coo_array((np.ones(len(one)), (one // 3, two // 3)), shape=(len(T),) * 2)
    pieces, piece = connected_components(graph, directed=False)
    share = np.bincount(piece, turn, pieces) / np.bincount(piece, minlength=pieces)
    turn = turn ^ (share > 0.5)[piece]
    T = np.where(turn[:, None], T[:, ::-1], T)
    pinched = np.intersect1d(np.flatnonzero(~igl.is_vertex_manifold(T)), T)
    if pinched.size:
        raise ValueError(
            f"the faces at vertex {pinched[0]}, near {_place(V[pinched[0]])}, form two fans: "
            "not a manifold"
        )
    return T, merged, dropped, int(turn.sum())


def _extended(T):
    """Triangles with three different corners, each once; and how many were dropped."""
    T = np.asarray(T, dtype=np.int64).reshape(-1, 3)
    good = (T[:, 0] != T[:, 1]) & (T[:, 1] != T[:, 2]) & (T[:, 2] != T[:, 0])
    _, first = np.unique(np.sort(T[good], axis=1), axis=0, return_index=True)
    kept = np.flatnonzero(good)[np.sort(first)]
    return T[kept], len(T) - len(kept)


def same_place(V, T, tolerance):
    """For each vertex the first one at its place, up to tolerance x the bounding box: (n,).

    V: (n, 3); T: the vertices that count, integers of any shape.
    """
    used = np.unique(T)
    radius = tolerance * np.linalg.norm(np.ptp(V[used], axis=0))
    if radius > 0:
        near = used[cKDTree(V[used]).query_pairs(radius, output_type="ndarray")]
        graph = coo_array((np.ones(len(near)), near.T), shape=(len(V),) * 2)
        _, place = connected_components(graph, directed=False)
    else:
        _, place = np.unique(V + 0.0, axis=0, return_inverse=True)  # -0.0 is 0.0
    place = place.ravel()
    _, first = np.unique(place, return_index=True)
    return first[place]


def _refuse_flat(V, T):
    a, b, c = np.moveaxis(V[T], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    longest = np.max([np.sum((p - q) ** 2, axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    flat = np.flatnonzero(~(area > 1e-12 * longest))
    if flat.size:
        raise ValueError(
            f"{_count(flat.size, 'triangle', 'found')} without area: the corners of one, near "
            f"{_place(a[flat[0]])}, lie on a line"
        )


def _place(point):
    return "(" + ", ".join(f"{x:.6g}" for x in point) + ")"


# --- polygons -----------------------------------------------------------------------------


def weld(V, F):
    """The mesh with equal points as one vertex, in the order of their first use: (V, F).

    V: (n, 3), F: integers of any shape.  Unused vertices go.
    """
    _, first, place = np.unique(V[F.ravel()] + 0.0, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return V[F.ravel()[first[order]]], rank[place.ravel()].reshape(F.shape)


def triangulate(V, F):
    """Triangles (t, 3) of faces of any sizes, in their order, without corners said twice.

    V: (n, 3), F: (f, k) or a list of faces.  Quads are cut along the shorter diagonal, larger
    polygons ear by ear.  ValueError where no ear is left: no area, or sides that cross.
    """
    if isinstance(F, np.ndarray) and F.shape[1] in (3, 4) and np.diff(np.sort(F)).all():
        return mesh.triangles(V, F)[1]
    faces = [_once(face) for face in F]
    sizes = np.array([len(face) for face in faces])
    parts = [np.empty((0, 3), dtype=np.int64)]
    owner = [np.empty(0, dtype=np.int64)]
    for size in np.unique(sizes[sizes >= 3]):
        which = np.flatnonzero(sizes == size)
        group = np.array([faces[k] for k in which], dtype=np.int64)
        if size == 4 and all(len(set(face)) == 4 for face in group.tolist()):
            group = mesh.triangles(V, group)[1]
        elif size > 3:
            group = np.concatenate(
                [face[_ears(V[face], k)] for k, face in zip(which, group, strict=True)]
            )
        parts.append(group)
        owner.append(np.repeat(which, size - 2))
    return np.concatenate(parts)[np.argsort(np.concatenate(owner), kind="stable")]


def _once(face):
    """The face without corners that repeat the one before."""
    face = [int(k) for k in face]
    return [k for k, before in zip(face, face[-1:] + face[:-1], strict=True) if k != before]


def _ears(P, number):
    """Triangles (k - 2, 3) of one polygon with corners P (k, 3): the shortest good cut first.

    Of equally short ones the first; three corners on a line are no ear.
    """
    normal = np.cross(P - P[0], np.roll(P, -1, axis=0) - P[0]).sum(axis=0)
    normal /= np.linalg.norm(normal) or 1.0
    left, found = list(range(len(P))), []
    while len(left) > 3:
        cuts = []
        for k, middle in enumerate(left):
            ear = left[k - 1], middle, left[(k + 1) % len(left)]
            others = [c for c in left if c not in ear]
            if _is_ear(P, normal, ear, others):
                cuts.append((float(np.linalg.norm(P[ear[2]] - P[ear[0]])), k, ear))
        if not cuts:
            raise ValueError(f"face {number} has no area, or sides that cross")
        _, k, ear = cuts[ties.first_smallest([length for length, *_ in cuts])]
        found.append(ear)
        del left[k]
    return np.array([*found, left])


def _is_ear(P, normal, ear, others):
    """Whether the triangle is turned like the polygon, with none of the other corners in it."""
    sides = [(P[ear[k]], P[ear[(k + 1) % 3]]) for k in range(3)]
    little = FLAT * np.sum(np.ptp(P, axis=0) ** 2)
    if not np.cross(sides[0][1] - sides[0][0], sides[1][1] - sides[1][0]) @ normal > little:
        return False
    inside = [np.cross(b - a, P[others] - a) @ normal >= -little for a, b in sides]
    return not np.all(inside, axis=0).any()
