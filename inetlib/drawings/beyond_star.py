"""Angles at the vertices of isogonal nets: how far off, and how fast they come."""

import numpy as np
from scipy.interpolate import RectBivariateSpline

from .. import conformal, loxodrome, measure, mesh, plot, reference, solver, surfaces
from ..plot import DEGREE
from . import drawn

SIZES = 8, 16, 32, 64
LABELS = ["$z^2$", r"$\exp$", "$1/z$", "sphere, loxodromes", "roof, optimised"]
LOOKS = list(zip("xosD^", [plot.GREY, plot.INK, "#7b2d8b", "#5b7fb5", "#9a5b1f"], strict=True))


def nets(theta=60 * DEGREE, theta0=45 * DEGREE, sizes=SIZES):
    """Nets of m x m quads, or m around the axis: {name: [(V, Q) for m in sizes]}.

    The images of a sheared grid of side 1 under (z + 1.2)^2, exp and 1 / (z + 1.2); the exact
    web on a sphere; an optimised freeform roof of sizes[0] x sizes[0] quads, refined by a
    spline and optimised again.  All have exactly the two angles (radians) in their faces, except
    under 1/z, which has them up to O(m^-2)."""
    maps = {
        "z2": (lambda z: (z + 1.2) ** 2, 0),
        "exp": (np.exp, 1),
        "inverse": (lambda z: 1 / (z + 1.2), 0),
    }
    found = {}
    for name, (f, kappa) in maps.items():
        grids = (conformal.sheared_grid(theta, theta0, m, m, 0, 1 / m, 1, kappa) for m in sizes)
        found[name] = [conformal.quads(f(z)) for z in grids]
    webs = (loxodrome.web(surfaces.sphere_profile(), theta, theta0, m) for m in sizes)
    found["sphere"] = [(web.V, web.Q) for web in webs]
    found["roof"] = refined(theta, theta0, sizes)
    return found


def refined(theta, theta0, sizes=SIZES):
    """An optimised roof and its refinements: [(V, Q) for m in sizes], m x m quads."""
    m = sizes[0]
    V, Q = surfaces.freeform_patch(m, m)
    near = reference.mesh(*surfaces.freeform_patch(64, 64))
    coarse = solver.optimize(V, Q, theta, theta0, reference=near, tolerance=1e-12).V
    at = np.linspace(0, 1, m + 1)
    splines = [RectBivariateSpline(at, at, x) for x in coarse.T.reshape(3, m + 1, m + 1)]
    found = [(coarse, Q)]
    for m in sizes[1:]:
        at = np.linspace(0, 1, m + 1)
        V, Q = np.stack([f(at, at).ravel() for f in splines], axis=1), mesh.grid_quads(m, m)
        options = {"via": "jump", "shape_steps": 0, "tolerance": 1e-12}
        found.append((solver.optimize(V, Q, theta, theta0, **options).V, Q))
    return found


def deviation(V, Q, theta, theta0, unit=False, part=1.0):
    """The largest deviations of the star angles from (theta, theta0), radians, two numbers.

    part: those that this part of the stars stay below instead; unit: see `measure.star_angles`."""
    star = measure.star_angles(V, Q, unit)
    off = np.abs([star.theta - theta, star.theta0 - theta0])
    return np.quantile(off, part, axis=1)


def table(found, theta, theta0, unit=False):
    """{name: (sizes, 2) degrees}: the largest `deviation` of all nets."""
    return {
        name: np.degrees([deviation(*net, theta, theta0, unit) for net in row])
        for name, row in found.items()
    }


