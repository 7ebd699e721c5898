"""The next parallel of a web on a surface of revolution: three equations and their roots.

A quad of a web stands on the ring at the meridian parameter t0 and reaches the ring at t:

     C = (turn, t) -------- D = (turn + delta, t)        A = v2, B = v3, C = v1, D = v4,
       |                    |                            each given as (angle, parameter);
     A = (0, t0) ---------- B = (delta, t0)              delta = 2 pi / m

All quads of the row are congruent to it, so the row is known from t and turn.  `march` adds
rows; `exact_ring` and `paper_ring` make the step that it repeats.

Paper: Eq. (16), Alg. 1, App. A.3.
"""

import numpy as np
from scipy.optimize import brentq

from . import surfaces, ties
from .parallelogram import ratios

FITS = 1e-12  # a last row that is too high by this part of it still fits: the rest is rounding


class NoRow(ValueError):
    """No further row of quads fits; the text says why.

    Paper: Alg. 1.
    """


def march(profile, following, n):
    """(t, turn, why): rings from profile.start up, n rows or as many as fit (n = None).

    following(t) returns the next parameter and the turn towards it, or raises NoRow; NoRow
    passes when not even one row fits.  t, turn: arrays; why: the reason to stop, in words.

    Paper: Alg. 1.
    """
    t, turn, why = [profile.start], [0.0], "as many as asked for"
    while n is None or len(t) <= n:
        if profile.stop - t[-1] < FITS * (profile.stop - profile.start):
            why = meridian_ends(profile)
            break
        try:
            after, by = following(t[-1])
        except NoRow as reason:
            if len(t) == 1:
                raise
            why = str(reason)
            break
        t.append(after)
        turn.append(turn[-1] + by)
    return np.array(t), np.array(turn), why


def meridian_ends(profile):
    """The words for a row that does not fit below profile.stop.

    Paper: Alg. 1.
    """
    return f"a further one does not fit: the meridian ends at t = {profile.stop:.6g}"


def smooth_rings(profile, theta, theta0, m, n):
    """(t, turn, why) as from `march`, by equal steps of the Mercator coordinate: closed form.

    Paper: Sec. 5.3 (explicit smooth webs, beyond the paper).
    """
    w_of_t, t_of_w = surfaces.mercator(profile)
    step = 2 * np.pi / m * np.sin(theta0) / ratios(theta, theta0)[1]
    fit = int(w_of_t(profile.stop) / step * (1 + ties.TIE))
    if fit < 1:
        raise NoRow(meridian_ends(profile))
    rows = fit if n is None else min(n, fit)
    w = step * np.arange(rows + 1)
    why = "as many as asked for" if rows == n else meridian_ends(profile)
    return t_of_w(w), w / np.tan(theta0), why


def check_size(profile, theta, theta0, m, n):
    """ValueError for webs of more than ten million quads, before memory and time run out.

    Paper: Alg. 1.
    """
    t = np.linspace(profile.start, profile.stop, 257)
    radius, height = profile.radius(t) + 0 * t, profile.height(t) + 0 * t
    width = np.sum(np.hypot(np.diff(radius), np.diff(height)) / radius[1:])
    rows = width * m * ratios(theta, theta0)[1] / (2 * np.pi * np.sin(theta0))
    if m * min(rows, rows if n is None else n) > 1e7:
        raise ValueError(f"about {rows:.0f} rows of {m} quads fit: choose a smaller n or m")


# --- one quad: squared lengths from the turn and two points of the meridian ---------------


def _squares(profile, m, t0, t, turn):
    """|d1|^2, |d2|^2, |m13|^2, |m24|^2 of the quad ABCD, without cancellation."""
    half = np.pi / m
    r0, r1 = profile.radius(t0), profile.radius(t)
    rise = (profile.height(t) - profile.height(t0)) ** 2
    across, product = (r1 - r0) ** 2, 4 * r0 * r1

    def chord(angle):
        return across + product * np.sin(angle) ** 2

    m13 = np.sin(half) ** 2 * (across + product * np.cos(turn / 2) ** 2)
    m24 = np.cos(half) ** 2 * chord(turn / 2) + rise
    return chord(turn / 2 - half) + rise, chord(turn / 2 + half) + rise, m13, m24


