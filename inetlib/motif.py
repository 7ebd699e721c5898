"""A motif repeated in every quad of a net: all inscribed parallelograms are similar."""

import numpy as np

from . import measure, mesh


def place(V, Q, curves, lam, theta):
    """A plane motif, similar in every quad: a list of arrays (f, k, 3), one for each curve.

    curves: a list of (k, 2) point arrays, drawn around 0 in the plane of the parallelogram
    with the half sides (1, 0) along d1 and lam (cos theta, sin theta) along d2; the motif
    fits when it stays inside.  lam, theta (radians): those of the net.  On a net with these
    angles every copy is a similar image; elsewhere it is an affine one.
    """
    if not (lam > 0 and 0 < theta < np.pi):
        raise ValueError(f"lam = {lam:.6g}, theta = {theta:.6g}: lam > 0, 0 < theta < pi wanted")
    sides = np.array([[1.0, 0.0], [lam * np.cos(theta), lam * np.sin(theta)]])
    d1, d2, _, _ = measure.vectors(V, Q)
    board = mesh.checkerboard(V, Q)
    centre = board.V[board.black].mean(axis=1)
    placed = []
    for curve in curves:
        points = np.asarray(curve, dtype=float)
        if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
            raise ValueError("a curve of the motif is an array (k, 2) of finite numbers")
        along = np.linalg.solve(sides.T, points.T)  # in half sides
        offsets = along[0, None, :, None] * d1[:, None] + along[1, None, :, None] * d2[:, None]
        placed.append(centre[:, None] + offsets / 4)
    return placed


def inner_circle(lam, theta, share=0.9, count=25):
    """The circle around 0 that touches two sides of the parallelogram, times `share`: (k, 2)."""
    t = np.linspace(0, 2 * np.pi, count)
    radius = share * np.sin(theta) * min(1.0, lam)
    return radius * np.stack([np.cos(t), np.sin(t)], axis=1)


def weave(lam, theta, share=0.35):
    """Two waves, each from a corner of the parallelogram to the opposite one: list of (k, 2).

    The corners are the middles of the quad's edges, where those of its neighbours go on.
    """
    t = np.linspace(-1, 1, 25)
    one, two = np.array([1.0, 0.0]), lam * np.array([np.cos(theta), np.sin(theta)])
    wave = share * np.sin(np.pi * t)
    return [
        np.outer(t, one + two) + np.outer(wave, one - two),
        np.outer(t, one - two) + np.outer(wave, one + two),
    ]
