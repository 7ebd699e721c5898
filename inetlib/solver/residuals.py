"""Residuals and Jacobians of the optimisation: one equation, one short function.

Every function takes the local variables of many places at once, x (f, k) with one row for
each place, and returns (residual (f, q), jacobian (f, q, k)).  The corners of a face are the
first 12 entries of its row, (x, y, z) of v1, v2, v3, v4; of a polyline's three neighbouring
vertices 9, of a single vertex 3.  Auxiliary variables follow in the order that is stated.
Where these rows sit in the unknowns, how they are weighted and solved, is not known here."""

import numpy as np

Local = tuple[np.ndarray, np.ndarray]  # residual and Jacobian

# d1 = v3 - v1, d2 = v4 - v2, v3 + v4 - v1 - v2 and v1 + v4 - v2 - v3 (twice the medial
# lines) in terms of the corners
SIGNS = np.array([[-1, 0, 1, 0], [0, -1, 0, 1], [-1, -1, 1, 1], [1, -1, -1, 1]], dtype=float)


def _vectors(x, rows):
    """The chosen vectors of `SIGNS`, (v, f, 3)."""
    return np.einsum("vc,fcx->vfx", SIGNS[rows], x[:, :12].reshape(-1, 4, 3))


def _dot(a, b):
    return np.einsum("...x,...x->...", a, b)


def _by_corners(gradients, rows):
    """Derivatives (f, 12) of a function with these gradients (v, f, 3) in the vectors `rows`."""
    return np.einsum("vfx,vc->fcx", gradients, SIGNS[rows]).reshape(-1, 12)


def logarithms(d1: np.ndarray, d2: np.ndarray, p: np.ndarray, q: np.ndarray) -> Local:
    """log |d2| / |d1| and log |p| / |q|, (2, ...), and their gradients (2, 2, 3, ...).

    d1, d2, p = d1 + d2 = 2 m13, q = d2 - d1 = 2 m24: (3, ...).  The gradients are those in
    -d1 and d2 (first axis) of log lam and log mu (second).  Paper: Eq. (11), Eq. (12)."""
    s1, s2, sp, sq = (np.einsum("x...,x...->...", a, a) for a in (d1, d2, p, q))
    found = 0.5 * np.log(np.stack([s2 / s1, sp / sq]))
    gradients = np.empty((2, 2, *d1.shape))
    gradients[0, 0], gradients[1, 0] = d1 / s1, d2 / s2
    p, q = p / sp, q / sq
    gradients[0, 1], gradients[1, 1] = -p - q, p - q
    return found, gradients


def log_ratios(x: np.ndarray) -> Local:
    """(log lam, log mu) of the faces: logarithms of |d2| / |d1| and |m13| / |m24|.

    x: (f, 12).  Free of scale; subtract the wanted logarithms to get a residual.
    Paper: Eq. (11), Eq. (12)."""
    v1, v2, v3, v4 = np.ascontiguousarray(x.T).reshape(4, 3, -1)
    d1, d2 = v3 - v1, v4 - v2
    found, (one, two) = logarithms(d1, d2, d1 + d2, d2 - d1)
    jacobian = np.stack([one, -two, -one, two], axis=1)  # (ratio, corner, xyz, face)
    return found.T, np.moveaxis(jacobian, 3, 0).reshape(-1, 2, 12)


