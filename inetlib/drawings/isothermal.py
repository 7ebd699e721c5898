"""What Figs. 8, 9 and 10 share: the (arccos 1/sqrt 5, 45 degree) net of an isothermal surface.

In the squares of the (u, v) plane its u-curves run along diagonals and its v-curves along
horizontal edges; a face is the parallelogram of two edges and two diagonals of neighbouring
squares.

Paper: Fig. 8, Fig. 9, Fig. 10.
"""

import numpy as np

from .. import conformal, mesh

ANGLES = np.arccos(1 / np.sqrt(5)), np.pi / 4


def domain(m, n, step, corner=0):
    """Grid points u + iv, complex (m+1, n+1): m rows downwards, n along the upper edge.

    step: side of the squares; corner: the upper left one.
    """
    return conformal.sheared_grid(
        *ANGLES, m, n, origin=corner, edge=np.sqrt(2) * step, direction=1 - 1j
    )


def sample(surface, z):
    """The net of the points over the grid z, as (V, Q)."""
    points = surface.point(np.real(z), np.imag(z)).reshape(-1, 3)
    return points, mesh.grid_quads(*np.subtract(z.shape, 1))


def refined(line, k=6):
    """A polyline of the (u, v) plane with k points an edge."""
    s = np.arange((len(line) - 1) * k + 1) / k
    index = np.arange(len(line))
    return np.interp(s, index, line.real) + 1j * np.interp(s, index, line.imag)
