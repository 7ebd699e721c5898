"""The shape of one parallelogram: two ratios (lam, mu) and two angles (theta, theta0).

         A ---------- D     A top left, then counter-clockwise, as v1 ... v4 in `mesh`:
        /      O     /      a = |BC| = 1, b = |AB| = lam, p = |AC|, q = |BD| = mu p,
       B ---------- C       theta = angle ABC, theta0 = angle AOD.

Inside a quad, BC ~ d1 and BA ~ d2 are its diagonals, BD ~ m13 and CA ~ m24 its medial lines.

Every function takes floats, NumPy arrays or sympy symbols: the formula that runs is the
formula that the notebooks prove.  Numbers out of range raise ValueError; symbols are not
checked.
"""

from typing import NamedTuple

import numpy as np


class Shape(NamedTuple):
    """Everything that one complex number rho says about a parallelogram (see `from_rho`)."""

    lam: float
    mu: float
    theta: float
    theta0: float


def library(*values):
    """sympy when a value is symbolic, else numpy: both spell acos, atan2, asinh alike."""
    if any(hasattr(value, "free_symbols") for value in values):
        import sympy

        return sympy
    return np


def _area_factors(lam, mu):
    """Four factors with the product (2 (1 + mu^2) lam sin theta)^2, positive inside Eq. (4).

    As in Heron's formula the product keeps its digits where 1 - cos^2 theta loses them.
    """
    return (
        (lam + 1) + mu * (lam - 1),
        (lam + 1) - mu * (lam - 1),
        mu * (lam + 1) + (lam - 1),
        mu * (lam + 1) - (lam - 1),
    )


def _root_area(lam, mu):
    """2 (1 + mu^2) lam sin theta = 2 (1 + lam^2) mu sin theta0."""
    w1, w2, w3, w4 = _area_factors(lam, mu)
    xp = library(lam, mu)
    if xp is np:  # root by root: the product overflows first
        return np.sqrt(w1) * np.sqrt(w2) * np.sqrt(w3) * np.sqrt(w4)
    return xp.sqrt(xp.expand(w1 * w2 * w3 * w4))


def lam_range(mu):
    """Open range of lam for a given mu; the upper end is infinite at mu = 1.

    mu: positive float or array (or symbol).  Returns (low, high) of the same shape.  Swap
    the names for the range of mu at a given lam: Eq. (4) is symmetric.

    Paper: Eq. (4), Eq. (6), Eq. (9).
    """
    if library(mu) is not np:
        return abs(mu - 1) / (mu + 1), (mu + 1) / abs(mu - 1)
    mu = check_positive("mu", mu)
    gap = np.abs(mu - 1)
    with np.errstate(divide="ignore"):
        return gap / (mu + 1), (mu + 1) / gap


def is_admissible(lam, mu):
    """Whether a parallelogram with these ratios exists (bool or bool array).

    lam, mu: numbers or arrays that broadcast.  NaN, infinite and non-positive values are
    not admissible; on the border the parallelogram collapses, so the border is not either.

    Paper: Eq. (4), Lemma 1.
    """
    lam, mu = np.asarray(lam, dtype=float), np.asarray(mu, dtype=float)
    with np.errstate(invalid="ignore", over="ignore"):
        inside = np.all([w > 0 for w in _area_factors(lam, mu)], axis=0)
        inside &= (lam > 0) & (mu > 0) & np.isfinite(lam) & np.isfinite(mu)
    return bool(inside) if inside.ndim == 0 else inside


def _require_admissible(lam, mu):
    """The ratios as floats (symbols pass through), or ValueError with the range."""
    if library(lam, mu) is not np:
        return lam, mu
    lam, mu = np.asarray(lam, dtype=float), np.asarray(mu, dtype=float)
    good = np.atleast_1d(is_admissible(lam, mu))
    if not good.all():
        first = np.argmin(good.ravel())
        bad_lam, bad_mu = (np.broadcast_to(x, good.shape).ravel()[first] for x in (lam, mu))
        if not (np.isfinite(bad_lam) and np.isfinite(bad_mu) and bad_lam > 0 and bad_mu > 0):
            raise ValueError(
                f"lam = {bad_lam:.6g}, mu = {bad_mu:.6g}: both ratios must be positive and finite"
            )
        low, high = lam_range(bad_mu)
        raise ValueError(
            f"lam = {bad_lam:.6g} at mu = {bad_mu:.6g} is no parallelogram: "
            f"lam must lie between {low:.6g} and {high:.6g} (Eq. 4)"
        )
    return lam[()], mu[()]


