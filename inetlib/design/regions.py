"""What is left of a flattened surface between the whole quads and its boundary, cut by the grid."""

from typing import NamedTuple

import numpy as np
import shapely
from scipy.spatial import cKDTree

from .. import mesh, repair, ties
from . import opening, overlay

NEAR = 1e-9  # of the size of the domain: points this close are one
GRID = 1e-12  # of the size: to which the crossings are rounded
CORNERS = np.array([(0, 1), (0, 0), (1, 0), (1, 1)])  # of a quad, in a cell
SIDES = np.stack([CORNERS, np.roll(CORNERS, -1, axis=0)], axis=1)
NONE = "not one whole quad is left beside the cut ones: ask for more"
ROUNDS = 20  # in which whole quads that are touched are cut, too


class Outline(NamedTuple):
    """The boundary of a flattened surface; that of a ring over some periods."""

    polygon: shapely.Polygon
    z: np.ndarray  # (s, 2) complex ends of its segments, without the ends of a ring
    vertex: np.ndarray  # (s, 2) their numbers in `Flat.z`
    turn: np.ndarray  # (s, 2) the angles by which it turns there, radians
    tree: shapely.STRtree  # of the segments


class Regions(NamedTuple):
    """Faces in the plane, counter-clockwise rings of numbered points; no gaps, no overlaps."""

    layer: overlay.Layer  # with the whole quads that nothing touches; its vertices come first
    rings: list  # of arrays of numbers
    z: list  # of arrays (k,) complex: where the points of each ring are; a ring has periods
    outline: Outline


def outline(domain: overlay.Domain, reach: float) -> Outline:
    """The `Outline` of a domain; reach: of a ring, the length of a cell."""
    flat = domain.flat
    loop, holes = opening.outlines(flat)
    if flat.period is None:
        chains = [np.append(x, x[0]) for x in (loop, *holes)]
        places = [flat.z[x] for x in chains]
        polygon = shapely.Polygon(_xy(places[0]), [_xy(z) for z in places[1:]])
    else:
        chains, places = _unrolled(flat, loop, reach)
        polygon = shapely.Polygon(_xy(np.concatenate(places)))
        chains, places = chains[::2], places[::2]
    if not polygon.is_valid:
        raise ValueError(
            "the boundary of the flattened surface crosses itself: cover it without trimming"
        )
    turns = []
    for chain, z in zip(chains, places, strict=True):
        way = np.diff(z)
        turn = np.angle(way / np.roll(way, 1))
        turns.append(np.stack([turn, np.roll(turn, -1)], axis=1))
        if chain[0] != chain[-1]:  # the ends are far away
            turns[-1][[0, -1], [0, 1]] = 0
    z, vertex = (
        np.concatenate([np.stack([x[:-1], x[1:]], 1) for x in y]) for y in (places, chains)
    )
    tree = shapely.STRtree(shapely.linestrings(_xy(z)))
    return Outline(polygon, z, vertex, np.concatenate(turns), tree)


def _unrolled(flat, loop, reach):
    """Four chains of vertices and their places: a loop, the cut, the other loop, the cut."""
    start, end = mesh.half_edges(flat.F)
    free = mesh.opposites(flat.origin[flat.F]) < 0
    rim = set(zip(start[free].tolist(), end[free].tolist(), strict=True))
    pairs = zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True)
    real = np.array([pair in rim for pair in pairs])
    first = np.argmax(real & ~np.roll(real, 1))
    loop, real = np.roll(loop, -first), np.roll(real, -first)
    ends = [*np.flatnonzero(np.diff(real)) + 1, len(loop)]
    parts = [np.append(loop, loop[0])[a : b + 1] for a, b in zip([0, *ends], ends, strict=False)]
    around = np.real(flat.z[loop] / flat.period)
    reach = reach / abs(flat.period)
    low, high = int(np.floor(-reach - around.max())), int(np.ceil(1 + reach - around.min()))
    turns = np.arange(low, high + 1) * flat.period
    if np.real((flat.z[parts[0][-1]] - flat.z[parts[0][0]]) / flat.period) < 0:
        turns = turns[::-1]
    chains, places = [], []
    for part, shifts in zip(parts, (turns, turns[-1:], turns[::-1], turns[:1]), strict=True):
        chains.append(np.concatenate([*[part[:-1]] * len(shifts), part[-1:]]))
        z = [flat.z[part[:-1]] + shift for shift in shifts]
        places.append(np.concatenate([*z, flat.z[part[-1:]] + shifts[-1:]]))
    return chains, places


