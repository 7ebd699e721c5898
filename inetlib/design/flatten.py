"""Conformal maps of disks and rings of triangles to the plane, as complex numbers.

Plain: the spectral relative of LSCM for disks; a ring becomes a strip between parallel lines,
its banks a period apart.  Even: a constant scale along the boundary, the least varying of all."""

from typing import NamedTuple

import igl
import numpy as np
from scipy.sparse import block_diag, coo_array, csr_array, diags_array, eye_array
from scipy.sparse.csgraph import dijkstra

from .. import mesh, repair, ties
from ..solver import sparse

ROUNDS = 100  # of the inverse iteration, at most; five are usual
STILL = 1e-9  # a change of the map, of its size, that ends the iteration
BEND = 0.1  # weight of an even boundary, against the conformal energy
BENDS = 60  # steps towards it, at most
STRAIGHT = 1e-4  # a change of the map, of its size, that ends them
SAMPLES = 20000  # triangles that are looked at for overlaps
OVERLAP = 1e-3  # the part of them that may
ROUND = 1e-3  # a surface without a longest direction: its moment, of its size, is less


class Flat(NamedTuple):
    """A flattened surface, made by `flatten`; the area in the plane is that of the surface."""

    z: np.ndarray  # (k,) complex
    F: np.ndarray  # (f, 3) the triangles of the surface in the numbering of z
    origin: np.ndarray  # (k,) the vertex of the surface that each z is
    period: complex | None  # None for a disk
    flips: int  # flipped triangles
    distortion: np.ndarray  # (f,) longer / shorter half axis of the ellipse a circle becomes
    scale: np.ndarray  # (f,) length in the plane / length on the surface


def flatten(V: np.ndarray, F: np.ndarray, loops: list, boundary: str = "even") -> Flat:
    """The surface V (n, 3), F (f, 3), loops from `repair.clean` as a `Flat`.

    The real axis is the longest direction of a disk, and runs around the hole of a ring.
    boundary: "even" or "plain"; where the even map would overlap itself or flip triangles,
    the plain one is taken.  ValueError if that overlaps itself, too."""
    if boundary not in ("even", "plain"):
        raise ValueError(f'boundary = "{boundary}": "even" or "plain" is wanted')
    disk = len(loops) == 1
    faces, origin, bank = (F, np.arange(len(V)), None) if disk else _cut(F, _path(V, F, loops))
    ends = _ends(V, loops[0]) if disk else np.flatnonzero(bank)[:2]  # any: energy is all we want
    uv, energy = igl.lscm(V[origin], faces, np.array(ends), np.array([[0.0, 0.0], [1.0, 0.0]]))
    z, energy, period = uv[:, 0] + 1j * uv[:, 1], csr_array(energy), None if disk else 1.0 + 0j
    z = _disk(z, energy, loops[0]) if disk else _ring(energy, loops, origin, bank, len(V))
    flat = _judged(V, F, z, faces, origin, period, ends)
    if boundary == "even":
        even = _even(V, F, loops, flat, energy)
        even = _judged(V, F, even, faces, origin, flat.period, ends)
        if even.flips <= flat.flips and _overlap(even) < OVERLAP:
            return even
    if (part := _overlap(flat)) > OVERLAP:
        part = f"{100 * part:.2g} %"
        raise ValueError(f"the flattened surface overlaps itself, {part} of it: cut it into pieces")
    return flat


def _ends(V, loop):
    """Two vertices of the loop far from each other, the first ones of those that are farthest."""
    first = loop[ties.first_largest(np.linalg.norm(V[loop] - V[loop].mean(axis=0), axis=1))]
    return first, loop[ties.first_largest(np.linalg.norm(V[loop] - V[first], axis=1))]


