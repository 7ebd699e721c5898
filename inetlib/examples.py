"""Surfaces to cover, as triangle meshes V (n, 3), F (f, 3): a roof, a saddle, a hanging shell.

Paper: Sec. 6.2 (beyond the paper).
"""

import numpy as np
from scipy.sparse import coo_array, diags_array

from . import linear, mesh


def wavy_roof(n=40):
    """A roof of 3 by 2 with waves, about n by 2 n / 3 squares of two triangles; n >= 2.

    Paper: Sec. 6.2 (beyond the paper).
    """
    n, m = _at_least(n, 2), max(2, round(2 * n / 3))
    x, y = np.meshgrid(np.linspace(0, 3, n + 1), np.linspace(0, 2, m + 1), indexing="ij")
    z = 0.25 * np.sin(2.2 * x + 0.4) * np.cos(1.7 * y) + 0.08 * x * y
    return mesh.triangles(np.stack([x, y, z], axis=-1).reshape(-1, 3), mesh.grid_quads(n, m))


def saddle_with_hole(n=20):
    """The saddle z = 0.4 (x^2 - y^2) between the radii 0.35 and 1: a ring of n by 5 n squares.

    Paper: Sec. 6.2 (beyond the paper).
    """
    n = _at_least(n, 2)
    radius = np.linspace(0.35, 1, n + 1)[:, None]
    angle = 2 * np.pi * np.arange(5 * n)[None, :] / (5 * n)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    V = np.stack([x, y, 0.4 * (x**2 - y**2)], axis=-1).reshape(-1, 3)
    i, j = np.divmod(mesh.grid_quads(n, 5 * n), 5 * n + 1)
    return mesh.triangles(V, 5 * n * i + j % (5 * n))


def hanging_shell(n=30):
    """A square cloth that hangs from its four corners, turned upside down: n by n squares.

    The edges are springs of no length, those of the border four times as strong, all vertices
    have the same weight: equilibrium is one linear system.

    Paper: Sec. 6.2 (beyond the paper).
    """
    n = _at_least(n, 2)
    Q = mesh.grid_quads(n, n)
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    V = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    pairs = np.sort(np.stack([Q.ravel(), np.roll(Q, -1, axis=1).ravel()], axis=1), axis=1)
    pairs, faces = np.unique(pairs, axis=0, return_counts=True)
    strength = np.where(faces == 1, 4.0 * n / 8, 1.0)
    graph = coo_array((strength, tuple(pairs.T)), shape=(len(V), len(V))).tocsr()
    graph = graph + graph.T
    stiffness = (diags_array(graph.sum(axis=1)) - graph).tocsr()
    free = np.setdiff1d(np.arange(len(V)), [0, n, n * (n + 1), (n + 1) ** 2 - 1])
    load = np.zeros_like(V)
    load[:, 2] = 5 / n**2
    right = (load - stiffness @ V)[free]
    solve = linear.factor(stiffness[free][:, free])
    V[free] += np.stack([solve(column) for column in right.T.copy()], axis=1)
    return mesh.triangles(V, Q)


def _at_least(n, low):
    if not (n >= low and int(n) == n):
        raise ValueError(f"n = {n}: a whole number of at least {low} is wanted")
    return int(n)
