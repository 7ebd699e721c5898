"""Webs on opaque surfaces of revolution: lines only where the outside faces the camera.

A net here is one of `loxodrome.web`: it has V, Q, families and rows."""

import numpy as np

from .. import measure, mesh, plot, ties

SLOTS = {"u": [(1, 2), (0, 3)], "v": [(1, 0), (2, 3)], "d1": [(0, 2)], "d2": [(1, 3)]}


def web(ax, view, net, families=("u", "v", "d1", "d2"), width=0.8):
    """The families of a web on a light surface; view: a `plot.camera` that looks from above."""
    Q = net.Q[facing(view, net.V, net.Q)]
    fill = plot.shade(net.V, Q, "white", depth=0.2)
    paint(ax, view, net, (net.V, Q), fill, lines(net.V, Q, families, width))


def black_quads(ax, view, net, width=0.7):
    """The inscribed parallelograms and the edges of a web's quads; arguments as in `web`."""
    Q = net.Q[facing(view, net.V, net.Q)]
    points, black, light = plot.cells(net.V, Q)
    fill = [plot.shade(points, black, plot.DARK, depth=0.3), plot.shade(points, light, depth=0.2)]
    outside = points, np.concatenate([black, light])
    paint(ax, view, net, outside, np.concatenate(fill), lines(net.V, Q, "uv", width))


def paint(ax, view, net, outside, fill, lines):
    """The front faces `outside` = (V, faces), the plain back faces, lines, the upper rim.

    fill: a colour for each of the front faces; lines: see `plot.scene`."""
    V, faces = outside
    back = net.Q[~facing(view, net.V, net.Q)]
    points = np.concatenate([net.V, V])
    every = np.concatenate([back, faces + len(net.V)])
    fill = np.concatenate([plot.shade(net.V, back, "#b9c0c9", depth=0.3), fill])
    rims = [net.V[np.append(loop, loop[0])] for loop in mesh.boundary_loops(net.Q)]
    if rims:  # the highest is seen all around, from above
        height = np.array([rim[:, 2].mean() for rim in rims]) - net.V[:, 2].min()
        highest = rims[ties.first_largest(height, np.ptp(net.V[:, 2]))]
        lines = [*lines, (highest, plot.COLOURS["u"], 0.8)]
    plot.scene(ax, view, points, every, fill, lines)


def facing(view, V, Q):
    """Whether each face shows its outside to the camera: boolean (f,)."""
    a, b = (view(x)[0] for x in measure.vectors(V, Q)[:2])
    size = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > ties.TIE * size  # edge on: not shown


def lines(V, Q, families, width):
    """Edges and diagonals of the faces Q that belong to the families, each once, for a scene."""
    pieces = []
    for name in families:
        ends = np.concatenate([Q[:, pair] for pair in SLOTS[name]])
        ends = np.unique(np.sort(ends, axis=1), axis=0)
        pieces += [(V[pair], plot.COLOURS[name], width) for pair in ends]
    return pieces
