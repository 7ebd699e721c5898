"""Fig. 2: what the reciprocals of the two ratios do to a parallelogram; three theta ones."""

import numpy as np

from .. import parallelogram, plot
from ..plot import DEGREE
from . import drawn
from .abcd import angle_at, beside, corners, frame, net

RATIOS = r"\lambda,\,\mu", r"1/\lambda,\,\mu", r"\lambda,\,1/\mu", r"1/\lambda,\,1/\mu"
SURDS = {60: r"(1+\sqrt{5})/2", 45: r"(\sqrt{2}+\sqrt{6})/2", 30: r"(\sqrt{3}+\sqrt{7})/2"}


@drawn()
def draw(theta=65 * DEGREE, theta0=70 * DEGREE, equal=(60 * DEGREE, 45 * DEGREE, 30 * DEGREE)):
    """Four parallelograms (A-D) with reciprocal ratios, and three theta-parallelograms (E-G).

    theta, theta0: angles of (A); (B) has the ratios (1/lam, mu), (C) (lam, 1/mu) and (D) both
    reciprocals.  equal: the angles of (E), (F), (G).  Radians in (0, pi), else ValueError.
    All have the side a = 1 and one scale.  Paper: Fig. 2."""
    angles = [(a, b) for a in (theta, np.pi - theta) for b in (theta0, np.pi - theta0)]
    angles += [(angle, angle) for angle in equal]
    texts = [f"$({ratios})$" for ratios in RATIOS] + [_equal_ratio(angle) for angle in equal]
    shapes = dict(zip("ABCDEFG", (corners(*pair) for pair in angles), strict=True))
    figure, ax, origins, top = _layout(list(shapes.values()))
    for k, (letter, shape) in enumerate(shapes.items()):
        left = shape.real.min() + origins[k].real
        ax.text(left, top[k], rf"$\mathbf{{{letter}}}$  {texts[k]}", size=10, va="bottom")
        _one(ax, shape + origins[k], *angles[k], r"1/\lambda" if k in (1, 3) else r"\lambda")
    nets = [net(shape, *pair) for shape, pair in zip(shapes.values(), angles, strict=True)]
    ratios = np.transpose(parallelogram.ratios(*np.transpose(angles))).tolist()
    claims = {f"lam, mu {letter}": pair for letter, pair in zip(shapes, ratios, strict=True)}
    return figure, shapes, nets, claims


def _equal_ratio(angle):
    """The common ratio of a theta-parallelogram in words: a surd where we know one."""
    number = f"{parallelogram.ratios(angle, angle)[0]:.4f}"
    return rf"$\lambda=\mu={SURDS.get(round(angle / DEGREE, 9), number)}$"


def _layout(shapes):
    """One panel for two rows: figure, axes, where B goes and the height of the headings."""
    rows = shapes[:4], shapes[4:]
    extents = [[np.ptp(z.real) for z in row] for row in rows]
    width = max(sum(row) + 0.45 * (len(row) - 1) for row in extents)
    heights = [max(z[0].imag for z in row) for row in rows]
    origins, tops = [], []
    for row, extent, floor in zip(rows, extents, (heights[1] + 0.8, 0), strict=True):
        gap = (width - sum(extent)) / (len(row) - 1)
        starts = np.cumsum([0, *(x + gap for x in extent[:-1])])
        origins += [x - z.real.min() + 1j * floor for x, z in zip(starts, row, strict=True)]
        tops += [floor + max(z[0].imag for z in row) + 0.16] * len(row)
    figure, axes = plot.canvas([["all"]], 7, 6.9 * (tops[0] + 0.5) / (width + 0.1))
    axes["all"].set(xlim=(-0.05, width + 0.05), ylim=(-0.22, tops[0] + 0.28), autoscale_on=False)
    return figure, axes["all"], origins, tops


def _one(ax, shape, theta, theta0, side):
    """A parallelogram with its diagonals, the values of theta at B and of theta0 at O."""
    A, B, C, D = shape
    middle, beta = (A + C) / 2, np.angle(D - B)
    frame(ax, shape)
    angle_at(ax, B, C - B, A - B, 0.2)
    place = B + _clear(beta, 0.1, 0.38) * np.exp(0.45j * beta)
    plot.text(ax, place, f"${plot.degrees(theta)}$", 8)
    reach = _clear(theta0, 0.14, 0.22)  # an acute angle leaves room for its label only far from O
    label = f"${plot.degrees(theta0)}$"
    angle_at(ax, middle, D - middle, A - middle, reach - 0.12, label, 0.12, 8)
    beside(ax, B, C, "1", size=8)
    beside(ax, A, B, side, size=8)


def _clear(angle, radius, least):
    """How far from its apex a disc of this radius fits into the angle, at least `least`."""
    return max(radius / np.sin(angle / 2), least)
