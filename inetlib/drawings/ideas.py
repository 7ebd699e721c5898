"""Small figures of the key ideas, made to be moved by a slider: see `inetlib.sliders`."""

import numpy as np
from matplotlib.ticker import NullLocator

from .. import conformal, developable, loxodrome, measure, parallelogram, plot, surfaces
from ..plot import COLOURS, DEGREE
from . import isothermal

SIZES = 8, 16, 32, 64  # of nets whose deviations are drawn


def star(theta=70 * DEGREE, theta0=55 * DEGREE):
    """A parallelogram, and its place in the map of all pairs (lam, mu)."""
    lam, mu = parallelogram.ratios(theta, theta0)
    figure, axes = plot.canvas([["map", "shape"]], 6.4, 3)
    ax, ratios = axes["map"], np.exp(np.linspace(-2.4, 2.4, 241))
    low, high = np.transpose([parallelogram.lam_range(x) for x in ratios])
    ax.set(aspect="auto", xscale="log", yscale="log", xlim=(0.1, 10), ylim=(0.1, 10))
    ax.set_axis_on()
    ax.fill_betweenx(ratios, np.maximum(low, 0.01), np.minimum(high, 100), color=plot.FILL, lw=0)
    ax.plot(lam, mu, "o", color=COLOURS["v"], ms=8)
    ticks = [0.1, 0.3, 1, 3, 10]
    ax.set_xticks(ticks, map(str, ticks))
    ax.set_yticks(ticks, map(str, ticks))
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_minor_locator(NullLocator())
    ax.set(xlabel=r"$\lambda$", ylabel=r"$\mu$")
    plot.panel(ax, "A", rf"$\lambda={lam:.3f}$, $\mu={mu:.3f}$")
    _parallelogram(axes["shape"], theta, theta0)
    plot.panel(axes["shape"], "B", f"${plot.degrees(theta, theta0)}$")
    return figure


def _parallelogram(ax, theta, theta0):
    """The parallelogram of these angles with its diagonals, and both angles."""
    rho = parallelogram.rho(*parallelogram.ratios(theta, theta0))
    corners = np.array([-1, -rho, 1, rho]) / (2 * max(1, abs(rho)))
    left, low, right, top = flat = plot.plane(corners)
    plot.polygons(ax, flat, [[0, 1, 2, 3]], plot.FILL)
    for name, pairs in {
        "d1": [[left, low], [right, top]],
        "d2": [[left, top], [low, right]],
        "u": [[left, right]],
        "v": [[low, top]],
    }.items():
        plot.curves(ax, pairs, COLOURS[name], 2)
    plot.angle(ax, left, low - left, top - left, 0.12, r"$\theta$")
    plot.angle(ax, np.zeros(2), right, top, 0.1, r"$\theta_0$")
    ax.set(xlim=(-0.62, 0.62), ylim=(-0.62, 0.62))


def half_plane(theta=60 * DEGREE, theta0=50 * DEGREE):
    """The number rho = X_v / X_u in the half plane, and the four directions at a point."""
    rho = parallelogram.rho(*parallelogram.ratios(theta, theta0))
    figure, axes = plot.canvas([["rho", "web"]], 6.4, 2.9)
    ax, far = axes["rho"], max(1.6, 1.15 * abs(rho))
    plot.curves(ax, [[-far, far + 0j]], plot.INK, 1)
    circle = np.exp(1j * np.linspace(0, np.pi, 91))
    plot.curves(ax, [circle], plot.GREY, 0.8, (0, (4, 3)))
    plot.curves(ax, [[0j, rho]], COLOURS["v"], 2)
    for end, name in ((1, "d1"), (-1, "d2")):
        plot.curves(ax, [[end + 0j, rho]], COLOURS[name], 1.2)
    for place, words in ((rho, r"$\rho$"), (-1, "$-1$"), (0, "$0$"), (1, "$1$")):
        ax.plot(*plot.plane(np.complex128(place)), "o", color=plot.INK, ms=4, zorder=6)
        below = 0.07j * far * (1.6 if place == rho else -1.6)
        plot.text(ax, place + below, words)
    plot.panel(ax, "A", rf"$\rho = {rho.real:.3f} + {rho.imag:.3f}\,i$")
    ax.set(xlim=(-far, far), ylim=(-0.3 * far, 1.2 * far))
    ways = {"u": 1 + 0j, "v": rho, "d2": 1 + rho, "d1": 1 - rho}
    for name, way in ways.items():
        way = way / abs(way)
        plot.curves(axes["web"], [[-way, way]], COLOURS[name], 2)
    plot.panel(axes["web"], "B", f"${plot.degrees(theta, theta0)}$")
    axes["web"].set(xlim=(-1.2, 1.2), ylim=(-1.1, 1.1))
    return figure


