"""Planar isogonal nets by one linear solve: a leaf, an annulus, a hexagon with rings."""

import numpy as np

from .. import mesh, parallelogram, planar, plot
from ..plot import DEGREE
from . import drawn


@drawn()
def draw(theta=60 * DEGREE, theta0=45 * DEGREE, tip=80 * DEGREE, pull=0.35):
    """A leaf filled with a net, a bent annulus, a hexagon with rings, and its middle.

    theta, theta0: radians, of the hexagon (C and D), the others have 60 degrees; tip: angle
    of the leaf's tips, radians; pull: of two handles of the annulus.  Paper: B7."""
    figure, axes = plot.canvas([list("AB"), list("CD")], 7.2, 6.0)
    equal = 60 * DEGREE, 60 * DEGREE
    one, Q1, held1, outline = leaf(*equal, tip=tip)
    two, Q2, held2 = annulus(*equal, pull=pull)
    three, Q3, held3, polygon = hexagon(theta, theta0)
    plot.curves(axes["A"], [np.append(outline, outline[0])], plot.INK, 2.4, alpha=0.35)
    words, others = (f"${plot.degrees(*pair)}$" for pair in (equal, (theta, theta0)))
    _net(axes["A"], "A", f"{words}, an outline filled", one.V, Q1, held1)
    _net(axes["B"], "B", f"{words}, a bent annulus", two.V, Q2, held2)
    _net(axes["C"], "C", f"{others}, a hexagon", three.V, Q3, held3)
    inside = polygon
    for _ in range(2):  # two quads around it
        inside = np.unique(Q3[np.isin(Q3, inside).any(axis=1)])
    near = np.isin(Q3, inside).all(axis=1)
    _net(axes["D"], "D", "the middle of C", three.V, Q3[near], (), 1.2)
    for name in "CD":
        plot.polygons(axes[name], three.V, polygon[None], plot.SINGULAR, plot.INK, 0.8)
    found = {"leaf": (one, Q1, *equal), "annulus": (two, Q2, *equal)}
    found["hexagon"] = three, Q3, theta, theta0
    data, claims = {name: net.V for name, (net, *_) in found.items()}, {}
    for name, (net, Q, *_) in found.items():
        claims[f"{name}: quads"] = len(Q)
        claims[f"{name}: complex freedoms"] = net.freedom
        claims[f"{name}: faces that cross themselves"] = len(net.flipped)
    claims["leaf: largest distance from the outline"] = round(one.distance, 6)
    exact = [(net.V, *rest) for net, *rest in found.values()]
    return figure, data | {"outline": outline}, exact, claims


def _net(ax, name, text, V, Q, held, width=0.9):
    """Parallelograms, diagonals thin below the edges, handles as dots."""
    plot.black_quads(ax, V, Q, plot.FILL, "none")
    plot.net(ax, V, Q, ("d1", "d2"), 0.45 * width)
    plot.net(ax, V, Q, ("u", "v"), width)
    points = {"color": plot.INK, "ms": 5, "mec": "white", "mew": 0.8, "zorder": 6}
    ax.plot(*V[np.array(held, dtype=int), :2].T, "o", **points)
    ax.margins(0.04)
    plot.panel(ax, name, text)
    ax.set_anchor("N")


def leaf(theta=60 * DEGREE, theta0=60 * DEGREE, cells=14, tip=80 * DEGREE, bend=0.12):
    """A leaf-shaped outline filled with a grid: (Planar, Q, handles, outline).

    cells: quads along u, as many along v as suit the angles; tip: the angle of the leaf's
    two tips, radians; bend: how far its middle line bends up, in half lengths.  Two opposite
    corners of the grid are handles at the tips, the rest of its boundary glides.  Paper: B7."""
    _, mu = parallelogram.ratios(theta, theta0)
    rows = max(1, round(cells * mu))
    Q = mesh.grid_quads(cells, rows)
    turn = np.linspace(-tip / 2, tip / 2, 300)[:-1]
    arc = (np.sin(turn) - 1j * (np.cos(turn) - np.cos(tip / 2))) / np.sin(tip / 2)
    outline = np.concatenate([arc, -arc])
    outline = outline + 1j * bend * (1 - outline.real**2)
    held = np.array([0, (cells + 1) * (rows + 1) - 1])
    return planar.planar_net(Q, theta, theta0, (held, [-1, 1]), outline), Q, held, outline


def annulus(theta=60 * DEGREE, theta0=60 * DEGREE, around=36, rows=10, pull=0.35):
    """A closed strip pulled out of its round shape: (Planar, Q, handles).

    around, rows: quads around and across; pull: how far two of the four handles on the outer
    rim move outwards, in its radii.  Two more handles hold the inner rim.  Paper: B7."""
    if around % 4:
        raise ValueError(f"around = {around}: a multiple of 4 is wanted")
    Q = mesh.grid_quads(around, rows) % (around * (rows + 1))
    z = closed_strip(theta, theta0, around, rows)
    outer = np.arange(4) * (around // 4) * (rows + 1)
    inner = outer[::2] + rows
    held, places = np.append(outer, inner), z.ravel()[np.append(outer, inner)]
    places[[0, 2]] *= 1 + pull
    return planar.planar_net(Q, theta, theta0, (held, places)), Q, held


def closed_strip(theta, theta0, around, rows):
    """The round net on a closed strip, complex (around, rows + 1), of radius 1 outside.

    Its points are w^i b^j with w^around = 1: the equations ask for b = (1 + K w) / (w + K),
    so it closes for all angles, with rings whose ratio |b| the angles decide.  Paper: B7."""
    K, w = planar.factor_k(theta, theta0), np.exp(2j * np.pi / around)
    b = (1 + K * w) / (w + K)
    return w ** np.arange(around)[:, None] * b ** np.arange(rows + 1)


def hexagon(theta=60 * DEGREE, theta0=45 * DEGREE, rings=8, obtuse=0.72):
    """A hexagon with rings of quads, six corners as handles: (Planar, Q, handles, polygon).

    obtuse: distance from the middle of the three corners with obtuse angles; 1 for the others.
    Paper: B7."""
    _, Q, polygon = mesh.polygon_rings(6, rings)
    rim = max(mesh.boundary_loops(Q), key=len)
    held = rim[np.bincount(Q.ravel())[rim] == 1]
    places = np.exp(1j * np.pi * np.arange(6) / 3 + 0.5j * np.pi)
    wide = np.array([(Q[:, [0, 2]] == k).any() for k in held])  # v1 and v3 of their face
    places[wide] *= obtuse
    return planar.planar_net(Q, theta, theta0, (held, places)), Q, held, polygon
