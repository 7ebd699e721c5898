"""Optimised nets in space: their parallelograms, coloured by the deviation of the angles."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.ticker import MaxNLocator

from .. import measure, mesh, plot, ties
from ..solver.problem import Weights

# A tenth of the printed weights: with those the paper's formulation ends degrees off the
# angles (Fig. 13) in the printed number of steps.  A boundary held tighter pinches corners.
WEIGHTS = Weights(fairness=0.0005, closeness=0.001, approximation=0.001, boundary=0.0001)
EXACT = "#7b9bcb"  # parallelograms without a deviation
DEVIATION = LinearSegmentedColormap.from_list("deviation", [EXACT, "#a8506a", "#3d0a1e"])


def domed(V, dome, wave, waves):
    """The plane mesh on a dome with waves of this depth along its boundary, in its radii.

    The bounding box gets the diagonal 1."""
    z = (V[:, 0] + 1j * V[:, 1]) / np.hypot(V[:, 0], V[:, 1]).max()
    r, wavy = np.abs(z), np.real((z / np.abs(z)) ** waves)
    V = np.stack([z.real, z.imag, dome * (1 - r**2) + wave * r**3 * wavy], axis=1)
    return V / np.linalg.norm(np.ptp(V, axis=0))


def deviation(V, Q, theta=None, theta0=None):
    """The larger deviation of both angles of each face, degrees (f,); see `measure.deviations`."""
    return np.degrees(measure.deviations(V, Q, theta, theta0).max(axis=0))


def tints(scale, off):
    """RGB of faces that are `off`; scale: Normalize."""
    return DEVIATION(scale(off))[:, :3]


def surface(ax, view, V, Q, colours=EXACT, lines=(), polygons=()):
    """Parallelograms in their colours on a light surface, u- and v-curves, and more lines.

    view: a `plot.camera`; colours: one, or RGB for each quad; lines: as for `plot.scene`;
    polygons: (corners (k, 3), colour) of further faces."""
    more = []
    for corners, colour in polygons:
        k, tip = np.arange(len(corners)), np.full(len(corners), len(corners))
        fan = np.stack([tip, k, np.roll(k, -1)], axis=1)
        more.append((np.concatenate([corners, corners.mean(axis=0)[None]]), fan, colour))
    lines = [*plot.families(V, Q, {"u": 0.45, "v": 0.45}), *lines]
    plot.board(ax, view, V, Q, lines, more, colours)


def outline(V, quads, colour=plot.INK, width=1.3):
    """The boundary of some faces as a line for `plot.scene`."""
    return closed(V[mesh.boundary_loops(quads)[0]]), colour, width


def closed(points):
    """The line through points (k, 3), back to the first one."""
    return np.concatenate([points, points[:1]])


def bar(ax, scale, box):
    """A colour bar of the deviation inside a panel; scale: Normalize, box: of `inset_axes`."""
    at = ax.inset_axes(box)
    mappable = ScalarMappable(scale, DEVIATION)
    ax.figure.colorbar(mappable, cax=at, orientation="horizontal").locator = MaxNLocator(4)
    at.set_title("deviation, degrees", fontsize=8.5)


def align(axes, below):
    """One scale for the panels, all hung from the top left; below: room, in heights of a net."""
    boxes = [ax.dataLim for ax in axes]
    width, height = (1.02 * max(getattr(b, s) for b in boxes) for s in ("width", "height"))
    for ax, box in zip(axes, boxes, strict=True):
        x, top = (box.x0 + box.x1) / 2, box.y1
        ax.set_anchor("NW")
        ax.set(xlim=(x - width / 2, x + width / 2), ylim=(top - (1 + below) * height, top))


def next_multiple(x, step):
    """The next multiple of a step, which x itself is when it is one up to 1e-9 of the step."""
    return float(np.ceil(x / step - ties.TIE) * step)


def claims(name, result, Q):
    """Steps, flips, darts, area ratio and angles of a `solver.Result` for the manifest."""
    quality = measure.quality(result.V, Q)
    return {
        f"{name}_steps": len(result.history) - 1,
        f"{name}_flips": quality.flips,
        f"{name}_darts": quality.darts,
        f"{name}_area_ratio": round(quality.area_ratio, 6),
        f"{name}_theta_deg": round(float(np.degrees(result.theta)), 6),
        f"{name}_theta0_deg": round(float(np.degrees(result.theta0)), 6),
    }
