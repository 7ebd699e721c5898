"""Faces in the plane made into panels: slivers joined to neighbours, then few corners each.

A side (a, b) of a face has the face over it that has (b, a); one on the boundary has none."""

from typing import NamedTuple

import numpy as np
import shapely

from .. import mesh, ties
from ..reference import CORNER
from . import overlay
from .regions import NONE, Regions, sides

SLIVER = 0.1  # of a quad: smaller faces become parts of their neighbours
SHORT = 0.3  # of the longest side it shares: where a sliver shares less, there it would be a spike
STRAIGHT = 0.01  # radians: a line of the grid turns by less
MOST = 6  # corners
BULGE = 0.1  # of an edge: a boundary farther from a side gets a corner; one too many, at 2 BULGE


class Face(NamedTuple):
    """A ring of numbered points, counter-clockwise, more of them than it has corners."""

    ring: np.ndarray  # (k,)
    z: np.ndarray  # (k,) complex places

    @property
    def area(self) -> float:
        """In the plane."""
        return float(np.imag(np.conj(self.z) @ np.roll(self.z, -1)) / 2)


def owners(faces: dict) -> dict:
    """{side: key} of the faces {key: `Face`}."""
    return {side: key for key, face in faces.items() for side in sides(face.ring)}


def over(face: Face, owner: dict) -> list:
    """The keys of the faces over the sides of a face, None on the boundary."""
    return [owner.get((b, a)) for a, b in sides(face.ring)]


def fixed(face: Face, owner: dict) -> np.ndarray:
    """Which points (k,) have another neighbour on each side, or one with a corner there, too."""
    after = over(face, owner)
    before = after[-1:] + after[:-1]
    way = np.roll(face.z, -1) - face.z
    bent = np.abs(np.angle(way / np.roll(way, 1))) > STRAIGHT
    whole = np.array([key is not None and key < 0 for key in after])
    inner = np.array([key is not None for key in after])
    return np.array([a != b for a, b in zip(before, after, strict=True)]) | whole | inner & bent


def merged(found: Regions) -> tuple[overlay.Layer, list, list]:
    """(the layer, a list of `Face`, and one of the sides between them that are gone, each of
    these a `Face` of two points).

    Slivers have become parts of their neighbours.  Where only whole quads are around, one of
    them is whole no longer."""
    layer = found.layer
    cell = abs(np.imag(np.conj(layer.u) * layer.v))
    faces = dict(enumerate(map(Face, found.rings, found.z)))
    near = layer.Q.ravel()[mesh.opposites(layer.Q) < 0]
    for _ in range(2):  # the quads at the rim, and what is next to these
        quads = np.flatnonzero(np.isin(layer.Q, near).any(axis=1))
        near = layer.Q[quads]
    faces |= {-1 - int(q): _quad(layer, q) for q in quads}
    owner, count, gone = owners(faces), len(found.rings), []
    area = np.array([faces[k].area for k in range(count)])
    order = np.argsort(ties.ranks(area, ties.TIE * cell), kind="stable") if count else []
    queue = [int(k) for k in order if area[k] < SLIVER * cell]
    while queue:
        sliver = queue.pop(0)
        other, face = _partner(sliver, faces, owner, cell)
        if face is None:
            continue
        one = faces[sliver]
        for k in np.flatnonzero([key == other for key in over(one, owner)]):
            at = [k, (k + 1) % len(one.ring)]
            gone.append(Face(one.ring[at], one.z[at]))
        for side in (*sides(faces[sliver].ring), *sides(faces[other].ring)):
            del owner[side]
        del faces[sliver], faces[other]
        faces[count], queue = face, [k for k in queue if k != other]
        owner |= owners({count: face})
        if face.area < SLIVER * cell:
            queue.append(count)
        count += 1
    whole = np.ones(len(layer.Q), dtype=bool)
    whole[[q for q in quads if -1 - q not in faces]] = False
    kept = whole.copy()
    kept[whole] = overlay.largest_piece(layer.Q[whole]) if whole.any() else False
    if not kept.any():
        raise ValueError(NONE)
    lost = np.flatnonzero(whole & ~kept)
    cut = [face for key, face in faces.items() if key >= 0]
    return layer._replace(Q=layer.Q[kept]), [*cut, *(_quad(layer, q) for q in lost)], gone


