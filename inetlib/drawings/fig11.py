"""Fig. 11: loxodromes and parallels on a surface of revolution, and their isogonal 4-web."""

import numpy as np
from matplotlib.colors import to_rgb

from .. import loxodrome, measure, parallelogram, plot, surfaces
from ..plot import COLOURS, DEGREE
from . import drawn, enlarged, patches, revolution, sampled

STRIP, HALO = "#9db9de", 2.2
TITLES = {"A": "a strip", "B": "the DI-net", "C": "the 4-web", "D": "along $d_1$, $d_2$"}
BOX = [-0.02, 0.1, 1.04, 0.9]  # of the parallelograms in their panels
FACE, OTHER = 12, 28  # of the nets B and D
ANGLES, VIEW = (75 * DEGREE, 60 * DEGREE), (54 * DEGREE, 24 * DEGREE)


@drawn("theta", "theta0", "azimuth", "elevation")
def draw(
    theta=ANGLES[0],
    theta0=ANGLES[1],
    m=36,
    coarse=18,
    profile=None,
    azimuth=VIEW[0],
    elevation=VIEW[1],
):
    """A strip between two loxodromes, the exact DI-net of all strips, its 4-web, another I-net.

    theta, theta0: radians; m, coarse: quads around the axis, in A fewer; profile: a
    `surfaces.Profile`, default the vase; azimuth, elevation: the camera, radians, A at azimuth 0
    (take a negative azimuth for obtuse theta0).  D has edges along d1 and d2: its angles are
    those of a smooth web.  Paper: Fig. 11."""
    profile = profile or surfaces.vase_profile()
    strip, net = (loxodrome.web(profile, theta, theta0, count) for count in (coarse, m))
    V, Q = loxodrome.subnet(net, "d1", "d2")
    figure, axes = plot.canvas([list("ABCD"), list("abcd")], 7.6, 4.9)
    axes["A"].get_gridspec().set_height_ratios([2.3, 1])
    figure.get_layout_engine().set(h_pad=0.08)
    view = plot.camera(azimuth, elevation)
    _strip(axes["A"], view, strip)
    lines = plot.families(net.V, net.Q, {"u": 0.3, "v": 0.3})
    lines.append(patches.outline(net.V, net.Q[[FACE]], width=1.1))
    plot.board(axes["B"], view, net.V, net.Q, lines)
    revolution.web(axes["C"], view, net, width=0.45)
    lines = plot.families(V, Q, {"u": 0.4, "v": 0.4})
    colours = {COLOURS["u"]: COLOURS["d1"], COLOURS["v"]: COLOURS["d2"]}
    lines = [(p, colours[c], w) for p, c, w in lines]
    lines.append(patches.outline(net.V, Q[[OTHER]], width=1.1))
    plot.board(axes["D"], view, net.V, Q, lines)
    _quad(axes["a"], 0.72 * enlarged.flat(net.V, net.Q, 0))
    _directions(axes["c"], theta, theta0)
    other = [float(x.mean()) for x in measure.angles(V, Q)]
    for name, text in TITLES.items():
        plot.panel(axes[name], name, text)
        axes[name].set_anchor("S")
        axes[name.lower()].set(xlim=(-0.95, 1.05), ylim=(-0.8, 0.75))
    enlarged.draw(axes["b"].inset_axes(BOX), net.V, net.Q, FACE)
    enlarged.draw(axes["d"].inset_axes(BOX), V, Q, OTHER, ("u", "v", "d1", "d2"))
    lam, mu = (float(x[0]) for x in measure.ratios(net.V, net.Q))
    quality = measure.quality(net.V, net.Q)
    claims = {"rows": int(net.rows), "lam": lam, "mu": mu}
    claims |= {"flips": quality.flips, "darts": quality.darts}
    claims |= sampled("net_along_d1_and_d2", V, Q, other)
    return figure, {"net": net.V}, [(net.V, net.Q, theta, theta0)], claims


def _strip(ax, view, net):
    """The first strip and two parallels; the corners A, B, C, D of its first quad; theta0."""
    first, up = net.Q[: net.rows], net.rows // 3
    fill = np.tile(to_rgb(plot.PALE), (len(net.Q), 1))
    fill[: net.rows] = to_rgb(STRIP)
    lines = revolution.edges(net.V, first, "u", 0.7) + revolution.edges(net.V, first, "v", 1.8)
    lines += [(net.families.u[row], COLOURS["u"], w) for row, w in ((0, 1.8), (up, 0.9), (-1, 0.9))]
    plot.scene(ax, view, [(net.V, net.Q, fill)], lines)
    places = {"C": (-0.09, 0.06), "A": (-0.05, -0.12), "B": (0.07, -0.12), "D": (0.1, 0.05)}
    corners = view(net.V[net.Q[0]])[0]
    for (name, shift), point in zip(places.items(), corners, strict=True):
        ax.plot(*point, "o", color=plot.INK, ms=2.8, zorder=6)
        plot.text(ax, point + shift, name, halo=HALO, zorder=7)
    _, a, b, d = net.V[net.Q[up]]
    plot.angle(ax, b, b - a, d - b, 0.24, camera=view)
    plot.text(ax, view(b + 0.22 * _between(b - a, d - b))[0], r"$\theta_0$", halo=HALO, zorder=7)


def _between(a, b):
    """The sum of the unit vectors along a and b."""
    return a / np.linalg.norm(a) + b / np.linalg.norm(b)


def _quad(ax, corners):
    """The quad A B D C with its diagonals: the lengths of lam in Eq. (16)."""
    plot.polygons(ax, corners, [[0, 1, 2, 3]], STRIP, zorder=0)
    for family, pairs in revolution.SLOTS.items():
        plot.curves(ax, corners[pairs], COLOURS[family], 1.6)
    for name, point in zip("CABD", corners, strict=True):
        ax.plot(*point, "o", color=plot.INK, ms=3.5, zorder=6)
        place = point + 0.12 * point / np.linalg.norm(point)
        plot.text(ax, place, name, halo=HALO, colour=plot.INK, zorder=7)
    plot.text(ax, -0.72j, r"$\lambda = |AD|\,/\,|BC|$", zorder=3)


def _directions(ax, theta, theta0):
    """The four directions of the web at one point, with their angles to the parallels."""
    alpha, beta = parallelogram.half_angles(*parallelogram.ratios(theta, theta0))
    plot.curves(ax, [[-0.45, 0.6 + 0j]], COLOURS["u"], 1.8)
    plot.text(ax, 0.65 + 0j, "parallel", 8, colour=COLOURS["u"], zorder=3, ha="left")
    turns = {
        "d2": (alpha, r"\alpha"),
        "v": (theta0, r"\theta_0"),
        "d1": (np.pi - beta, r"\pi-\beta"),
    }
    for k, (family, (turn, name)) in enumerate(turns.items()):
        way, colour = np.exp(1j * turn), COLOURS[family]
        plot.curves(ax, [[-0.45 * way, 0.6 * way]], colour, 1.8)
        text, side = f"${name}$ = {np.degrees(turn):.1f}$\\degree$", turn < np.pi / 2
        ha = "left" if side else "center"
        plot.text(ax, 0.65 * way, text, 8, colour=colour, zorder=3, ha=ha, va="bottom")
        plot.angle(ax, np.zeros(2), [1, 0], plot.plane(way), 0.2 + 0.1 * k, colour=colour)
