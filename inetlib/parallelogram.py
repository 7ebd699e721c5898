"""The shape of one parallelogram: two ratios (lam, mu) and two angles (theta, theta0).

         A ---------- D     A top left, then counter-clockwise, as v1 ... v4 in `mesh`:
        /      O     /      a = |BC| = 1, b = |AB| = lam, p = |AC|, q = |BD| = mu p,
       B ---------- C       theta = angle ABC, theta0 = angle AOD.

Inside a quad, BC ~ d1 and BA ~ d2 are its diagonals, BD ~ m13 and CA ~ m24 its medial lines.
Angles are radians.  Numbers out of range raise ValueError; sympy symbols go through the same
formulas unchecked, so what runs is what the notebooks prove."""

from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

LEAST = 1e-300  # smaller numbers have no reciprocal, or fewer digits
Number = Any  # a float, an array of them that broadcasts, or a sympy expression


def library(*values: Number) -> ModuleType:
    """sympy when a value is symbolic, else numpy: both spell acos, atan2, asinh alike."""
    if any(hasattr(value, "free_symbols") for value in values):
        import sympy

        return sympy
    return np


def _check_below(name, value, limit, words):
    value = np.asarray(value, dtype=float)
    bad = ~((value >= LEAST) & (value < limit))
    if bad.any():
        raise ValueError(f"{name} = {value[bad][0]:.6g}{words}")
    return value[()]


def check_positive(name: str, value: Number) -> Number:
    """The value as floats, or ValueError unless 0 < value < inf."""
    return _check_below(name, value, np.inf, ": a positive finite number is wanted")


def check_angle(name: str, value: Number) -> Number:
    """The angle as floats (symbols pass through), or ValueError unless 0 < value < pi."""
    if library(value) is not np:
        return value
    words = " rad: the angle must lie strictly between 0 and pi (radians, not degrees)"
    return _check_below(name, value, np.pi, words)


def check_whole(name: str, value: float, least: int = 1) -> int:
    """The value as an int, or ValueError unless it is a whole number >= least."""
    if not (value >= least and value % 1 == 0):
        raise ValueError(f"{name} = {value}: a whole number, {least} or more, is wanted")
    return int(value)


def area_factors(lam: Number, mu: Number) -> tuple:
    """Four factors with the product (2 (1 + mu^2) lam sin theta)^2, positive inside Eq. (4).

    As in Heron's formula the product keeps its digits where 1 - cos^2 theta loses them."""
    more, less = lam + 1, lam - 1
    return more + mu * less, more - mu * less, mu * more + less, mu * more - less


def _root_area(lam, mu):
    """2 (1 + mu^2) lam sin theta = 2 (1 + lam^2) mu sin theta0."""
    w1, w2, w3, w4 = area_factors(lam, mu)
    xp = library(lam, mu)
    if xp is np:  # root by root: the product overflows first
        return np.sqrt(w1) * np.sqrt(w2) * np.sqrt(w3) * np.sqrt(w4)
    return xp.sqrt(xp.expand(w1 * w2 * w3 * w4))


def lam_range(mu: Number) -> tuple[Number, Number]:
    """Open range of lam for a given mu, or of mu for a given lam; infinite above at 1.

    Paper: Eq. (4), Eq. (6), Eq. (9)."""
    if library(mu) is not np:
        return abs(mu - 1) / (mu + 1), (mu + 1) / abs(mu - 1)
    mu = check_positive("mu", mu)
    gap = np.abs(mu - 1)
    with np.errstate(divide="ignore"):
        return gap / (mu + 1), (mu + 1) / gap


def is_admissible(lam: Number, mu: Number) -> bool | np.ndarray:
    """Whether a parallelogram exists; on the border it collapses.  Paper: Eq. (4), Lemma 1."""
    lam, mu = np.asarray(lam, dtype=float), np.asarray(mu, dtype=float)
    with np.errstate(invalid="ignore", over="ignore"):
        inside = np.all([w > 0 for w in area_factors(lam, mu)], axis=0)
        inside &= (lam > 0) & (mu > 0) & np.isfinite(lam) & np.isfinite(mu)
    return bool(inside) if inside.ndim == 0 else inside


