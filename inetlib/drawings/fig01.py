"""Fig. 1: the parts of a parallelogram, and its two similar triangles when theta0 = theta."""

import numpy as np

from .. import parallelogram, plot
from ..plot import DEGREE
from . import drawn
from .abcd import angle_at, beside, corners, frame, net

SHADES = "#a9bfdd", "#f3d3c0"  # of the triangles ABD and ODC


@drawn()
def draw(theta=70 * DEGREE, theta0=55 * DEGREE, equal=60 * DEGREE):
    """A (theta, theta0)-parallelogram, a theta-parallelogram, and its two similar triangles.

    theta, theta0: angles of the first one, equal: both angles of the second one; radians in
    (0, pi), else ValueError.  All panels have a = |BC| = 1 and one scale.

    Paper: Fig. 1."""
    general, special = corners(theta, theta0), corners(equal, equal)
    pair = special[[0, 1, 3]], special[[0, 1, 3]] / np.sqrt(2) + 1.05  # ODC, turned over
    figure, axes = _layout([general, special, np.concatenate(pair)])
    for name, shape in (("left", general), ("middle", special)):
        _named(axes[name], shape, shape is special)
    _similar(axes["right"], *pair)
    one, two, both = (plot.degrees(angle) for angle in (theta, theta0, equal))
    axes["left"].set_title(rf"$\theta={one}$,  $\theta_0={two}$")
    axes["middle"].set_title(rf"$\theta=\theta_0={both}$")
    axes["right"].set_title(r"$a : b : q \,=\, p/2 : q/2 : b$")
    data = {"general": general, "special": special, "same_pose": np.stack(pair)}
    nets = [net(general, theta, theta0), net(special, equal, equal)]
    lam, mu = parallelogram.ratios(theta, theta0)
    return figure, data, nets, {"lam": lam, "mu": mu} | _proportion(special)


def _layout(shapes):
    """Three panels of one scale, 7 inches wide."""
    widths = [np.ptp(z.real) + 0.44 for z in shapes]
    high = max(np.ptp(z.imag) for z in shapes) + 0.42
    panels = [["left", "middle", "right"]]
    figure, axes = plot.canvas(panels, 7, 6.8 / sum(widths) * high + 0.22, widths)
    for ax, z, width in zip(axes.values(), shapes, widths, strict=True):
        left = (z.real.min() + z.real.max() - width) / 2
        ax.set(xlim=(left, left + width), ylim=(-0.22, high - 0.22), autoscale_on=False)
    return figure, axes


def _proportion(special):
    """The quotients of corresponding sides of ABD and ODC, as claims."""
    A, B, C, D = special
    middle = (A + C) / 2
    pairs = {"b/(q/2)": (A - B, middle - D), "q/b": (B - D, D - C), "a/(p/2)": (D - A, C - middle)}
    return {name: abs(x) / abs(y) for name, (x, y) in pairs.items()}


def _named(ax, shape, equal):
    """Corners, sides, half diagonals, angles; with equal angles the triangles ABD and ODC too."""
    A, B, C, D = shape
    middle, unit = (A + C) / 2, min(1, abs(A - B))
    frame(ax, shape)
    radius, half = (0.2 if equal else 0.56) * unit, np.exp(0.45j * np.angle(D - B))
    angle_at(ax, B, C - B, A - B, radius)
    if not equal:
        angle_at(ax, B, C - B, D - B, 0.26 * unit, r"$\beta$")
        angle_at(ax, B, D - B, A - B, 0.33 * unit, r"$\alpha$")
    plot.text(ax, B + (radius + 0.1) * half, r"$\theta$", 10)
    if equal:
        plot.polygons(ax, np.array([A, B, D, middle, D, C]), [[0, 1, 2], [3, 4, 5]], list(SHADES))
        angle_at(ax, B, D - B, A - B, 0.42 * unit, r"$\alpha$")
        angle_at(ax, D, B - D, C - D, 0.42 * unit, r"$\alpha$")
    name, gap = (r"$\theta$", 0.12) if equal else (r"$\theta_0$", 0.14)
    angle_at(ax, middle, D - middle, A - middle, 0.2 * unit, name, gap, 10)
    for point, corner in zip(shape, "ABCD", strict=True):
        plot.text(ax, point + 0.11 * _unit(point - middle), f"${corner}$", 9)
    plot.text(ax, middle + 0.12 * _unit(_unit(A - middle) + _unit(B - middle)), "$O$", 9)
    for start, end, side, at in ((B, C, "a", 0.5), (A, B, "b", 0.5), (C, middle, "p/2", 0.66)):
        beside(ax, start, end, side, at)
    beside(ax, D, middle, "q/2", 0.43)


def _similar(ax, big, small):
    """Both triangles in one pose: equal angles, corresponding sides one under the other."""
    rows = [
        (big, SHADES[0], "ABD", ("b", "q", "a"), ("d2", "u", "d1")),
        (small, SHADES[1], "ODC", ("q/2", "b", "p/2"), ("u", "d2", "v")),
    ]
    angles = [(r"$\pi-\theta$", 0.13, 0.11), (r"$\alpha$", 0.24, 0.1), (r"$\beta$", 0.2, 0.1)]
    for triangle, shade, names, sides, colours in rows:
        plot.polygons(ax, triangle, [[0, 1, 2]], shade)
        for k, (label, radius, gap) in enumerate(angles):
            before, here, after = triangle[k - 1], triangle[k], triangle[(k + 1) % 3]
            plot.curves(ax, [[here, after]], plot.COLOURS[colours[k]], 1.8, zorder=4)
            angle_at(ax, here, after - here, before - here, radius, label, gap, 8)
            plot.text(ax, here + 0.1 * _unit(here - triangle.mean()), f"${names[k]}$", 9)
            beside(ax, here, after, sides[k])


def _unit(z):
    return z / abs(z)
