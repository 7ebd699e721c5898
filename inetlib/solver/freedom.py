"""How many numbers of an isogonal net may still be chosen: the rank of its equations.

Two equations a face, three coordinates a vertex: 3 V - 2 F degrees of freedom wherever the
equations are independent at first order.  Paper: B8."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array

from .. import mesh
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
