"""Moebius transformations of space, and the stereographic projection of the unit sphere.

A point x is lifted to X = (x, (|x|^2 - 1)/2, (|x|^2 + 1)/2), a vector of length 0 in the
Lorentz product <X, Y> = X0 Y0 + ... + X3 Y3 - X4 Y4; multiples of X mean the same point.
Inversions, and all they generate, are then the 5 x 5 matrices M that keep this product:
M2 @ M1 does M1 first, `numpy.linalg.inv(M)` undoes M.  Squared coordinates enter: keep the
net near the origin and the radius of an inversion about as large as the distance of its
centre, and 10 digits or more are right, there and back."""

import numpy as np
from numpy.typing import ArrayLike

from .parallelogram import check_positive
from .surfaces import Surface

LORENTZ = np.diag([1.0, 1.0, 1.0, 1.0, -1.0])
LORENTZ.setflags(write=False)


def lift(V: np.ndarray) -> np.ndarray:
    """The points V (..., 3) as lifted vectors (..., 5), X4 - X3 = 1; ValueError for NaN, inf."""
    V = _points(V)
    square = np.sum(V * V, axis=-1, keepdims=True)
    return np.concatenate([V, (square - 1) / 2, (square + 1) / 2], axis=-1)


def inversion(centre: ArrayLike = (0, 0, 0), radius: float = 1.0) -> np.ndarray:
    """The inversion x -> centre + radius^2 (x - centre) / |x - centre|^2 as a 5 x 5 matrix.

    centre: (3,), goes to infinity; radius > 0.  It is its own inverse and reverses the
    orientation.

    >>> apply(inversion(radius=2), [0, 0, 1])
    array([0., 0., 4.])"""
    centre, radius = np.asarray(centre, dtype=float), check_positive("radius", radius)
    if centre.shape != (3,) or not np.isfinite(centre).all():
        raise ValueError(f"centre = {centre}: three finite coordinates are wanted")
    k = centre @ centre - radius**2
    sphere = np.array([*centre, (k - 1) / 2, (k + 1) / 2])  # <sphere, sphere> = radius^2
    return np.eye(5) - 2 / radius**2 * np.outer(sphere, LORENTZ @ sphere)


def check(M: np.ndarray) -> np.ndarray:
    """M as a float array, or a ValueError when it is not a 5 x 5 Lorentz matrix.

    M^T J M = J with J = diag(1, 1, 1, 1, -1) must hold to 1e-9 of the largest entry squared."""
    M = np.asarray(M, dtype=float)
    if M.shape != (5, 5) or not np.isfinite(M).all():
        raise ValueError(f"M has the shape {M.shape}: a 5 x 5 matrix of finite numbers is wanted")
    off = np.abs(M.T @ LORENTZ @ M - LORENTZ).max()
    if off > 1e-9 * max(1, np.abs(M).max() ** 2):
        words = "multiply matrices of inversion"
        raise ValueError(f"M is no Lorentz matrix (M^T J M differs from J by {off:.3g}): {words}")
    return M


def apply(M: np.ndarray, V: np.ndarray) -> np.ndarray:
    """The images (..., 3) of the points V (..., 3) under the 5 x 5 Lorentz matrix M.

    ValueError for a matrix that is not Lorentz, and for a vertex that goes to infinity.
    Paper: Fig. 9."""
    M, X = check(M), lift(V)
    Y = X @ M.T
    weight = Y[..., 4] - Y[..., 3]
    infinite = np.abs(weight) <= 1e-12 * (np.abs(X) @ np.abs(M[4] - M[3]))
    _refuse(infinite, "vertex{} goes to infinity: move the pole off the net")
    return Y[..., :3] / weight[..., None]


def pole(M: np.ndarray) -> np.ndarray | None:
    """The point (3,) that M sends to infinity; None when M is a similarity."""
    # M^-1 = J M^T J takes the point at infinity, (0, 0, 0, 1, 1), back to the pole.
    X = LORENTZ @ check(M).T @ np.array([0, 0, 0, 1.0, -1.0])
    weight = X[4] - X[3]
    return None if abs(weight) <= 1e-12 * np.abs(X).max() else X[:3] / weight


def image(M: np.ndarray, surface: Surface) -> Surface:
    """The image of a whole `surfaces.Surface` under M, again a Surface; numbers only.

    An isothermal parametrisation stays isothermal.  Points that go to infinity are an
    error when they are asked for.  Paper: Fig. 9."""
    M = check(M)

    def coordinates(u, v):
        return tuple(np.moveaxis(apply(M, surface.point(u, v)), -1, 0))

    return Surface(f"Moebius image of the {surface.name}", coordinates)


def stereographic(V: np.ndarray) -> np.ndarray:
    """The points V (..., 3) of the unit sphere, seen from (0, 0, 1) in the plane z = 0: complex.

    ValueError for a vertex off the sphere by more than 1e-9 and for the north pole itself.
    Paper: Fig. 10."""
    x, y, z = np.moveaxis(_points(V), -1, 0)
    off = np.abs(np.sqrt(x * x + y * y + z * z) - 1) > 1e-9
    _refuse(off, "vertex{} does not lie on the unit sphere")
    square = x * x + y * y
    _refuse((z > 0) & (square < 1e-24), "vertex{} is the north pole: it goes to infinity")
    # 1 - z = (x^2 + y^2) / (1 + z) loses no digits near the north pole.
    height = np.where(z > 0, square / (1 + np.abs(z)), 1 - z)
    return (x + 1j * y) / height


def sphere_points(z: np.ndarray) -> np.ndarray:
    """The points (..., 3) of the unit sphere over the complex numbers z: `stereographic` undone.

    Paper: Fig. 10."""
    z = np.asarray(z, dtype=complex)
    _refuse(~np.isfinite(z), "point{} is not a finite number")
    square = np.abs(z) ** 2
    return np.stack([2 * z.real, 2 * z.imag, square - 1], axis=-1) / (square + 1)[..., None]


def _points(V):
    V = np.asarray(V, dtype=float)
    if V.ndim < 1 or V.shape[-1] != 3:
        raise ValueError(f"V has the shape {V.shape}: points of three coordinates are wanted")
    _refuse(~np.isfinite(V).all(axis=-1), "vertex{} has a coordinate that is not a finite number")
    return V


def _refuse(bad, words):
    """ValueError with the words and the index of the first True in `bad`, if there is one."""
    if np.any(bad):
        index = [int(k) for k in np.unravel_index(np.argmax(bad), np.shape(bad))]
        where = "" if not index else f" {index[0]}" if len(index) == 1 else f" {tuple(index)}"
        raise ValueError(words.format(where))
