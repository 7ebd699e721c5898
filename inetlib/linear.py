"""Sparse matrices from local Jacobians, and their factorisation.

Paper: Sec. 6.3 (linear systems).
"""

import numpy as np
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu
from threadpoolctl import ThreadpoolController

BLAS = ThreadpoolController()
NARROW = 500  # up to this bandwidth a band is faster than a sparse factor
MANY = 5000  # from here on nested dissection beats minimum degree
LEAF = 16  # points that need no further division


def rows(jacobian, index, columns):
    """Local Jacobians (f, q, k) as a sparse matrix (f q, columns).

    index: (f, k), the column of each local variable; within a row all different.

    Paper: Sec. 6.3 (linear systems).
    """
    f, q, k = jacobian.shape
    pattern = np.repeat(index, q, axis=0).ravel(), np.arange(0, f * q * k + 1, k)
    return csr_array((np.ascontiguousarray(jacobian).ravel(), *pattern), shape=(f * q, columns))


def coordinates(vertices):
    """Columns of the coordinates of vertices (f, c): (f, 3 c).

    Paper: Sec. 6.3 (linear systems).
    """
    vertices = np.asarray(vertices)
    return (3 * vertices[..., None] + np.arange(3)).reshape(len(vertices), -1)


def scaled(A, columns):
    """A with its columns multiplied by numbers, (columns,) or one; CSR.

    Paper: Sec. 6.3 (linear systems).
    """
    data = A.data * (columns[A.indices] if np.ndim(columns) else columns)
    return csr_array((data, A.indices, A.indptr), shape=A.shape)


def factor(A, order=None):
    """A function that solves A x = b, for a symmetric positive definite sparse A.

    order: a permutation of the rows that keeps the factors sparse, such as that of
    `nested_dissection`; without one, a band where A is narrow, else minimum degree on the
    pattern of A + A^T, many times faster here than SuperLU's default ordering.  Pivots are
    on the diagonal.

    Paper: Sec. 6.3 (linear systems).
    """
    if order is None:
        return _banded(A) or _superlu(A.tocsc(), "MMD_AT_PLUS_A").solve
    inner = _superlu(A.tocsr()[order].tocsc()[:, order], "NATURAL").solve

    def solve(b):
        x = np.empty_like(b)
        x[order] = inner(b[order])
        return x

    return solve


class Factor:
    """`factor` for one matrix after the other with the same pattern: ordered only once.

    points (k, d): where the unknowns are, an equal number in a row at each point.
    """

    def __init__(self, points):
        self.points, self.order = points, None

    def __call__(self, A):
        narrow = _banded(A) if self.order is None else None
        if narrow:
            return narrow
        if self.order is None and len(self.points) >= MANY:
            self.order = nested_dissection(self.points, A)
        if self.order is not None:
            return factor(A, self.order)
        factors = _superlu(A.tocsc(), "MMD_AT_PLUS_A")
        self.order = np.argsort(factors.perm_c)
        return factors.solve


def _superlu(A, ordering):
    options = {"SymmetricMode": True}
    return splu(A, permc_spec=ordering, diag_pivot_thresh=0.0, options=options)


def _banded(A):
    """`factor` by a banded Cholesky factor; None where A is too wide or not positive."""
    A = A.tocsr()
    count = A.shape[0]
    width = int((np.arange(count) - np.minimum.reduceat(A.indices, A.indptr[:-1])).max())
    if width > NARROW:
        return None
    below = np.repeat(np.arange(count), np.diff(A.indptr)) - A.indices
    low = below >= 0
    band = np.zeros((width + 1, count), order="F")
    band[below[low], A.indices[low]] = A.data[low]
    try:
        with BLAS.limit(limits=1, user_api="blas"):  # on small blocks more threads only wait
            factors = cholesky_banded(band, overwrite_ab=True, lower=True, check_finite=False)
    except LinAlgError:
        return None
    return lambda b: cho_solve_banded((factors, True), b, check_finite=False)


# --- ordering ---------------------------------------------------------------------------


def nested_dissection(points, A):
    """A permutation of the rows of A that keeps its factors sparse, by halving again and again.

    points (k, d): where the unknowns are, A (b k, b k): b in a row at each point.  Of each
    half of the points, those with a neighbour in the other half come last.  Twice as fast
    as minimum degree from some 10 000 points on; it depends on the pattern of A only.

    Paper: Sec. 6.3 (linear systems).
    """
    count = len(points)
    block = A.shape[0] // count
    pattern = A.tobsr((block, block))
    one, two = np.repeat(np.arange(count), np.diff(pattern.indptr)), pattern.indices
    part, path = np.zeros((2, count), dtype=np.int64)  # part -1: has its place already
    while np.bincount(part[part >= 0]).max(initial=0) > LEAF:
        side = _halves(points, part)
        inner = (part[one] == part[two]) & (part[one] >= 0)
        one, two = one[inner], two[inner]
        border = one[side[one] < side[two]]
        path = 3 * path + side
        path[border] += 2
        part = np.where(part >= 0, 2 * part + side, -1)
        part[border] = -1
        alive = part >= 0
        part[alive] = np.unique(part[alive], return_inverse=True)[1]
    return (block * np.argsort(path, kind="stable")[:, None] + np.arange(block)).ravel()


def _halves(points, part):
    """0 or 1 for the points in the lower or upper half of their part along its longest side."""
    order = np.argsort(part, kind="stable")
    order = order[np.searchsorted(part[order], 0) :]
    start = np.flatnonzero(np.diff(part[order], prepend=-1))
    size = np.diff(start, append=len(order))
    spots = points[order]
    extent = np.maximum.reduceat(spots, start) - np.minimum.reduceat(spots, start)
    along = points[order, np.repeat(extent.argmax(axis=1), size)]
    ranked = order[np.lexsort((along, part[order]))]
    side = np.zeros(len(points), dtype=np.int64)
    side[ranked] = np.arange(len(order)) - np.repeat(start, size) >= np.repeat(size // 2, size)
    return side
