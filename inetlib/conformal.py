"""Sheared grids in the complex plane, their images, and which maps keep the ratios exact.

Points of the plane are complex numbers; a grid is a complex array z (m+1, n+1) with u along
the first axis and v along the second."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from . import mesh
from .parallelogram import Number, check_angle, check_positive, check_whole, library, ratios, rho
from .planar import planar_net as planar_net


def shear(z: ArrayLike, theta0: float) -> np.ndarray:
    """x + iy -> x + y cot(theta0) + iy, which tilts vertical lines to theta0."""
    return z + np.imag(z) / np.tan(check_angle("theta0", theta0))


def unit(direction: complex) -> complex:
    """The complex number of length 1 along a direction; ValueError for 0, NaN and infinity."""
    if not (np.isfinite(direction) and abs(direction) > 0):
        raise ValueError(f"direction = {direction}: a complex number other than 0 is wanted")
    return direction / abs(direction)


def sheared_grid(
    theta: float,
    theta0: float,
    m: int,
    n: int,
    origin: complex = 0,
    edge: float = 1.0,
    direction: complex = 1,
    kappa: complex = 0,
) -> np.ndarray:
    """A planar grid of congruent cells with (theta, theta0)-parallelograms inside.

    Its lines meet at theta0 and the diagonals of its cells at theta.  z[i, j] = origin + i u + j v
    with |u| = edge along `direction` (its length ignored) and v = u exp(i theta0) / mu.

    kappa is f'''/f' of the map f that is to follow, where that is constant: 0 for z and z^2,
    1 for exp, -1 for sin and cos, c^2 for exp(cz).  The image of the grid then has both angles
    exactly, at any size of the cells; the grid itself up to O(edge^2).  Paper: App. A.2, B3, B6."""
    shape = rho(*ratios(theta, theta0))
    m, n = check_whole("m", m), check_whole("n", n)
    u = check_positive("edge", edge) * unit(direction)
    half = np.sqrt(complex(kappa)) / 2
    v = np.arctanh(shape * np.tanh(half * u)) / half if kappa else shape * u
    return origin + u * np.arange(m + 1)[:, None] + v * np.arange(n + 1)[None, :]


def quads(z: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """A finite grid as a mesh (V, Q) in the plane z = 0; numbered as by `mesh.grid_quads`."""
    z = np.asarray(z, dtype=complex)
    if z.ndim != 2 or min(z.shape) < 2:
        raise ValueError(f"z has the shape {z.shape}: a grid of at least 2 x 2 points is wanted")
    if not np.isfinite(z).all():
        i, j = np.argwhere(~np.isfinite(z))[0].tolist()
        raise ValueError(f"grid point {i, j} is not finite: is it a pole of the map?")
    V = np.stack([z.real.ravel(), z.imag.ravel(), np.zeros(z.size)], axis=1)
    return V, mesh.grid_quads(z.shape[0] - 1, z.shape[1] - 1)


def complex_ratios(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(K, R) of every cell: d2 / d1 = lam exp(i theta) and m24 / m13 = exp(i theta0) / mu.

    Paper: Eq. (11), Eq. (12) in complex form, B6."""
    v1, v2, v3, v4 = z[:-1, 1:], z[:-1, :-1], z[1:, :-1], z[1:, 1:]
    d1, d2 = v3 - v1, v4 - v2
    return d2 / d1, (d2 - d1) / (d1 + d2)


def _line(point, direction):
    """(a, b, h) of a line a y - b x = h with the direction a + ib, not 0."""
    (a, b), (x, y) = (
        z.as_real_imag() if hasattr(z, "as_real_imag") else (np.real(z), np.imag(z))
        for z in (direction, point)
    )
    if a == 0 and b == 0:
        raise ValueError("direction = 0: a line needs a direction other than 0")
    return a, b, a * y - b * x


def inversion_circle(point: Number, direction: Number) -> tuple[Number, Number]:
    """Centre and radius of the circle onto which 1/z takes a line.  Paper: App. A.2."""
    a, b, h = _line(point, direction)
    xp = library(a, b, h)
    length = xp.sqrt(a * a + b * b)
    if xp is np and abs(h) <= 1e-14 * length * abs(point):
        raise ValueError("the line passes through 0: 1/z takes it to a line, not to a circle")
    # The point of the line nearest to 0 is i h / conj(direction): its image ends a diameter.
    return -(b + a * (1j if xp is np else xp.I)) / (2 * h), length / abs(2 * h)


def square_conic(point: Number, direction: Number) -> tuple[Number, ...]:
    """(A, B, C, D, E, F) of the parabola onto which z^2 takes a line; B^2 = 4 A C.

    A u^2 + B u v + C v^2 + D u + E v + F = 0 in w = u + iv; a doubled ray where the line meets 0.
    Paper: App. A.2."""
    a, b, h = _line(point, direction)
    s, t = a * a - b * b, 2 * a * b  # direction^2: the axis of the parabola
    # In z' = conj(direction) z = x + ih, z'^2 = x^2 - h^2 + 2ihx, so V^2 = 4 h^2 (U + h^2)
    # for U + iV = conj(direction)^2 w = (s u + t v) + i (s v - t u).
    return t * t, -2 * s * t, s * s, -4 * h**2 * s, -4 * h**2 * t, -4 * h**4


def image_lines(f: Callable, z: np.ndarray, samples: int = 33) -> tuple[np.ndarray, np.ndarray]:
    """The two families of grid lines under a map f of complex arrays, finely sampled.

    Each straight edge of the grid is sampled at `samples` points, 2 or more, before it is
    mapped: (n+1, m (samples-1) + 1) along u and (m+1, n (samples-1) + 1) along v.  Paper: Fig. 3.
    """
    samples = check_whole("samples", samples, 2)
    return f(_refine(z, samples).T), f(_refine(z.T, samples).T)


def _refine(z, samples):
    t = np.arange((z.shape[0] - 1) * (samples - 1) + 1) / (samples - 1)
    low = np.minimum(t.astype(int), z.shape[0] - 2)
    part = (t - low)[:, None]
    return (1 - part) * z[low] + part * z[low + 1]


def moebius(M: ArrayLike, z: ArrayLike) -> np.ndarray:
    """(a z + b) / (c z + d) for the matrix M = [[a, b], [c, d]] and points z.

    Products of matrices are compositions.  ValueError when det M = 0 or a point is the pole."""
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
        bad = np.argwhere(pole)[0].tolist()
        raise ValueError(f"point z{bad or ''} lies on the pole {-d / c + 0:.6g} of the map")
    return (a * z + b) / denominator


def moebius_through(z: ArrayLike, w: ArrayLike) -> np.ndarray:
    """The matrix of the Moebius transformation with z[k] -> w[k] for three distinct points."""
    return np.linalg.inv(_to_zero_one_infinity(w)) @ _to_zero_one_infinity(z)


def _to_zero_one_infinity(p):
    p0, p1, p2 = np.asarray(p, dtype=complex)
    if p0 == p1 or p1 == p2 or p2 == p0 or not np.isfinite([p0, p1, p2]).all():
        raise ValueError(f"three distinct finite points are wanted, not {p0}, {p1}, {p2}")
    return np.array([[p1 - p2, -p0 * (p1 - p2)], [p1 - p0, -p2 * (p1 - p0)]])


def cell_errors(f: Callable, z: complex, u: complex, v: complex) -> tuple[complex, complex]:
    """(ln K/K0, ln R/R0) of the image of the cell with edges u, v around z.  Paper: B6."""
    if not (np.imag(np.conj(u) * v) != 0 and np.isfinite([z, u, v]).all()):
        raise ValueError(f"u = {u}, v = {v}: finite edges that are not parallel are wanted")
    cell = z + np.array([[-u - v, v - u], [u - v, u + v]]) / 2
    K, R = (x[0, 0] for x in complex_ratios(np.asarray(f(cell))))
    return np.log(K * (u - v) / (u + v)), np.log(R * u / v)


def leading_errors(first: Number, third: Number, u: Number, v: Number) -> tuple[Number, Number]:
    """`cell_errors` to second order, from f' and f''' at the centre of the cell.  Paper: B6."""
    if library(first) is np and not np.all(first):
        raise ValueError("f' = 0: the map is not conformal there")
    return third / first * u * v / 6, third / first * (u**2 - v**2) / 12


def kappa(f: Number, z: Number) -> Number:
    """f'''/f' of a sympy expression f in the symbol z, simplified; ValueError for a constant f.

    Where it is a constant, and only there, the ratios of all images of congruent cells agree at
    every mesh size: f is a + b z + c z^2 or a + b exp(gz) + c exp(-gz), kappa = g^2.  Paper: B6."""
    import sympy

    f = sympy.sympify(f)
    if sympy.simplify(f.diff(z)) == 0:
        raise ValueError(f"{f} does not depend on {z}")
    return sympy.simplify(f.diff(z, 3) / f.diff(z))
