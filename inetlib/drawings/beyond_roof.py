"""A whole roof: whole quads around two openings, and cut panels up to every edge."""

import numpy as np

from .. import design, examples, mesh, plot, repair
from ..plot import DEGREE
from . import drawn, enlarged, patches

CUT = "#d9b26a"  # panels that are cut
FACE, PLACE = 153, [0.71, 0.79, 0.28, 0.17]  # the quad that is enlarged, and where
MOSAIC = [["A", "B"], ["C", "C"], ["C", "C"]]
TEXTS = {
    "A": "a vault with two openings",
    "B": "whole quads only",
    "C": "whole quads, and panels cut at every edge",
}


@drawn("theta", "theta0", "azimuth", "elevation")
def draw(
    theta=60 * DEGREE,
    theta0=60 * DEGREE,
    count=300,
    azimuth=-40 * DEGREE,
    elevation=34 * DEGREE,
):
    """A vault with two openings (A), covered by the whole quads of an isogonal net (B), and by the
    same quads with panels in another colour that are cut at every edge (C).

    theta, theta0: radians; count: about how many quads; azimuth, elevation: the camera, radians.
    """
    figure, axes = plot.canvas(MOSAIC, 7.4, 7.2)
    view = plot.camera(azimuth, elevation)
    V, F = examples.two_skylights()
    net = design.cover(V, F, theta, theta0, count, trim=True)
    rims = [patches.closed(V[loop]) for loop in mesh.boundary_loops(F)]
    rims = [(line, plot.INK, 0.9) for line in rims]
    families = plot.families(net.V, net.Q, {"u": 0.45, "v": 0.45})
    plot.scene(axes["A"], view, [(V, F, plot.PALE)], rims)
    plot.board(axes["B"], view, net.V, net.Q, [*families, *rims], fill=patches.EXACT)
    lines = [(net.V[one], plot.COLOURS[k], 0.45) for k, some in net.edges.items() for one in some]
    lines += [(patches.closed(net.V[panel]), plot.INK, 0.4) for panel in net.polygons]
    lines += [*families, patches.outline(net.V, net.Q[[FACE]])]
    cut = net.V, repair.triangulate(net.V, net.polygons), CUT
    plot.board(axes["C"], view, net.V, net.Q, lines, [cut], patches.EXACT)
    enlarged.draw(axes["C"].inset_axes(PLACE), net.V, net.Q, FACE)
    for letter, words in TEXTS.items():
        plot.panel(axes[letter], letter, words)
    corners = [len(panel) for panel in net.polygons]
    claims = {
        "whole_quads": len(net.Q),
        "cut_panels": len(corners),
        "fewest_corners": min(corners),
        "most_corners": max(corners),
        "flips": net.report.flips,
    }
    data = {"net": net.V, "quads": net.Q, "cut": np.concatenate(net.polygons), "corners": corners}
    return figure, data, [(net.V, net.Q, theta, theta0)], claims
