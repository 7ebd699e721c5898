"""One parallelogram ABCD, drawn, and as a net that can be measured.

  A ---------- D      B = 0 and C = 1, so a = |BC| = 1 and b = |AB| = lam
 /            /       angle B = theta, the diagonals meet at O with
B ---------- C        angle AOD = theta0"""

import numpy as np

from .. import conformal, parallelogram, plot


def corners(theta, theta0):
    """The corners A, B, C, D, complex (4,); angles in radians in (0, pi), else ValueError."""
    lam, _ = parallelogram.ratios(theta, theta0)
    slanted = lam * np.exp(1j * theta)
    return np.array([slanted, 0, 1, 1 + slanted])


def net(shape, theta, theta0):
    """(V, Q, theta, theta0) of a quad whose mid-edge parallelogram is similar to ABCD.

    Its diagonals are BC and BA, so that `measure` finds the angles of ABCD in it."""
    d1, d2 = shape[2] - shape[1], shape[0] - shape[1]
    return *conformal.quads(np.array([[-d2, -d1], [d1, d2]]) / 2), theta, theta0


def frame(ax, shape):
    """The area, the sides in the colours of d1 and d2, the diagonals in those of u and v."""
    A, B, C, D = shape
    plot.polygons(ax, shape, [[0, 1, 2, 3]], plot.PALE)
    plot.curves(ax, [[A, C]], plot.COLOURS["v"], 1.26, zorder=3)
    plot.curves(ax, [[B, D]], plot.COLOURS["u"], 1.26, zorder=3)
    plot.curves(ax, [[B, A], [C, D]], plot.COLOURS["d2"], 1.8, zorder=4)
    plot.curves(ax, [[B, C], [A, D]], plot.COLOURS["d1"], 1.8, zorder=4)


def beside(ax, start, end, label, at=0.5, size=10):
    """A label to the right of the segment from `start` to `end`, at the fraction `at` of it."""
    right = -1j * (end - start) / abs(end - start)
    width = len(label.replace(r"\lambda", "l"))  # a wide label needs more room sideways
    reach = 0.1 + 0.02 * width * abs(right.real)
    plot.text(ax, start + at * (end - start) + reach * right, f"${label}$", size)


def angle_at(ax, apex, start, end, radius, label="", gap=0.11, size=9):
    """An angle mark from the direction `start` to `end` (complex), the label beyond the arc."""
    plot.angle(ax, *(plot.plane(z) for z in (apex, start, end)), radius)
    middle = start / abs(start) + end / abs(end)
    right = abs(np.angle(end / start) - np.pi / 2) <= 1e-9  # its mark is a corner
    reach = radius + (1.4 * gap if right else gap)
    plot.text(ax, apex + reach * middle / abs(middle), label, size)
