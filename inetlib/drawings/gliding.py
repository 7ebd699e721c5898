"""Nets that glide on the surface of their start to other angles, and how far they went."""

from typing import NamedTuple

import numpy as np

from .. import measure, mesh, reference, solver
from ..solver.problem import Weights

MARGIN = 1.0  # the surface goes on beyond the start by this much of u and v
TOLERANCE = 1e-12  # of the angles, radians
WEIGHTS = Weights(fairness=0.001, closeness=0.01)  # faces of very different sizes stay so

# Fig. 9 prints distances for column 4 only, without saying in which unit
PRINTED = {"A4": 1.959, "B4": 0.016, "C4": 38.593, "D4": 3.120, "E4": 9.464}


class Glide(NamedTuple):
    """A net before (`start`) and after (`result.V`), both with the quads Q, and its surface.

    rows: the vertex numbers as an array, one row a v-curve; diagonal: of the box of the start;
    angles: the wanted (theta, theta0), radians; result: a `solver.Result`.
    """

    surface: object
    start: np.ndarray
    Q: np.ndarray
    rows: np.ndarray
    angles: tuple
    reference: reference.Reference
    result: solver.Result
    diagonal: float


class Row(NamedTuple):
    """Distances of one panel as fractions of the diagonal of the start's bounding box.

    printed     the paper's figure, None where there is none; its unit is not stated
    off         the farthest vertex of the optimised net from the analytic surface
    there       the farthest vertex of the optimised net from the start, a mesh
    back        the farthest vertex of the start from the optimised net
    """

    panel: str
    printed: float | None
    off: float
    there: float
    back: float


def glide(surface, z, angles):
    """The net of the points over the grid z, optimised to the angles on the surface: a `Glide`.

    surface: `surfaces.Surface`; z: complex (m+1, n+1); angles: (theta, theta0), radians.  Where
    the last column of the net falls on the first the two are glued, and no seam can open.
    """
    V = surface.point(z.real, z.imag)
    closed = np.allclose(V[:, 0], V[:, -1], rtol=0, atol=1e-9)
    V = V[:, :-1] if closed else V
    rows = np.arange(V[..., 0].size).reshape(V.shape[:2])
    Q = mesh.grid_quads(len(z) - 1, z.shape[1] - 1)
    if closed:
        Q = np.hstack([rows, rows[:, :1]]).ravel()[Q]
    V = V.reshape(-1, 3)
    u, v = ((x.min() - MARGIN, x.max() + MARGIN) for x in (z.real, z.imag))
    smooth = reference.parametric(surface.point, u, v)
    options = {"reference": smooth, "on_surface": True}
    result = solver.optimize(V, Q, *angles, weights=WEIGHTS, tolerance=TOLERANCE, **options)
    return Glide(surface, V, Q, rows, angles, smooth, result, np.linalg.norm(np.ptp(V, axis=0)))


def distances(glides):
    """The distances of {panel: Glide}, as a list of `Row`; noise below 1e-9 counts as 0."""
    return [Row(panel, PRINTED.get(panel), *_measured(g)) for panel, g in glides.items()]


def _measured(g):
    V = g.result.V
    feet, _ = g.reference.closest(V)
    off = np.linalg.norm(feet - V, axis=1).max()
    values = np.array([off, *measure.hausdorff(V, g.Q, g.start, g.Q)]) / g.diagonal
    return (float(x) for x in np.where(values < 1e-9, 0, values))