def scaled_ratios(x: np.ndarray, lam: float, mu: float, sizes: np.ndarray | None = None) -> Local:
    """(d2^2 - lam^2 d1^2) / (2 lam size1) and the same for m13, m24, mu and size2.

    x: (f, 12); sizes (f, 2) are numbers without derivatives, |d1| |d2| and |m13| |m24| if
    None.  Then the derivatives are those of `log_ratios` at a solution, while the residual
    stays a polynomial and does not explode where an edge collapses.  Paper: Eq. (11), Eq. (12)."""
    d1, d2, p, q = vectors = _vectors(x, [0, 1, 2, 3])
    vectors[2:] /= 2
    if sizes is None:
        lengths = np.linalg.norm(vectors, axis=2)
        sizes = (lengths[::2] * lengths[1::2]).T
    scale = 2 * np.array([lam, mu]) * sizes
    residual = _dot(d2, d2) - lam**2 * _dot(d1, d1), _dot(p, p) - mu**2 * _dot(q, q)
    one = _by_corners(np.stack([-2 * lam**2 * d1, 2 * d2]), [0, 1])
    two = _by_corners(np.stack([p, -(mu**2) * q]), [2, 3])
    return np.stack(residual, axis=1) / scale, np.stack([one, two], axis=1) / scale[..., None]


def squared_diagonals(x: np.ndarray) -> Local:
    """d1^2 - La and d2^2 - Lb; x: corners, La, Lb (f, 14).  Paper: Eq. (17)."""
    return _squared(x, [0, 1])


def squared_medials(x: np.ndarray) -> Local:
    """(2 m13)^2 - Lp and (2 m24)^2 - Lq; x: corners, Lp, Lq (f, 14).  Paper: Eq. (18)."""
    return _squared(x, [2, 3])


def _squared(x, rows):
    vectors = _vectors(x, rows)
    jacobian = np.zeros((len(x), 2, 14))
    for k in (0, 1):
        jacobian[:, k, :12] = _by_corners(2 * vectors[k : k + 1], rows[k : k + 1])
        jacobian[:, k, 12 + k] = -1
    return _dot(vectors, vectors).T - x[:, 12:], jacobian


def proportional(x: np.ndarray) -> Local:
    """L - c K; x: (L, K, c), (f, 3).  Lb = c1 La, and Lp = c2 Lq (printed the other way round).

    Paper: Eq. (17), Eq. (18)."""
    L, K, c = x.T
    return (L - c * K)[:, None], np.stack([np.ones_like(L), -c, -K], axis=1)[:, None]


def square_root(x: np.ndarray) -> Local:
    """lam^2 - c1, or mu^2 - c2; x: (ratio, its square), (f, 2).  Paper: Eq. (17), Eq. (18)."""
    root, square = x.T
    return (root**2 - square)[:, None], np.stack([2 * root, -np.ones_like(root)], 1)[:, None]


def given(x: np.ndarray, value: float) -> Local:
    """x - value; x: (f, 1), a ratio with a wanted value.  Paper: Eq. (19), Eq. (22)."""
    return x - value, np.ones((len(x), 1, 1))


def given_angle(x: np.ndarray, angle: float) -> Local:
    """(1 + c1)(c2 - 1) - 2 cos theta lam (1 + c2); x: (lam, c1, c2), (f, 3).

    The same function of (mu, c2, c1) and theta0.  Paper: Eq. (20)."""
    (ratio, c1, c2), k = x.T, 2 * np.cos(angle)
    residual = (1 + c1) * (c2 - 1) - k * ratio * (1 + c2)
    columns = [-k * (1 + c2), c2 - 1, 1 + c1 - k * ratio]
    return residual[:, None], np.stack(columns, axis=1)[:, None]


def theta_quad(x: np.ndarray) -> Local:
    """d2^2 - d1^2 - 2 d1 . d2 (theta = theta0); x: corners (f, 12).  Paper: Eq. (13), Eq. (21)."""
    d1, d2 = _vectors(x, [0, 1])
    residual = _dot(d2, d2) - _dot(d1, d1) - 2 * _dot(d1, d2)
    gradient = _by_corners(np.stack([-2 * (d1 + d2), 2 * (d2 - d1)]), [0, 1])
    return residual[:, None], gradient[:, None]


def distances(x: np.ndarray, feet: np.ndarray, *normals: np.ndarray) -> Local:
    """(v - p) . n for each of the normals: the distances of points from planes; all (k, 3)."""
    frame = np.stack(normals, axis=1)
    return np.einsum("kqx,kx->kq", frame, x - feet), frame
