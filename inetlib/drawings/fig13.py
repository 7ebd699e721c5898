"""Fig. 13: a mesh around a hexagon, optimised to two isogonal nets, and their Moebius images."""

import numpy as np
from matplotlib.colors import Normalize

from .. import mesh, moebius, plot, reference, solver
from ..plot import DEGREE
from . import darts, drawn, enlarged, patches

SIXTY = 60 * DEGREE
SETTINGS = {"A": {"theta": SIXTY, "theta0": SIXTY}, "B": {"theta": SIXTY, "theta0": 45 * DEGREE}}
ITERATIONS = 12  # of the paper's formulation
SIDES, RINGS = 6, 8
CENTRE, RADIUS = (-0.2, 0.1, -0.25), 0.3
PLACE = [0.36, 0, 0.62, 0.24]  # of a parallelogram in its panel
FACE = 377  # that is enlarged


def start(dome=0.45, wave=0.1):
    """A hexagon and eight rings of quads on a dome with six waves: (V, Q, polygon).

    dome, wave: height and depth of the waves along the boundary, in radii of the mesh; the
    bounding box gets the diagonal 1.  Paper: Fig. 13."""
    V, Q, polygon = mesh.polygon_rings(SIDES, RINGS)
    return patches.domed(V, dome, wave, SIDES), Q, polygon


def nets(formulation="ratio", dome=0.45, wave=0.1, weights=patches.WEIGHTS):
    """The start and the two nets: (V, Q, polygon, {"A": `solver.Result`, "B"}).

    formulation: of `solver.optimize`; "paper" takes the printed numbers of iterations.  The
    wanted angles change step by step from those of the start.  Paper: Fig. 13, Table 1."""
    V, Q, polygon = start(dome, wave)
    same = {"reference": reference.mesh(V, Q), "weights": weights, "polygons": [polygon]}
    found = {}
    for letter, angles in SETTINGS.items():
        most = ITERATIONS if formulation != "ratio" else None
        way = {"formulation": formulation, "iterations": most}
        found[letter] = solver.optimize(V, Q, **angles, **same, **way)
    return V, Q, polygon, found


@drawn("azimuth", "elevation")
def draw(dome=0.45, wave=0.1, azimuth=-75 * DEGREE, elevation=50 * DEGREE):
    """A net with a singular hexagon, two isogonal nets from it, and their Moebius images.

    dome, wave: of the `start`; azimuth, elevation: the camera, radians.  The images keep the
    connectivity, and the angles up to the size of the quads: they are coloured by the larger
    deviation of theta and theta0 from those of the net.  Paper: Fig. 13."""
    V, Q, polygon, found = nets(dome=dome, wave=wave)
    figure, axes = plot.canvas([["start", "A", "B"], ["steps", "A'", "B'"]], 7.4, 5.6)
    view = plot.camera(azimuth, elevation)
    inversion = moebius.inversion(CENTRE, RADIUS)
    images = {letter: moebius.apply(inversion, r.V) for letter, r in found.items()}
    off = {k: patches.deviation(W, Q, found[k].theta, found[k].theta0) for k, W in images.items()}
    scale = Normalize(0, patches.next_multiple(max(x.max() for x in off.values()), 0.1))
    _net(axes["start"], view, V, Q, polygon)
    axes["start"].set_title(f"the start: {len(Q)} quads, 1 hexagon", loc="left")
    claims = {}
    for letter, result in found.items():
        image, colours = axes[letter + "'"], patches.tints(scale, off[letter])
        _net(axes[letter], view, result.V, Q, polygon, more=[patches.outline(result.V, Q[[FACE]])])
        enlarged.draw(axes[letter].inset_axes(PLACE), result.V, Q, FACE)
        plot.panel(axes[letter], letter, f"${plot.degrees(**SETTINGS[letter])}$")
        _net(image, view, images[letter], Q, polygon, colours)
        plot.panel(image, letter + "'", f"M\u00f6bius image of {letter}")
        claims |= patches.claims(letter, result, Q)
        claims[f"{letter}'_darts"] = darts([(images[letter], Q)])
    _history(axes["steps"], found)
    patches.bar(axes["A'"], scale, [0.68, 0.9, 0.6, 0.035])
    patches.align([axes[k] for k in ("start", "A", "B")], 0.15)
    patches.align([axes[k] for k in ("A'", "B'")], 0.1)
    claims |= {f"{letter}'_max_deviation_deg": round(x.max(), 6) for letter, x in off.items()}
    data = {"start": V} | {f"net_{letter}": r.V for letter, r in found.items()}
    data |= {f"image_{letter}": W for letter, W in images.items()}
    return figure, data, [(r.V, Q, r.theta, r.theta0) for r in found.values()], claims


def _net(ax, view, V, Q, polygon, colours=patches.EXACT, more=()):
    corners = V[polygon]
    lines = [(np.concatenate([corners, corners[:1]]), plot.INK, 1.0), *more]
    patches.surface(ax, view, V, Q, colours, lines, [(corners, plot.SINGULAR)])


def _history(ax, found):
    """The largest deviation of the angles after each step."""
    ax.set_title("the largest deviation, degrees", loc="left")
    ax = ax.inset_axes([0.16, 0.15, 0.76, 0.8])
    for (letter, result), style, side in zip(found.items(), ("o-", "s--"), (-1, 1), strict=True):
        off = np.maximum(np.degrees([step.deviation for step in result.history]), 1e-12)
        ax.semilogy(off, style, ms=4, color=plot.INK, mfc="white")
        place, shift = (len(off) - 2, off[-2]), (12 * side, 0)
        ax.annotate(letter, place, shift, textcoords="offset points", ha="center", va="center")
    ax.set(xlabel="steps", xlim=(-0.4, max(len(r.history) for r in found.values())))
    ax.set_yticks([1, 1e-4, 1e-8, 1e-12])
    ax.minorticks_off()
