"""Fig. 1: the parts of a parallelogram, and its two similar triangles when theta0 = theta.

Paper: Fig. 1.
"""

import numpy as np

from .. import parallelogram, plot, publish
from ..plot import DEGREE
from .abcd import angle_at, beside, corners, frame, net, text_at

SHADES = "#a9bfdd", "#f3d3c0"  # of the triangles ABD and ODC


@publish.drawn
def draw(theta=70 * DEGREE, theta0=55 * DEGREE, equal=60 * DEGREE):
    """A (theta, theta0)-parallelogram, a theta-parallelogram, and its two similar triangles.

    theta, theta0: angles of the first one, equal: both angles of the second one; radians in
    (0, pi), else ValueError.  All panels have a = |BC| = 1 and one scale.

    Paper: Fig. 1.
    """
    general, special = corners(theta, theta0), corners(equal, equal)
    pair = _same_pose(special)
    axes, figure = _layout([general, special, np.concatenate(pair)])
    _general(axes["left"], general)
    _special(axes["middle"], special)
    _similar(axes["right"], *pair)
    one, two, both = (f"{angle / DEGREE:.4g}\\degree" for angle in (theta, theta0, equal))
    axes["left"].set_title(rf"$\theta={one}$,  $\theta_0={two}$")
    axes["middle"].set_title(rf"$\theta=\theta_0={both}$")
    axes["right"].set_title(r"$a : b : q \,=\, p/2 : q/2 : b$")
    lam, mu = (round(float(x), 9) for x in parallelogram.ratios(theta, theta0))
    return (
        figure,
        {"general": general, "special": special, "same_pose": np.stack(pair)},
        [net(general, theta, theta0), net(special, equal, equal)],
        {"lam": lam, "mu": mu} | _proportion(special),
    )


def _layout(shapes):
    """Three panels of one scale, 7 inches wide."""
    widths = [np.ptp(z.real) + 0.44 for z in shapes]
    height = max(np.ptp(z.imag) for z in shapes) + 0.42
    figure, axes = plot.canvas(
        [["left", "middle", "right"]], 7, 6.8 / sum(widths) * height + 0.22, widths
    )
    for ax, z, width in zip(axes.values(), shapes, widths, strict=True):
        left = (z.real.min() + z.real.max() - width) / 2
        ax.set(xlim=(left, left + width), ylim=(-0.22, height - 0.22), autoscale_on=False)
    return axes, figure


def _same_pose(special):
    """Triangle ABD, and ODC turned over into the same pose: two complex arrays (3,)."""
    big = special[[0, 1, 3]]
    return big, big / np.sqrt(2) + 1.05


def _proportion(special):
    """The quotients of corresponding sides of ABD and ODC, as claims."""
    A, B, C, D = special
    middle = (A + C) / 2
    pairs = {"b/(q/2)": (A - B, middle - D), "q/b": (B - D, D - C), "a/(p/2)": (D - A, C - middle)}
    return {name: round(float(abs(x) / abs(y)), 9) for name, (x, y) in pairs.items()}


def _general(ax, shape):
    """The names of everything: corners, sides, half diagonals, angles."""
    A, B, C, D = shape
    middle, unit = (A + C) / 2, min(1, abs(A - B))
    plot.polygons(ax, shape, [[0, 1, 2, 3]], plot.PALE)
    frame(ax, shape)
    angle_at(ax, B, C - B, A - B, 0.56 * unit)
    angle_at(ax, B, C - B, D - B, 0.26 * unit, r"$\beta$")
    angle_at(ax, B, D - B, A - B, 0.33 * unit, r"$\alpha$")
    text_at(ax, B + (0.56 * unit + 0.1) * np.exp(0.45j * np.angle(D - B)), r"$\theta$", 10)
    angle_at(ax, middle, D - middle, A - middle, 0.2 * unit, r"$\theta_0$", 0.14, 10)
    _names(ax, shape, middle)


def _special(ax, shape):
    """The triangles ABD and ODC, their common angle alpha, and theta twice."""
    A, B, C, D = shape
    middle, unit = (A + C) / 2, min(1, abs(A - B))
    plot.polygons(ax, shape, [[0, 1, 2, 3]], plot.PALE)
    plot.polygons(ax, np.array([A, B, D, middle, D, C]), [[0, 1, 2], [3, 4, 5]], list(SHADES))
    frame(ax, shape)
    angle_at(ax, B, C - B, A - B, 0.2 * unit)
    text_at(ax, B + (0.2 * unit + 0.1) * np.exp(0.45j * np.angle(D - B)), r"$\theta$", 10)
    angle_at(ax, B, D - B, A - B, 0.42 * unit, r"$\alpha$")
    angle_at(ax, D, B - D, C - D, 0.42 * unit, r"$\alpha$")
    angle_at(ax, middle, D - middle, A - middle, 0.2 * unit, r"$\theta$", 0.12, 10)
    _names(ax, shape, middle)


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
            text_at(ax, here + 0.1 * _unit(here - triangle.mean()), f"${names[k]}$")
            beside(ax, here, after, sides[k])


def _names(ax, shape, middle):
    """Corners and O in capitals; a, b and the halves of the diagonals, each beside its segment."""
    A, B, C, D = shape
    for point, name in zip(shape, "ABCD", strict=True):
        text_at(ax, point + 0.11 * _unit(point - middle), f"${name}$")
    text_at(ax, middle + 0.12 * _unit(_unit(A - middle) + _unit(B - middle)), "$O$")
    beside(ax, B, C, "a")
    beside(ax, A, B, "b")
    beside(ax, C, middle, "p/2", 0.66)
    beside(ax, D, middle, "q/2", 0.43)


def _unit(z):
    return z / abs(z)
