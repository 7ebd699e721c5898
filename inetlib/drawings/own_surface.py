"""A net on a surface of one's own: panels by size and by planarity, and a motif in every quad."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from .. import measure, plot
from ..plot import DEGREE


def warps(V, Q):
    """How far each face is from being planar: distance of the diagonals over their mean length."""
    d1, d2, _, _ = measure.vectors(V, Q)
    normal = np.cross(d1, d2)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    apart = np.abs(np.sum((V[Q[:, 1]] - V[Q[:, 0]]) * normal, axis=1))
    return 2 * apart / (np.linalg.norm(d1, axis=1) + np.linalg.norm(d2, axis=1))


def panels(V, Q, curves, azimuth=-62 * DEGREE, elevation=42 * DEGREE):
    """Three pictures of a net: sizes, planarity, and a motif (see `motif.place`) in every quad.

    curves: placed ones, a list of (f, k, 3); azimuth, elevation: the camera, radians.
    Returns the figure."""
    figure, axes = plot.canvas([["size", "planarity", "motif"]], 7.4, 3.1)
    view = plot.camera(azimuth, elevation)
    d1, d2, _, _ = measure.vectors(V, Q)
    side = np.sqrt(np.linalg.norm(np.cross(d1, d2), axis=1) / 2)  # of a square as large
    values = {"size": side / side.mean(), "planarity": warps(V, Q)}
    for name, numbers in values.items():
        mappable = ScalarMappable(Normalize(numbers.min(), numbers.max()), "cividis")
        fill = mappable.to_rgba(numbers)[:, :3]
        apart = np.arange(Q.size).reshape(-1, 4)
        plot.scene(axes[name], view, [(V[Q].reshape(-1, 3), apart, fill)])
        bar = axes[name].inset_axes([0.1, -0.12, 0.8, 0.05])
        figure.colorbar(mappable, cax=bar, orientation="horizontal")
    axes["size"].set_title("size, over the mean", loc="left")
    axes["planarity"].set_title("distance of the diagonals", loc="left")
    lines = [(copy, plot.INK, 0.5) for curve in curves for copy in curve]
    plot.scene(axes["motif"], view, [(V, Q, plot.PALE)], lines)
    axes["motif"].set_title("a motif in every quad", loc="left")
    return figure