def check_positive(name, value):
    """The value as floats, or ValueError unless 0 < value < inf."""
    value = np.asarray(value, dtype=float)
    good = ((value > 0) & np.isfinite(value)).ravel()
    if not good.all():
        bad = value.ravel()[np.argmin(good)]
        raise ValueError(f"{name} = {bad:.6g}: a positive finite number is wanted")
    return value[()]


def check_angle(name, value):
    """The angle as floats (symbols pass through), or ValueError unless 0 < value < pi."""
    if library(value) is not np:
        return value
    value = np.asarray(value, dtype=float)
    good = np.atleast_1d((value > 0) & (value < np.pi)).ravel()
    if not good.all():
        bad = value.ravel()[np.argmin(good)]
        raise ValueError(
            f"{name} = {bad:.6g} rad: the angle must lie strictly between 0 and pi "
            "(radians, not degrees)"
        )
    return value[()]


def check_whole(name, value, least=1):
    """The value as an int, or ValueError unless it is a whole number >= least."""
    if not (value >= least and value % 1 == 0):
        raise ValueError(f"{name} = {value}: a whole number, {least} or more, is wanted")
    return int(value)


def diagonals(a, b, theta):
    """Lengths p = |AC|, q = |BD| of the diagonals, from two sides and the angle between them.

    a, b: positive lengths, theta: radians in (0, pi), else ValueError.  Together
    p^2 + q^2 = 2 (a^2 + b^2).

    Paper: Eq. (1), Eq. (2).
    """
    xp = library(a, b, theta)
    if xp is np:
        a, b = check_positive("a", a), check_positive("b", b)
    theta = check_angle("theta", theta)
    half = theta / 2  # a^2 + b^2 - 2ab cos(theta), without the cancellation
    p = xp.sqrt((a - b) ** 2 + 4 * a * b * xp.sin(half) ** 2)
    q = xp.sqrt((a - b) ** 2 + 4 * a * b * xp.cos(half) ** 2)
    return p, q


def lengths(lam, mu):
    """The lengths (a, b, p, q) = (1, lam, p, mu p) that belong to two ratios.

    For lam = mu (a theta-parallelogram) they are 1, lam, sqrt 2, sqrt 2 lam.

    Paper: Sec. 3.1, Eq. (2), Eq. (7), App. A.1.
    """
    lam, mu = _require_admissible(lam, mu)
    p = library(lam, mu).sqrt(2 * (1 + lam**2) / (1 + mu**2))
    return 1, lam, p, mu * p


def cosines(lam, mu):
    """(cos theta, cos theta0) as rational functions of the two ratios.

    For lam = mu both are (lam - 1/lam) / 2.  Use `angles` for the angles themselves: an
    arccos of these loses half the digits near 0 and pi.

    Paper: Eq. (3), Eq. (8), Lemma 1, Def. 10.
    """
    lam, mu = _require_admissible(lam, mu)
    cos_theta = (1 + lam**2) * (mu**2 - 1) / (2 * lam * (1 + mu**2))
    cos_theta0 = (1 + mu**2) * (lam**2 - 1) / (2 * mu * (1 + lam**2))
    return cos_theta, cos_theta0


def angles(lam, mu):
    """Interior angle theta and diagonal angle theta0, radians in (0, pi).

    lam, mu: ratios inside the range of Eq. (4), numbers or arrays that broadcast; else
    ValueError.  Inverse of `ratios`.

    Paper: Eq. (3), Eq. (8), Lemma 1.
    """
    lam, mu = _require_admissible(lam, mu)
    xp, root = library(lam, mu), _root_area(lam, mu)
    theta = xp.atan2(root, (lam**2 + 1) * (mu - 1) * (mu + 1))
    theta0 = xp.atan2(root, (mu**2 + 1) * (lam - 1) * (lam + 1))
    return theta, theta0