def mercator(theta=75 * DEGREE, theta0=60 * DEGREE, m=18):
    """A sheared grid in Mercator's map, and the web on the sphere that it is a map of.

    m: quads around the axis."""
    profile = surfaces.sphere_profile()
    net = loxodrome.web(profile, theta, theta0, m, method="smooth")
    figure, axes = plot.canvas([["map", "sphere"]], 6.4, 2.9, ratios=[1.3, 1])
    ax, height = axes["map"], surfaces.mercator(profile)[0](net.t)
    turns = 2 * np.pi * np.arange(-m, 2 * m + 1) / m
    plot.curves(ax, [[-np.pi + 1j * y, np.pi + 1j * y] for y in height], COLOURS["u"], 0.8)
    slope = height / np.tan(theta0)
    lines = [turn - slope[0] + slope + 1j * height for turn in turns]
    plot.curves(ax, lines, COLOURS["v"], 0.8)
    ax.set(xlim=(-np.pi, np.pi), ylim=(height[0] - 0.1, height[-1] + 0.1))
    plot.panel(ax, "A", "a sheared grid in Mercator's map")
    lines = plot.families(net.V, net.Q, {"d1": 0.6, "d2": 0.6, "v": 1, "u": 1})
    view = plot.camera(-60 * DEGREE, 18 * DEGREE)
    plot.scene(axes["sphere"], view, [(net.V, net.Q, plot.PALE)], lines, pixels=600)
    plot.panel(axes["sphere"], "B", f"${plot.degrees(theta, theta0)}$")
    return figure


def refinement(m=16):
    """A sampled net on a catenoid with m quads around, and how far its angles are off."""
    figure, axes = plot.canvas([["net", "off"]], 6.4, 2.9)
    off = {size: _deviation(*_catenoid(size)) for size in sorted({*SIZES, m})}
    V, Q = _catenoid(m)
    view = plot.camera(-80 * DEGREE, 22 * DEGREE)
    plot.board(axes["net"], view, V, Q, isothermal.lines(V, Q, 0.6), pixels=600)
    plot.panel(axes["net"], "A", f"{m} quads around")
    ax = axes["off"]
    ax.set(aspect="auto", xlabel="quads around", ylabel="degrees off")
    ax.set_axis_on()
    ax.loglog(list(off), list(off.values()), "-", color=plot.GREY)
    ax.loglog(m, off[m], "o", color=COLOURS["v"], ms=8)
    ax.set_xticks(SIZES, map(str, SIZES))
    ax.xaxis.set_minor_locator(NullLocator())
    plot.panel(ax, "B", f"{off[m]:.3f} degrees")
    return figure


def _catenoid(m):
    step, rows = 2 * np.pi / m, max(2, round(0.4 * m))
    z = isothermal.domain(rows, m, step, 0.5j * rows * step)
    return isothermal.sample(surfaces.CATENOID, z)


def _deviation(V, Q):
    return float(np.degrees(measure.deviations(V, Q, *isothermal.ANGLES).max()))


def bending(curvature=0.5, theta=60 * DEGREE, theta0=45 * DEGREE):
    """A net of the plane rolled up; curvature 1 closes the cylinder."""
    z = conformal.sheared_grid(theta, theta0, 10, 10, edge=2 * np.pi / 10)
    z = z - z.mean()
    domain, Q = conformal.quads(z)
    V = developable.roll(domain[:, 0] + 1j * domain[:, 1], curvature)[:, [0, 2, 1]]
    figure, axes = plot.canvas([["net"]], 4.4, 3.2)
    view = plot.camera(-70 * DEGREE, 20 * DEGREE)
    plot.board(axes["net"], view, V, Q, plot.families(V, Q, {"u": 0.8, "v": 0.8}), pixels=700)
    off = measure.deviations(V, Q, theta, theta0).max()
    plot.panel(
        axes["net"], "", f"curvature {curvature:.2f}, chords {np.degrees(off):.2f} degrees off"
    )
    return figure