def _require_admissible(lam, mu):
    """The ratios as floats (symbols pass through), or ValueError with the range."""
    if library(lam, mu) is not np:
        return lam, mu
    lam, mu = np.asarray(lam, dtype=float), np.asarray(mu, dtype=float)
    bad = ~np.asarray(is_admissible(lam, mu))
    if bad.any():
        x, y = (np.broadcast_to(ratio, bad.shape)[bad][0] for ratio in (lam, mu))
        if not (0 < x < np.inf and 0 < y < np.inf):
            raise ValueError(f"lam = {x:.6g}, mu = {y:.6g}: both must be positive and finite")
        wanted = "lam must lie between {:.6g} and {:.6g} (Eq. 4)".format(*lam_range(y))
        raise ValueError(f"lam = {x:.6g} at mu = {y:.6g} is no parallelogram: {wanted}")
    return lam[()], mu[()]


def diagonals(a: Number, b: Number, theta: Number) -> tuple[Number, Number]:
    """The diagonals p, q from two sides and the angle between.  Paper: Eq. (1), Eq. (2)."""
    xp = library(a, b, theta)
    if xp is np:
        a, b = check_positive("a", a), check_positive("b", b)
    half = check_angle("theta", theta) / 2  # a^2 + b^2 - 2ab cos(theta), without cancellation
    p = xp.sqrt((a - b) ** 2 + 4 * a * b * xp.sin(half) ** 2)
    q = xp.sqrt((a - b) ** 2 + 4 * a * b * xp.cos(half) ** 2)
    return p, q


def lengths(lam: Number, mu: Number) -> tuple[Number, Number, Number, Number]:
    """The lengths (a, b, p, q) = (1, lam, p, mu p).  Paper: Eq. (2), Eq. (7), App. A.1."""
    lam, mu = _require_admissible(lam, mu)
    p = library(lam, mu).sqrt(2 * (1 + lam**2) / (1 + mu**2))
    return 1, lam, p, mu * p


def cosines(lam: Number, mu: Number) -> tuple[Number, Number]:
    """(cos theta, cos theta0), rational in the ratios.

    An arccos of these loses half the digits near 0 and pi: see `angles`.
    Paper: Eq. (3), Eq. (8), Lemma 1, Thm 7, Def. 10."""
    lam, mu = _require_admissible(lam, mu)
    cos_theta = (1 + lam**2) * (mu**2 - 1) / (2 * lam * (1 + mu**2))
    cos_theta0 = (1 + mu**2) * (lam**2 - 1) / (2 * mu * (1 + lam**2))
    return cos_theta, cos_theta0


def angles(lam: Number, mu: Number) -> tuple[Number, Number]:
    """(theta, theta0); the inverse of `ratios`.  Paper: Eq. (3), Eq. (8), Lemma 1."""
    lam, mu = _require_admissible(lam, mu)
    xp, root = library(lam, mu), _root_area(lam, mu)
    theta = xp.atan2(root, (lam**2 + 1) * (mu - 1) * (mu + 1))
    theta0 = xp.atan2(root, (mu**2 + 1) * (lam - 1) * (lam + 1))
    return theta, theta0


def half_cosines(lam: Number, mu: Number) -> tuple[Number, Number]:
    """(cos alpha, cos beta) of the `half_angles`.  Paper: Eq. (5), Eq. (10), Lemma 1, Thm 7."""
    lam, mu = _require_admissible(lam, mu)
    root = 2 * mu * library(lam, mu).sqrt(2 * (1 + lam**2) * (1 + mu**2))
    cos_alpha = (3 * lam**2 * mu**2 + lam**2 + mu**2 - 1) / (lam * root)
    cos_beta = (lam**2 * mu**2 - lam**2 + 3 * mu**2 + 1) / root
    return cos_alpha, cos_beta


def half_angles(lam: Number, mu: Number) -> tuple[Number, Number]:
    """(alpha, beta): BD (m13) splits theta into alpha, next to d2, and beta, next to d1.

    Paper: Eq. (5), Eq. (10), Lemma 1."""
    lam, mu = _require_admissible(lam, mu)
    xp, root = library(lam, mu), _root_area(lam, mu)
    along, across = 2 * mu**2 * (lam**2 + 1), (mu**2 + 1) * (lam - 1) * (lam + 1)
    return xp.atan2(root, along + across), xp.atan2(root, along - across)


