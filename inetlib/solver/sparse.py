"""Sparse matrices from local Jacobians, and their factorisation.

From `step` on: a smallest step of a large grid, by conjugate gradients without any matrix."""

from collections.abc import Callable

import numpy as np
from scipy import fft
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded
from scipy.sparse import csr_array
from scipy.sparse.linalg import LinearOperator, cg, splu
from threadpoolctl import ThreadpoolController

from .residuals import logarithms

BLAS = ThreadpoolController()
NARROW = 500  # up to this bandwidth a band is faster than a sparse factor
MANY = 5000  # from here on nested dissection beats minimum degree
LEAF = 16  # points that need no further division
INEXACT = 1e-4  # relative residual of the conjugate gradients


def rows(jacobian: np.ndarray, index: np.ndarray, columns: int) -> csr_array:
    """Local Jacobians (f, q, k) as a sparse matrix (f q, columns).

    index: (f, k), the column of each local variable; within a row all different."""
    f, q, k = jacobian.shape
    whole = np.int32 if max(columns, f * q * k) < 2**31 else np.int64  # SciPy checks the longer
    index, ends = np.asarray(index, dtype=whole), np.arange(0, f * q * k + 1, k, dtype=whole)
    pattern = np.repeat(index, q, axis=0).ravel(), ends
    return csr_array((np.ascontiguousarray(jacobian).ravel(), *pattern), shape=(f * q, columns))


def coordinates(vertices: np.ndarray) -> np.ndarray:
    """Columns of the coordinates of vertices (f, c): (f, 3 c)."""
    vertices = np.asarray(vertices)
    return (3 * vertices[..., None] + np.arange(3)).reshape(len(vertices), -1)


def scaled(A: csr_array, columns: np.ndarray | float) -> csr_array:
    """A with its columns multiplied by numbers, (columns,) or one; CSR."""
    data = A.data * (columns[A.indices] if np.ndim(columns) else columns)
    return csr_array((data, A.indices, A.indptr), shape=A.shape)


def factor(A: csr_array, order: np.ndarray | None = None) -> Callable:
    """A function that solves A x = b, for a symmetric positive definite sparse A.

    order: a permutation of the rows, such as that of `nested_dissection`; without one, a band
    where A is narrow, else minimum degree on the pattern of A + A^T, many times faster here
    than SuperLU's default.  Pivots are on the diagonal."""
    if order is None:
        return _banded(A) or _superlu(A.tocsc(), "MMD_AT_PLUS_A").solve
    inner = _superlu(A.tocsr()[order].tocsc()[:, order], "NATURAL").solve

    def solve(b):
        x = np.empty_like(b)
        x[order] = inner(b[order])
        return x

    return solve


class Factor:
    """`factor` for matrices of one pattern, ordered only once; points: see `nested_dissection`."""

    def __init__(self, points):
        self.points, self.order = points, None

    def __call__(self, A):
        if self.order is None:
            if narrow := _banded(A):
                return narrow
            if len(self.points) < MANY:
                factors = _superlu(A.tocsc(), "MMD_AT_PLUS_A")
                self.order = np.argsort(factors.perm_c)
                return factors.solve
            self.order = nested_dissection(self.points, A)
        return factor(A, self.order)