def exact_turn(profile, theta, theta0, m, t0, t):
    """The turn from the ring t0 to the ring t for which the quad's medial lines meet at theta0.

    t: number or array; NaN where no turn does it (the radii differ too much).  Holds together
    with |m13| = mu |m24|, see `residual`.

    Paper: Sec. 5.3 (exact webs, beyond the paper).
    """
    return _exact_turn(profile, _psi(theta, theta0, m), t0, t)


def _psi(theta, theta0, m):
    """Half the turn between two rings of the same radius."""
    return np.arctan(np.cos(theta0) / ratios(theta, theta0)[1] * np.tan(np.pi / m))


def _exact_turn(profile, psi, t0, t):
    ratio = profile.radius(t) / profile.radius(t0)
    sine = np.sin(psi) * (ratio + 1 / ratio) / 2
    return psi + np.arcsin(np.where(np.abs(sine) <= 1, sine, np.nan))


def residual(profile, theta, theta0, m, t0, t, equation="exact"):
    """The equation whose root t is the next ring above the ring at t0, as a function of t.

    equation "lam": log(|A-D| / (lam |B-C|)), "mu": log(|m13| / (mu |m24|)), both between points
    of the smooth loxodromes; "exact": |m13|^2 - mu^2 |m24|^2 with the turn of `exact_turn`.
    t: array of parameters above t0.  Draw it to see the two roots of "lam".

    Paper: Eq. (16), Alg. 1, App. A.3.
    """
    if equation == "exact":
        mu, psi = ratios(theta, theta0)[1], _psi(theta, theta0, m)
        return _exact_residual(profile, mu, psi, m, t0, t)
    _check_equation(equation)
    w_of_t, _ = surfaces.mercator(profile)
    return _paper_residual(profile, w_of_t, theta, theta0, m, t0, t, equation)


def _exact_residual(profile, mu, psi, m, t0, t):
    _, _, m13, m24 = _squares(profile, m, t0, t, _exact_turn(profile, psi, t0, t))
    return m13 - mu**2 * m24


def _paper_residual(profile, w_of_t, theta, theta0, m, t0, t, equation):
    lam, mu = ratios(theta, theta0)
    turn = (w_of_t(t) - w_of_t(t0)) / np.tan(theta0)
    d1, d2, m13, m24 = _squares(profile, m, t0, t, turn)
    if equation == "lam":
        return np.log(d2 / d1) / 2 - np.log(lam)
    return np.log(m13 / m24) / 2 - np.log(mu)


def _check_equation(equation):
    if equation not in ("lam", "mu"):
        raise ValueError(f'equation = {equation!r}: "lam" or "mu" is wanted')


# --- the next ring ------------------------------------------------------------------------


def exact_ring(profile, theta, theta0, m):
    """The step of the exact web: t0 -> (t, turn), at the first root of the equation "exact".

    The residual is positive at t0 itself, so that the first sign change is the shortest row.
    The step raises NoRow where there is none below profile.stop.

    Paper: Alg. 1, App. A.3 (straight distances; beyond the paper: B5).
    """
    mu, psi = ratios(theta, theta0)[1], _psi(theta, theta0, m)
    smooth, half = 2 * np.pi / m * np.sin(theta0) / mu, np.pi / m
    little = (profile.stop - profile.start) * 1e-5

    def following(t0):
        ends = np.array([t0, min(t0 + little, profile.stop)])
        moved = np.hypot(*(np.ptp(f(ends)) for f in (profile.radius, profile.height)))
        step = smooth * profile.radius(t0) * np.ptp(ends) / max(moved, 1e-300)

        def gap(t):
            return _exact_residual(profile, mu, psi, m, t0, t)

        t = _first_root(gap, t0, step, profile.stop)
        if t is None:
            if not gap(profile.stop) < FITS * (2 * profile.radius(t0) * np.sin(half)) ** 2:
                raise NoRow(meridian_ends(profile))
            t = profile.stop
        if np.isnan(t):
            raise NoRow(f"a further one does not fit: no such quad stands on t = {t0:.6g}")
        return t, float(_exact_turn(profile, psi, t0, t))

    return following


