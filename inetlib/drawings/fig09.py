"""Fig. 9: I-nets on five isothermal surfaces, their Moebius images, both optimised to others."""

from typing import NamedTuple

import numpy as np

from .. import conformal, measure, mesh, moebius, plot, reference, solver, surfaces
from ..plot import DEGREE
from ..solver.problem import Weights
from . import darts, drawn, enlarged, isothermal, patches, sampled

NAMES = {"A": "cylinder", "B": "sphere", "C": "catenoid", "D": "helicoid", "E": "conjugate"}
ROWS, COLUMNS, TOP = 14, 36, 7  # of each net; its upper edge v, in steps
LEFT = {"A": 0, "B": 0, "C": 0, "D": -25, "E": -25}  # its left corner u, in steps
MARKED = {"A": 23, "B": 23, "C": 23, "D": 18, "E": 18}  # the line that is highlighted
CAMERAS = {"A": (-90, 18), "B": (-90, 18), "C": (-90, 25), "D": (15, 62), "E": (-15, 28)}  # degrees
CENTRES = {"A": (2.9, 0, 0.7), "B": (2, -1, 1.1), "C": (0.5, -3.6, 0.6)}  # of the inversions
CENTRES |= {"D": (2.9, 0, 0), "E": (0, 0, 4.8)}
IMAGE_CAMERAS = {"A": (-35, 30), "B": (-75, 50), "C": (-45, 30), "D": (0, 20), "E": (-45, 50)}
# the faces that are enlarged, in columns 1 and 2, 3 and 4
FACES = {"A": (234, 74), "B": (236, 200), "C": (411, 97), "D": (75, 99), "E": (408, 105)}
GOALS = {2: (80 * DEGREE, 45 * DEGREE), 4: (50 * DEGREE, 50 * DEGREE)}
TITLES = {1: "(63.43*, 45*)", 2: "(80*, 45*)", 3: "M\u00f6bius image", 4: "(50*, 50*)"}  # * degrees
# distances, printed for column 4 only and without saying in which unit
PRINTED = {"A4": 1.959, "B4": 0.016, "C4": 38.593, "D4": 3.120, "E4": 9.464}
MARGIN = 1.0  # the surface goes on beyond the start by this much of u and v
WEIGHTS = Weights(fairness=0.001, closeness=0.01)  # faces of very different sizes stay so


@drawn("t")
def draw(around=36, t=45 * DEGREE):
    """The (arccos 1/sqrt 5, 45 degree) net on five surfaces, its images, and optimised nets.

    around: steps of a full turn of u; t: of the conjugate minimal surface, radians.  Column 2
    is column 1 optimised to (80, 45) degrees, column 4 is column 3, the images of column 1
    under inversions, optimised to (50, 50), both on their surfaces.  In each picture one
    u-curve, in column 1 a loxodrome, is highlighted.  Paper: Fig. 9."""
    panels = [[f"{letter}{column}" for column in TITLES] for letter in NAMES]
    figure, axes = plot.canvas(panels, 7.2, 10.4)
    data, nets, claims = {}, [], {}
    for panel, (surface, z) in _starts(around, t).items():
        V, Q = isothermal.sample(surface, z)
        _panel(axes[panel], panel, V, Q, isothermal.curve(surface, z[:, MARKED[panel[0]]], 3))
        if panel[1] == "1":
            nets.append((*conformal.quads(z), *isothermal.ANGLES))
        data[f"net_{panel}"] = V
        claims |= sampled(f"sampled_net_{panel}", V, Q, isothermal.ANGLES)
    glides = optimised(around, t)
    for panel, g in glides.items():
        V = data[f"net_{panel}"] = g.result.V
        _panel(axes[panel], panel, V, g.Q, V[g.rows[:, MARKED[panel[0]]]])
        nets.append((V, g.Q, *g.angles))
        claims[f"{panel}_darts"] = darts(nets[-1:])
    for row in distances(glides):
        claims[f"off_surface_{row.panel}"] = round(row.off, 6)
        claims[f"hausdorff_{row.panel}"] = [round(row.there, 6), round(row.back, 6)]
    return figure, data, nets, claims


class Glide(NamedTuple):
    """A net before (`start`) and after it has glided on its surface (`result.V`)."""

    start: np.ndarray
    Q: np.ndarray  # of both
    rows: np.ndarray  # the vertex numbers, one row a v-curve
    angles: tuple  # the wanted (theta, theta0), radians
    reference: reference.Reference
    result: solver.Result
    diagonal: float  # of the box of the start


