"""Fig. 11: loxodromes and parallels on a surface of revolution, and their isogonal 4-web."""

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.patheffects import withStroke

from .. import loxodrome, measure, parallelogram, plot, publish, surfaces
from ..plot import DEGREE
from . import revolution

STRIP = to_rgb("#9db9de")
HALO = [withStroke(linewidth=2.2, foreground="white")]
TITLES = {"A": "a strip of quads", "B": "the DI-net", "C": "the isogonal 4-web"}


@publish.drawn
def draw(
    theta=75 * DEGREE,
    theta0=60 * DEGREE,
    m=18,
    profile=None,
    azimuth=54 * DEGREE,
    elevation=24 * DEGREE,
):
    """A strip between two loxodromes, the exact DI-net of all strips, and its 4-web.

    theta, theta0: radians; m: quads around the axis; profile: a `surfaces.Profile`, default
    the vase; azimuth, elevation: the camera, radians, A at azimuth 0 (take a negative
    azimuth for obtuse theta0).

    Paper: Fig. 11.
    """
    asked = theta, theta0
    net = loxodrome.web(profile or surfaces.vase_profile(), *asked, m)
    figure, axes = plot.canvas([list("ABC"), list("abc")], 7.0, 5.8)
    axes["A"].get_gridspec().set_height_ratios([2.3, 1])
    figure.get_layout_engine().set(h_pad=0.1)
    view = plot.camera(azimuth, elevation)
    _strip(axes["A"], view, net)
    revolution.black_quads(axes["B"], view, net)
    revolution.web(axes["C"], view, net, ("u", "v", "d1", "d2"))
    corners = _flat(net.V[net.Q[0]])
    _quad(axes["a"], corners)
    _inside(axes["b"], corners, theta, theta0)
    _directions(axes["c"], *asked)
    for name, text in TITLES.items():
        plot.panel(axes[name], name, text)
        axes[name].set_anchor("S")
    lam, mu = measure.ratios(net.V, net.Q)
    claims = {"rows": int(net.rows), "lam": round(float(lam[0]), 9), "mu": round(float(mu[0]), 9)}
    claims |= {"flips": int(measure.quality(net.V, net.Q).flips)}
    return figure, {"net": net.V}, [(net.V, net.Q, *asked)], claims


# --- the surface ----------------------------------------------------------------------------