def _disk(z, energy, loop):
    """The plain map of a disk, by inverse iteration from the map z."""
    count, before = len(z), 0
    matrix = (energy + 1e-12 * energy.diagonal().mean() * eye_array(2 * count)).tocsr()
    inverse = sparse.factor(matrix)
    for _ in range(ROUNDS):
        z = z - z[loop].mean()
        z /= np.linalg.norm(z[loop])
        if np.abs(z - before).max() < STILL * np.abs(z).max():
            break
        load = np.zeros(count, dtype=complex)
        load[loop] = z[loop]
        x = inverse(np.concatenate([load.real, load.imag]))
        before, z = z, x[:count] + 1j * x[count:]
        z *= np.exp(1j * np.angle(np.vdot(z[loop], before[loop])))  # rounding turns flat disks
    return z


def _path(V, F, loops):
    """A shortest path from the second loop to the first; of equal ones that of lowest numbers."""
    start, end = mesh.half_edges(F)
    once = (start < end) | (mesh.opposites(F) < 0)
    length = np.linalg.norm(V[start] - V[end], axis=1)[once]
    graph = coo_array((length, (start[once], end[once])), shape=(len(V), len(V))).tocsr()
    graph = graph + graph.T
    distance = dijkstra(graph, indices=loops[1], min_only=True)
    path = [int(loops[0][ties.first_smallest(distance[loops[0]])])]
    while distance[path[-1]] > 0:
        row = slice(*graph.indptr[path[-1] : path[-1] + 2])
        near = graph.indices[row]
        on_way = ties.at_most(distance[near] + graph.data[row], distance[path[-1]])
        path.append(int(near[on_way & (distance[near] < distance[path[-1]])].min()))
    return np.array(path[::-1])


def _cut(F, path):
    """(faces, origin, bank) of the triangles cut along a path: bank marks its left copies."""
    (start, end), twin = mesh.half_edges(F), mesh.opposites(F)
    step = np.full(F.max() + 1, -1)
    step[path[:-1]] = path[1:]
    left = step[start] == end
    closed = left | (left[twin] & (twin >= 0))
    corner = repair.corner_fans(F, np.where(closed, -1, twin)).astype(np.int64)
    faces, origin = corner.reshape(-1, 3), np.empty(corner.max() + 1, dtype=np.int64)
    origin[corner] = start
    bank = np.zeros(len(origin), dtype=bool)
    bank[corner[left]] = bank[np.roll(faces, -1, axis=1).ravel()[left]] = True
    return faces, origin, bank


def _ring(energy, loops, origin, bank, count):
    """The plain map of a ring: period 1, Im z = 0 and h on the loops, with the best h."""
    k = len(origin)
    column = np.arange(2 * count)  # x and y of each vertex; -1 for what is zero
    column[count + loops[1]] = count + loops[1][0]
    column[count + loops[0]] = column[0] = -1
    number = np.unique(column, return_inverse=True)[1] - 1
    column = number[np.concatenate([origin, origin + count])]
    row = np.flatnonzero(column >= 0)
    merge = csr_array((np.ones(len(row)), (row, column[row])), shape=(2 * k, number.max() + 1))
    jump = np.concatenate([bank, np.zeros(k)])
    x = merge @ sparse.factor((merge.T @ energy @ merge).tocsr())(-merge.T @ (energy @ jump))
    return x[:k] + bank + 1j * x[k:]


