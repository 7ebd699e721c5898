"""Openings of a surface, closed by triangles while it is flattened, and open again after that."""

import igl
import numpy as np
import shapely
from scipy.spatial import Delaunay

from .. import mesh, repair, ties
from .flatten import Flat

AWAY = 0.7  # steps between the points inside an opening and its rim
MOST = 2000  # points inside an opening, about


def are_filled(openings: str | None, loops: list) -> bool:
    """Whether the surface with these boundary loops is covered as a disk with openings.

    openings: None, "fill" or "ring", else ValueError; "ring" is for a surface with one hole."""
    if openings not in (None, "fill", "ring"):
        raise ValueError(f'openings = "{openings}": "fill", "ring" or None is wanted')
    if openings == "ring" and len(loops) != 2:
        found = f"the surface has {len(loops) - 1} openings"
        raise ValueError(f'openings = "ring": {found}, a ring has one: leave the option out')
    return len(loops) > 2 or (len(loops) == 2 and openings == "fill")


def filled(V: np.ndarray, F: np.ndarray, loops: list) -> tuple[np.ndarray, np.ndarray]:
    """(V, F), all boundary loops closed but the longest in space; what is new comes last."""
    length = [np.linalg.norm(V[loop] - V[np.roll(loop, 1)], axis=1).sum() for loop in loops]
    outer = ties.first_largest(length)
    for loop in (loop for k, loop in enumerate(loops) if k != outer):
        rim = loop[::-1]
        inner, patch = _patch(V, rim)
        number = np.concatenate([rim, len(V) + np.arange(len(inner))])
        V, F = np.concatenate([V, inner]), np.concatenate([F, number[patch]])
    return V, F


def _patch(V, rim):
    """(points (m, 3), triangles in numbers of rim and points) within a rim, seen from its left."""
    P, count = V[rim], len(rim)
    normal = np.cross(P - P[0], np.roll(P, -1, axis=0) - P[0]).sum(axis=0)
    normal /= np.linalg.norm(normal) or 1.0
    sides = np.roll(P, -1, axis=0) - P
    sides -= (sides @ normal)[:, None] * normal
    first = sides[ties.first_largest(np.linalg.norm(sides, axis=1))]
    frame = np.stack([first / np.linalg.norm(first), np.cross(normal, first)])
    frame[1] /= np.linalg.norm(frame[1]) or 1.0
    flat, polygon = P @ frame.T, shapely.Polygon(P @ frame.T)
    if polygon.is_valid:
        points = np.concatenate([flat, _lattice(flat, polygon)])
        T = Delaunay(points).simplices.astype(np.int64)
        a, b, c = (points[T] @ [1, 1j]).T
        area, middle = np.imag(np.conj(b - a) * (c - a)), points[T].mean(axis=1)
        good = np.abs(area) > 1e-6 * polygon.area / len(T)
        good &= shapely.contains_xy(polygon, *middle.T)
        T = np.where(area[:, None] < 0, T[:, ::-1], T)[good]
        if _is_closed_by(T, count, len(points)):
            space = np.stack([*points.T, 0 * points[:, 0]], axis=1)
            height = igl.harmonic(space, T, np.arange(count), (P @ normal)[:, None], 1).ravel()
            return points[count:] @ frame + height[count:, None] * normal, T
    try:
        return V[:0], repair.triangulate(P, [list(range(count))])
    except ValueError:
        words = "the opening through the vertices {} is too twisted to be closed: cut the surface"
        raise mesh.Fault(words, rim, V) from None


def _lattice(rim, polygon):
    """Points (m, 2) of a lattice of equal triangles in a polygon, a step from its rim."""
    step = np.linalg.norm(rim - np.roll(rim, 1, axis=0), axis=1).mean()
    step = max(step, np.sqrt(polygon.area / MOST))
    low, size = rim.min(axis=0), np.ptp(rim, axis=0)
    i, j = np.mgrid[: int(size[0] / step) + 2, : int(size[1] / step / 0.866) + 2].reshape(2, -1)
    points = low + step * np.stack([i - j % 2 / 2, 0.866 * j], axis=1)
    points = points[shapely.contains_xy(polygon, *points.T)]
    off = (
        shapely.distance(polygon.exterior, shapely.points(points)) if len(points) else points[:, 0]
    )
    return points[off > AWAY * step]


def _is_closed_by(T, count, points):
    """Whether triangles use all points, and their boundary is the rim 0, 1, ..., count - 1."""
    if len(np.unique(T)) != points:
        return False
    try:
        (loop,) = mesh.boundary_loops(T)
    except ValueError:
        return False
    return len(loop) == count and bool(np.all(np.diff(np.append(loop, loop[0])) % count == 1))


def opened(flat: Flat, V: np.ndarray, count: int) -> Flat:
    """The `Flat` of the first `count` triangles only; V: the vertices that were flattened."""
    F = flat.F[:count]
    a, b, c = flat.z[F].T
    area = np.imag(np.conj(b - a) * (c - a))
    grow = float(np.sqrt(igl.doublearea(V[flat.origin], F).sum() / area.sum()))
    scale, flips = flat.scale[:count] * grow, int(np.sum(area <= 0))
    more = {"distortion": flat.distortion[:count], "scale": scale, "flips": flips}
    return flat._replace(z=flat.z * grow, F=F, **more)


def outlines(flat: Flat) -> tuple[np.ndarray, list[np.ndarray]]:
    """(the outer loop, the loops of the openings) of the triangles in the plane, in numbers of z.

    The outer one turns counter-clockwise, the others clockwise."""
    loops = mesh.boundary_loops(flat.F)
    area = [np.sum(np.imag(np.conj(flat.z[x]) * np.roll(flat.z[x], -1))) for x in loops]
    outer = int(np.argmax(area))
    return loops[outer], [loop for k, loop in enumerate(loops) if k != outer]