def _strip(ax, view, net):
    front = revolution.facing(view, net.V, net.Q)
    Q, first = net.Q[front], np.arange(len(net.Q))[front] < net.rows
    fill = plot.shade(net.V, Q, depth=0.2)
    fill[first] = plot.shade(net.V, Q[first], STRIP, depth=0.2)
    lines = revolution.lines(net.V, Q[first], "u", 0.7) + revolution.lines(
        net.V, Q[first], "v", 1.8
    )
    for row, width in ((0, 1.8), (net.rows // 3, 0.9)):
        level = Q[Q[:, 1] % (net.rows + 1) == row]
        lines += [(s, plot.COLOURS["u"], width) for s in net.V[level[:, 1:3]]]
    revolution.paint(ax, view, net, (net.V, Q), fill, lines)
    _mark(ax, view, net)


def _mark(ax, view, net):
    """The corners A, B, C, D of the first quad, and theta0 further up the strip."""
    places = {"C": (-0.09, 0.06), "A": (-0.05, -0.12), "B": (0.07, -0.12), "D": (0.1, 0.05)}
    corners = view(net.V[net.Q[0]])[0]
    for (name, shift), point in zip(places.items(), corners, strict=True):
        ax.plot(*point, "o", color=plot.INK, ms=2.8, zorder=6)
        ax.text(*(point + shift), name, ha="center", va="center", path_effects=HALO, zorder=7)
    row = net.rows // 3
    _, a, b, d = net.V[net.Q[row]]
    plot.angle(ax, b, b - a, d - b, 0.24, camera=view)
    half = (b - a) / np.linalg.norm(b - a) + (d - b) / np.linalg.norm(d - b)
    place = view(b + 0.22 * half)[0]
    ax.text(*place, r"$\theta_0$", ha="center", va="center", path_effects=HALO, zorder=7)


# --- the first quad, seen along its normal ------------------------------------------------


def _flat(corners):
    """Corners (4, 3) of a quad in the plane of its parallelogram, u to the right, as (4, 2)."""
    d1, d2 = corners[2] - corners[0], corners[3] - corners[1]
    normal, right = np.cross(d1, d2), d1 + d2
    normal, right = normal / np.linalg.norm(normal), right / np.linalg.norm(right)
    flat = (corners - corners.mean(axis=0)) @ np.stack([right, np.cross(normal, right)], axis=1)
    return flat * 0.72 / np.abs(flat).max()


def _label(ax, point, text, away, colour=plot.INK, gap=0.12):
    place = point + gap * away / np.linalg.norm(away)
    ax.text(*place, text, color=colour, ha="center", va="center", path_effects=HALO, zorder=7)


def _quad(ax, corners):
    """The quad A B D C with its diagonals: the lengths of lam in Eq. (16)."""
    c = plot.COLOURS
    plot.polygons(ax, corners, [[0, 1, 2, 3]], STRIP, zorder=0)
    plot.curves(ax, corners[[[1, 2], [0, 3]]], c["u"], 1.6)
    plot.curves(ax, corners[[[1, 0], [2, 3]]], c["v"], 1.6)
    plot.curves(ax, corners[[[0, 2]]], c["d1"], 1.6)
    plot.curves(ax, corners[[[1, 3]]], c["d2"], 1.6)
    for name, point in zip("CABD", corners, strict=True):
        ax.plot(*point, "o", color=plot.INK, ms=3.5, zorder=6)
        _label(ax, point, name, point)
    text = r"$\lambda = |AD|\,/\,|BC|$"
    ax.text(0, -0.72, text, ha="center", va="center")
    _frame(ax)


def _inside(ax, corners, theta, theta0):
    """Its parallelogram: the angle theta between the sides, theta0 between the diagonals."""
    c, middle = plot.COLOURS, (corners + np.roll(corners, -1, axis=0)) / 2
    left, low, right, top = 1.35 * middle
    plot.polygons(ax, [left, low, right, top], [[0, 1, 2, 3]], plot.DARK, zorder=0)
    plot.curves(ax, [[left, low], [right, top]], c["d1"], 2)
    plot.curves(ax, [[left, top], [low, right]], c["d2"], 2)
    plot.curves(ax, [[left, right]], c["u"], 2)
    plot.curves(ax, [[low, top]], c["v"], 2)
    plot.angle(ax, left, low - left, top - left, 0.2)
    plot.angle(ax, np.zeros(2), right, top, 0.16)
    ax.text(left[0] - 0.05, left[1], rf"${theta / DEGREE:.4g}\degree$", ha="right", va="center")
    half = right / np.linalg.norm(right) + top / np.linalg.norm(top)
    ax.text(
        *(0.18 * half),
        rf"${theta0 / DEGREE:.4g}\degree$",
        ha="center",
        va="center",
        path_effects=HALO,
    )
    text = r"sides: $\theta$, diagonals: $\theta_0$"
    ax.text(0, -0.72, text, ha="center", va="center")
    _frame(ax)


def _directions(ax, theta, theta0):
    """The four directions of the web at one point, with their angles to the parallels."""
    alpha, beta = parallelogram.half_angles(*parallelogram.ratios(theta, theta0))
    turns = {"u": 0, "d2": alpha, "v": theta0, "d1": np.pi - beta}
    names = {"u": "parallel", "d2": r"$\alpha$", "v": r"$\theta_0$", "d1": r"$\pi-\beta$"}
    for k, (name, turn) in enumerate(turns.items()):
        way = np.array([np.cos(turn), np.sin(turn)])
        plot.curves(ax, [[-0.45 * way, 0.6 * way]], plot.COLOURS[name], 1.8)
        text = f"{names[name]} = {np.degrees(turn):.1f}" + r"$\degree$" if turn else "parallel"
        ends = {
            "ha": "left" if turn < np.pi / 2 else "center",
            "va": "bottom" if turn else "center",
        }
        ax.text(*(0.65 * way), text, color=plot.COLOURS[name], fontsize=8, **ends)
        if turn:
            plot.angle(ax, np.zeros(2), [1, 0], way, 0.1 + 0.1 * k, colour=plot.COLOURS[name])
    _frame(ax)


def _frame(ax):
    ax.set(xlim=(-0.95, 1.05), ylim=(-0.8, 0.75))
