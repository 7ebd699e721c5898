"""Sheared grids in the complex plane and their conformal images.

Points of the plane are complex numbers; a grid is a complex array z (m+1, n+1) with u along
the first axis and v along the second.

Paper: Sec. 3.3, App. A.2.
"""

import numpy as np

from . import mesh, parallelogram
from .planar import planar_net as planar_net


def shear(z, theta0):
    """The shear x + iy -> x + y cot(theta0) + iy, which tilts vertical lines to theta0.

    z: complex number or array; theta0: radians in (0, pi).
    """
    parallelogram.ratios(np.pi / 2, theta0)  # raises for an angle out of range
    return z + np.imag(z) / np.tan(theta0)


def unit(direction):
    """The complex number of length 1 along a direction; ValueError for 0, NaN and infinity."""
    if not (np.isfinite(direction) and abs(direction) > 0):
        raise ValueError(f"direction = {direction}: a complex number other than 0 is wanted")
    return direction / abs(direction)


def sheared_grid(theta, theta0, m, n, origin=0, edge=1.0, direction=1, kappa=0):
    """A planar grid of congruent parallelograms, complex (m+1, n+1).

    Its lines meet at theta0 and the diagonals of its cells at theta, so its mid-edge
    parallelograms are (theta, theta0)-parallelograms.  z[i, j] = origin + i u + j v with
    |u| = edge along `direction` (a complex number, its length ignored) and
    v = u exp(i theta0) / mu: the slanted edge is 1/mu times the other one.

    kappa is f'''/f' of the map f that is to follow, where that is constant: 0 (default) for
    z and z^2, 1 for exp, -1 for sin and cos, c^2 for exp(cz).  The image of the grid then
    has both angles exactly, at any size of the cells; the grid itself up to O(edge^2).

    Paper: Sec. 3.3, App. A.2 (beyond the paper: B3, kappa: B6).
    """
    lam, mu = parallelogram.ratios(theta, theta0)
    m, n = mesh.check_counts(m, n)
    if not (np.isfinite(edge) and edge > 0):
        raise ValueError(f"edge = {edge}: a positive length is wanted")
    u = edge * unit(direction)
    rho = parallelogram.rho(lam, mu)
    half = np.sqrt(complex(kappa)) / 2
    v = np.arctanh(rho * np.tanh(half * u)) / half if kappa else rho * u
    return origin + u * np.arange(m + 1)[:, None] + v * np.arange(n + 1)[None, :]


def quads(z):
    """A grid as a mesh (V, Q) in the plane z = 0; see `mesh.grid_quads` for the numbering.

    z: complex (m+1, n+1), finite.
    """
    z = np.asarray(z, dtype=complex)
    if z.ndim != 2 or min(z.shape) < 2:
        raise ValueError(f"z has the shape {z.shape}: a grid of at least 2 x 2 points is wanted")
    V = np.stack([z.real.ravel(), z.imag.ravel(), np.zeros(z.size)], axis=1)
    if not np.isfinite(V).all():
        bad = np.unravel_index(np.argmin(np.isfinite(z).ravel()), z.shape)
        raise ValueError(
            f"grid point {tuple(map(int, bad))} is not finite: is it a pole of the map?"
        )
    return V, mesh.grid_quads(z.shape[0] - 1, z.shape[1] - 1)


def complex_ratios(z):
    """(K, R) of every cell of a grid: K = d2 / d1 and R = m24 / m13, complex (m, n).

    An isogonal net has the constants K = lam exp(i theta) and R = exp(i theta0) / mu.

    Paper: Eq. (11), Eq. (12) in complex form (beyond the paper: B6).
    """
    v1, v2, v3, v4 = z[:-1, 1:], z[:-1, :-1], z[1:, :-1], z[1:, 1:]
    d1, d2 = v3 - v1, v4 - v2
    return d2 / d1, (d2 - d1) / (d1 + d2)


# --- exact images of straight lines -------------------------------------------------------


def inversion_circle(point, direction):
    """Centre (complex) and radius of the circle onto which 1/z takes a line.

    The line runs through `point` along `direction`; ValueError when it meets 0, because
    its image is then a line.  Numbers or sympy symbols, as in `square_conic`.

    Paper: App. A.2 (1/z).
    """
    (a, b), h = _parts(direction), _moment(point, direction)
    xp = parallelogram.library(a, b, h)
    length = xp.sqrt(a * a + b * b)
    if xp is np and abs(h) <= 1e-14 * length * abs(point):
        raise ValueError("the line passes through 0: 1/z takes it to a line, not to a circle")
    # The point of the line nearest to 0 is i h / conj(direction): its image ends a diameter.
    return -(b + a * (1j if xp is np else xp.I)) / (2 * h), length / abs(2 * h)


def square_conic(point, direction):
    """Coefficients (A, B, C, D, E, F) of the parabola onto which z^2 takes a line.

    A u^2 + B u v + C v^2 + D u + E v + F = 0 in w = u + iv; numbers or sympy symbols (real
    and imaginary parts are then taken by `as_real_imag`).  B^2 = 4 A C always: for a line
    through 0 it is a doubled ray.

    Paper: App. A.2 (z^2).
    """
    (a, b), h = _parts(direction), _moment(point, direction)
    s, t = a * a - b * b, 2 * a * b  # direction^2: the axis of the parabola
    # In z' = conj(direction) z = x + ih, z'^2 = x^2 - h^2 + 2ihx, so V^2 = 4 h^2 (U + h^2)
    # for U + iV = conj(direction)^2 w = (s u + t v) + i (s v - t u).
    return t * t, -2 * s * t, s * s, -4 * h**2 * s, -4 * h**2 * t, -4 * h**4


