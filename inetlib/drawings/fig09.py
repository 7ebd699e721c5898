"""Fig. 9: I-nets on five isothermal surfaces, their Moebius images, both optimised to others."""

import numpy as np

from .. import moebius, plot, publish, surfaces
from ..plot import DEGREE
from . import gliding, isothermal, lighter

NAMES = {"A": "cylinder", "B": "sphere", "C": "catenoid", "D": "helicoid", "E": "conjugate"}
# rows, quads along a row, the upper left corner (u, v) in steps, the line that is highlighted
PATCHES = {
    "A": (8, 20, 0, 4, 13),
    "B": (8, 20, 0, 4, 13),
    "C": (8, 20, 0, 4, 13),
    "D": (8, 20, -14, 4, 10),
    "E": (8, 20, -14, 4, 10),
}
CAMERAS = {"A": (-90, 18), "B": (-90, 18), "C": (-90, 25), "D": (15, 45), "E": (-15, 28)}  # degrees
CENTRES = {
    "A": (2.9, 0, 0.7),
    "B": (2, -1, 1.1),
    "C": (0.5, -3.6, 0.6),
    "D": (2.9, 0, 0),
    "E": (0, 0, 4.8),
}
IMAGE_CAMERAS = {"A": (-35, 30), "B": (-75, 50), "C": (-45, 30), "D": (0, 20), "E": (-45, 50)}
GOALS = {2: (80 * DEGREE, 45 * DEGREE), 4: (50 * DEGREE, 50 * DEGREE)}
TITLES = {
    1: "(63.43\N{DEGREE SIGN}, 45\N{DEGREE SIGN})",
    2: "(80\N{DEGREE SIGN}, 45\N{DEGREE SIGN})",
    3: "Moebius image",
    4: "(50\N{DEGREE SIGN}, 50\N{DEGREE SIGN})",
}


@publish.drawn
def draw(around=20, t=45 * DEGREE):
    """The (arccos 1/sqrt 5, 45 degree) net on five surfaces, its images, and optimised nets.

    around: steps of a full turn of u; t: of the conjugate minimal surface, radians.  Column 2
    is column 1 optimised to (80, 45) degrees, column 4 is column 3, the images of column 1
    under inversions, optimised to (50, 50), both on their surfaces.  In each picture one
    u-curve, in column 1 a loxodrome, is highlighted.

    Paper: Fig. 9.
    """
    panels = [[f"{k}{column}" for column in TITLES] for k in NAMES]
    figure, axes = plot.canvas(panels, 6.6, 7.9)
    for ax in axes.values():
        ax.set_aspect("equal", adjustable="datalim")  # titles in one line
    nets, data, claims = [], {}, {}
    for panel, (surface, z, marked) in _starts(around, t).items():
        V, Q = isothermal.sample(surface, z)
        line = isothermal.refined(z[:, marked], 3)
        _panel(axes[panel], panel, V, Q, surface.point(line.real, line.imag))
        if panel[1] == "1":
            nets.append((np.stack([z.real.ravel(), z.imag.ravel(), 0 * z.real.ravel()], 1), Q))
        data[f"net_{panel}"] = V
        off = publish.off(V, Q, isothermal.ANGLES)
        claims[f"sampled_net_{panel}_max_deviation_deg"] = off
    nets = [(V, Q, *isothermal.ANGLES) for V, Q in nets]
    glides = optimised(around, t)
    for panel, g in glides.items():
        V = g.result.V
        _panel(axes[panel], panel, V, g.Q, V[g.rows[:, PATCHES[panel[0]][4]]])
        nets.append((V, g.Q, *g.angles))
        data[f"net_{panel}"] = V
    for row in distances(glides):
        claims[f"off_surface_{row.panel}"] = round(row.off, 6)
        claims[f"hausdorff_{row.panel}"] = [round(row.there, 6), round(row.back, 6)]
    return figure, data, nets, claims


def optimised(around=20, t=45 * DEGREE):
    """The ten nets of columns 2 and 4 as {panel: Glide}, from "A2" and "A4" to "E4".

    around, t: as in `draw`.  A Glide holds `.start` and `.result.V`, their common quads `.Q`,
    the wanted `.angles`, the `.reference` surface, the `.diagonal` of the start's box and all
    of `solver.optimize`'s result.  On the cylinder, the sphere, the catenoid and their images
    the nets are closed, as long as the patch is one full turn (around=20).

    Paper: Fig. 9, Sec. 6.
    """
    glides = {}
    for start, (surface, z, _) in _starts(around, t).items():
        column = int(start[1]) + 1
        glides[f"{start[0]}{column}"] = gliding.glide(surface, z, GOALS[column])
    return glides


def distances(glides):
    """Rows (panel, printed, off, there, back) of the nets of `optimised`, as fractions.

    off: the farthest vertex from the analytic surface; there, back: one-sided Hausdorff
    distances between the optimised net and its start (`measure.hausdorff`), which see how far
    the border has moved too; all over the diagonal of the start's bounding box, below 1e-9 as
    0.  printed: the paper's number, in a unit that it does not state (E16), or None.

    Paper: Fig. 9.
    """
    return gliding.distances(glides)


def _starts(around, t):
    """The nets of columns 1 and 3, {panel: (surface, grid of parameters, line to highlight)}."""
    step = 2 * np.pi / around
    found = surfaces.CYLINDER, surfaces.SPHERE, surfaces.CATENOID, surfaces.HELICOID
    starts = {}
    for letter, surface in zip(NAMES, (*found, surfaces.conjugate(t)), strict=True):
        m, n, left, top, marked = PATCHES[letter]
        z = isothermal.domain(m, n, step, step * (left + 1j * top))
        image = moebius.image(moebius.inversion(CENTRES[letter]), surface)
        starts |= {f"{letter}1": (surface, z, marked), f"{letter}3": (image, z, marked)}
    return starts


def _panel(ax, panel, V, Q, curve):
    letter, column = panel[0], int(panel[1])
    view = plot.camera(*np.radians((CAMERAS if column < 3 else IMAGE_CAMERAS)[letter]))
    lines = plot.families(V, Q, {"v": 0.6, "u": 0.6})
    lines.append((curve, plot.COLOURS["u"], 2.2))
    scene = plot.scene(ax, view, V, Q, plot.shade(V, Q), lines)
    lighter.lighter(scene).set_clip_on(False)  # a smaller file
    plot.panel(ax, f"{letter}_{column}", NAMES[letter] if column == 1 else "")
    if letter == "A":
        place = {"xycoords": "axes fraction", "textcoords": "offset points", "ha": "center"}
        ax.annotate(TITLES[column], (0.5, 1), (0, 22), **place)