class Row(NamedTuple):
    """Distances of one panel, see `distances`."""

    panel: str
    printed: float | None
    off: float
    there: float
    back: float


def optimised(around=36, t=45 * DEGREE):
    """The ten nets of columns 2 and 4 as {panel: `Glide`}, from "A2" and "A4" to "E4".

    around, t: as in `draw`.  On the cylinder, the sphere, the catenoid and their images the
    nets are closed, as long as the patch is one full turn (around=36).  Paper: Fig. 9, Sec. 6."""
    glides = {}
    for start, (surface, z) in _starts(around, t).items():
        column = int(start[1]) + 1
        glides[f"{start[0]}{column}"] = _glide(surface, z, GOALS[column])
    return glides


def _glide(surface, z, angles):
    """The net over the grid z, optimised to the angles on the surface: a `Glide`.

    Where its last column falls on the first the two are glued, and no seam can open."""
    V = surface.point(z.real, z.imag)
    closed = np.allclose(V[:, 0], V[:, -1], rtol=0, atol=1e-9)
    V = V[:, :-1] if closed else V
    rows = np.arange(V[..., 0].size).reshape(V.shape[:2])
    Q = mesh.grid_quads(*np.subtract(z.shape, 1))
    if closed:
        Q = np.hstack([rows, rows[:, :1]]).ravel()[Q]
    V = V.reshape(-1, 3)
    u, v = ((x.min() - MARGIN, x.max() + MARGIN) for x in (z.real, z.imag))
    smooth = reference.parametric(surface.point, u, v)
    options = {"reference": smooth, "on_surface": True, "weights": WEIGHTS, "tolerance": 1e-12}
    result = solver.optimize(V, Q, *angles, **options)
    return Glide(V, Q, rows, angles, smooth, result, np.linalg.norm(np.ptp(V, axis=0)))


def distances(glides):
    """A `Row` for each of the nets of `optimised`, as fractions; noise below 1e-9 counts as 0.

    off: the farthest vertex from the analytic surface; there, back: one-sided Hausdorff
    distances between the optimised net and its start (`measure.hausdorff`), which see how far
    the border has moved too; all over the diagonal of the start's bounding box.
    printed: the paper's number, in a unit that it does not state (E16), or None.  Paper: Fig. 9."""
    rows = []
    for panel, g in glides.items():
        V = g.result.V
        off = np.linalg.norm(g.reference.closest(V)[0] - V, axis=1).max()
        values = np.array([off, *measure.hausdorff(V, g.Q, g.start, g.Q)]) / g.diagonal
        rows.append(Row(panel, PRINTED.get(panel), *np.where(values < 1e-9, 0, values).tolist()))
    return rows


def _starts(around, t):
    """The nets of columns 1 and 3, {panel: (surface, grid of parameters)}."""
    step, starts = 2 * np.pi / around, {}
    found = surfaces.CYLINDER, surfaces.SPHERE, surfaces.CATENOID, surfaces.HELICOID
    for letter, surface in zip(NAMES, (*found, surfaces.conjugate(t)), strict=True):
        z = isothermal.domain(ROWS, COLUMNS, step, step * (LEFT[letter] + 1j * TOP))
        image = moebius.image(moebius.inversion(CENTRES[letter]), surface)
        starts |= {f"{letter}1": (surface, z), f"{letter}3": (image, z)}
    return starts


def _panel(ax, panel, V, Q, curve):
    """A net with its highlighted curve, and below it the parallelogram that is marked."""
    letter, column = panel[0], int(panel[1])
    view = plot.camera(*np.radians((CAMERAS if column < 3 else IMAGE_CAMERAS)[letter]))
    face = FACES[letter][column > 2]
    lines = [*isothermal.lines(V, Q, 0.35), (curve, isothermal.SLANTED, 2)]
    lines.append(patches.outline(V, Q[[face]], width=0.9))
    plot.board(ax, view, V, Q, lines, pixels=480)
    enlarged.draw(enlarged.below(ax, 1.2), V, Q, face, isothermal.FAMILIES, 8)
    plot.panel(ax, f"{letter}_{column}", NAMES[letter] if column == 1 else "")
    if letter == "A":
        title = TITLES[column].replace("*", "\N{DEGREE SIGN}")
        place = {"xycoords": "axes fraction", "textcoords": "offset points", "ha": "center"}
        ax.annotate(title, (0.5, 1), (0, 22), **place)
