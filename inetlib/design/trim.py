"""Panels between the whole quads of a net and the boundary of its surface, 3 to 6 corners each.

The curves of the grid are cut at the boundary of the flattened surface; there the corners of
the panels lie on the surface's own boundary edges, elsewhere on the surface."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import shapely

from .. import mesh, panels, ties
from ..reference import CORNER
from . import faces as cut
from . import overlay
from .faces import Face
from .regions import NEAR, coordinates, regions

ON = 1e-6  # of a cell: points this close to a line of the grid are on it


class Trimmed(NamedTuple):
    """A `Layer` and the cut panels around it."""

    layer: overlay.Layer  # without quads that are whole no longer
    extra: np.ndarray  # (m, 3) further vertices on the surface, numbered after the layer's
    polygons: list  # index arrays of the panels, counter-clockwise like the quads
    areas: np.ndarray  # of the panels in the plane, up to the boundary itself
    edges: dict  # {"u": (k, 2), "v": (k, 2)} on lines of the grid, between or inside panels

    @property
    def smallest(self) -> float:
        """The area of the smallest panel / that of a quad, in the plane; 1 without panels."""
        cell = abs(np.imag(np.conj(self.layer.u) * self.layer.v))
        return float(self.areas.min(initial=cell) / cell)


def trim(domain: overlay.Domain, layer: overlay.Layer, ask: Callable = lambda: None) -> Trimmed:
    """The `Trimmed` layer: whole quads and panels leave no gap, and overlap nowhere.

    ask() is called between the parts of the work.  ValueError where the boundary of the
    flattened surface crosses itself."""
    found = regions(domain, layer)
    ask()
    layer, faces, gone = cut.merged(found)
    ask()
    count = 1 + max(int(layer.Q.max()), *(int(face.ring.max()) for face in faces), 0)
    place = np.zeros(count, dtype=complex)
    for face in faces:
        place[face.ring] = face.z
    edge = np.sqrt(abs(np.imag(np.conj(layer.u) * layer.v)))
    points = np.unique(np.concatenate([np.zeros(0, int), *(face.ring for face in faces)]))
    turn, V = np.zeros(count), np.zeros((count, 3))
    turn[points], V[points] = _lifted(domain, found.outline, place[points])
    for side in gone:  # where curves end at the boundary inside a panel, it gets a corner, too
        turn[side.ring] = np.maximum(np.abs(turn[side.ring]), CORNER * (1 + ON))
    parts = cut.cornered(faces, layer.Q, turn, edge)
    ask()
    rings = [face.ring[corners] for face, corners in parts]
    used = np.unique(np.concatenate([np.zeros(0, int), *rings]))
    extra = np.setdiff1d(used, layer.Q)
    whole = np.unique(layer.Q)
    number = np.full(count, -1)
    number[whole], number[extra] = np.arange(len(whole)), len(whole) + np.arange(len(extra))
    areas = np.array([face.area for face, _ in parts])
    layer = layer.kept(layer.Q)
    drawn = [face for face in gone if (number[face.ring] >= 0).all()]
    drawn += [Face(face.ring[k], face.z[k]) for face, k in parts]
    edges = _edges(layer, [(number[face.ring], face.z) for face in drawn])
    return Trimmed(layer, V[extra], [number[ring] for ring in rings], areas, edges)


def uncrossed(
    V: np.ndarray, plain: np.ndarray, Q: np.ndarray, trimmed: Trimmed
) -> tuple[np.ndarray, np.ndarray, Trimmed]:
    """(V, Q, `Trimmed`) where no cut panel crosses itself since the net has moved to V (n, 3).

    A corner may have moved across the boundary beside it: it goes back to its place in plain
    (n, 3), and the quads Q (f, 4) around it are whole no longer, but cut panels."""
    while (bad := panels.crossed(V, trimmed.polygons)).size:
        far = np.linalg.norm(V - plain, axis=1)
        corners = [trimmed.polygons[k] for k in bad]
        moved = [x[ties.first_largest(far[x] / _near(plain[x]))] for x in corners]
        lost = np.isin(Q, moved).any(axis=1)
        if not lost.any() or lost.all():
            break
        V = V.copy()
        V[moved] = plain[moved]
        edges = {}
        for kind, at in (("u", [[1, 2], [3, 0]]), ("v", [[0, 1], [2, 3]])):
            known = np.sort(Q[~lost][:, at].reshape(-1, 2), axis=1)
            new = np.sort(Q[lost][:, at].reshape(-1, 2), axis=1)
            new = new[~(new[:, None] == known).all(axis=2).any(axis=1)]
            edges[kind] = np.unique(np.concatenate([trimmed.edges[kind], new]), axis=0)
        trimmed = trimmed._replace(polygons=[*trimmed.polygons, *Q[lost]], edges=edges)
        Q = Q[~lost]
    return V, Q, trimmed


def _near(P):
    """The distances (k,) of the corners of a polygon P (k, 3) from their next neighbours."""
    side = np.linalg.norm(np.roll(P, -1, axis=0) - P, axis=1)
    return np.minimum(side, np.roll(side, 1))


def _lifted(domain, outline, z):
    """(how far the boundary turns there (k,), points (k, 3) in space) of points z (k,)."""
    points = shapely.points(np.stack([z.real, z.imag], axis=1))
    at, off = outline.tree.query_nearest(points, return_distance=True, all_matches=False)
    segment, rim = at[1], off <= NEAR * domain.size
    a, b = outline.z[segment].T
    along = np.clip(np.real((z - a) * np.conj(b - a)) / np.abs(b - a) ** 2, 0, 1)
    ends = np.abs(np.stack([z - a, z - b], axis=1)) <= NEAR * domain.size
    turn = np.where(ends, outline.turn[segment], 0)
    turn = np.where(ends[:, 0], turn[:, 0], turn[:, 1])
    one, two = np.moveaxis(domain.space[outline.vertex[segment]], 1, 0)
    on_rim = one + along[:, None] * (two - one)
    return turn * rim, np.where(rim[:, None], on_rim, domain.raised(z))


def _edges(layer, rings):
    """{"u": (k, 2), "v": (k, 2)}: sides of the rings (numbers, z) along lines of the grid."""
    start, end = mesh.half_edges(layer.Q)
    known = set(map(tuple, np.sort(np.stack([start, end], axis=1)).tolist()))
    often, kinds = {}, {}
    for ring, z in rings:
        ij = coordinates(layer, z)
        along = np.abs(np.roll(ij, -1, axis=1) - ij) < ON
        along &= np.abs(ij - np.rint(ij)) < ON
        pairs = np.sort(np.stack([ring, np.roll(ring, -1)], axis=1), axis=1)
        for pair, on_v, on_u in zip(map(tuple, pairs.tolist()), *along, strict=True):
            often[pair] = often.get(pair, 0) + 1
            kinds[pair] = "u" if on_u else "v" if on_v else None
    inner = sorted(pair for pair, count in often.items() if count == 2 and pair not in known)
    pairs = {kind: [pair for pair in inner if kinds[pair] == kind] for kind in "uv"}
    return {kind: np.array(x, dtype=np.int64).reshape(-1, 2) for kind, x in pairs.items()}
