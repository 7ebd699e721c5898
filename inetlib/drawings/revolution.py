"""Webs on surfaces of revolution; a net here is one of `loxodrome.web`."""

import numpy as np

from .. import plot

SLOTS = {"u": [(1, 2), (0, 3)], "v": [(1, 0), (2, 3)], "d1": [(0, 2)], "d2": [(1, 3)]}


def web(ax, view, net, families=("d1", "d2", "v", "u"), width=0.8):
    """The families of a web on its shaded surface; view: a `plot.camera`."""
    lines = plot.families(net.V, net.Q, dict.fromkeys(families, width))
    plot.scene(ax, view, [(net.V, net.Q, plot.PALE)], lines)


def black_quads(ax, view, net, width=0.7):
    """The inscribed parallelograms and the edges of a web's quads; arguments as in `web`."""
    lines = plot.families(net.V, net.Q, {"v": width, "u": width} if width else {})
    plot.board(ax, view, net.V, net.Q, lines)


def edges(V, Q, families, width):
    """Edges and diagonals of some faces Q that belong to the families, for `plot.scene`."""
    pairs = {name: np.concatenate([Q[:, pair] for pair in SLOTS[name]]) for name in families}
    return [(V[pair], plot.COLOURS[name], width) for name in families for pair in pairs[name]]
