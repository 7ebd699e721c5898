"""Conformal maps of disks and rings of triangles to the plane, as complex numbers.

Plain: the spectral relative of LSCM for disks; a ring becomes a strip between parallel lines,
its banks a period apart.  Even: a constant scale along the boundary, the least varying of all.
The maps of disks start from one without branch points, whose boundary turns just once.
"""

from typing import NamedTuple

import igl
import numpy as np
from scipy.sparse import block_array, coo_array, csr_array, eye_array
from scipy.sparse.csgraph import dijkstra

from .. import mesh, repair, ties
from ..solver import sparse

ROUNDS = 8  # of the inverse iteration, at most: many could end at a branched map, like z^2
STILL = 1e-9  # a change of the map, of its size, that ends the iteration
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
    boundary: "even" or "plain"; where that map would overlap itself or flip triangles, the
    other one is tried.  ValueError if both overlap themselves.
    """
    if boundary not in ("even", "plain"):
        raise ValueError(f'boundary = "{boundary}": "even" or "plain" is wanted')
    disk = len(loops) == 1
    path = None if disk else _path(V, F, loops)
    faces, origin, bank = (F, np.arange(len(V)), np.zeros(len(V))) if disk else _cut(F, path)
    energy = _energy(V[origin], faces)
    even = _unrolled(V, F, loops, path, origin, bank, energy)
    known = V, F, faces, origin, None if disk else 1.0 + 0j, _ends(V, loops[0])
    found = []
    for kind in ("even", "plain") if boundary == "even" else ("plain", "even"):
        if kind == "even":
            z = even
        elif disk:
            z = _disk(even, V, energy, loops[0])
        else:
            z = _ring(energy, loops, origin, bank, len(V))
        flat = _judged(z, *known)
        found.append((_overlap(flat), flat.flips, flat))
        if found[-1][0] < OVERLAP and not flat.flips:
            return flat
    overlap, _, flat = min(found, key=lambda one: (one[0] >= OVERLAP, one[1]))
    if overlap >= OVERLAP:
        part = f"{100 * overlap:.2g} %"
        raise ValueError(f"the flattened surface overlaps itself, {part} of it: cut it into pieces")
    return flat


def _energy(V, F):
    """The conformal energy as a Hermitian matrix H: z^H H z / 2, of Dirichlet less the area."""
    start, end = (ends[mesh.opposites(F) < 0] for ends in mesh.half_edges(F))
    area = coo_array((np.full(len(start), 0.5j), (start, end)), shape=(len(V),) * 2).tocsr()
    return csr_array(area + area.T.conj() - igl.cotmatrix(V, F))


def _unrolled(V, F, loops, path, origin, bank, energy):
    """The even map, which has no branch points ("Boundary First Flattening").

    The logarithm u of the scale is 0 on the boundary, or another constant on a second loop, and
    its Laplacian is the curvature.  So all angles of the outlines are known: a disk's make one
    turn, and a small change of its lengths closes it; those of a ring make none, for the right
    constant.  Inside the map is harmonic; what is left to choose is where the second loop lies.
    """
    laplacian, angles = csr_array(-igl.cotmatrix(V, F)), igl.internal_angles(V, F)
    inner = np.setdiff1d(np.arange(len(V)), np.concatenate(loops))
    solve = sparse.Factor(V[inner])(laplacian[inner][:, inner]) if len(inner) else np.copy

    def continued(x, right=0):
        """x with other values inside, where its Laplacian is `right` then."""
        right = right - laplacian[inner] @ x
        parts = [solve(part.copy()) for part in (right.real, right.imag)]
        x[inner] = parts[0] + 1j * parts[1] if np.iscomplexobj(x) else parts[0]
        return x

    curvature = -np.bincount(F.ravel(), angles.ravel())
    curvature[inner] += 2 * np.pi
    curvature[np.concatenate(loops)] += np.pi
    turn = curvature + laplacian @ continued(np.zeros(len(V)), -curvature[inner])
    second = np.zeros(len(V))
    if path is not None:
        first = [np.argmax(loop == end) for loop, end in zip(loops, path[[-1, 0]], strict=True)]
        loops = [np.roll(loop, -k) for loop, k in zip(loops, first, strict=True)]
        second[loops[1]] = 1
        second = continued(second)
        change = laplacian @ second
        turn -= turn[loops[0]].sum() / change[loops[0]].sum() * change
    z = np.zeros(len(V), dtype=complex)
    for k, loop in enumerate(loops):
        way = np.exp(1j * np.cumsum([0, *turn[loop[1:]]]))
        length = np.linalg.norm(V[np.roll(loop, -1)] - V[loop], axis=1)
        if path is None:
            ways = np.stack([way.real, way.imag])
            length -= length * (np.linalg.solve((ways * length) @ ways.T, ways @ length) @ ways)
        else:
            length = length * (-1) ** (k + 1) / np.sum(length * way)  # to the period 1 or -1
        z[loop[1:]] = np.cumsum(length * way)[:-1] + (path is not None and k == 0)
    jump = np.bincount(origin, energy.real @ bank)  # across the cut of a ring
    z = continued(z, -jump[inner])[origin] + bank
    if path is None:
        return z - z.mean()
    w = second[origin]
    return z - (w @ (energy @ z)) / (w @ (energy @ w)) * w


def _ends(V, loop):
    """Two vertices of the loop far from each other, the first ones of those that are farthest."""
    first = loop[ties.first_largest(np.linalg.norm(V[loop] - V[loop].mean(axis=0), axis=1))]
    return first, loop[ties.first_largest(np.linalg.norm(V[loop] - V[first], axis=1))]


def _disk(z, V, energy, loop):
    """The plain map of a disk, by inverse iteration from the map z."""
    count, before = len(z), 0
    tiny = 1e-12 * energy.diagonal().real.mean() * eye_array(count)
    inverse = sparse.Factor(V)((energy + tiny).tocsr())
    for _ in range(ROUNDS):
        z = z - z[loop].mean()
        z /= np.linalg.norm(z[loop])
        if np.abs(z - before).max() < STILL * np.abs(z).max():
            break
        load = np.zeros(count, dtype=complex)
        load[loop] = z[loop]
        before, z = z, inverse(load)
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
    energy = block_array([[energy.real, -energy.imag], [energy.imag, energy.real]])
    x = merge @ sparse.factor((merge.T @ energy @ merge).tocsr())(-merge.T @ (energy @ jump))
    return x[:k] + bank + 1j * x[k:]


def _judged(z, V, F, faces, origin, period, ends):
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
    parts = np.array_split(places, 1 + len(places) // 1000)  # in between others can work
    return np.mean(np.concatenate([igl.winding_number(points, edges, x) for x in parts]) > 1.5)
