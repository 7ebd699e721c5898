"""A surface as somebody drew it: checked, repaired where that is safe, its topology named."""

from typing import NamedTuple

import igl
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from . import mesh, repair

SAME = 1e-12  # of the diagonal: vertices closer than this are one
FIT = {(1, 0): "a disk", (2, 0): "a ring"}  # (boundary loops, handles)


class Clean(NamedTuple):
    """A surface that can be covered: V (n, 3), triangles F (f, 3), oriented, and every vertex used.

    loops: the boundary loops, one for a disk, two for a ring; repairs: what was done, sentences.
    """

    V: np.ndarray
    F: np.ndarray
    loops: list
    repairs: list


def clean(V, F):
    """The triangles (f, 3) or quads (f, 4) F with vertices V (n, 3) as a `Clean` surface.

    Repaired, and said so in `repairs`: faces turned against their neighbours, duplicate
    vertices (where the mesh falls apart without merging them, or a triangle has two corners
    at one point, and is dropped), vertices of no face.
    ValueError, one sentence, for anything else that is no disk and no ring: broken arrays,
    edges of three faces, pinched vertices, faces without area, Moebius strips, several
    pieces, and other numbers of boundary loops and handles.  Triangles of a ring are halved
    where an edge joins two vertices of one boundary loop; the surface stays the same.
    """
    V, F = np.array(V, copy=True), mesh.check_faces(F)
    V, T = mesh.triangles(V, F)
    repairs = []
    F, dropped = _without_collapsed(V, F, T)
    if dropped:
        repairs.append(f"merged vertices and dropped {dropped} triangles that were lines")
    _refuse_flat(V, F)
    found, problem = _try(F)
    merged = _merged(V, F) if found is None else None
    if merged is not None:
        F, count = merged
        repairs.append(f"merged {count} duplicate vertices")
        found, problem = _try(F)
    if found is None:
        raise ValueError(problem)
    F, turned, loops = found
    if turned:
        repairs.append(f"turned {turned} faces that were oriented against the others")
    used, small = np.unique(F, return_inverse=True)
    small = small.reshape(F.shape)
    if not (merged or dropped) and len(used) < len(V):
        repairs.append(f"left out {len(V) - len(used)} vertices of no face")
    loops = [np.searchsorted(used, loop) for loop in loops]
    V, F = V[used], mesh.triangles(V[used], small)[1]
    if len(loops) > 1:
        V, F = _without_chords(V, F, loops)
    return Clean(np.ascontiguousarray(V), np.ascontiguousarray(F), loops, repairs)


def _without_collapsed(V, F, T):
    """(faces, how many dropped): without triangles two corners of which are one point.

    T: the faces as triangles.  Where there are any, all coinciding vertices become one.
    """
    near = SAME * np.linalg.norm(np.ptp(V, axis=0))
    two = [np.linalg.norm(V[T[:, k]] - V[T[:, k - 1]], axis=1) <= near for k in range(3)]
    merged = _merged(V, T, check=False) if np.any(two) else None
    if merged is None:
        return F, 0
    T = merged[0]
    kept = (np.roll(T, 1, axis=1) != T).all(axis=1)
    return mesh.check_faces(T[kept]), int(np.sum(~kept))


def _without_chords(V, F, loops):
    """The same surface, edges inside that join two vertices of one boundary loop halved.

    A boundary can then become a straight line, and no triangle with it.
    """
    one = mesh.pairs(F)[:, 0]
    ends = np.stack([F.ravel()[one], np.roll(F, -1, axis=1).ravel()[one]], axis=1)
    chords = [pair for loop in loops for pair in ends[np.isin(ends, loop).all(axis=1)].tolist()]
    for number, (a, b) in enumerate(chords, start=len(V)):
        at_a, at_b = np.isin(F, a), np.isin(F, b)
        both = at_a.any(axis=1) & at_b.any(axis=1)
        halves = [np.where(at, number, F)[both] for at in (at_a, at_b)]
        F = np.concatenate([*halves, F[~both]])
    middles = [(V[a] + V[b]) / 2 for a, b in chords]
    return np.concatenate([V, np.array(middles).reshape(-1, 3)]), F


def _refuse_flat(V, F):
    T = mesh.triangles(V, F)[1]
    a, b, c = np.moveaxis(V[T], 1, 0)
    longest = np.max([np.sum((p - q) ** 2, axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    flat = ~(np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12 * longest)
    if flat.any():
        face = np.argmax(flat) // (len(T) // len(F))
        raise ValueError(f"face {face} has no area: its corners {F[face].tolist()} are on a line")


def _try(F):
    """((oriented faces, how many were turned, loops), None), or (None, what is wrong)."""
    try:
        F, turned = _orient(F)
        return (F, turned, _topology(F)), None
    except ValueError as problem:
        return None, str(problem)


def _merged(V, F, check=True):
    """(F with coinciding vertices made one, their number), or None if there are none."""
    first = repair.same_place(V, np.arange(len(V)), SAME)
    count = len(V) - len(np.unique(first))
    if not count:
        return None
    F = first[F]
    return mesh.check_faces(F) if check else F, count


def _orient(F):
    """The faces oriented alike, the way most of them are, and how many were turned."""
    one, two = mesh.pairs(F).T
    start, sides = F.ravel(), F.shape[1]
    clash = start[one] == start[two]
    swap, loop = mesh.two_colour(len(F), one // sides, two // sides, clash)
    if loop is not None:
        raise ValueError(
            f"the surface is one-sided, like a Moebius strip: see the loop of {len(loop)} faces "
            f"from face {loop[0]}"
        )
    _one_piece(F, one // sides, two // sides)
    swap = ~swap if swap.mean() > 0.5 else swap
    return np.where(swap[:, None], F[:, ::-1], F), int(swap.sum())


def _one_piece(F, one, two):
    graph = coo_array((np.ones(len(one)), (one, two)), shape=(len(F), len(F)))
    pieces, label = connected_components(graph, directed=False)
    if pieces > 1:
        sizes = np.sort(np.bincount(label))[::-1][:4].tolist()
        raise ValueError(
            f"the surface has {pieces} separate pieces (of {', '.join(map(str, sizes))} "
            f"{'... ' if pieces > 4 else ''}faces): one is wanted, cover them one by one"
        )


def _topology(F):
    """The boundary loops of the oriented faces; ValueError if they are no disk and no ring."""
    triangles = F if F.shape[1] == 3 else np.concatenate([F[:, [0, 1, 2]], F[:, [0, 2, 3]]])
    pinched = np.intersect1d(np.flatnonzero(~igl.is_vertex_manifold(triangles)), F)
    if pinched.size:
        raise ValueError(
            f"two parts of the surface touch at vertex {pinched[0]} only: not a manifold"
        )
    loops = mesh.boundary_loops(F)
    edges = (F.size + sum(map(len, loops))) // 2
    handles = (2 - len(loops) - (len(np.unique(F)) - edges + len(F))) // 2
    if (len(loops), handles) not in FIT:
        raise ValueError(
            f"the surface {'is closed: it ' if not loops else ''}has {len(loops)} boundary loops "
            f"and {handles} handles; a disk (1 loop, no handle) or a ring (2 loops, no handle) "
            "is wanted: cut it open or into pieces"
        )
    return sorted(loops, key=len, reverse=True)