@drawn()
def draw(theta=60 * DEGREE, theta0=45 * DEGREE):
    """(A) the chords at a vertex, (B) the largest deviations against the size, in degrees.

    theta, theta0: radians.  Shown is the largest deviation of theta0 over all inner vertices.
    Those of the roof do not converge: next to its corners the smallest change that restores the
    angles of the faces is not smooth.  Full lines: chords over two edges; dotted: unit tangents."""
    figure, axes = plot.canvas([["A", "B"]], 7.4, 3.9, [1, 1.5])
    found = nets(theta, theta0)
    chords, units = (table(found, theta, theta0, unit) for unit in (False, True))
    _star(axes["A"])
    axes["A"].set_anchor("N")
    _slopes(axes["B"], chords, units)
    plot.panel(axes["A"], "A", "the chords at a vertex")
    plot.panel(axes["B"], "B", r"largest deviation of $\theta_0$ at vertices, degrees")
    nets_of = [row for name, row in found.items() if name != "inverse"]
    exact = [(*net, theta, theta0) for row in nets_of for net in row]
    smooth = {name: x for name, x in chords.items() if name not in ("z2", "roof")}
    claims = {f"{name}: order": _order(x) for name, x in smooth.items()}
    claims["z2: largest deviation, degrees"] = chords["z2"].max()
    roof = zip(SIZES, chords["roof"][:, 1], strict=True)
    claims |= {f"roof, m = {m}: largest deviation, degrees": round(x, 4) for m, x in roof}
    data = {f"chords {name}": x for name, x in chords.items()}
    return figure, data | {f"units {name}": x for name, x in units.items()}, exact, claims


def _order(values):
    """The order of theta0, from the two finest nets."""
    last = np.log(values[-2, 1] / values[-1, 1]) / np.log(SIZES[-1] / SIZES[-2])
    return round(float(last), 2)


def _star(ax):
    u, v = np.exp(0.05j), 0.75 * np.exp(0.95j)
    right, up, left, down = 1.15 * u, 1.1 * v - 0.06, -0.85 * u + 0.14j, -v + 0.12
    tips = np.array([right, up, left, down])
    corners = np.array([right + up + 0.1, up + left, left + down, right + down - 0.05j])
    rim = np.stack([tips, corners], axis=1).ravel()
    plot.polygons(ax, rim, [np.arange(8)], "#f0f2f5", plot.GREY, 0.7)
    for (one, other), family in zip(((right, left), (up, down)), "uv", strict=True):
        colour = plot.COLOURS[family]
        plot.curves(ax, [[one, 0j, other]], colour, 1.0)
        plot.curves(ax, [[one, other]], colour, 2.0, (0, (3, 1.5)))
    ax.plot(0, 0, "o", color=plot.INK, ms=4, zorder=6)
    names = {"left": left - 0.2, "right": right + 0.24, "up": up + 0.13j, "down": down - 0.13j}
    for name, z in names.items():
        ax.text(z.real, z.imag, name, ha="center", va="center", size=8)
    ax.margins(0.1)


def _slopes(ax, chords, units):
    ax.set_axis_on()
    ax.set_aspect("auto")
    for name, label, (marker, colour) in zip(chords, LABELS, LOOKS, strict=True):
        look = {"marker": marker, "color": colour, "ms": 4.5, "mfc": "white", "lw": 1.1}
        for values, style in ((chords, "-"), (units, ":")):
            off = values[name][:, 1]
            if off.max() > 1e-9:
                text = label if style == "-" or name == "z2" else None
                ax.loglog(SIZES, off, style, label=text, **look)
    guide = 0.7 * np.array(SIZES, dtype=float) ** -2
    ax.loglog(SIZES, guide, color=plot.GREY, lw=0.9, dashes=(6, 3), label="slope $-2$")
    corner, look = (SIZES[-1], chords["roof"][-1, 1]), {"textcoords": "offset points"}
    ax.annotate("at its corners", corner, (-4, 7), ha="right", **look)
    ax.text(8.2, 6e-4, "full lines: chords\ndotted: unit tangents", size=8)
    ax.set_xticks(SIZES, SIZES)
    ax.minorticks_off()
    ax.set(xlabel="quads on a side, or around the axis, $m$", ylim=(1.2e-4, 9))
    ax.legend(ncols=2, loc="upper right")