def half_cosines(lam, mu):
    """(cos alpha, cos beta) of the angles at which a diagonal of the parallelogram splits theta.

    Paper: Eq. (5), Eq. (10), Lemma 1.
    """
    lam, mu = _require_admissible(lam, mu)
    root = 2 * mu * library(lam, mu).sqrt(2 * (1 + lam**2) * (1 + mu**2))
    cos_alpha = (3 * lam**2 * mu**2 + lam**2 + mu**2 - 1) / (lam * root)
    cos_beta = (lam**2 * mu**2 - lam**2 + 3 * mu**2 + 1) / root
    return cos_alpha, cos_beta


def half_angles(lam, mu):
    """alpha = angle(d2, m13) and beta = angle(d1, m13), radians; alpha + beta = theta.

    The diagonal BD (m13) splits the angle at B into alpha, next to AB (d2), and beta, next
    to BC (d1).

    Paper: Eq. (5), Eq. (10), Lemma 1.
    """
    lam, mu = _require_admissible(lam, mu)
    xp, root = library(lam, mu), _root_area(lam, mu)
    along, across = 2 * mu**2 * (lam**2 + 1), (mu**2 + 1) * (lam - 1) * (lam + 1)
    return xp.atan2(root, along + across), xp.atan2(root, along - across)


def log_ratios(theta, theta0):
    """(ln lam, ln mu): two inverse hyperbolic sines, a bijection from (0, pi)^2.

    theta, theta0: radians, numbers or arrays that broadcast; ValueError outside (0, pi).

    Paper: inverse of Lemma 1 (beyond the paper: B1).
    """
    theta, theta0 = check_angle("theta", theta), check_angle("theta0", theta0)
    xp = library(theta, theta0)
    log_lam = xp.asinh(xp.sin(theta) * xp.cos(theta0) / xp.sin(theta0))
    log_mu = xp.asinh(xp.sin(theta0) * xp.cos(theta) / xp.sin(theta))
    return log_lam, log_mu


def ratios(theta, theta0):
    """The ratios (lam, mu) of the parallelogram with these angles; inverse of `angles`.

    theta, theta0: radians, numbers or arrays that broadcast; ValueError outside (0, pi).
    theta = theta0 gives lam = mu = cos theta + sqrt(1 + cos^2 theta).

    Paper: Def. 2 and Eq. (8) for theta = theta0, else inverse of Lemma 1 (B1).
    """
    log_lam, log_mu = log_ratios(theta, theta0)
    xp = library(log_lam, log_mu)
    return xp.exp(log_lam), xp.exp(log_mu)


def rho(lam, mu):
    """The parallelogram as one complex number: rho = X_v / X_u = exp(i theta0) / mu.

    Paper: Sec. 3.1 in complex form (beyond the paper: B2).
    """
    lam, mu = _require_admissible(lam, mu)
    xp = library(lam, mu)
    unit = 1j if xp is np else xp.I
    across = (mu**2 + 1) * (lam - 1) * (lam + 1)
    return (across + unit * _root_area(lam, mu)) / (2 * mu**2 * (lam**2 + 1))


def diagonal_ratio(rho):
    """Y_v / Y_u = (1 + rho) / (1 - rho) = lam exp(i theta), for rho = X_v / X_u.

    rho: complex number, array or symbol, not 1, else ValueError.  In terms of s = Y_v / Y_u
    and r = 1 / rho it is the involution s = (r + 1) / (r - 1), r = (s + 1) / (s - 1).

    Paper: Thm 7 in complex form (beyond the paper: B2).
    """
    if library(rho) is np:
        rho = np.asarray(rho, dtype=complex)[()]
        if np.any(rho == 1):
            raise ValueError("rho = 1: X_u = X_v, the diagonal Y_u vanishes")
    return (1 + rho) / (1 - rho)