def _quad(layer, q):
    """The whole quad number q as a `Face`."""
    corners = layer.ij[layer.Q[q, 1]] + [(0, 1), (0, 0), (1, 0), (1, 1)]
    return Face(layer.Q[q], corners @ [layer.u, layer.v])


def _partner(sliver, faces, owner, cell):
    """(key, what both become) of the neighbour with the longest common side.

    A cut one that is no sliver and has not just a corner of it, else a quad, else what is left."""
    face, common = faces[sliver], {}
    lengths = np.abs(np.roll(face.z, -1) - face.z)
    for key, length in zip(over(face, owner), lengths, strict=True):
        if key is not None:
            common[key] = common.get(key, 0) + length
    keys = np.array(sorted(common))
    length = np.array([common[k] for k in keys])
    rank = ties.ranks(-length, ties.TIE * length.sum()) if len(keys) else []
    later = None, None
    area = np.array([faces[k].area for k in keys])
    small = (keys >= 0) & ((area < SLIVER * cell) | (length < SHORT * max(length, default=0)))
    for k in np.lexsort([rank, 2 * small + (keys < 0)]):
        both = _joined(face, faces[keys[k]])
        if both is not None:
            corners = np.flatnonzero(fixed(both, owner))
            if len(corners) <= MOST:
                return int(keys[k]), both
            parts = _split(both, corners)
            if len(parts) > 1 and later[1] is None:
                least = min(part.area for part, _ in parts)
                later = (int(keys[k]), both) if least > 2 * face.area else later
    return later


def _joined(one, two):
    """The `Face` that two neighbours are together, None if it would have a hole."""
    twin = {(b, a) for a, b in sides(two.ring)}
    start = next(k for k, side in enumerate(sides(one.ring)) if side in twin)
    shift = one.z[start] - two.z[np.argmax(two.ring == one.ring[start])]  # around a ring
    place = dict(zip(two.ring.tolist(), two.z + shift, strict=True))
    place |= dict(zip(one.ring.tolist(), one.z, strict=True))
    mine = {(b, a) for a, b in sides(one.ring)}
    rest = [side for side in sides(one.ring) if side not in twin]
    rest += [side for side in sides(two.ring) if side not in mine]
    after = dict(rest)
    if len(after) < len(rest) or not rest:
        return None
    ring = [rest[0][0]]
    while (point := after.pop(ring[-1])) != ring[0]:
        ring.append(point)
    return None if after else Face(np.array(ring), np.array([place[k] for k in ring]))


def cornered(faces: list, Q: np.ndarray, turn: np.ndarray, edge: float) -> list:
    """[(`Face`, which of its points are corners), ...], each with three to six of them.

    Q: the whole quads; turn (n,): how far the boundary turns at points; edge: the mean one."""
    start, end = mesh.half_edges(Q)
    free = mesh.opposites(Q) < 0
    owner = owners(dict(enumerate(faces)))
    owner |= dict.fromkeys(zip(start[free].tolist(), end[free].tolist(), strict=True), -1)
    forced, known = set(), np.sort(np.stack([start, end], axis=1)[free], axis=1).tolist()
    while True:
        chosen = [_corners(face, owner, np.abs(turn), edge, forced) for face in faces]
        more = _doubled(faces, chosen, owner, known) - forced
        if not more:
            return [part for one in zip(faces, chosen, strict=True) for part in _split(*one)]
        forced |= more


