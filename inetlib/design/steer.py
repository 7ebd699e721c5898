"""Where the grid lies on a flat surface: through a point, along the boundary or a direction."""

import igl
import numpy as np
from numpy.typing import ArrayLike

from .. import mesh, ties
from ..reference import CORNER
from .flatten import Flat

ROUND = 1e-3  # of its length: a boundary that goes everywhere alike has no direction
UPRIGHT = 1e-6  # of its length: a direction that is normal to the surface has less along it


def check(along: str | None, through: ArrayLike | None, align: ArrayLike | None) -> tuple:
    """(through, align) as arrays (3,) or None; ValueError for what is no wish of that kind."""
    if along not in (None, "boundary"):
        raise ValueError(f'along = "{along}": "boundary" or None is wanted')
    if along and align is not None:
        raise ValueError("along and align both say where u goes: give one of them")
    found = []
    for name, given in (("through", through), ("align", align)):
        point = None if given is None else np.asarray(given, dtype=float)
        if given is not None and (point.shape != (3,) or not np.isfinite(point).all()):
            raise ValueError(f"{name} = {given}: three finite numbers x, y, z are wanted")
        found.append(point)
    return tuple(found)


def steered(
    flat: Flat,
    V: np.ndarray,
    along: str | None,
    through: np.ndarray | None,
    align: np.ndarray | None,
) -> tuple[Flat, float]:
    """(the `Flat` moved so that a grid point, 0, is where the net goes through, the angle of u).

    V: the vertices of the surface that was flattened; for the others see `design.cover`.
    ValueError for a point farther from the surface than its size, and for an upright direction."""
    F = flat.origin[flat.F]
    point, angle = through, 0.0
    if point is None and align is not None:
        weight = igl.doublearea(V, F)
        point = np.average(V[F].mean(axis=1), axis=0, weights=weight)
    if point is not None:
        square, face, foot = igl.point_mesh_squared_distance(point[None], V, F)
        size = np.linalg.norm(np.ptp(V[F].reshape(-1, 3), axis=0))
        if np.sqrt(square.item()) > size:
            far = f"{np.sqrt(square.item()):.3g} from the surface, whose diagonal is {size:.3g}"
            raise ValueError(f"through = {mesh.place(point)}: {far}; a point near it is wanted")
        corner, z = V[F[face.item()]], flat.z[flat.F[face.item()]]
        sides, ways = (corner[1:] - corner[0]).T, z[1:] - z[0]
        if align is not None:
            angle = float(np.angle(ways @ _within(sides, align)))
        if through is not None:
            flat = flat._replace(
                z=flat.z - z[0] - ways @ _within(sides, foot.ravel() - corner[0], 0)
            )
    if along:
        angle = _along(flat, V, F)
    return flat, angle


def _within(sides, vector, least=UPRIGHT):
    """The coordinates (2,) in two sides (3, 2) of a triangle of a vector's part along it."""
    found = np.linalg.lstsq(sides, vector, rcond=None)[0]
    if np.linalg.norm(sides @ found) <= least * np.linalg.norm(vector) and least:
        words = "there it is normal to the surface, or no direction at all"
        raise ValueError(f"align = {mesh.place(vector)}: {words}; take another one")
    return found


def _along(flat, V, F):
    """The mean direction, in the plane, of the longest stretch without corners of the outline."""
    start, end = mesh.half_edges(flat.F)
    free = mesh.opposites(F) < 0
    way = {
        int(a): z for a, z in zip(F.ravel()[free], (flat.z[end] - flat.z[start])[free], strict=True)
    }
    loops = mesh.boundary_loops(F)
    lengths = [np.linalg.norm(V[np.roll(loop, -1)] - V[loop], axis=1) for loop in loops]
    outer = ties.first_largest([length.sum() for length in lengths])
    ways, length = np.array([way[int(k)] for k in loops[outer]]), lengths[outer]
    corners = np.flatnonzero(np.abs(np.angle(ways / np.roll(ways, 1))) > CORNER)
    if len(corners):
        ways, length = (np.roll(x, -corners[0]) for x in (ways, length))
        first = corners - corners[0]
        k = ties.first_largest(np.add.reduceat(length, first))
        part = slice(first[k], [*first, len(ways)][k + 1])
        ways, length = ways[part], length[part]
    mean = np.sum(length * (ways / np.abs(ways)) ** 2)  # squared: there is no way back
    if np.abs(mean) < ROUND * length.sum():
        return 0.0
    angle = float(np.angle(mean)) / 2
    return angle + np.pi * (angle < ties.TIE - np.pi / 2)
