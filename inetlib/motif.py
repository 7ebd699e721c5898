"""A motif repeated in every quad of a net: all inscribed parallelograms are similar."""

import numpy as np

from . import measure, mesh
from .parallelogram import check_angle, check_positive


def place(V: np.ndarray, Q: np.ndarray, curves: list, lam: float, theta: float) -> list[np.ndarray]:
    """A plane motif, similar in every quad: a list of arrays (f, k, 3), one for each curve.

    curves: a list of (k, 2) point arrays, drawn around 0 in the plane of the parallelogram
    with the half sides (1, 0) along d1 and lam (cos theta, sin theta) along d2, those of the
    net (radians); elsewhere the copies are affine images."""
    lam, theta = check_positive("lam", lam), check_angle("theta", theta)
    sides = np.array([[1.0, 0.0], [lam * np.cos(theta), lam * np.sin(theta)]])
    d1, d2, _, _ = measure.vectors(V, Q)
    board = mesh.checkerboard(V, Q)
    centre = board.V[board.black].mean(axis=1)
    placed = []
    for curve in curves:
        points = np.asarray(curve, dtype=float)
        if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
            raise ValueError("a curve of the motif is an array (k, 2) of finite numbers")
        a, b = np.linalg.solve(sides.T, points.T)[:, None, :, None]  # in half sides
        placed.append(centre[:, None] + (a * d1[:, None] + b * d2[:, None]) / 4)
    return placed


def weave(lam: float, theta: float, share: float = 0.35) -> list[np.ndarray]:
    """Two waves between opposite corners of the parallelogram, [(25, 2), (25, 2)]: see `place`."""
    t = np.linspace(-1, 1, 25)
    one, two = np.array([1.0, 0.0]), lam * np.array([np.cos(theta), np.sin(theta)])
    corner, other, wave = one + two, one - two, share * np.sin(np.pi * t)
    return [np.outer(t, a) + np.outer(wave, b) for a, b in ((corner, other), (other, corner))]