def regions(domain: overlay.Domain, layer: overlay.Layer) -> Regions:
    """The `Regions` between the whole quads of a layer and the boundary of its domain.

    Quads with a point of the boundary on an edge are whole no longer."""
    edge = outline(domain, abs(layer.u) + abs(layer.v))
    shapely.prepare(edge.polygon)
    lines = np.empty((0, 2), dtype=complex)
    for _ in range(ROUNDS):
        i, j = _cut_cells(domain, layer, edge)
        faces, more = _faces(layer, edge, i, j, lines)
        rings, z = _numbered(domain, layer, faces)
        touched = _touched(domain, layer, rings, edge)
        if not len(more) and not touched.any():
            return Regions(layer, rings, z, edge)
        lines = np.concatenate([lines, more])
        Q = layer.Q[~touched]
        Q = Q[overlay.largest_piece(Q)] if len(Q) else Q
        if not len(Q):
            raise ValueError(NONE)
        layer = layer.kept(Q)
    raise ValueError(
        "the panels at the boundary could not be cut: another size or direction may do"
    )


def _cut_cells(domain, layer, edge):
    """Integers i, j (k,) of the cells that meet the domain and are no whole quads."""
    grid = layer.u, layer.v, layer.winding
    i, j = overlay.turned(domain, *grid, *overlay.points(domain, *grid[:2]))
    key, first = np.unique(overlay.keys(i, j), return_index=True)
    whole = np.isin(key, overlay.keys(*layer.ij[layer.Q[:, 1]].T))
    i, j = i[first][~whole], j[first][~whole]
    meet = shapely.intersects(edge.polygon, overlay.cells(i, j, *grid[:2]))
    return i[meet], j[meet]


def _faces(layer, edge, i, j, lines):
    """(polygons of the cells i, j inside the outline, lines (k, 2) that divide rings of them)."""
    u, v = layer.u, layer.v
    cells, cell = overlay.cells(i, j, u, v), abs(np.imag(np.conj(u) * v))
    along = [np.stack([i, j + k, i + 1, j + k], axis=1) for k in (0, 1)]
    across = [np.stack([i + k, j, i + k, j + 1], axis=1) for k in (0, 1)]
    sides = np.unique(np.concatenate(along + across), axis=0)
    ends = np.stack([sides[:, k] * u + sides[:, k + 1] * v for k in (0, 2)], axis=1)
    segments = shapely.linestrings(_xy(np.concatenate([ends, lines])))
    size = np.sqrt(edge.polygon.area)
    noded = shapely.union_all([*segments, edge.polygon.boundary], grid_size=GRID * size)
    faces = np.array(shapely.get_parts(shapely.polygonize([*shapely.get_parts(noded)])))
    faces = faces[shapely.area(faces) > overlay.TINY * cell]
    inside = shapely.point_on_surface(faces)
    faces = faces[shapely.intersects(edge.polygon, inside)]
    at = coordinates(layer, shapely.get_coordinates(shapely.point_on_surface(faces)) @ [1, 1j])
    a, b = np.floor(at).astype(np.int64)
    mine = np.isin(overlay.keys(a, b), overlay.keys(i, j))
    faces, a, b = faces[mine], a[mine], b[mine]
    middle = shapely.get_coordinates(shapely.centroid(faces))
    order = np.lexsort([*(ties.ranks(x, NEAR * size) for x in middle.T[::-1]), b, a])
    faces, more = faces[order], []
    for k in np.flatnonzero(shapely.get_num_interior_rings(faces)):
        corners = shapely.get_coordinates(
            cells[np.flatnonzero((i == a[order][k]) & (j == b[order][k]))[0]]
        )
        for ring in shapely.get_rings(faces[k])[1:]:
            centre = shapely.get_coordinates(shapely.centroid(ring))[0] @ [1, 1j]
            more += [(centre, corner @ [1, 1j]) for corner in corners[:4]]
    return faces, np.array(more, dtype=complex).reshape(-1, 2)


