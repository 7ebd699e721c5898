"""The one place where a surface is checked and repaired; each step returns what it did."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from . import mesh, ties

FLAT = 1e-8  # of the square of the longest side: an area this small is none
NEAR = 1e-6  # of the bounding box: vertices of a file closer than this are meant to be one
SAME = 1e-12  # of the bounding box: vertices closer than this are at one place


class Clean(NamedTuple):
    """A surface that can be covered: oriented, and every vertex used."""

    V: np.ndarray  # (n, 3)
    F: np.ndarray  # (f, 3)
    loops: list  # the boundary loops, one for a disk, two for a ring, more with more openings
    repairs: list  # what was done, sentences


def clean(V: np.ndarray, F: np.ndarray) -> Clean:
    """The triangles (f, 3) or quads (f, 4) F with vertices V (n, 3) as a `Clean` surface.

    Vertices at one place become one only where nothing else helps.  With openings, triangles
    are halved where an edge joins two vertices of one boundary loop.  ValueError, one sentence,
    for what no step can repair, and for all but disks with any number of openings."""
    given = mesh.triangles(V, F)
    try:
        V, F, said = _oriented(*given)
        loops = topology(F)
    except ValueError:
        V, F, said = _oriented(*given, SAME)
        loops = topology(F)
    if len(loops) > 1:
        V, F = _without_chords(V, F, loops)
    return Clean(V, F, loops, said)


def manifold(V: np.ndarray, F: Sequence, merge: bool = True) -> tuple:
    """Faces F of any sizes as an oriented manifold of triangles: (V, T (t, 3), sentences).

    With `merge`, vertices at one place become one where the surface stays a manifold and open,
    and a vertex inside an edge of its neighbour divides it.  ValueError, with vertices of V,
    for what no step can repair."""
    T = triangulate(V, F)
    F = F.tolist() if isinstance(F, np.ndarray) else F
    first = {
        "faces with more than three corners cut into triangles": sum(len(f) > 3 for f in F),
        "faces without three different corners dropped": sum(len(set(f)) < 3 for f in F),
    }
    said = _counted(first)
    for tolerance in (NEAR, SAME) if merge else ():
        try:
            W, G, more = _oriented(V, T, tolerance)
            if len(W) < len(np.unique(T)) and not mesh.boundary_loops(G) and _in_one_piece(T):
                raise ValueError("a cut would be closed")
            return W, G, said + more
        except ValueError as error:
            refused = _unmerged(error, V)
    V, T, more = _oriented(V, T)
    return V, T, [*said, refused, *more] if merge else said + more


def _unmerged(error, V):
    words = error.told(V, first=None) if isinstance(error, mesh.Fault) else error
    return f"duplicate vertices were not merged: {words}"


def _in_one_piece(F):
    used, corner = np.unique(F, return_inverse=True)
    return not components(len(used), *mesh.half_edges(corner.reshape(F.shape))).any()


def _oriented(V, T, tolerance=None):
    """(V, T, sentences): an oriented manifold, merged where there is a tolerance."""
    T, dropped = drop(T)
    merged = more = divided = 0
    if tolerance is not None:
        T, merged = merge(V, T, tolerance)
        T, more = drop(T)
        T, divided = divide(V, T, tolerance)
    if more and tolerance == NEAR:
        raise ValueError("the tolerance is too large for this mesh")
    T, turned = orient(T)
    normals(V, T)
    require_single_fans(V, T, mesh.opposites(T))
    used, T = np.unique(T, return_inverse=True)
    done = {
        "duplicate vertices merged": merged,
        "collapsed or double triangles dropped": dropped + more,
        "vertices inside an edge of a neighbour (T-junctions) joined to it": divided,
        "triangles turned round, so that all are oriented alike": turned,
        "vertices of no face left out": len(V) - merged - len(used),
    }
    return V[used], T.reshape(-1, 3), _counted(done)


def _counted(done):
    return [f"{what}: {count}" for what, count in done.items() if count]


def merge(V: np.ndarray, F: np.ndarray, tolerance: float) -> tuple:
    """(faces F with the first of the vertices at each place only, how many others went).

    tolerance: how far vertices at one place may be apart, in diagonals of the faces' box."""
    used, corner = np.unique(F, return_inverse=True)
    points, place = np.unique(V[used] + 0.0, axis=0, return_inverse=True)  # -0.0 is 0.0
    radius = tolerance * np.linalg.norm(np.ptp(points, axis=0))
    near = cKDTree(points).query_pairs(radius, output_type="ndarray")
    place = components(len(points), *near.T)[place.ravel()]
    _, first = np.unique(place, return_index=True)
    return used[first[place[corner]]].reshape(F.shape), len(used) - len(first)