def _parts(z):
    return z.as_real_imag() if hasattr(z, "as_real_imag") else (np.real(z), np.imag(z))


def _moment(point, direction):
    """h of the line Im(conj(direction) z) = h."""
    (a, b), (c, d) = _parts(direction), _parts(point)
    if a == 0 and b == 0:
        raise ValueError("direction = 0: a line needs a direction other than 0")
    return a * d - b * c


def square_bezier(start, end):
    """The image of a segment under z^2 as the three control points of a quadratic Bezier curve.

    start, end: complex numbers or arrays.  Exact: ((1-t) s + t e)^2 is a quadratic in t.

    Paper: App. A.2 (z^2), Fig. 3.
    """
    return start**2, start * end, end**2


def image_lines(f, z, samples=33):
    """The two families of grid lines under a map, as finely sampled complex polylines.

    f: a function of a complex array.  Returns (u_lines, v_lines), arrays
    (n+1, m (samples-1) + 1) and (m+1, n (samples-1) + 1): each straight edge of the grid is
    sampled at `samples` points (at least 2) before it is mapped.

    Paper: Fig. 3.
    """
    if samples < 2:
        raise ValueError(f"samples = {samples}: an edge needs at least its 2 ends")
    return f(_refine(z, samples).T), f(_refine(z.T, samples).T)


def _refine(z, samples):
    t = np.arange((z.shape[0] - 1) * (samples - 1) + 1) / (samples - 1)
    low = np.minimum(t.astype(int), z.shape[0] - 2)
    part = (t - low)[:, None]
    return (1 - part) * z[low] + part * z[low + 1]


# --- Moebius transformations of the plane -------------------------------------------------


def moebius(M, z):
    """(a z + b) / (c z + d) for the matrix M = [[a, b], [c, d]] and points z.

    Products of matrices are compositions, `numpy.linalg.inv` the inverse map.  ValueError
    when det M = 0 or when a point lies on the pole -d/c.
    """
    M = np.asarray(M, dtype=complex)
    if M.shape != (2, 2) or not np.isfinite(M).all():
        raise ValueError("M must be a 2 x 2 matrix of finite complex numbers")
    (a, b), (c, d) = M
    if abs(a * d - b * c) <= 1e-14 * (abs(a * d) + abs(b * c)):
        raise ValueError("det M = 0: the map takes everything to one point")
    z = np.asarray(z, dtype=complex)
    denominator = c * z + d
    pole = np.abs(denominator) <= 1e-14 * (np.abs(c * z) + abs(d))
    if pole.any():
        bad = [int(k) for k in np.unravel_index(np.argmax(pole), pole.shape)]
        raise ValueError(f"point z{bad or ''} lies on the pole {-d / c + 0:.6g} of the map")
    return (a * z + b) / denominator


def moebius_through(z, w):
    """The matrix of the Moebius transformation with z[k] -> w[k] for three distinct points."""
    return np.linalg.inv(_to_zero_one_infinity(w)) @ _to_zero_one_infinity(z)


def _to_zero_one_infinity(p):
    p0, p1, p2 = np.asarray(p, dtype=complex)
    if p0 == p1 or p1 == p2 or p2 == p0 or not np.isfinite([p0, p1, p2]).all():
        raise ValueError(f"three distinct finite points are wanted, not {p0}, {p1}, {p2}")
    return np.array([[p1 - p2, -p0 * (p1 - p2)], [p1 - p0, -p2 * (p1 - p0)]])


# --- How far the image of a finite cell under a conformal map is from the cell's own ratios. ---


def cell_errors(f, z, u, v):
    """(ln K/K0, ln R/R0) of the image of a cell under f, complex.

    f: a function of a complex array; z, u, v: complex numbers, u and v not parallel.

    Paper: Sec. 3.3 (beyond the paper: B6).
    """
    if not (np.imag(np.conj(u) * v) != 0 and np.isfinite([z, u, v]).all()):
        raise ValueError(f"u = {u}, v = {v}: finite edges that are not parallel are wanted")
    cell = z + np.array([[-u - v, v - u], [u - v, u + v]]) / 2
    K, R = (x[0, 0] for x in complex_ratios(np.asarray(f(cell))))
    return np.log(K * (u - v) / (u + v)), np.log(R * u / v)


def leading_errors(first, third, u, v):
    """What `cell_errors` are to second order: (S u v / 6, S (u^2 - v^2) / 12), S = third / first.

    first, third: f' and f''' at the centre of the cell, numbers, arrays or sympy symbols;
    ValueError where the number f' is 0.

    Paper: Sec. 3.3 (beyond the paper: B6).
    """
    if not hasattr(first, "free_symbols") and not np.all(first):
        raise ValueError("f' = 0: the map is not conformal there")
    return third / first * u * v / 6, third / first * (u**2 - v**2) / 12


def kappa(f, z):
    """f'''/f' of a sympy expression f in the symbol z, simplified.

    Where it is a constant, and only there, the ratios of all images of congruent cells agree
    at every mesh size: f is then a + b z + c z^2 or a + b exp(gz) + c exp(-gz), kappa = g^2.
    This is the number that `conformal.sheared_grid` takes.  ValueError for a constant f.

    Paper: Sec. 3.3 (beyond the paper: B6).
    """
    import sympy

    f = sympy.sympify(f)
    if sympy.simplify(f.diff(z)) == 0:
        raise ValueError(f"{f} does not depend on {z}")
    return sympy.simplify(f.diff(z, 3) / f.diff(z))