def _first_root(function, low, step, stop):
    """The first t in (low, stop] where the function, positive at low, vanishes; or None.

    NaN when the function turns into NaN before.  Scanned in stretches that double in length,
    2 * step at first.
    """
    length = 2 * step
    while low < stop:
        high = min(low + length, stop)
        bracket = _first_bracket(function, low, high, 3)
        if bracket is not None:
            return bracket[1] if np.isnan(bracket[1]) else _root(function, *bracket)
        low, length = high, 2 * length
    return None


def _first_bracket(function, low, high, depth):
    """(a, b) around the first root, None without one, (a, nan) where the function ends."""
    t = np.linspace(low, high, 33)
    value = function(t)
    out = np.flatnonzero(~(value > 0))
    first = out[0] if out.size else len(t)
    if first == 0:  # too thin for floating point
        return low, np.nan
    inner = value[1:-1]
    dips = 1 + np.flatnonzero((inner < value[:-2]) & (inner <= value[2:]))
    for k in dips[dips < first] if depth else []:  # two roots may hide between two samples
        if (bracket := _first_bracket(function, t[k - 1], t[k + 1], depth - 1)) is not None:
            return bracket
    if first == len(t):
        return None
    if np.isnan(value[first]):
        zoom = t[first - 1], t[first], depth - 1
        return _first_bracket(function, *zoom) if depth else (low, np.nan)
    return t[first - 1], t[first]


def _root(function, low, high):
    return brentq(function, low, high, xtol=1e-15 * (high - low), rtol=4 * np.finfo(float).eps)


def paper_ring(profile, theta, theta0, m, equation):
    """The published step: t0 -> (t, turn), on smooth loxodromes, by the equation "lam" or "mu".

    A and B lie on the ring t0; C and D on the same loxodromes, at one parallel.  D is C turned
    by 2 pi / m, so the chord |C-D| is 2 r sin(pi / m) on every parallel: the first printed
    equation decides nothing (and names the arc 2 pi r / m instead).  Left is
    |A-D| = lam |B-C|, "lam".  It is empty for theta0 = 90 degrees and has a double root for
    theta = 90 degrees: ValueError; else it has two roots, and the step takes the one on the
    smooth web's side of |m13| = |m24|, or raises NoRow.  "mu" is |m13| = mu |m24| instead.

    Paper: Alg. 1, Eq. (16), App. A.3.
    """
    _check_equation(equation)
    lam, mu = ratios(theta, theta0)
    if equation == "lam":
        _check_not_vacuous(lam, mu)
    w_of_t, t_of_w = surfaces.mercator(profile)
    end, unit = w_of_t(profile.stop), 2 * np.pi / m * np.sin(theta0)
    if equation == "mu":
        search = 1e-3 / mu, 4 / mu + 4
    else:  # log(|A-D| / |B-C|) is largest or smallest near 1, the other root is near mu
        search = (1e-3 / mu, 1) if mu > 1 else (1, 4 / mu + 4)

    def following(t0):
        def gap(t):
            return _paper_residual(profile, w_of_t, theta, theta0, m, t0, t, equation)

        # search is in units of the smooth row with |m13| = |m24|; the row wanted is 1 / mu
        low, high = (w_of_t(t0) + x * unit for x in search)
        ended = high >= end * (1 - FITS)
        low, high = t_of_w(min(low, end)), profile.stop if ended else t_of_w(high)
        if ended and abs(gap(high)) < FITS:
            return high, float((end - w_of_t(t0)) / np.tan(theta0))
        if not gap(low) * gap(high) < 0:
            none = f'the equation "{equation}" has no root where the next row should be'
            raise NoRow(meridian_ends(profile) if ended else none)
        t = _root(gap, low, high)
        return t, float((w_of_t(t) - w_of_t(t0)) / np.tan(theta0))

    return following


def _check_not_vacuous(lam, mu):
    use = 'use equation = "mu" or method = "exact"'
    if abs(np.log(lam)) < 1e-9:
        raise ValueError(
            "theta0 = 90 degrees: lam = 1, and |A-D| = lam |B-C| holds on every parallel, so it "
            f"finds none; {use}"
        )
    if abs(np.log(mu)) < 1e-9:
        raise ValueError(
            "theta = 90 degrees: |A-D| = lam |B-C| has a double root, where no sign changes and "
            f"no solver is safe; {use}"
        )
