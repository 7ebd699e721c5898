"""Which meshes can carry an isogonal net: a gallery, labelled or refused, and two nets in space."""

import numpy as np

from .. import examples, mesh, plot, reference, solver
from ..plot import DEGREE
from . import drawn, enlarged, patches
from .revolution import SLOTS

SEAM = "#d0006f"
ROWS = [[f"{letter}{k}" for k in range(6)] for letter in "ABC"]
MOSAIC = [*ROWS, *[["D"] * 3 + ["E"] * 3] * 2]


NAMES = "triangle", "square", "pentagon", "hexagon", "heptagon", "octagon"
HEAD = (
    "In a net the edges around a vertex or a polygon alternate between blue ($u$) and orange ($v$)."
    "\nAn odd number of edges cannot: they disagree along the dotted lines."
)

FACES = {"D": 255, "E": 102}  # that are enlarged
PLACES = {"D": [0.6, 0.03, 0.46, 0.2], "E": [0.59, 0.0, 0.45, 0.2]}


def gallery():
    """The small meshes, {panel: (words, V, Q, polygon or None)}, not yet labelled.

    A: polygons of 3 to 8 sides with corners of valence 4; B: vertices of valence 3 to 8; C:
    polar caps of 3, 5 and 7 sides, closed strips with 3 and 4 turns, a Moebius strip.  Paper: B9.
    """
    found = {}
    for k in range(6):
        found[f"A{k}"] = (NAMES[k], *mesh.polygon_rings(k + 3, 2))
        found[f"B{k}"] = (f"{k + 3} quads meet", *examples.vertex(k + 3, 3), None)
    for k, sides in enumerate((3, 5, 7)):
        found[f"C{k}"] = (f"cap, {sides} sides", *examples.polar_cap(sides, 3))
    for k, turns in ((3, 3), (4, 4)):
        found[f"C{k}"] = (f"strip, {turns} turns", *mesh.polygon_rings(turns, 1)[:2], None)
    found["C5"] = ("M\u00f6bius strip", *examples.moebius_strip(26, 2), None)
    return found


def verdict(Q):
    """ "labelled", or the first words of the reason why `mesh.label` refuses the faces.

    Paper: B9."""
    try:
        mesh.label(Q)
    except ValueError as error:
        words = str(error).removeprefix("no consistent u/v labelling: ")
        if "odd sum" in words:
            return f"odd sum of\n(valence - 1): {words.split()[-1]}"
        return words.replace(" has the ", " has\nthe ").replace("the mesh is ", "").split(":")[0]
    return "labelled"