def _numbered(domain, layer, faces):
    """(rings, their places z) of the polygons: equal numbers for points that are the same."""
    rings = [shapely.get_coordinates(shapely.get_exterior_ring(f))[:-1] @ [1, 1j] for f in faces]
    rings = [z if np.imag(np.conj(z) @ np.roll(z, -1)) > 0 else z[::-1] for z in rings]
    if not rings:
        return [], []
    z, period = np.concatenate(rings), domain.flat.period
    ij = np.rint(coordinates(layer, z)).astype(np.int64)
    node = np.abs(ij[0] * layer.u + ij[1] * layer.v - z) < NEAR * domain.size
    key = overlay.keys(*overlay.turned(domain, layer.u, layer.v, layer.winding, *ij))
    place = z if period is None else z - period * np.floor(np.real(z / period) + 1e-9)
    known = overlay.keys(*layer.ij.T)
    order = np.argsort(known)
    found = order[np.minimum(np.searchsorted(known, key, sorter=order), len(known) - 1)]
    same = cKDTree(_xy(place)).query_pairs(NEAR * domain.size, output_type="ndarray")
    label = repair.components(len(z), *same.T)
    number = np.where(node & (known[found] == key), found, len(known) + label)
    parts = np.split(number, np.cumsum([len(ring) for ring in rings])[:-1])
    kept = [np.flatnonzero(part != np.roll(part, 1)) for part in parts]
    pairs = [(p[k], r[k]) for p, r, k in zip(parts, rings, kept, strict=True) if len(k) > 2]
    return [p for p, _ in pairs], [r for _, r in pairs]


def _touched(domain, layer, rings, edge):
    """Whether each whole quad (f,) has an edge that no other face has, and not the boundary."""
    start, end = mesh.half_edges(layer.Q)
    free = np.flatnonzero(mesh.opposites(layer.Q) < 0)
    known = {pair for ring in rings for pair in sides(ring)}
    pairs = zip(end[free].tolist(), start[free].tolist(), strict=True)
    lonely = free[[pair not in known for pair in pairs]]
    touched = np.zeros(len(layer.Q), dtype=bool)
    if len(lonely):
        ij = layer.ij[layer.Q[lonely // 4, 1]][:, None] + SIDES[lonely % 4]
        lines = shapely.linestrings(_xy(ij @ [layer.u, layer.v]))
        rim = shapely.buffer(edge.polygon.boundary, NEAR * domain.size)
        off = shapely.length(shapely.difference(lines, rim))
        touched[lonely[off > NEAR * domain.size] // 4] = True
    return touched


def sides(ring: np.ndarray) -> list[tuple[int, int]]:
    """The pairs of numbers that follow each other in a ring."""
    points = ring.tolist()
    return list(zip(points, points[1:] + points[:1], strict=True))


def coordinates(layer: overlay.Layer, z: np.ndarray) -> np.ndarray:
    """The coordinates i, j (2, k), real numbers, of points z (k,) in the grid of a layer."""
    area = np.imag(np.conj(layer.u) * layer.v)
    return np.stack([np.imag(z * np.conj(layer.v)) / -area, np.imag(np.conj(layer.u) * z) / area])


def _xy(z):
    return np.stack([z.real, z.imag], axis=-1)
