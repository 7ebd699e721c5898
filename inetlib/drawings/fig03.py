"""Fig. 3: sheared grids and their images under 1/z and z^2.

The cells are those of Fig. 1 and Def. 2: |BC| = 1, |AB| = mu, interior angle theta0 at B, and
theta = angle AOD between the diagonals.  The oriented labels of Section 4 put v1 ... v4 at
A ... D and measure COD, so `measure` and `conformal` say 180 degrees - theta of them."""

import numpy as np
from matplotlib.collections import PathCollection
from matplotlib.path import Path
from matplotlib.patheffects import withStroke

from .. import conformal, parallelogram, plot
from ..plot import DEGREE
from . import drawn, sampled

ROWS = [["A", "B", "C"], ["A'", "B'", "C'"], ["C_1", "C_2", "C_3"]]
MOSAIC = [row for row, height in zip(ROWS, (3, 5, 5), strict=True) for _ in range(height)]
SPANS = {"A": (4, 2, 4), "B": (4, 1, 3), "C": (4, 1, 3)}  # m, first row, n as in `_grid`
A, B, C = (80 * DEGREE, 50 * DEGREE), 45 * DEGREE, 60 * DEGREE  # the angles of the grids


@drawn()
def draw(theta=A[0], theta0=A[1], theta1=B, theta2=C, cells=10):
    """Three sheared grids, their conformal images with exact curves, and three patterns.

    theta, theta0: radians, the angles of the grid A, between the diagonals (AOD) and between
    the lines; theta1 and theta2: both angles of the grids B and C; cells: the patterns C1 to C3
    have cells x cells quads, an even number.
    Paper: Fig. 3."""
    figure, axes = plot.canvas(MOSAIC, 7.2, 6.6)
    angles = {"A": (theta, theta0), "B": (theta1, theta1), "C": (theta2, theta2)}
    z = {name: _grid(*angles[name], *SPANS[name]) for name in angles}
    for name in angles:
        _preimage(axes[name], name, z[name], *angles[name])
    z |= {"A'": 1 / z["A"], "B'": z["B"] ** 2, "C'": z["C"] ** 2} | _patterns(theta2, cells)
    _circles_through_0(axes["A'"], z["A"])
    _image(axes["A'"], "A'", "under $1/z$", z["A'"], _arcs(z["A"]))
    for name in "BC":
        _image(axes[name + "'"], name + "'", "under $z^2$", z[name + "'"], _parabolas(z[name]))
    _pattern(axes["C_1"], "C_1", "under $1/z$", z["C1"], (0, 4))
    _pattern(axes["C_2"], "C_2", "under $z^2$, 0 outside", z["C2"], (7, -3))
    _pattern(axes["C_3"], "C_3", "$z^2$ around 0: two sheets", z["C3"])
    sections = {name: (np.pi - t, t0) for name, (t, t0) in angles.items()}  # COD, of Section 4
    nets = {name: (*conformal.quads(z[name]), *sections[name[0]]) for name in z}
    exact = [nets[name] for name in nets if name not in ("A'", "C1")]
    return figure, z, exact, _claims(angles, nets)


def cells_abcd(theta, theta0, m, n, origin=0):
    """A grid of m x n cells ABCD as the paper labels them: |BC| = 1 and |AB| = mu.

    theta: the angle AOD between the diagonals, theta0: the one at B, radians.  Returns complex
    (m+1, n+1), numbered as by `conformal.sheared_grid`, which has |AB| = 1 / mu and COD = theta."""
    return conformal.sheared_grid(np.pi - theta, theta0, m, n, origin=origin)


def _grid(theta, theta0, m, first, n):
    """The grid of App. A.2: unit edges on rows at the heights first h, (first + 1) h, ...

    The slanted lines meet the real axis in the integers -m-1 ... -1, so none passes through 0."""
    _, mu = parallelogram.ratios(theta, theta0)
    return cells_abcd(theta, theta0, m, n, -m - 1 + first * mu * np.exp(1j * theta0))


