"""What Figs. 12 and 13 share: a net in space with its parallelograms, and its enlarged middle.

Paper: Fig. 12, Fig. 13.
"""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.ticker import MaxNLocator

from .. import measure, mesh, plot
from ..solver.problem import Weights

# A tenth of the printed weights: with those the paper's formulation ends degrees off the
# angles (Fig. 13) in the printed number of steps.  A boundary held tighter pinches corners.
WEIGHTS = Weights(fairness=0.0005, closeness=0.001, approximation=0.001, boundary=0.0001)
EXACT = "#7b9bcb"  # parallelograms without a deviation
DEVIATION = LinearSegmentedColormap.from_list("deviation", [EXACT, "#a8506a", "#3d0a1e"])
LIGHT = (-0.45, -0.5, 0.75)


def surface(ax, view, V, Q, colours=EXACT, lines=(), polygons=(), width=0.45, light=LIGHT):
    """Parallelograms in their colours on a light surface, u- and v-curves, and more lines.

    view: a `plot.camera`; colours: one, or RGB for each quad; lines: as for `plot.scene`;
    polygons: (corners (k, 3), colour) of further faces.
    """
    points, black, pale = plot.cells(V, Q, white=True)
    fill = [shaded(points, black, colours, light), shaded(points, pale, "#f0f2f5", light, 0.3)]
    faces = np.concatenate([black, pale])
    for corners, colour in polygons:  # as thin triangles from the middle
        extra, fan = _fan(corners, len(points))
        points, faces = np.concatenate([points, extra]), np.concatenate([faces, fan])
        fill.append(shaded(points, fan, colour, light, 0.2))
    both, fill = plot.families(V, Q, {"u": width, "v": width}), np.concatenate(fill)
    plot.scene(ax, view, points, faces, fill, [*both, *lines], lift=0.003).set_clip_on(False)


def shaded(V, faces, colours, light=LIGHT, depth=0.45):
    """RGB of the faces: `plot.shade` with one colour a face, or one for all."""
    grey = plot.shade(V, faces, "white", light, depth)
    return grey * (to_rgb(colours) if isinstance(colours, str) else colours)


def _fan(corners, start):
    """Vertices and faces (k, 4) of the triangles from the mean of the corners to its sides."""
    k = np.arange(len(corners))
    tip = np.full(len(corners), start + len(corners))
    faces = np.stack([tip, tip, start + k, start + np.roll(k, -1)], axis=1)
    return np.concatenate([corners, corners.mean(axis=0)[None]]), faces


def enlarged(ax, V, Q, faces, colours=EXACT):
    """Some faces with their 4-web in their mean plane: what the parallelograms look like.

    faces: numbers; colours: one, or RGB for each of them.
    """
    Q = Q[faces]
    d1, d2, m13, _ = measure.vectors(V, Q)
    normal, right = (x.mean(axis=0) for x in (np.cross(d1, d2), m13))
    up = np.cross(normal, right)
    plane = np.stack([np.cross(up, normal), up])
    plane /= np.linalg.norm(plane, axis=1, keepdims=True)
    board = mesh.checkerboard(V, Q)
    flat, quads = V @ plane.T, board.V @ plane.T
    plot.polygons(ax, flat, Q, "#f0f2f5")
    plot.polygons(ax, quads, board.black, colours, plot.INK, 0.5)
    ends = {"d1": [(0, 2)], "d2": [(1, 3)], "u": [(1, 2), (0, 3)], "v": [(0, 1), (3, 2)]}
    for name, pairs in ends.items():
        lines = np.concatenate([flat[Q[:, pair]] for pair in pairs])
        plot.curves(ax, lines, plot.COLOURS[name], 1.3)


def outline(V, quads):
    """The boundary of some faces as a line for `plot.scene`."""
    rim = V[mesh.boundary_loops(quads)[0]]
    return np.concatenate([rim, rim[:1]]), plot.INK, 1.3


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


def inset(ax, box):
    """An empty picture inside a panel; box: of `inset_axes`."""
    found = ax.inset_axes(box)
    found.set_axis_off()
    found.set_aspect("equal")
    return found


def claims(found, Q):
    """Steps, flips, angles and area ratio of each net for the manifest; found: {name: Result}."""
    numbers = {}
    for name, result in found.items():
        quality = measure.quality(result.V, Q)
        numbers[f"{name}_steps"] = len(result.history) - 1
        numbers[f"{name}_flips"] = int(quality.flips)
        numbers[f"{name}_area_ratio"] = round(quality.area_ratio, 6)
        for angle in ("theta", "theta0"):
            degrees = float(np.degrees(getattr(result, angle)))
            numbers[f"{name}_{angle}_deg"] = round(degrees, 6)
    return numbers