def _corners(face, owner, turn, edge, forced):
    """The corners of a face, increasing: what neighbours need, then what the boundary needs."""
    ring, z, free = face.ring, face.z, np.array([k is None for k in over(face, owner)])
    must = fixed(face, owner) | [int(k) in forced for k in ring]
    sharp = np.flatnonzero(~must & free & np.roll(free, 1) & (turn[ring] > CORNER))
    sharp = sharp[np.argsort(ties.ranks(-turn[ring[sharp]], ties.TIE), kind="stable")]
    chosen = np.union1d(np.flatnonzero(must), sharp[: max(0, MOST - must.sum())])
    while True:
        far, where = max(_bulges(z, free, chosen), default=(0, None), key=lambda one: one[0])
        sound = _is_sound(z[chosen])
        if where is None:
            return chosen
        full = 0.25 if turn[ring[where]] > CORNER else 2  # these make two panels of one
        if sound and far < BULGE * edge * (1 if len(chosen) < MOST else full):
            return chosen
        chosen = np.union1d(chosen, where)


def _bulges(z, free, chosen):
    """[(how far from the side of a panel, which point), ...] for its sides along the boundary."""
    if not len(chosen):
        return [(np.inf, 0)]
    ends = zip(chosen, np.roll(chosen, -1), strict=True)
    return [bulge for a, b in ends if free[a] and (bulge := _bulge(z, a, b))]


def _bulge(z, a, b):
    """(how far from the line between the points a and b of a ring, which) of those between."""
    arc = np.arange(a + 1, b if b > a else b + len(z)) % len(z)
    if not len(arc):
        return None
    way = z[b] - z[a]
    off = np.abs(np.imag(np.conj(way) * (z[arc] - z[a]))) / abs(way) if way else abs(z[arc] - z[a])
    k = ties.first_largest(off)
    return float(off[k]), int(arc[k])


def _doubled(faces, chosen, owner, known):
    """Points of the boundary between the ends of two sides that would close a hole otherwise."""
    count, arcs, found = dict.fromkeys(map(tuple, known), 1), [], set()
    for face, corners in zip(faces, chosen, strict=True):
        free = [k is None for k in over(face, owner)]
        for a, b in zip(corners, np.roll(corners, -1), strict=True):
            pair = tuple(sorted((int(face.ring[a]), int(face.ring[b]))))
            count[pair] = count.get(pair, 0) + 1
            if free[a]:
                arcs.append((pair, face, a, b))
    for pair, face, a, b in arcs:
        bulge = _bulge(face.z, a, b) if count[pair] > 1 else None
        if bulge:
            found.add(int(face.ring[bulge[1]]))
    return found


def _split(face, corners):
    """The parts of a face with more corners than a panel may have, cut from corner to corner."""
    if len(corners) <= MOST:
        return [(face, corners)]
    best, parts, region = 0, None, _polygon(face.z)
    for one in range(len(corners)):
        for two in range(one + 2, len(corners) - (one == 0)):
            a, b = corners[[one, two]]
            inner = np.arange(a, b + 1)
            outer = np.append(np.arange(b, len(face.z)), np.arange(a + 1))
            halves = [Face(face.ring[k], face.z[k]) for k in (inner, outer)]
            least = min(half.area for half in halves)
            way = shapely.LineString(np.stack([face.z[[a, b]].real, face.z[[a, b]].imag], axis=1))
            if least > best * (1 + ties.TIE) and region.covers(way):
                places = [np.flatnonzero(np.isin(k, corners)) for k in (inner, outer)]
                both = list(zip(halves, places, strict=True))
                if all(_is_sound(half.z[k]) for half, k in both):
                    best, parts = least, both
    return [(face, corners)] if parts is None else [x for part in parts for x in _split(*part)]


def _is_sound(z):
    """Whether points are the corners of a polygon without crossings, counter-clockwise."""
    turns = np.imag(np.conj(z) @ np.roll(z, -1)) > 0
    return len(z) > 2 and bool(turns and shapely.is_valid(_polygon(z)))


def _polygon(z):
    return shapely.Polygon(np.stack([z.real, z.imag], axis=1))
