"""Fig. 8: the parallelogram of two edges and two diagonals, and the I-net made of it."""

import numpy as np

from .. import conformal, parallelogram, plot, surfaces
from ..plot import DEGREE
from . import drawn, enlarged, isothermal, patches, sampled

FACE = 411  # of the net, enlarged


@drawn("azimuth", "elevation")
def draw(around=36, rows=14, azimuth=-80 * DEGREE, elevation=22 * DEGREE):
    """Two neighbouring squares with their parallelogram; an isothermal net with its I-net.

    around: squares of a full turn of the catenoid; rows: of squares; azimuth, elevation: the
    camera, radians.  Paper: Fig. 8."""
    figure, axes = plot.canvas([["A", "B"]], 7.2, 3.9, ratios=[1, 1.1])
    _squares(axes["A"])
    step = 2 * np.pi / around
    z = isothermal.domain(rows, around, step, 1j * step * rows / 2)
    V, Q = isothermal.sample(surfaces.CATENOID, z)
    squares = [(points, plot.GREY, 0.3) for points, _, _ in plot.families(V, Q, {"d1": 0})]
    lines = [*squares, *isothermal.lines(V, Q, 0.7), patches.outline(V, Q[[FACE]])]
    plot.board(axes["B"], plot.camera(azimuth, elevation), V, Q, lines)
    enlarged.draw(enlarged.below(axes["B"], 1, 0.22), V, Q, FACE, isothermal.FAMILIES, 10)
    titles = {"A": "in two squares of the $(u, v)$ plane", "B": "on a catenoid"}
    for name, ax in axes.items():
        ax.set_anchor("N")
        plot.panel(ax, name, titles[name])
    lam, mu = parallelogram.ratios(*isothermal.ANGLES)
    theta, theta0 = np.degrees(isothermal.ANGLES)
    claims = {"lam_squared": lam**2, "mu_squared": mu**2, "theta_deg": theta, "theta0_deg": theta0}
    claims |= sampled("sampled_net", V, Q, isothermal.ANGLES)
    domain, _ = conformal.quads(z)
    return figure, {"net": V, "domain": domain}, [(domain, Q, *isothermal.ANGLES)], claims


def _squares(ax):
    """Two squares of side 1, the quad v1 ... v4 in them, its parallelogram and the angles."""
    corners = np.array([1 + 1j, 1j, 1, 2])
    v1, v2, v3, v4 = corners
    p12, p23, p34, p41 = middles = (corners + np.roll(corners, -1)) / 2
    plot.curves(ax, np.array([[0, 2], [1j, 2 + 1j], [0, 1j], [2, 2 + 1j]]), plot.GREY, 0.9)
    plot.polygons(ax, middles, [[0, 1, 2, 3]], plot.FILL, zorder=0)
    for family, lines, width, style, zorder in (
        ("d1", [[v1, v3]], 0.9, (0, (4, 3)), 2),
        ("d2", [[v2, v4]], 0.9, (0, (4, 3)), 2),
        ("v", [[v2, v3], [v1, v4]], 2.2, "-", 4),  # the colours of parallels and slanted curves
        ("u", [[v1, v2], [v3, v4]], 2.2, "-", 4),
        ("v", [[p12, p34]], 0.9, "-", 2),
        ("u", [[p23, p41]], 0.9, "-", 2),
        ("d1", [[p12, p23], [p34, p41]], 1.8, "-", 3),
        ("d2", [[p12, p41], [p23, p34]], 1.8, "-", 3),
    ):
        plot.curves(ax, lines, plot.COLOURS[family], width, style, zorder)
    flat = plot.plane
    plot.angle(ax, flat(p12), flat(p23 - p12), flat(p41 - p12), 0.13)
    plot.angle(ax, flat(1 + 0.5j), flat(p41 - p23), flat(p34 - p12), 0.3)
    theta, theta0 = np.degrees(isothermal.ANGLES)
    plot.text(ax, 0.608 + 0.785j, rf"${theta:.2f}\degree$", 7, zorder=7)
    plot.text(ax, 1.385 + 0.425j, rf"${theta0:.0f}\degree$", 8, zorder=7)
    for k, place in enumerate((1 + 1.09j, 1.09j, 1 - 0.1j, 2 - 0.1j)):
        plot.text(ax, place, f"$v_{k + 1}$", 10, zorder=7)
    plot.text(ax, 1 - 0.3j, r"$\lambda=\sqrt{5}$,  $\mu=\sqrt{2}$", 10, zorder=7)
    ax.plot(*flat(corners).T, "o", color=plot.INK, ms=3.5, zorder=6)
    ax.set(xlim=(-0.1, 2.1), ylim=(-0.4, 1.2))
