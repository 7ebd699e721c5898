"""Fig. 6: the special cases lam = 1, mu = 1, lam = mu and lam = mu = 1."""

import numpy as np

from .. import conformal, mesh, parallelogram, plot, publish
from ..plot import DEGREE

TITLES = {"A": r"$\lambda=1$", "B": r"$\mu=1$", "C": r"$\lambda=\mu$", "D": r"$\lambda=\mu=1$"}
SHAPES = {
    "A": "rhombuses",
    "B": "rectangles",
    "C": r"$\theta$-parallelograms",
    "D": "squares",
}


@publish.drawn
def draw(angle=60 * DEGREE, cells=6, size=1.5, azimuth=-90 * DEGREE, elevation=20 * DEGREE):
    """Four isogonal nets on a sphere with their black quads, and one parallelogram of each.

    angle: radians, theta in A, theta0 in B, both in C; cells: about how many faces each way;
    size: of the net along u; azimuth, elevation: the camera, radians.

    Paper: Fig. 6.
    """
    panels = [list("ABCD"), list("abcd")]
    figure, axes = plot.canvas(panels, 7.6, 3.9)
    view = plot.camera(azimuth, elevation)
    right = 90 * DEGREE
    asked = {"A": (angle, right), "B": (right, angle), "C": (angle, angle), "D": (right, right)}
    nets, data, claims = [], {}, {}
    for name, target in asked.items():
        lam, mu = parallelogram.ratios(*target)
        z = _domain(target, cells, size)
        V, Q = _sphere(z), mesh.grid_quads(*np.subtract(z.shape, 1))
        _net(axes[name], view, V, Q)
        abcd(axes[name.lower()], parallelogram.rho(lam, mu), target)
        plot.panel(axes[name], name, TITLES[name])
        axes[name.lower()].text(0, -0.6, SHAPES[name], ha="center", va="top")
        nets.append((*conformal.quads(z), *target))
        data |= {f"net_{name}": V, f"domain_{name}": nets[-1][0]}
        claims |= {f"lam_{name}": round(float(lam), 9), f"mu_{name}": round(float(mu), 9)}
        claims[f"sampled_net_{name}_max_deviation_deg"] = publish.off(V, Q, target)
    flat = view(np.concatenate([data[f"net_{name}"] for name in asked]))[0]
    for name in asked:
        axes[name].update_datalim([flat.min(axis=0), flat.max(axis=0)])
        axes[name].autoscale_view()
    return figure, data, nets, claims


def _domain(target, cells, size):
    """A sheared grid around 0, about as many small faces along u as its size asks for."""
    root = np.sqrt(parallelogram.ratios(*target)[1])
    m, n = round(cells / root), round(cells * root)
    z = conformal.sheared_grid(*target, m, n, edge=size / m)
    return z - z.mean()


def _sphere(z):
    """Points (n, 3) of the unit sphere: Mercator's map backwards, an isothermal net."""
    x, y = np.real(z).ravel(), np.imag(z).ravel()
    return np.stack([np.sin(x) / np.cosh(y), -np.cos(x) / np.cosh(y), np.tanh(y)], axis=1)


def _net(ax, view, V, Q):
    """A net in space: black quads dark, the corners left of its faces light, four a face."""
    points, black, light = plot.cells(V, Q)
    fill = [plot.shade(points, black, plot.DARK, depth=0.3), plot.shade(points, light, depth=0.2)]
    lines = plot.families(V, Q, {"u": 0.9, "v": 0.9})
    plot.scene(ax, view, points, np.concatenate([black, light]), np.concatenate(fill), lines)


def abcd(ax, rho, angles):
    """Diagonals X_u and X_v = rho X_u, sides Y_u / 2 and Y_v / 2, and both angles."""
    corners = np.array([-1, -rho, 1, rho]) / (2 * max(1, abs(rho)))
    left, low, right, top = plot.plane(corners)
    colours = plot.COLOURS
    plot.polygons(ax, corners, [[0, 1, 2, 3]], plot.FILL, zorder=0)
    plot.curves(ax, [[low, right]], colours["d2"], 1.2)
    plot.curves(ax, [[top, right]], colours["d1"], 1.2)
    plot.vector(ax, left, low, colours["d1"])
    plot.vector(ax, left, top, colours["d2"])
    plot.vector(ax, left, right, colours["u"])
    plot.vector(ax, low, top, colours["v"])
    plot.angle(ax, left, low - left, top - left, 0.13)
    plot.angle(ax, np.zeros(2), right, top, 0.1)
    _text(ax, left, 0.28, low - left, right, rf"${angles[0] / DEGREE:.4g}\degree$")
    _text(ax, np.zeros(2), 0.18, right, top, rf"${angles[1] / DEGREE:.4g}\degree$")
    _text(ax, right, 0.1, right, right, "$X_u$")
    _text(ax, top, 0.1, top, top, "$X_v$")
    _text(ax, (left + low) / 2, 0.13, low + left, low + left, "$Y_u/2$")
    _text(ax, (left + top) / 2, 0.13, top + left, top + left, "$Y_v/2$")
    ax.set(xlim=(-0.62, 0.68), ylim=(-0.58, 0.62))


def _text(ax, start, distance, a, b, text):
    """A label at a distance from `start`, half way between the directions a and b."""
    half = a / np.linalg.norm(a) + b / np.linalg.norm(b)
    place = start + distance * half / np.linalg.norm(half)
    ax.text(*place, text, ha="center", va="center", fontsize=8, zorder=6)
