"""Fig. 5: a smooth 4-web over its parameter square; discrete derivatives on a mesh."""

import numpy as np
from matplotlib.colors import to_rgb

from .. import conformal, measure, mesh, parallelogram, plot
from ..plot import COLOURS, DEGREE
from . import drawn, sampled

STEPS = {"u": (1, 0), "v": (0, 1), "d1": (1, -1), "d2": (1, 1)}  # along the families, in (u, v)
SMOOTH = {"u": "$X_u$", "v": "$X_v$", "d1": "$Y_u$", "d2": "$Y_v$"}
DISCRETE = {"u": "$f_u$", "v": "$f_v$", "d1": "$d_1$", "d2": "$d_2$"}
LINES = {"u": "$v$ = const.", "v": "$u$ = const.", "d1": "$u+v$ = const.", "d2": "$u-v$ = const."}
HALO = 2.5
TITLES = {
    "A": "four families of lines",
    "A'": "the same lines on the surface",
    "B": "a triangulated grid",
    "B'": "the same grid as a mesh",
}


@drawn("theta", "theta0", "azimuth", "elevation")
def draw(
    theta=75 * DEGREE,
    theta0=65 * DEGREE,
    lines=6,
    cells=3,
    size=1.45,
    azimuth=-85 * DEGREE,
    elevation=22 * DEGREE,
):
    """An I-web on a catenoid with its parameter square; below, a coarse mesh on it.

    theta, theta0: angles of the web; lines, cells: steps of the smooth web (even) and of the
    mesh (odd); size: of the parameter square; azimuth, elevation: the camera; radians.
    Paper: Fig. 5."""
    asked = theta, theta0
    rho = parallelogram.rho(*parallelogram.ratios(*asked))
    figure, axes = plot.canvas([["A", "A'"], ["B", "B'"]], 7.2, 6.4, ratios=[1, 1.35])
    view = plot.camera(azimuth, elevation)

    def surface(uv):
        return _catenoid(size * (uv[..., 0] + rho * uv[..., 1]))

    net, finer = (_mesh(surface, k) for k in (cells, 2 * cells))
    _square(axes["A"], lines)
    _web(axes["A'"], view, surface, lines)
    _grid(axes["B"], cells)
    _faces(axes["B'"], view, *net)
    axes["B"].set(xlim=axes["A"].get_xlim(), ylim=axes["A"].get_ylim())
    for name, ax in axes.items():
        ax.set_anchor("N")
        plot.panel(ax, name, TITLES[name])
    domain = conformal.quads(conformal.sheared_grid(*asked, cells, cells, edge=size / cells))
    claims = sampled("sampled_net", *net, asked)
    claims |= sampled("sampled_net_half_size", *finer, asked)
    return figure, {"domain": domain[0], "mesh": net[0]}, [(*domain, *asked)], claims


def _catenoid(z):
    """An isothermal parametrisation: x = Re z around the axis, y = Im z along it."""
    x, y = np.real(z), np.imag(z)
    return np.stack([np.cosh(y) * np.sin(x), -np.cosh(y) * np.cos(x), y], axis=-1)


def _points(n):
    """The grid points (u, v) of the square [-1/2, 1/2]^2 in the order of `mesh.grid_quads`."""
    side = np.linspace(-0.5, 0.5, n + 1)
    return np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1).reshape(-1, 2)


def _families(n, samples=2):
    """(family, straight line (samples, 2)) for the lines through the grid points of the square."""
    uv, t = _points(n), np.linspace(0, 1, samples)[:, None]
    for name, chains in mesh.polylines(mesh.grid_quads(n, n))._asdict().items():
        for chain in chains:
            yield name, (1 - t) * uv[chain[0]] + t * uv[chain[-1]]


def _mesh(surface, cells):
    return surface(_points(cells)), mesh.grid_quads(cells, cells)


def _lines(ax, n, width):
    """The four families in the parameter square."""
    for family in COLOURS:
        lines = [line for name, line in _families(n) if name == family]
        plot.curves(ax, lines, COLOURS[family], width)


def _square(ax, n):
    _lines(ax, n, 0.8)
    for k, (name, text) in enumerate(LINES.items()):
        x, y = (0.06 if k % 2 else -0.47), -0.58 - 0.09 * (k // 2)
        plot.curves(ax, [[(x, y), (x + 0.09, y)]], COLOURS[name], 1.8)
        ax.text(x + 0.12, y, text, va="center")
    _arrows(ax, np.zeros(2), {name: np.array(s) * 1.5 / n for name, s in STEPS.items()}, SMOOTH)


def _web(ax, view, surface, n):
    lines = [(surface(line), COLOURS[name], 0.9) for name, line in _families(n, 25)]
    V, Q = _mesh(surface, 3 * n)
    plot.scene(ax, view, [(V, Q, plot.PALE)], lines)
    flat = {}
    for name, s in STEPS.items():
        step = 1e-5 * np.array(s)
        tangent = (surface(step) - surface(-step)) / 2e-5
        flat[name] = view(tangent * 1.5 / n)[0]
    _arrows(ax, view(surface(np.zeros(2)))[0], flat, SMOOTH)


def _grid(ax, n):
    uv, Q = _points(n), mesh.grid_quads(n, n)
    middle = n // 2 * n + n // 2
    plot.polygons(ax, uv, Q[[middle]], plot.FILL, zorder=0)
    _lines(ax, n, 0.9)
    ax.plot(*uv[Q[middle]].T, "o", color=plot.INK, ms=3, zorder=6)
    ax.plot(0, 0, "o", color=plot.INK, ms=3.5, zorder=6)
    plot.text(ax, -0.045j, "$p$", halo=HALO, zorder=7)


def _faces(ax, view, V, Q):
    middle = len(Q) // 2
    fill = np.tile(to_rgb(plot.PALE), (len(Q), 1))
    fill[middle] = to_rgb(plot.FILL)
    lines = plot.families(V, Q, dict.fromkeys(COLOURS, 1.1))
    apart = np.arange(Q.size).reshape(-1, 4)
    plot.scene(ax, view, [(V[Q].reshape(-1, 3), apart, fill)], lines, lift=0.03)
    corners = view(V[Q[middle]])[0]
    ax.plot(*corners.T, "o", color=plot.INK, ms=3, zorder=6)
    for k, turn in enumerate((1, 1, np.exp(-1.2j), np.exp(1.2j))):  # beside the ends of d1, d2
        away = 0.28 * turn * complex(*(corners[k] - corners.mean(axis=0)))
        plot.text(ax, complex(*corners[k]) + away, f"$v_{k + 1}$", halo=HALO, zorder=7)
    d1, d2, m13, m24 = (view(x[middle])[0] for x in measure.vectors(V, Q))
    start = view(V[Q[middle]].mean(axis=0))[0]
    _arrows(ax, start, {"u": m13, "v": m24, "d1": d1, "d2": d2}, DISCRETE)
    plot.text(ax, start - [0.04, -0.02], "$f(p)$", halo=HALO, ha="right", zorder=3)


def _arrows(ax, start, vectors, names):
    """The four vectors from one point, each with a white border and its name at its tip."""
    for name, vector in vectors.items():
        end = start + vector
        plot.curves(ax, [np.stack([start, start + 0.85 * vector])], "white", 4.5, zorder=3)
        plot.vector(ax, start, end, COLOURS[name], 2.2)
        tip = 0.06 * np.ptp(ax.dataLim.intervaly) * vector / np.linalg.norm(vector)
        plot.text(ax, end + tip, names[name], 11, HALO, zorder=8)
    ax.plot(*start, "o", color=plot.INK, ms=4, zorder=7)