def _patterns(theta, cells):
    """The images C1, C2, C3 of a sheared grid with both angles theta, as a dict.

    The grid stands above 0 for C1 and C2.  For C3 its centre is 0: the two sheets of z^2
    coincide.  ValueError for odd `cells`, where z^2 would collapse a quad."""
    if cells % 2:
        raise ValueError(f"cells = {cells}: an even number is wanted, so that 0 is a vertex in C3")
    z = cells_abcd(theta, theta, cells, cells)
    z = z - z.mean()
    height = np.ptp(z.imag)
    return {"C1": 1 / (z + height * 1j), "C2": (z + 0.7j * height) ** 2, "C3": z**2}


def _lines(z):
    """The ends of the u-lines and of the v-lines of a grid."""
    return (z[0], z[-1]), (z[:, 0], z[:, -1])


def square_bezier(start, end):
    """Control points of the Bezier curve ((1-t) s + t e)^2.  Paper: App. A.2, Fig. 3."""
    return start**2, start * end, end**2


def _parabolas(z):
    """The images of the lines of a grid under z^2, exact quadratic Bezier curves: two families."""
    codes = [Path.MOVETO, Path.CURVE3, Path.CURVE3]
    points = [np.transpose(square_bezier(*ends)) for ends in _lines(z)]
    return [[Path(plot.plane(p), codes) for p in family] for family in points]


def _arcs(z):
    """The images of the lines of a grid under 1/z, points on the exact circles: two families."""
    return [[_arc(*ends) for ends in zip(*pair, strict=True)] for pair in _lines(z)]


def _arc(start, end):
    centre, _ = conformal.inversion_circle(start, end - start)
    # Angles count from the point opposite to 0: the image of a segment never reaches 0.
    a, b = np.angle((1 / np.array([start, end]) - centre) / centre)
    return Path(plot.plane(centre + centre * np.exp(1j * np.linspace(a, b, 181))))


def _preimage(ax, name, z, theta, theta0):
    feet = (z[:, 0] - z[:, 0].imag * (1 / np.tan(theta0) + 1j)).real
    ax.plot([feet.min() - 0.5, max(0, z.real.max()) + 0.2], [0, 0], color=plot.INK, lw=0.8)
    plot.curves(ax, np.stack([feet, z[:, 0]], axis=1), plot.GREY, 0.7, ":")
    for foot in feet:
        ax.text(foot, -0.15, f"${foot:.0f}$", ha="center", va="top", fontsize=7.5)
    plot.net(ax, *conformal.quads(z), width=1.2)
    slant = [np.cos(theta0), np.sin(theta0)]
    plot.angle(ax, [feet[-1], 0], [1, 0], slant, 0.4, r"$\theta_0$", gap=2.2)
    _diagonals(ax, z)
    _origin(ax, (0, -10))
    plot.panel(ax, name, f"${plot.degrees(theta, theta0)}$".replace(r"\degree", r"^\circ"))
    ax.set_aspect("equal", adjustable="datalim")


