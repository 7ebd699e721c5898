"""How many numbers of an isogonal net may still be chosen: the rank of its equations.

Two equations a face, three coordinates a vertex: 3 V - 2 F degrees of freedom wherever the
equations are independent at first order.  Paper: B8."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array

from .. import mesh
from ..parallelogram import check_whole, ratios
from . import residuals, sparse

LARGEST = 1200  # faces, of a dense singular value decomposition


class Freedom(NamedTuple):
    """The size of the linearised equations, and how many of them are independent."""

    unknowns: int  # coordinates of vertices that do not stay
    equations: int  # two a face
    rank: int  # how many are independent
    free: int  # unknowns - rank, the dimension of the linearised nets
    gap: float  # smallest singular value that counts / the largest


def jacobian(V: np.ndarray, Q: np.ndarray) -> csr_array:
    """The derivative of (log lam, log mu) of all faces by all coordinates: (2 f, 3 n), sparse.

    V: (n, 3), Q: (f, 4), labelled.  Row 2 k belongs to lam of face k, row 2 k + 1 to mu;
    column 3 i + c to the coordinate c of vertex i.  Paper: B8."""
    V, Q = mesh.check_arrays(V, Q)
    _, blocks = residuals.log_ratios(V[Q].reshape(-1, 12))
    return sparse.rows(blocks, sparse.coordinates(Q), V.size)


def count(
    V: np.ndarray, Q: np.ndarray, fixed: Sequence | np.ndarray = (), tolerance: float = 1e-9
) -> Freedom:
    """The `Freedom` of the net (V, Q) when the vertices `fixed` (numbers or mask) stay.

    A singular value below `tolerance` of the largest counts as 0.  ValueError for meshes of
    more than 1200 faces: the decomposition is dense.  Paper: B8."""
    if len(Q) > LARGEST:
        raise ValueError(f"{len(Q)} faces: at most {LARGEST} are wanted, take a coarser mesh")
    free = np.ones(len(V), dtype=bool)
    try:
        free[list(fixed)] = False
    except IndexError as error:
        raise ValueError(f"fixed: vertex numbers or a mask are wanted ({error})") from error
    J = jacobian(V, Q).toarray()[:, np.repeat(free, 3)]
    values = np.linalg.svd(J, compute_uv=False)
    rank = int(np.sum(values > tolerance * values[0]))
    gap = float(values[rank - 1] / values[0])
    return Freedom(J.shape[1], J.shape[0], rank, J.shape[1] - rank, gap)


def march(V: np.ndarray, m: int, n: int, theta: float, theta0: float) -> np.ndarray:
    """A net of m x n quads with exact angles, built face by face from two of its sides.

    V: ((m+1)(n+1), 3), numbered as by `mesh.grid_quads`.  Its sides i = 0 and j = 0 stay.  Three
    corners of a face leave a circle to the fourth: v2 + d2, where d2 has the length lam |d1| and
    the angle theta with d1; taken is its point nearest to V.  Angles are radians.  Returns the
    vertices ((m+1)(n+1), 3)."""
    m, n = check_whole("m", m), check_whole("n", n)
    lam, _ = ratios(theta, theta0)
    V = np.array(V, dtype=float)
    if V.shape != ((m + 1) * (n + 1), 3):
        raise ValueError(f"V has the shape {V.shape}: {m} x {n} quads have {(m + 1) * (n + 1)} x 3")
    grid = V.reshape(m + 1, n + 1, 3)
    for i, j in np.ndindex(m, n):
        v1, v2, v3, near = grid[i, j + 1], grid[i, j], grid[i + 1, j], grid[i + 1, j + 1]
        length = np.linalg.norm(v3 - v1)
        along = (v3 - v1) / length
        across = (near - v2) - ((near - v2) @ along) * along
        across /= np.linalg.norm(across)
        d2 = lam * length * (np.cos(theta) * along + np.sin(theta) * across)
        grid[i + 1, j + 1] = v2 + d2
    return V