def around(Q, polygon=None):
    """How many edges there are on and from the polygon, or the hole of a strip, or vertex 0.

    These must be an even number, where the surface has an orientation.  Paper: B9."""
    loops = sorted(mesh.boundary_loops(Q), key=len)
    middle = polygon if polygon is not None else loops[0] if len(loops) > 1 else [0]
    edges = np.sort(np.stack([Q, np.roll(Q, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    return int(np.isin(np.unique(edges, axis=0), middle).any(axis=1).sum())


def _caption(Q, polygon, words):
    """What a reader is told of a mesh with this `verdict`."""
    if words == "not orientable":
        return "one side only"
    count = around(Q, polygon)
    return f"{count} edges alternate" if words == "labelled" else f"{count} edges disagree"


def nets(theta=60 * DEGREE, theta0=45 * DEGREE, dome=0.5):
    """Two nets in space: {"D": (V, Q, polygon, `solver.Result`), "E"}; V is the start.

    D: an octagon with corners of valence 4 in six rings; E: a polar cap of 20 sides.  Both
    start from domes.  theta, theta0: radians.  Paper: B9."""
    meshes = {"D": mesh.polygon_rings(8, 6), "E": examples.polar_cap(20, 7)}
    found = {}
    for letter, (V, Q, polygon) in meshes.items():
        V = patches.domed(V, *((dome, 0.1) if letter == "D" else (2 * dome, 0.0)), 4)
        options = {"reference": reference.mesh(V, Q), "polygons": [polygon], "tolerance": 1e-12}
        found[letter] = V, Q, polygon, solver.optimize(V, Q, theta, theta0, **options)
    return found


@drawn("azimuth", "elevation")
def draw(theta=60 * DEGREE, theta0=45 * DEGREE, azimuth=-70 * DEGREE, elevation=48 * DEGREE):
    """The gallery (A to C) and an isogonal net around an octagon (D) and on a polar cap (E).

    theta, theta0: radians, of the nets; azimuth, elevation: the camera, radians.  Edges have
    the colours of u and v; where a mesh is refused, the names spread from one face until they
    meet in disagreement along the dotted edges.  Paper: B9."""
    figure, axes = plot.canvas(MOSAIC, 7.4, 7.8)
    data, exact, claims = {}, [], {}
    for name, (title, V, Q, polygon) in gallery().items():
        words = verdict(Q)
        _small(axes[name], V, Q, polygon)
        heading = rf"$\mathbf{{{name[0]}}}$  {title}" if name[1] == "0" else title
        axes[name].set_title(heading, loc="left", fontsize=9)
        look = {"ha": "center", "va": "top", "size": 7.5, "transform": axes[name].transAxes}
        colour = plot.INK if words == "labelled" else SEAM
        axes[name].text(0.5, -0.03, _caption(Q, polygon, words), color=colour, **look)
        claims[f"{name} {title}"] = words.replace("\n", " ")
    figure.get_layout_engine().set(h_pad=0.06, hspace=0.08)
    figure.suptitle(HEAD, x=0.01, ha="left", fontsize=9)
    view = plot.camera(azimuth, elevation)
    texts = {"D": "a net around an octagon", "E": "a net on a polar cap"}
    for letter, (_, Q, polygon, result) in nets(theta, theta0).items():
        V = data[letter] = result.V
        lines, face = [patches.outline(V, Q[[FACES[letter]]])], FACES[letter]
        singular = [(V[polygon], plot.SINGULAR)]
        patches.surface(axes[letter], view, V, Q, lines=lines, polygons=singular)
        if letter == "E":  # room at the right
            left, right = axes[letter].get_xlim()
            axes[letter].set_xlim(left, right + 0.3 * (right - left))
        axes[letter].set_anchor("N")
        enlarged.draw(axes[letter].inset_axes(PLACES[letter]), V, Q, face)
        plot.panel(axes[letter], letter, texts[letter])
        exact.append((V, Q, result.theta, result.theta0))
        claims |= patches.claims(letter, result, Q)
    return figure, data, exact, claims


def _small(ax, V, Q, polygon):
    """A mesh with its edges in the colours of the families, and where these disagree."""
    labelled, bad = examples.seam(Q)
    view = plot.camera(-75 * DEGREE, 32 * DEGREE)
    edges = {k: np.concatenate([labelled[:, pair] for pair in SLOTS[k]]) for k in "uv"}
    if np.ptp(V[:, 2]) == 0:
        points = plot.plane(V)
        plot.polygons(ax, points, Q, "#f0f2f5")
        if polygon is not None:
            plot.polygons(ax, points, polygon[None], plot.SINGULAR)
        for family, pairs in edges.items():
            plot.curves(ax, points[pairs], plot.COLOURS[family], 1.0)
    else:
        points = view(V)[0]
        lines = [(V[pair], plot.COLOURS[k], 0.9) for k in "uv" for pair in edges[k]]
        plot.scene(ax, view, [(V, Q, "#e3e7ee")], lines, lift=0.01)
    low, high = points.min(axis=0), points.max(axis=0)
    half = 0.53 * (high - low).max() * np.array([-1, 1])
    ax.set(xlim=(low + high)[0] / 2 + half, ylim=(low + high)[1] / 2 + half)
    if len(bad):
        plot.curves(ax, points[bad], "white", 3.4, zorder=5)
        plot.curves(ax, points[bad], SEAM, 2.6, (0, (0.6, 0.9)), zorder=6)