def _diagonals(ax, z):
    i, j = (size // 2 for size in z.shape)
    d1, d2 = ([z[i - 1, j - s], z[i + 1, j + s]] for s in (-1, 1))
    plot.curves(ax, [d1], plot.COLOURS["d1"], 1.2)
    plot.curves(ax, [d2], plot.COLOURS["d2"], 1.2)
    directions = (plot.plane(way) for way in (d2[1] - d2[0], d1[0] - d1[1]))  # OD and OA
    plot.angle(ax, plot.plane(z[i, j]), *directions, 0.33, r"$\theta$", gap=1.95)
    ax.texts[-1].set_path_effects([withStroke(linewidth=2.5, foreground="white")])


def _circles_through_0(ax, z):
    (left, right), (bottom, top) = _lines(z)
    turn = np.exp(2j * np.pi * np.arange(181) / 180)
    pairs = zip(left, right - left, strict=True)
    centres = [conformal.inversion_circle(*pair)[0] for pair in pairs]
    plot.curves(ax, [c + abs(c) * turn for c in centres], plot.GREY, 0.6, ":")
    far = top + 1e6 * (top - bottom)
    rays = [_arc(*ends).vertices for ends in zip(top, far, strict=True)]
    plot.curves(ax, rays, plot.GREY, 0.6, ":")


def _image(ax, name, text, z, curves):
    plot.black_quads(ax, *conformal.quads(z), plot.FILL, "none")
    for straight in (z, z.T):
        plot.curves(ax, straight, plot.GREY, 0.8, (0, (3, 2)))
    for family, paths in zip("uv", curves, strict=True):
        line = {"edgecolors": plot.COLOURS[family], "linewidths": 1.2}
        ax.add_collection(PathCollection(paths, facecolors="none", zorder=3, **line))
    _origin(ax, (0, 4))
    plot.panel(ax, name, text)
    ax.set_aspect("equal", adjustable="datalim")


def _pattern(ax, name, text, z, label=None):
    V, Q = conformal.quads(z)
    plot.black_quads(ax, V, Q, plot.FILL, "none")
    plot.net(ax, V, Q, width=0.6)
    _origin(ax, label)
    plot.panel(ax, name, text)
    ax.set_aspect("equal", adjustable="datalim")


def _origin(ax, label):
    ax.plot(0, 0, "o", color=plot.INK, ms=3, zorder=6)
    if label:
        ax.annotate("$0$", (0, 0), label, textcoords="offset points", ha="center", fontsize=8)


def _claims(angles, nets):
    """The steps between the rows, and how far the two nets under 1/z, not exact, are off."""
    claims = {}
    for name, (theta, theta0) in angles.items():
        _, mu = parallelogram.ratios(theta, theta0)
        claims[f"{name}: h = mu sin(theta0)"] = mu * np.sin(theta0)
    for name in ("A'", "C1"):
        V, Q, *both = nets[name]
        claims |= sampled(name, V, Q, both)
    return claims


def conventions(theta=C, theta0=C):
    """One cell with the labels of Fig. 1 and with those of Section 4: a figure of two panels.

    theta, theta0: radians, as for `cells_abcd`."""
    (B, A), (C, D) = cells_abcd(theta, theta0, 1, 1)
    middle = (A + C) / 2
    figure, axes = plot.canvas([["ABCD", "v"]], 6.4, 2.5)
    names = {"ABCD": "ABCD", "v": [f"v_{k}" for k in (1, 2, 3, 4)]}
    words = {
        "ABCD": ("labels of Fig. 1: angle $AOD$", D - middle, A - middle, theta),
        "v": ("labels of Sec. 4: from $d_1$ to $d_2$", C - middle, D - middle, np.pi - theta),
    }
    for name, ax in axes.items():
        text, one, two, angle = words[name]
        plot.polygons(ax, np.array([A, B, C, D]), [np.arange(4)], plot.PALE)
        plot.curves(ax, [[B, C], [A, D]], plot.COLOURS["u"], 1.4)
        plot.curves(ax, [[B, A], [C, D]], plot.COLOURS["v"], 1.4)
        for family, (start, end) in {"d1": (A, C), "d2": (B, D)}.items():
            if name == "v":
                plot.vector(ax, plot.plane(start), plot.plane(end), plot.COLOURS[family])
            else:
                plot.curves(ax, [[start, end]], plot.COLOURS[family], 1.4)
        arms = plot.plane(one), plot.plane(two)
        plot.angle(ax, plot.plane(middle), *arms, 0.2, f"${plot.degrees(angle)}$", gap=1.75)
        for label, corner in zip(names[name], (A, B, C, D), strict=True):
            plot.text(
                ax,
                plot.plane(corner + 0.16 * (corner - middle) / abs(corner - middle)),
                f"${label}$",
            )
        ax.set_title(text)
        ax.margins(0.16, 0.2)
    return figure