def log_ratios(theta: Number, theta0: Number) -> tuple[Number, Number]:
    """(ln lam, ln mu), a bijection from (0, pi)^2.  Paper: inverse of Lemma 1, B1."""
    theta, theta0 = check_angle("theta", theta), check_angle("theta0", theta0)
    xp = library(theta, theta0)
    log_lam = xp.asinh(xp.sin(theta) * xp.cos(theta0) / xp.sin(theta0))
    log_mu = xp.asinh(xp.sin(theta0) * xp.cos(theta) / xp.sin(theta))
    return log_lam, log_mu


def ratios(theta: Number, theta0: Number) -> tuple[Number, Number]:
    """(lam, mu) of the parallelogram with these angles; inverse of `angles`.

    theta = theta0 gives lam = mu = cos theta + sqrt(1 + cos^2 theta).

    >>> "{:.5f} {:.5f}".format(*ratios(np.pi / 3, np.pi / 4))
    '2.18890 1.48837'

    Paper: Def. 2 and Eq. (8) for theta = theta0, else inverse of Lemma 1, B1."""
    log_lam, log_mu = log_ratios(theta, theta0)
    xp = library(log_lam, log_mu)
    return xp.exp(log_lam), xp.exp(log_mu)


class Shape(NamedTuple):
    """Everything that one complex number rho says about a parallelogram (see `from_rho`)."""

    lam: float
    mu: float
    theta: float
    theta0: float


def rho(lam: Number, mu: Number) -> Number:
    """The parallelogram as one number, X_v / X_u = exp(i theta0) / mu.  Paper: B2."""
    lam, mu = _require_admissible(lam, mu)
    xp = library(lam, mu)
    unit = 1j if xp is np else xp.I
    across = (mu**2 + 1) * (lam - 1) * (lam + 1)
    return (across + unit * _root_area(lam, mu)) / (2 * mu**2 * (lam**2 + 1))


def diagonal_ratio(rho: Number) -> Number:
    """Y_v / Y_u = (1 + rho) / (1 - rho) = lam exp(i theta); ValueError for rho = 1.

    An involution between s = Y_v / Y_u and r = 1 / rho: s = (r + 1) / (r - 1).
    Paper: B2."""
    if library(rho) is np:
        rho = np.asarray(rho, dtype=complex)[()]
        if np.any(rho == 1):
            raise ValueError("rho = 1: X_u = X_v, the diagonal Y_u vanishes")
    return (1 + rho) / (1 - rho)


def from_rho(rho: Number) -> Shape:
    """The `Shape` of rho in the upper half plane, else ValueError.  Paper: Lemma 1, B2."""
    rho = np.asarray(rho, dtype=complex)[()]
    if not np.all((rho.imag > 0) & np.isfinite(rho)):
        raise ValueError("rho must be finite, in the upper half plane (Im rho > 0)")
    diagonal = diagonal_ratio(rho)
    return Shape(abs(diagonal), 1 / abs(rho), np.angle(diagonal), np.angle(rho))


def directions(rho: Number) -> tuple[Number, Number, Number, Number]:
    """The lines X_u, Y_v, X_v, Y_u, complex, counter-clockwise mod pi.  Paper: B10."""
    return 1 + 0 * rho, 1 + rho, rho, 1 - rho


def gaps(lam: Number, mu: Number) -> tuple[Number, Number, Number, Number]:
    """The angles between neighbours of the `directions`; their sum is pi.  Paper: Thm 8, B10."""
    alpha, beta = half_angles(lam, mu)
    _, theta0 = angles(lam, mu)
    return alpha, theta0 - alpha, library(lam, mu).pi - theta0 - beta, beta


def _oriented_area(a, b):
    """Im(conj(a) b) of complex numbers, arrays or sympy expressions."""
    if any(hasattr(z, "as_real_imag") for z in (a, b)):
        import sympy

        (p, q), (r, s) = (sympy.sympify(z).as_real_imag() for z in (a, b))
        return sympy.expand(p * s - q * r)
    return np.imag(np.conj(a) * b)


def cross_ratio(a: Number, b: Number, c: Number, d: Number) -> Number:
    """(a, b; c, d) of four lines through a point, given by complex directions; -1: harmonic.

    ValueError when a and d or b and c are parallel.  Paper: B10."""
    below = _oriented_area(a, d) * _oriented_area(b, c)
    if np.any(below == 0):
        raise ValueError("two of the lines coincide: the cross ratio is infinite")
    return _oriented_area(a, c) * _oriented_area(b, d) / below
