"""Fig. 6: the special cases lam = 1, mu = 1, lam = mu and lam = mu = 1."""

import numpy as np

from .. import conformal, measure, parallelogram, plot
from ..plot import DEGREE
from . import drawn, enlarged, patches, sampled

RIGHT = 90 * DEGREE
TITLES = {"A": r"$\lambda=1$", "B": r"$\mu=1$", "C": r"$\lambda=\mu$", "D": r"$\lambda=\mu=1$"}
SHAPES = {"A": "rhombuses", "B": "rectangles", "C": r"$\theta$-parallelograms", "D": "squares"}


@drawn("angle", "azimuth", "elevation")
def draw(angle=60 * DEGREE, cells=10, size=1.5, azimuth=-90 * DEGREE, elevation=20 * DEGREE):
    """Four isogonal nets on a sphere with their black quads, and one parallelogram of each.

    angle: radians, theta in A, theta0 in B, both in C; cells: about how many faces each way;
    size: of the net along u; azimuth, elevation: the camera, radians.  Paper: Fig. 6."""
    figure, axes = plot.canvas([list("ABCD"), list("abcd")], 7.6, 3.9)
    view = plot.camera(azimuth, elevation)
    asked = {"A": (angle, RIGHT), "B": (RIGHT, angle), "C": (angle, angle), "D": (RIGHT, RIGHT)}
    data, nets, claims = {}, [], {}
    for name, target in asked.items():
        lam, mu = parallelogram.ratios(*target)
        z = _domain(target, cells, size)
        domain, Q = conformal.quads(z)
        V = _sphere(z)
        face = np.ravel_multi_index(np.array(z.shape) // 2, np.array(z.shape) - 1)  # in the middle
        lines = [*plot.families(V, Q, {"u": 0.6, "v": 0.6}), patches.outline(V, Q[[face]])]
        plot.board(axes[name], view, V, Q, lines)
        _parallelogram(axes[name.lower()], V, Q, face)
        plot.panel(axes[name], name, TITLES[name])
        plot.text(axes[name.lower()], -0.6j, SHAPES[name], zorder=3, va="top")
        nets.append((domain, Q, *target))
        data |= {f"net_{name}": V, f"domain_{name}": domain}
        claims |= {f"lam_{name}": lam, f"mu_{name}": mu}
        claims |= sampled(f"sampled_net_{name}", V, Q, target)
    flat = view(np.concatenate([data[f"net_{name}"] for name in asked]))[0]
    ends = 1.03 * np.array([flat.min(axis=0), flat.max(axis=0)])
    for name in asked:
        axes[name].set(xlim=ends[:, 0], ylim=ends[:, 1])
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


def _parallelogram(ax, V, Q, face):
    """That of a face: its diagonals, its sides, and both angles as measured, to a degree."""
    corners, colours, centre = enlarged.flat(V, Q, face), plot.COLOURS, np.zeros(2)
    middles = (corners + np.roll(corners, -1, axis=0)) / 2
    corners = (corners - middles.mean(axis=0)) / np.ptp(middles, axis=0).max()
    enlarged.parallelogram(ax, corners, radii=(0.13, 0.1))
    left, low, right, top = (corners + np.roll(corners, -1, axis=0)) / 2
    ends = {"d1": (left, low), "d2": (left, top), "u": (left, right), "v": (low, top)}
    for name, pair in ends.items():
        plot.vector(ax, *pair, colours[name])
    theta, theta0 = (f"${np.degrees(x[face]):.0f}\\degree$" for x in measure.angles(V, Q))
    for start, distance, a, b, text in (
        (left, 0.28, low - left, right, theta),
        (centre, 0.18, right, top, theta0),
        (right, 0.1, right, right, "$X_u$"),
        (top, 0.1, top, top, "$X_v$"),
        ((left + low) / 2, 0.13, low + left, low + left, "$Y_u/2$"),
        ((left + top) / 2, 0.13, top + left, top + left, "$Y_v/2$"),
    ):
        half = a / np.linalg.norm(a) + b / np.linalg.norm(b)  # the way between a and b
        plot.text(ax, start + distance * half / np.linalg.norm(half), text, 8)
    ax.set(xlim=(-0.62, 0.68), ylim=(-0.58, 0.62))