def _superlu(A, ordering):
    return splu(A, ordering, diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def _banded(A):
    """`factor` by a banded Cholesky factor; None where A is too wide or not positive."""
    A = A.tocsr()
    count = A.shape[0]
    width = int((np.arange(count) - np.minimum.reduceat(A.indices, A.indptr[:-1])).max())
    if width > NARROW:
        return None
    below = np.repeat(np.arange(count), np.diff(A.indptr)) - A.indices
    low = below >= 0
    band = np.zeros((width + 1, count), dtype=A.dtype, order="F")
    band[below[low], A.indices[low]] = A.data[low]
    try:
        with BLAS.limit(limits=1, user_api="blas"):  # on small blocks more threads only wait
            factors = cholesky_banded(band, overwrite_ab=True, lower=True, check_finite=False)
    except LinAlgError:
        return None
    return lambda b: cho_solve_banded((factors, True), b, check_finite=False)


def nested_dissection(points: np.ndarray, A: csr_array) -> np.ndarray:
    """A permutation of the rows of A that keeps its factors sparse, by halving again and again.

    points (k, d): where the unknowns are, A (b k, b k): b in a row at each point; only its
    pattern counts.  Of each half of the points, those with a neighbour in the other half come
    last.  Twice as fast as minimum degree from some 10 000 points on."""
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


def step(A: np.ndarray, f: np.ndarray) -> tuple[np.ndarray, int]:
    """(d, iterations): the smallest change with J d = f, nearly; d (3, m+1, n+1)."""
    y, count = solve(A, f)
    return transposed(A, y), count


def equations(P: np.ndarray, log_lam: float, log_mu: float) -> tuple[np.ndarray, np.ndarray]:
    """(f, A): log |d2| / |d1| - log_lam and log |m13| / |m24| - log_mu, and the gradients.

    f (2, m, n), A (2, 2, 3, m, n) as in `residuals.logarithms`: for the faces of a grid.
    Paper: Eq. (11), Eq. (12)."""
    d1, d2 = P[:, 1:, :-1] - P[:, :-1, 1:], P[:, 1:, 1:] - P[:, :-1, :-1]
    f, A = logarithms(d1, d2, d1 + d2, d2 - d1)
    f[0] -= log_lam
    f[1] -= log_mu
    return f, A


def times(A: np.ndarray, x: np.ndarray) -> np.ndarray:
    """J x, (2, m, n), of vectors x (3, m+1, n+1) at the vertices."""
    one, two = x[:, :-1, 1:] - x[:, 1:, :-1], x[:, 1:, 1:] - x[:, :-1, :-1]
    rows = "rkij,kij->rij"
    return np.einsum(rows, A[0], one) + np.einsum(rows, A[1], two)


def transposed(A: np.ndarray, y: np.ndarray) -> np.ndarray:
    """J^T y, (3, m+1, n+1), of the face values y (2, m, n)."""
    x = np.zeros((3, y.shape[1] + 1, y.shape[2] + 1))
    one, two = (np.einsum("rkij,rij->kij", a, y) for a in A)
    x[:, :-1, 1:] += one
    x[:, 1:, :-1] -= one
    x[:, 1:, 1:] += two
    x[:, :-1, :-1] -= two
    return x


def solve(
    A: np.ndarray, f: np.ndarray, tolerance: float = INEXACT, most: int = 300
) -> tuple[np.ndarray, int]:
    """(y, iterations) with J J^T y = f up to the relative residual: conjugate gradients."""

    def flat(apply):
        shape = f.size, f.size
        return LinearOperator(shape, lambda x: apply(x.reshape(f.shape)).ravel(), dtype=float)

    matrix, M = flat(lambda y: times(A, transposed(A, y))), flat(preconditioner(A))
    steps: list = []
    with BLAS.limit(limits=1, user_api="blas"):  # more threads only wait here
        y, _ = cg(matrix, f.ravel(), rtol=tolerance, maxiter=most, M=M, callback=steps.append)
    return y.reshape(f.shape), len(steps)


def preconditioner(A: np.ndarray) -> Callable:
    """A function z(r), symmetric positive definite, nearly the inverse of J J^T.

    Each face is scaled by the Cholesky factor of its 2 x 2 block; what remains is nearly the
    same at every face and is inverted by fast sine transforms: in a wave with the cosines a
    and b along the two directions it is 1 - a b + 2 K (b - a), K the mean coupling of
    neighbours across u-edges minus that across v-edges.  In single precision."""
    scale = _scale(A)
    K = _coupling(A, scale)
    a, b = (np.cos(np.pi * np.arange(1, k + 1) / (k + 1)) for k in A.shape[3:])
    rest, across = 1 - a[:, None] * b, 2 * (b - a[:, None])
    t00, t01, t11 = rest + K[0, 0] * across, K[0, 1] * across, rest + K[1, 1] * across
    inverse = np.stack([t11, -t01, t00]) / (t00 * t11 - t01**2)
    i00, i10, i11, w00, w01, w11 = np.concatenate([scale, inverse]).astype(np.float32)

    def waves(z):
        return fft.dstn(z, type=1, norm="ortho", axes=(1, 2), overwrite_x=True)

    def apply(r):
        r = r.astype(np.float32)
        z = waves(np.stack([i00 * r[0], i10 * r[0] + i11 * r[1]]))
        z = waves(np.stack([w00 * z[0] + w01 * z[1], w01 * z[0] + w11 * z[1]]))
        return np.stack([i00 * z[0] + i10 * z[1], i11 * z[1]]).astype(np.float64)

    return apply


def _scale(A):
    """Entries 00, 10, 11 of the inverse Cholesky factors of the blocks of J J^T, (3, m, n)."""
    (d00, d01), (_, d11) = 2 * sum(np.einsum("rkij,skij->rsij", a, a) for a in A)
    i00, i11 = 1 / np.sqrt(d00), 1 / np.sqrt(d11 - d01**2 / d00)
    return np.stack([i00, -i11 * d01 / d00, i11])


def _coupling(A, scale):
    """K of `preconditioner`, (2, 2), symmetric, with eigenvalues below 0.475."""
    i00, i10, i11 = scale
    A1, A2 = (np.stack([i00 * a[0], i10 * a[0] + i11 * a[1]]) for a in A)  # scaled rows

    def mean(one, two):
        return np.einsum("rkij,skij->rs", one, two) / one[0, 0].size

    v = mean(A1[..., :-1], A2[..., 1:]) + mean(A2[..., :-1], A1[..., 1:])
    u = mean(A1[..., :-1, :], A2[..., 1:, :]) + mean(A2[..., :-1, :], A1[..., 1:, :])
    K = -(u + v + (u + v).T) / 4
    size = np.abs(np.linalg.eigvalsh(K)).max()
    return K * min(1, 0.475 / size) if size else K