def drop(T: np.ndarray) -> tuple:
    """(triangles with three different corners, each once; how many went); ValueError for none."""
    corners = np.sort(T, axis=1)
    good = np.diff(corners).all(axis=1)
    if not good.any():
        raise ValueError("no face has three different corners")
    _, first = np.unique(corners[good], axis=0, return_index=True)
    kept = np.flatnonzero(good)[np.sort(first)]
    return T[kept], len(T) - len(kept)


def divide(V: np.ndarray, T: np.ndarray, tolerance: float) -> tuple:
    """(triangles whose free edges end at all vertices of free edges on them, how many these are).

    tolerance: how close such a vertex is to the edge, as a part of the bounding box.
    """
    start, end = mesh.half_edges(T)
    edges = np.sort([start, end], axis=0)
    _, first, often = np.unique(edges, axis=1, return_index=True, return_counts=True)
    free = first[often == 1]
    points, count = np.unique(edges[:, free]), 0
    radius = tolerance * np.linalg.norm(np.ptp(V[np.unique(T)], axis=0))
    a, way = V[start[free]], V[end[free]] - V[start[free]]
    long = np.linalg.norm(way, axis=1)
    near = cKDTree(V[points]).query_ball_point(a + way / 2, long / 2) if len(free) else []
    inserted = {}
    for k, found in enumerate(near):
        found = points[found]
        along = (V[found] - a[k]) @ way[k] / long[k]
        off = np.linalg.norm(V[found] - a[k] - along[:, None] * way[k] / long[k], axis=1)
        on = (off <= radius) & (along > radius) & (along < long[k] - radius)
        if on.any():
            inserted[free[k]] = found[on][np.argsort(along[on])]
            count += on.sum()
    new, gone = [], sorted({half // 3 for half in inserted})
    for face in gone:
        corners = [[T[face, k], *inserted.get(3 * face + k, [])] for k in range(3)]
        polygon = np.concatenate(corners)
        new.append(_ears(V, polygon))
    return np.concatenate([np.delete(T, gone, axis=0), *new]), int(count)


def orient(T: np.ndarray) -> tuple:
    """(triangles oriented alike, how many were turned): the more frequent side of a piece wins.

    ValueError for edges of more than two triangles and for one-sided surfaces."""
    one, two = mesh.pairs(T).T
    clash = T.ravel()[one] == T.ravel()[two]
    turn, loop = mesh.two_colour(len(T), one // 3, two // 3, clash)
    if loop is not None:
        words = (
            "the surface is one-sided: see the loop of triangles that begin with the vertices {}, "
            "and cut it there"
        )
        raise mesh.Fault(words, T[loop, 0])
    piece = components(len(T), one // 3, two // 3)
    turn ^= (np.bincount(piece, turn) > np.bincount(piece) / 2)[piece]
    return np.where(turn[:, None], T[:, ::-1], T), int(turn.sum())


def normals(V: np.ndarray, T: np.ndarray) -> np.ndarray:
    """Unit normals (t, 3) of triangles; ValueError where one has no area."""
    sides = V[np.roll(T, -1, axis=1)] - V[T]
    normal = np.cross(sides[:, 0], -sides[:, 2])
    area = np.linalg.norm(normal, axis=1)
    flat = ~(area > FLAT * np.sum(sides**2, axis=2).max(axis=1))
    if flat.any():
        raise mesh.Fault(
            "the triangle {} has no area: remove it, or join its corners", T[np.argmax(flat)], V
        )
    return normal / area[:, None]


def require_single_fans(V: np.ndarray, T: np.ndarray, twin: np.ndarray) -> None:
    """ValueError where two fans of triangles share a vertex only; twin: `mesh.opposites(T)`."""
    _, first = np.unique(corner_fans(T, twin), return_index=True)
    pinched = np.flatnonzero(np.bincount(T.ravel()[first]) > 1)
    if pinched.size:
        words = "the faces at vertex {} form two fans: not a manifold, part them there"
        raise mesh.Fault(words, pinched[0], V)


def corner_fans(T: np.ndarray, twin: np.ndarray) -> np.ndarray:
    """The number (3 t,) of each corner's fan around its vertex; twin: -1 where the fans end."""
    after = np.roll(np.arange(T.size).reshape(-1, 3), -1, axis=1).ravel()
    half = np.flatnonzero(twin >= 0)
    return components(T.size, half, after[twin[half]])


def topology(T: np.ndarray) -> list:
    """The boundary loops of oriented triangles, longest first; ValueError if no open disk."""
    sizes = np.sort(np.bincount(_pieces(T)))[::-1]
    if len(sizes) > 1:
        some = ", ".join(map(str, sizes[:4])) + " ..." * (len(sizes) > 4)
        pieces = f"{len(sizes)} separate pieces (of {some} faces)"
        take = "--piece 1 or --largest of inet cover, repair.piece in Python"
        raise ValueError(f"the surface has {pieces}: cover them one by one ({take})")
    loops = mesh.boundary_loops(T)
    euler = len(np.unique(T)) - (T.size + sum(map(len, loops))) // 2 + len(T)
    handles = (2 - len(loops) - euler) // 2
    if handles or not loops:
        found = f"{'has' if loops else 'is closed: it has'} {len(loops)} boundary loops and"
        wanted = "cut it into pieces with a boundary and without handles"
        raise ValueError(f"the surface {found} {handles} handles: {wanted}")
    return sorted(loops, key=len, reverse=True)


def piece(V: np.ndarray, F: np.ndarray, number: int = 1) -> tuple[np.ndarray, np.ndarray, str]:
    """(V, triangles, a sentence) of one piece of a surface; number 1 is the largest by area.

    F: triangles (f, 3) or quads (f, 4).  ValueError for a number beyond that of the pieces."""
    V, T = mesh.triangles(V, F)
    label = _pieces(T)
    sides = V[np.roll(T, -1, axis=1)] - V[T]
    area = np.bincount(label, np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2)
    if not 1 <= number <= len(area):
        words = f"the surface has {len(area)} separate pieces: a number from 1 to {len(area)}"
        raise ValueError(f"piece {number}: {words} is wanted")
    order = np.argsort(ties.ranks(-area, ties.TIE * area.max()), kind="stable")
    chosen = order[number - 1]
    used, corner = np.unique(T[label == chosen], return_inverse=True)
    part = f"{100 * area[chosen] / area.sum():.2g} % of the area"
    said = f"piece {number} of {len(area)} is covered, {part}" if len(area) > 1 else ""
    return V[used], corner.reshape(-1, 3), said


def _pieces(T):
    """The number of each triangle's piece, connected by edges."""
    return components(len(T), *mesh.pairs(T).T // 3)


def _without_chords(V, T, loops):
    """(V, T), inner edges between vertices of one loop halved: the loop can become straight."""
    ends = np.stack(mesh.half_edges(T), axis=1)[mesh.pairs(T)[:, 0]]
    chords = np.concatenate([ends[np.isin(ends, loop).all(axis=1)] for loop in loops])
    for number, (a, b) in enumerate(chords, start=len(V)):
        both = (a == T).any(axis=1) & (b == T).any(axis=1)
        halves = [np.where(T[both] == end, number, T[both]) for end in (a, b)]
        T = np.concatenate([*halves, T[~both]])
    return np.concatenate([V, V[chords].mean(axis=1)]), T


def components(count: int, one: np.ndarray, two: np.ndarray) -> np.ndarray:
    """The number of the connected component of each of `count` nodes joined by edges one-two."""
    graph = coo_array((np.ones(len(one), dtype=np.int8), (one, two)), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def weld(V: np.ndarray, F: np.ndarray) -> tuple:
    """(V, F), equal points as one vertex, in the order of their first use; F of any shape."""
    _, first, place = np.unique(V[F.ravel()] + 0.0, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return V[F.ravel()[first[order]]], np.argsort(order)[place.ravel()].reshape(F.shape)


def without_repeats(F: Sequence) -> list:
    """The faces as lists, without corners that repeat the one before."""
    return [[k for k, one in zip(f, [f[-1], *f[:-1]], strict=True) if k != one] for f in F]


def welded(V: np.ndarray, Q: np.ndarray, polygons: Sequence = ()) -> tuple:
    """A net with one vertex at each place: (V, Q, polygons, sentences), as it was if nothing is.

    Duplicates stay where the quads would be no manifold, or a cut would be closed."""
    corners = np.concatenate([Q.ravel(), *polygons])
    joined, count = merge(V, corners, NEAR)
    if not count:
        return V, Q, polygons, []
    new = joined[: Q.size].reshape(Q.shape)
    try:
        mesh.check_quads(new)
        closed = 2 * len(mesh.pairs(new)) == Q.size
        if closed and _in_one_piece(Q):
            raise ValueError("a cut would be closed")
    except ValueError as error:
        return V, Q, polygons, [_unmerged(error, V)]
    used, joined = np.unique(joined, return_inverse=True)
    parts = np.split(joined, np.cumsum([Q.size, *map(len, polygons)])[:-1])
    left = [np.array(face) for face in without_repeats(parts[1:]) if len(face) > 2]
    said = _counted({"duplicate vertices merged": count})
    return V[used], parts[0].reshape(Q.shape), left, said


def triangulate(V: np.ndarray, F: Sequence) -> np.ndarray:
    """Triangles (t, 3) of faces F of any sizes, in their order, without corners said twice.

    Quads are cut along the shorter diagonal, polygons ear by ear: ValueError where none is left."""
    if isinstance(F, np.ndarray) and F.shape[1] in (3, 4) and np.diff(np.sort(F)).all():
        return mesh.triangles(V, F)[1]
    faces = without_repeats(F)
    sizes = np.array(list(map(len, faces)))
    parts, owner = [np.empty((0, 3), dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    for size in np.unique(sizes[sizes >= 3]):
        which = np.flatnonzero(sizes == size)
        group = np.array([faces[k] for k in which])
        if size == 4 and np.diff(np.sort(group)).all():
            group = mesh.triangles(V, group)[1]
        elif size > 3:
            group = np.concatenate([_ears(V, face) for face in group])
        parts.append(group)
        owner.append(np.repeat(which, size - 2))
    return np.concatenate(parts)[np.argsort(np.concatenate(owner), kind="stable")]


def _ears(V, face):
    """Triangles (k - 2, 3) of a face (k,), the shortest good cut first; no straight ears."""
    P = V[face]
    normal = np.cross(P - P[0], np.roll(P, -1, axis=0) - P[0]).sum(axis=0)
    normal /= np.linalg.norm(normal) or 1.0
    little = FLAT * np.sum(np.ptp(P, axis=0) ** 2)
    left, found = np.arange(len(P)), []
    while len(left) > 3:
        ears = np.stack([np.roll(left, 1), left, np.roll(left, -1)], axis=1)
        sides = P[np.roll(ears, -1, axis=1)] - P[ears]
        turned = np.cross(sides[:, 0], sides[:, 1]) @ normal > little
        inside = np.cross(sides[:, :, None], P[left] - P[ears][:, :, None]) @ normal >= -little
        own = (
            (P[left] == P[ears][:, :, None]).all(axis=3).any(axis=1)
        )  # corners, or bridges to them
        good = np.flatnonzero(turned & ~(inside.all(axis=1) & ~own).any(axis=1))
        if not good.size:
            raise mesh.Fault("the face {} has no area, or sides that cross: divide it", face, V)
        cuts = np.linalg.norm(P[ears[good, 2]] - P[ears[good, 0]], axis=1)
        k = good[ties.first_smallest(cuts)]
        found.append(ears[k])
        left = np.delete(left, k)
    return face[np.array([*found, left])]