def _even(V, F, loops, flat, energy):
    """The map whose boundary edges have lengths in proportion to those of the surface.

    In steps the edges keep their directions and get the wanted lengths as targets; the sum of
    the conformal energy and the squared distances from the targets becomes the least."""
    count, k, origin = len(V), len(flat.z), flat.origin
    z = flat.z[np.unique(origin, return_index=True)[1]]
    banks = flat.z - z[origin]  # 0, or the period on one side of the cut
    half = np.flatnonzero(mesh.opposites(F) < 0)
    ends = np.stack([np.roll(flat.F, -1, axis=1).ravel()[half], flat.F.ravel()[half]], axis=1)
    loop = np.isin(origin[ends[:, 1]], loops[0], invert=True).astype(int)
    jump = banks[ends[:, 0]] - banks[ends[:, 1]]
    length = np.linalg.norm(V[origin[ends[:, 0]]] - V[origin[ends[:, 1]]], axis=1)
    difference = sparse.rows(np.tile([[[1.0, -1.0]]], (len(half), 1, 1)), origin[ends], count)
    weight = BEND / length
    merge = csr_array((np.ones(2 * k), (np.arange(2 * k), np.r_[origin, origin + count])))
    bend = difference.T @ diags_array(weight) @ difference
    A = merge.T @ energy @ merge + block_diag([bend, bend])
    hold = 1e-10 * A.diagonal().mean()  # near the last map, wherever the cut is
    solve = sparse.factor((A + hold * eye_array(2 * count)).tocsr())
    still = merge.T @ (energy @ np.concatenate([banks.real, banks.imag]))
    for _ in range(BENDS):
        edge = difference @ z + jump
        scale = np.bincount(loop, np.abs(edge)) / np.bincount(loop, length)
        if flat.period is None:
            scale[:] = 1  # nothing else fixes the size of a disk
        target = scale[loop] * length * edge / np.maximum(np.abs(edge), 1e-300)
        force = difference.T @ (weight * (target - jump)) + hold * z
        x = solve(np.concatenate([force.real, force.imag]) - still)
        before, z = z, x[:count] + 1j * x[count:]
        z -= z.mean() if flat.period is None else z[0].real + 1j * z.imag.mean()
        if np.abs(z - before - (z - before).mean()).max() < STRAIGHT * np.ptp(z.real):
            break
    return z[origin] + banks


def _judged(V, F, z, faces, origin, period, ends):
    """The `Flat` of a map, scaled to the area of the surface, a disk turned to its long axis."""
    if period is None:
        z = z * np.exp(-1j * _axis(z, faces, ends))
    a, b, c = np.moveaxis(V[F], 1, 0)
    length = np.linalg.norm(b - a, axis=1)
    along = np.einsum("ij,ij->i", c - a, b - a) / length
    height = np.linalg.norm(np.cross(b - a, c - a), axis=1) / length
    a, b, c = z[faces].T
    by_x = (b - a) / length
    by_y = (c - a - along * by_x) / height
    one, two = np.abs(by_x - 1j * by_y) / 2, np.abs(by_x + 1j * by_y) / 2
    distortion = (one + two) / np.maximum(np.abs(one - two), 1e-300)
    scale, area = np.sqrt(np.abs(one**2 - two**2)), length * height / 2
    grow = np.sqrt(area.sum() / np.sum(area * scale**2))
    period = None if period is None else period * grow
    return Flat(z * grow, faces, origin, period, int(np.sum(one <= two)), distortion, scale * grow)


def _axis(z, F, ends):
    """The angle of the longest direction, or on squares and the like that between the ends."""
    a, b, c = z[F].T
    area = np.imag(np.conj(b - a) * (c - a))
    a, b, c = z[F].T - np.average((a + b + c) / 3, weights=area)
    moment = np.average(a * a + b * b + c * c + a * b + b * c + c * a, weights=area)
    size = np.average(np.abs(a) ** 2, weights=area)
    way = z[ends[1]] - z[ends[0]]
    if abs(moment) <= ROUND * size:
        return np.angle(way)
    axis = np.sqrt(moment)
    aside = np.exp(1e-3j)  # so that an axis at right angles to the way is no tie
    return np.angle(axis if np.real(np.conj(axis) * way * aside) >= 0 else -axis)


def _overlap(flat):
    """The part of the flat surface that is covered more than once."""
    edges = np.stack(mesh.half_edges(flat.F), axis=1)[mesh.opposites(flat.F) < 0]
    centres = flat.z[flat.F[:: 1 + len(flat.F) // SAMPLES]].mean(axis=1)
    points, places = (np.stack([z.real, z.imag], axis=1) for z in (flat.z, centres))
    return np.mean(igl.winding_number(points, edges, places) > 1.5)