def from_rho(rho):
    """`Shape(lam, mu, theta, theta0)` of rho = X_v / X_u in the upper half plane.

    rho: finite complex number or array with positive imaginary part; else ValueError.

    Paper: Lemma 1 in complex form (beyond the paper: B2).
    """
    rho = np.asarray(rho, dtype=complex)
    if not np.all((rho.imag > 0) & np.isfinite(rho)):
        raise ValueError(
            "rho must be finite and lie in the upper half plane: its imaginary part is |m24|/|m13| "
            "times sin theta0 > 0"
        )
    diagonal = diagonal_ratio(rho[()])
    return Shape(abs(diagonal), 1 / abs(rho[()]), np.angle(diagonal), np.angle(rho[()]))


# --- The 4-web of a parallelogram as a harmonic pencil, and the half plane of the number rho. ---


def directions(rho):
    """The directions (X_u, Y_v, X_v, Y_u) of the web, complex, counter-clockwise mod pi.

    rho: complex number X_v / X_u.  They are 1, 1 + rho, rho and 1 - rho.

    Paper: Sec. 3.1 (beyond the paper: B10).
    """
    return 1 + 0 * rho, 1 + rho, rho, 1 - rho


def cross_ratio(a, b, c, d):
    """(a, b; c, d) of four lines through a point, given by complex directions; -1: harmonic.

    It does not depend on the lengths and signs of the directions.  No two of a, d and of
    b, c parallel, else ValueError.

    Paper: Sec. 3.1 (beyond the paper: B10).
    """
    below = _area(a, d) * _area(b, c)
    if np.any(below == 0):
        raise ValueError("two of the lines coincide: the cross ratio is infinite")
    return _area(a, c) * _area(b, d) / below


def _area(a, b):
    """The oriented area Im(conj(a) b)."""
    if hasattr(a, "as_real_imag") or hasattr(b, "as_real_imag"):
        import sympy

        (p, q), (r, s) = (sympy.sympify(z).as_real_imag() for z in (a, b))
        return sympy.expand(p * s - q * r)
    return np.imag(np.conj(a) * b)


def gaps(lam, mu):
    """The angles (alpha, theta0 - alpha, pi - theta0 - beta, beta) between neighbouring lines.

    In the order of `directions`, radians, their sum is pi; ValueError for ratios outside the
    range of parallelograms.

    Paper: Sec. 3.1 (beyond the paper: B10).
    """
    alpha, beta = half_angles(lam, mu)
    _, theta0 = angles(lam, mu)
    return alpha, theta0 - alpha, library(lam, mu).pi - theta0 - beta, beta


def mu_circle(mu):
    """Centre and radius of the circle of all rho with this mu.

    Paper: Sec. 3.1 (beyond the paper: B2).
    """
    return 0 * mu, 1 / mu


def lam_circle(lam):
    """Centre (on the real axis) and radius of the circle of all rho with this lam, not 1.

    For lam = 1 it is the imaginary axis, and this is a ValueError.

    Paper: Sec. 3.1 (beyond the paper: B2).
    """
    if np.any(lam == 1):
        raise ValueError("lam = 1: the imaginary axis, no circle")
    return (lam**2 + 1) / (lam**2 - 1), 2 * lam / abs(lam**2 - 1)


def theta_circle(theta):
    """Height of the centre above 0 and radius of the circle through -1 and 1 with this theta.

    theta: radians in (0, pi).  Only the arc in the upper half plane counts.

    Paper: Sec. 3.1 (beyond the paper: B2).
    """
    xp = library(theta)
    return -xp.cos(theta) / xp.sin(theta), 1 / xp.sin(theta)


def equal_circle():
    """Centre and radius of the circle of all rho with theta = theta0, that is lam = mu.

    Its mirror image in the imaginary axis holds theta + theta0 = pi.

    Paper: Sec. 3.2 (beyond the paper: B2).
    """
    return -1, np.sqrt(2)
