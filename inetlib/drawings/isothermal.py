"""The (arccos 1/sqrt 5, 45 degree) net of an isothermal surface.

In the squares of the (u, v) plane its u-curves run along diagonals and its v-curves along
horizontal edges; a face is the parallelogram of two edges and two diagonals of neighbours."""

import numpy as np

from .. import conformal, plot

ANGLES = np.arccos(1 / np.sqrt(5)), np.pi / 4
# Parallels are drawn alike in all figures; here they are v-curves.
FAMILIES = "d1", "d2", "v", "u"  # whose colours its families have
PARALLEL, SLANTED = plot.COLOURS["u"], plot.COLOURS["v"]


def domain(m, n, step, corner=0):
    """Grid points u + iv, complex (m+1, n+1): m rows downwards, n along the upper edge.

    step: side of the squares; corner: the upper left one."""
    edge = np.sqrt(2) * step
    return conformal.sheared_grid(*ANGLES, m, n, origin=corner, edge=edge, direction=1 - 1j)


def sample(surface, z):
    """The net of the points over the grid z, as (V, Q)."""
    return surface.point(z.real, z.imag).reshape(-1, 3), conformal.quads(z)[1]


def curve(surface, line, k=6):
    """The points over a polyline of the (u, v) plane, complex, with k an edge."""
    s = np.arange((len(line) - 1) * k + 1) / k
    index = np.arange(len(line))
    return surface.point(np.interp(s, index, line.real), np.interp(s, index, line.imag))


def lines(V, Q, width):
    """The parallels and the other curves of the net, for `plot.scene`."""
    found = plot.families(V, Q, {"u": width, "v": width})
    swapped = {plot.COLOURS["u"]: SLANTED, plot.COLOURS["v"]: PARALLEL}
    return [(points, swapped[colour], w) for points, colour, w in found]
