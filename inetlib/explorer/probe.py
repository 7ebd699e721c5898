"""A face that is touched: which one the pointer is on, and what there is to say of it."""

from typing import Any

import numpy as np

from .. import measure
from . import plates


def seen(points: np.ndarray, camera: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) as a camera sees them: places (n, 2) and nearness (n,).

    camera: as vtk.js has it, without perspective: position, focalPoint, viewUp, parallelScale.
    Places have the unit of half the height of the view, from its middle, to the right and up."""
    names = "position", "focalPoint", "viewUp"
    position, middle, upright = (np.array(camera[name], dtype=float) for name in names)
    near = position - middle
    right = np.cross(upright, near)
    up = np.cross(near, right)
    axes = np.array([x / np.linalg.norm(x) for x in (right, up, near)]) / camera["parallelScale"]
    place = (points - middle) @ axes.T
    return place[:, :2], place[:, 2]


def hit(V: np.ndarray, Q: np.ndarray, camera: dict[str, Any], x: float, y: float) -> int | None:
    """The number of the face seen at the place x, y of a camera (see `seen`), None beside all."""
    place, near = seen(V, camera)
    corners = place[Q] - np.array([x, y])
    around = (corners.min(axis=1) <= 0) & (corners.max(axis=1) >= 0)
    faces = np.flatnonzero(around.all(axis=1))
    halves = np.array([[0, 1, 2], [0, 2, 3]])
    P = corners[faces][:, halves]  # (k, 2, 3, 2)
    (x1, y1), (x2, y2) = (np.moveaxis(np.roll(P, -k, axis=2), 3, 0) for k in (1, 2))
    weights = x1 * y2 - y1 * x2  # of the corners, times twice the area
    area = weights.sum(axis=2)
    inside = (weights * area[..., None] >= 0).all(axis=2) & (area != 0)
    depth = (weights * near[Q[faces]][:, halves]).sum(axis=2) / np.where(inside, area, 1)
    depth = np.where(inside, depth, -np.inf).max(axis=1, initial=-np.inf)
    return int(faces[np.argmax(depth)]) if np.isfinite(depth).any() else None


def middle(V: np.ndarray, Q: np.ndarray, camera: dict[str, Any]) -> int:
    """The number of the face in the middle of what a camera sees, or nearest to it."""
    face, place = hit(V, Q, camera, 0, 0), seen(V, camera)[0]
    return int(np.argmin(np.hypot(*place[Q].mean(axis=1).T))) if face is None else face


def about(V: np.ndarray, Q: np.ndarray, face: int, asked: tuple[float, float]) -> dict[str, str]:
    """What the page says of a face: texts, the angles and their deviations from those asked for
    in degrees."""
    lam, mu, *angles = measure.faces(V, Q[face : face + 1])[:, 0]
    found = {"name": f"Face {face + 1}", "lam": f"{lam:.5g}", "mu": f"{mu:.5g}"}
    for name, angle, wanted in zip(("theta", "theta0"), np.degrees(angles), asked, strict=True):
        off = angle - wanted
        found[name] = f"{angle:.6f}"
        found[f"{name}_off"] = "+" * bool(off >= 0) + plates.short(off)
    return found
