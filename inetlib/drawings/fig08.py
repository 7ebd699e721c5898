"""Fig. 8: the parallelogram of two edges and two diagonals, and the I-net made of it."""

import numpy as np

from .. import parallelogram, plot, publish, surfaces
from ..plot import DEGREE
from . import isothermal


@publish.drawn
def draw(around=20, rows=8, azimuth=-80 * DEGREE, elevation=20 * DEGREE):
    """Two neighbouring squares with their parallelogram; an isothermal net with its I-net.

    around: squares of a full turn of the catenoid; rows: of squares; azimuth, elevation: the
    camera, radians.

    Paper: Fig. 8.
    """
    figure, axes = plot.canvas([["A", "B"]], 7.2, 3.3, ratios=[1, 1.1])
    _squares(axes["A"])
    step = 2 * np.pi / around
    z = isothermal.domain(rows, around, step, 1j * step * rows / 2)
    V, Q = isothermal.sample(surfaces.CATENOID, z)
    _surface(axes["B"], plot.camera(azimuth, elevation), V, Q)
    for ax in axes.values():
        ax.set_anchor("N")
    plot.panel(axes["A"], "A", "in two squares of the $(u, v)$ plane")
    plot.panel(axes["B"], "B", "on a catenoid")
    lam, mu = parallelogram.ratios(*isothermal.ANGLES)
    claims = {
        "lam_squared": round(float(lam**2), 9),
        "mu_squared": round(float(mu**2), 9),
        "theta_deg": round(float(np.degrees(isothermal.ANGLES[0])), 9),
        "theta0_deg": round(float(np.degrees(isothermal.ANGLES[1])), 9),
    }
    claims["sampled_net_max_deviation_deg"] = publish.off(V, Q, isothermal.ANGLES)
    flat = np.stack([z.real.ravel(), z.imag.ravel(), 0 * z.real.ravel()], axis=1)
    return figure, {"net": V, "domain": flat}, [(flat, Q, *isothermal.ANGLES)], claims


def _squares(ax):
    """Two squares of side 1, the quad v1 ... v4 in them, its parallelogram and the angles."""
    corners = np.array([1 + 1j, 1j, 1, 2])
    v1, v2, v3, v4 = corners
    p12, p23, p34, p41 = middles = (corners + np.roll(corners, -1)) / 2
    colours = plot.COLOURS
    plot.curves(ax, np.array([[0, 2], [1j, 2 + 1j], [0, 1j], [2, 2 + 1j]]), plot.GREY, 0.9)
    plot.polygons(ax, middles, [[0, 1, 2, 3]], plot.FILL, zorder=0)
    plot.curves(ax, [[v1, v3]], colours["d1"], 0.9, (0, (4, 3)))
    plot.curves(ax, [[v2, v4]], colours["d2"], 0.9, (0, (4, 3)))
    plot.curves(ax, [[v2, v3], [v1, v4]], colours["u"], 2.2, zorder=4)
    plot.curves(ax, [[v1, v2], [v3, v4]], colours["v"], 2.2, zorder=4)
    plot.curves(ax, [[p12, p34]], colours["u"], 0.9)
    plot.curves(ax, [[p23, p41]], colours["v"], 0.9)
    plot.curves(ax, [[p12, p23], [p34, p41]], colours["d1"], 1.8, zorder=3)
    plot.curves(ax, [[p12, p41], [p23, p34]], colours["d2"], 1.8, zorder=3)
    flat = plot.plane
    plot.angle(ax, flat(p12), flat(p23 - p12), flat(p41 - p12), 0.13)
    plot.angle(ax, flat(1 + 0.5j), flat(p41 - p23), flat(p34 - p12), 0.3)
    theta, theta0 = np.degrees(isothermal.ANGLES)
    _text(ax, 0.608 + 0.785j, rf"${theta:.2f}\degree$", 7)
    _text(ax, 1.385 + 0.425j, rf"${theta0:.0f}\degree$")
    for place, k in ((1 + 1.09j, 1), (1.09j, 2), (1 - 0.1j, 3), (2 - 0.1j, 4)):
        _text(ax, place, f"$v_{k}$", 10)
    _text(ax, 1 - 0.3j, r"$\lambda=\sqrt{5}$,  $\mu=\sqrt{2}$", 10)
    ax.plot(*flat(corners).T, "o", color=plot.INK, ms=3.5, zorder=6)
    ax.set(xlim=(-0.1, 2.1), ylim=(-0.4, 1.2))


def _text(ax, place, text, size=8):
    ax.text(place.real, place.imag, text, ha="center", va="center", fontsize=size, zorder=7)


def _surface(ax, view, V, Q):
    """The net with its parallelograms dark, the squares' other edges thin and grey."""
    points, black, light = plot.cells(V, Q)
    dark = plot.shade(points, black, plot.DARK, depth=0.3)
    fill = np.concatenate([dark, plot.shade(points, light, depth=0.2)])
    lines = plot.families(V, Q, {"d1": 0.5, "v": 1.0, "u": 1.0})
    lines = [(p, plot.GREY if w == 0.5 else c, w) for p, c, w in lines]
    plot.scene(ax, view, points, np.concatenate([black, light]), fill, lines)
