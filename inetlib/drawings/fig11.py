"""Fig. 11: loxodromes and parallels on a surface of revolution, and their isogonal 4-web."""

import numpy as np

from .. import loxodrome, measure, parallelogram, plot, surfaces
from ..plot import COLOURS, DEGREE
from . import drawn, revolution

STRIP, HALO = "#9db9de", 2.2
TITLES = {"A": "a strip of quads", "B": "the DI-net", "C": "the isogonal 4-web"}
ANGLES, VIEW = (75 * DEGREE, 60 * DEGREE), (54 * DEGREE, 24 * DEGREE)


@drawn("theta", "theta0", "azimuth", "elevation")
def draw(theta=ANGLES[0], theta0=ANGLES[1], m=18, profile=None, azimuth=VIEW[0], elevation=VIEW[1]):
    """A strip between two loxodromes, the exact DI-net of all strips, and its 4-web.

    theta, theta0: radians; m: quads around the axis; profile: a `surfaces.Profile`, default
    the vase; azimuth, elevation: the camera, radians, A at azimuth 0 (take a negative
    azimuth for obtuse theta0).  Paper: Fig. 11."""
    net = loxodrome.web(profile or surfaces.vase_profile(), theta, theta0, m)
    figure, axes = plot.canvas([list("ABC"), list("abc")], 7.0, 5.8)
    axes["A"].get_gridspec().set_height_ratios([2.3, 1])
    figure.get_layout_engine().set(h_pad=0.1)
    view = plot.camera(azimuth, elevation)
    _strip(axes["A"], view, net)
    revolution.black_quads(axes["B"], view, net)
    revolution.web(axes["C"], view, net)
    corners = _flat(net.V[net.Q[0]])
    _quad(axes["a"], corners)
    _inside(axes["b"], corners, theta, theta0)
    _directions(axes["c"], theta, theta0)
    for name, text in TITLES.items():
        plot.panel(axes[name], name, text)
        axes[name].set_anchor("S")
        axes[name.lower()].set(xlim=(-0.95, 1.05), ylim=(-0.8, 0.75))
    lam, mu = (float(x[0]) for x in measure.ratios(net.V, net.Q))
    claims = {"rows": int(net.rows), "lam": lam, "mu": mu}
    claims["flips"] = measure.quality(net.V, net.Q).flips
    return figure, {"net": net.V}, [(net.V, net.Q, theta, theta0)], claims


def _strip(ax, view, net):
    """The first strip and two parallels; the corners A, B, C, D of its first quad; theta0."""
    front = revolution.facing(view, net.V, net.Q)
    Q, first = net.Q[front], np.arange(len(net.Q))[front] < net.rows
    fill = plot.shade(net.V, Q, depth=0.2)
    fill[first] = plot.shade(net.V, Q[first], STRIP, depth=0.2)
    lines = revolution.lines(net.V, Q[first], "u", 0.7)
    lines += revolution.lines(net.V, Q[first], "v", 1.8)
    up = net.rows // 3
    for row, width in ((0, 1.8), (up, 0.9)):
        level = Q[Q[:, 1] % (net.rows + 1) == row]
        lines += [(s, COLOURS["u"], width) for s in net.V[level[:, 1:3]]]
    revolution.paint(ax, view, net, (net.V, Q), fill, lines)
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


def _flat(corners):
    """Corners (4, 3) of a quad in the plane of its parallelogram, u to the right, as (4, 2)."""
    d1, d2 = corners[2] - corners[0], corners[3] - corners[1]
    normal, right = np.cross(d1, d2), d1 + d2
    normal, right = normal / np.linalg.norm(normal), right / np.linalg.norm(right)
    flat = (corners - corners.mean(axis=0)) @ np.stack([right, np.cross(normal, right)], axis=1)
    return flat * 0.72 / np.abs(flat).max()


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


def _inside(ax, corners, theta, theta0):
    """Its parallelogram: the angle theta between the sides, theta0 between the diagonals."""
    left, low, right, top = 1.35 * (corners + np.roll(corners, -1, axis=0)) / 2
    plot.polygons(ax, [left, low, right, top], [[0, 1, 2, 3]], plot.DARK, zorder=0)
    plot.curves(ax, [[left, low], [right, top]], COLOURS["d1"], 2)
    plot.curves(ax, [[left, top], [low, right]], COLOURS["d2"], 2)
    plot.curves(ax, [[left, right]], COLOURS["u"], 2)
    plot.curves(ax, [[low, top]], COLOURS["v"], 2)
    plot.angle(ax, left, low - left, top - left, 0.2)
    plot.angle(ax, np.zeros(2), right, top, 0.16)
    one, two = (f"${plot.degrees(angle)}$" for angle in (theta, theta0))
    plot.text(ax, left - np.array([0.05, 0]), one, zorder=3, ha="right")
    plot.text(ax, 0.18 * _between(right, top), two, halo=HALO, zorder=3)
    plot.text(ax, -0.72j, r"sides: $\theta$, diagonals: $\theta_0$", zorder=3)


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
