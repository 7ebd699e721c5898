"""One smallest step of a large grid, by conjugate gradients and without any matrix.

A net of m x n quads is an array P (3, m+1, n+1), coordinates first; f and y (2, m, n) hold
two numbers a face.  The Jacobian of the two logarithms of a face is the pair of blocks
A = (A1, A2), (2, 2, 3, m, n): J x = A1 (x1 - x3) + A2 (x4 - x2) with the corners of `mesh`.

Paper: Sec. 6.3 (beyond the paper).
"""

import numpy as np
from scipy import fft

INEXACT = 1e-4  # relative residual of the conjugate gradients


def step(A, f):
    """(d, iterations): the smallest change with J d = f, nearly; d (3, m+1, n+1).

    Paper: Sec. 6.3 (linear systems).
    """
    y, count = solve(A, f)
    return transposed(A, y), count


def equations(P, log_lam, log_mu):
    """(f, A): log |d2| / |d1| - log_lam and log |m13| / |m24| - log_mu, and the Jacobian.

    The same equations as `constraints.log_ratios` for the faces of a grid.

    Paper: Eq. (11), Eq. (12).
    """
    d1 = P[:, 1:, :-1] - P[:, :-1, 1:]
    d2 = P[:, 1:, 1:] - P[:, :-1, :-1]
    s1, s2, c = ((a * b).sum(axis=0) for a, b in ((d1, d1), (d2, d2), (d1, d2)))
    p, q = s1 + s2 + 2 * c, s1 + s2 - 2 * c  # (2 m13)^2 and (2 m24)^2
    f = np.stack([0.5 * np.log(s2 / s1) - log_lam, 0.5 * np.log(p / q) - log_mu])
    A = np.empty((2, 2, *d1.shape))
    A[0, 0], A[1, 0] = d1 / s1, d2 / s2
    plus, minus = 1 / p + 1 / q, 1 / p - 1 / q
    A[0, 1] = -minus * d1 - plus * d2
    A[1, 1] = plus * d1 + minus * d2
    return f, A


def times(A, x):
    """J x, (2, m, n), of vectors x (3, m+1, n+1) at the vertices.

    Paper: Sec. 6.3 (linear systems).
    """
    one, two = x[:, :-1, 1:] - x[:, 1:, :-1], x[:, 1:, 1:] - x[:, :-1, :-1]
    rows = "rkij,kij->rij"
    return np.einsum(rows, A[0], one) + np.einsum(rows, A[1], two)


def transposed(A, y):
    """J^T y, (3, m+1, n+1), of the face values y (2, m, n).

    Paper: Sec. 6.3 (linear systems).
    """
    x = np.zeros((3, y.shape[1] + 1, y.shape[2] + 1))
    one, two = (np.einsum("rkij,rij->kij", a, y) for a in A)
    x[:, :-1, 1:] += one
    x[:, 1:, :-1] -= one
    x[:, 1:, 1:] += two
    x[:, :-1, :-1] -= two
    return x


def solve(A, f, tolerance=INEXACT, most=300):
    """(y, iterations) with J J^T y = f up to the relative residual: conjugate gradients.

    Paper: Sec. 6.3 (linear systems).
    """
    precondition = preconditioner(A)
    y, r = np.zeros_like(f), f.copy()
    z = precondition(r)
    p, rz = z.copy(), _dot(r, z)
    enough = tolerance**2 * _dot(f, f)
    for k in range(most):
        if _dot(r, r) <= enough:
            return y, k
        q = times(A, transposed(A, p))
        step = rz / _dot(p, q)
        y += step * p
        r -= step * q
        z = precondition(r)
        before, rz = rz, _dot(r, z)
        p = z + (rz / before) * p
    return y, most


def _dot(a, b):
    return np.einsum("rij,rij->", a, b)  # np.vdot would start threads that only wait here


def preconditioner(A):
    """A function z(r), symmetric positive definite, nearly the inverse of J J^T.

    Each face is scaled by the Cholesky factor of its 2 x 2 block; what remains is nearly the
    same at every face and is inverted by fast sine transforms: in a wave with the cosines a
    and b along the two directions it is 1 - a b + 2 K (b - a), K the mean coupling of
    neighbours across u-edges minus that across v-edges.  In single precision.

    Paper: Sec. 6.3 (linear systems).
    """
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
    d00, d01, d11 = (
        2 * sum(np.einsum("kij,kij->ij", a[r], a[s]) for a in A)
        for r, s in ((0, 0), (0, 1), (1, 1))
    )
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
