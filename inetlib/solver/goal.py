"""What is wanted of a net, and the way there: given angles or ratios, the rest left free.

A `Goal` is a curve, a surface or a point in the plane of (log lam, log mu): what is given
fixes part of it, and up to two numbers s, the freedom, remain."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from .. import parallelogram
from ..parallelogram import check_angle, check_positive

ANGLES = "theta", "theta0"
INSIDE = 0.99  # of the range of Eq. (4), for a start
CLOSE = 1e-6  # radians: angles closer to 0 or pi are lost in rounding
ALIKE = 1e-9  # radians: two given angles as close as this are meant to be the same


class Goal(NamedTuple):
    """What is wanted, made by `aim`."""

    kind: str  # "angles", "theta", "theta0", "lam", "mu", "equal" or "free"
    values: tuple  # (theta, theta0), the one given angle, or the logarithm of the one given ratio
    equal: bool = False  # theta = theta0 in the end; the paper has fewer equations for that


def aim(
    theta: float | None = None,
    theta0: float | None = None,
    lam: float | None = None,
    mu: float | None = None,
    equal: bool = False,
) -> Goal:
    """The `Goal` of the given numbers: angles in radians, ratios positive; None leaves free.

    equal: theta = theta0 wanted (lam = mu), whatever its value.  ValueError for numbers out of
    range, for more than two, and for pairs that fit no parallelogram or two of them.

    >>> aim(lam=1, mu=1).equal, aim(theta=1.2).kind, aim(1.2, 1.3).values
    (True, 'theta', (1.2, 1.3))

    Paper: Eq. (19), Eq. (20), Eq. (22)."""
    known = {}
    for name, x in {"theta": theta, "theta0": theta0, "lam": lam, "mu": mu}.items():
        if x is not None:
            check = check_angle if name in ANGLES else check_positive
            known[name] = float(check(name, x))
            if name in ANGLES and not CLOSE <= known[name] <= np.pi - CLOSE:
                raise ValueError(f"{name} = {x} rad: {CLOSE} or more away from 0 and pi is wanted")
    if equal:
        return _equal(known)
    if len(known) > 2:
        raise ValueError(f"{', '.join(known)} are given: two numbers fix the net, drop the others")
    if not known:
        return Goal("free", ())
    if len(known) == 1:
        ((kind, x),) = known.items()
        return Goal(kind, (x if kind in ANGLES else float(np.log(x)),))
    one, two = _both(known)
    if abs(one - two) <= ALIKE:  # one angle, twice: lam and mu from it may differ in a bit
        return _equal({"theta": one})
    return Goal("angles", (one, two))


def _equal(known):
    """The goal theta = theta0, whatever it is or as given."""
    angles = [x if k in ANGLES else float(parallelogram.angles(x, x)[0]) for k, x in known.items()]
    if np.ptp(angles or [0.0]) > ALIKE:
        raise ValueError("with equal=True one angle or one ratio is wanted, and no other value")
    return Goal("angles", (angles[0], angles[0]), True) if angles else Goal("equal", (), True)


def _both(known):
    """(theta, theta0) from any two of the four numbers."""
    one, other = sorted(known)
    if (one, other) == ANGLES:
        return known["theta"], known["theta0"]
    if (one, other) in (("lam", "theta0"), ("mu", "theta")):
        rest = "mu or theta" if one == "lam" else "lam or theta0"
        raise ValueError(f"{one} and {other} fit two nets, or none: give {rest} instead of one")
    if (one, other) == ("lam", "mu"):
        found = parallelogram.angles(known["lam"], known["mu"])
    else:
        kind, ratio = ("theta", "lam") if "theta" in known else ("theta0", "mu")
        found = angles(Goal(kind, (known[kind],)), [np.log(known[ratio])])
    return tuple(float(x) for x in found)


def logs(goal: Goal, s: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """(log lam, log mu), shape (2,), and their derivatives (2, k) in the k freedoms s.

    "angles" has no freedom; "theta" and "mu" have s = (log lam), "theta0" and "lam" (log mu),
    "equal" the common logarithm, "free" both.  By Lemma 1 tanh(log mu) = cos theta /
    cosh(log lam), and the same with the names exchanged.  Paper: Lemma 1."""
    s = np.asarray(s, dtype=float)
    if goal.kind == "angles":
        return np.log(parallelogram.ratios(*goal.values)), np.zeros((2, 0))
    if goal.kind == "free":
        return s, np.eye(2)
    if goal.kind == "equal":
        return s[[0, 0]], np.ones((2, 1))
    if goal.kind in ("lam", "mu"):
        other, slope = goal.values[0], 0.0
    else:
        x = np.cos(goal.values[0]) / np.cosh(s[0])
        other, slope = np.arctanh(x), -x * np.tanh(s[0]) / (1 - x * x)
    found, slopes = np.array([s[0], other]), np.array([[1.0], [slope]])
    turn = 1 if goal.kind in ("theta", "mu") else -1
    return found[::turn], slopes[::turn]


def angles(goal: Goal, s: Sequence[float]) -> tuple:
    """(theta, theta0) of the goal at the freedom s; ValueError where no parallelogram has them."""
    if goal.kind == "angles":
        return goal.values
    return parallelogram.angles(*np.exp(logs(goal, s)[0]))


def freedom(goal: Goal, near: Sequence[float]) -> np.ndarray:
    """The freedom s of a goal whose (log lam, log mu) comes near the given pair."""
    log_lam, log_mu = _possible(goal, *near)
    values = {"angles": [], "free": [log_lam, log_mu], "equal": [(log_lam + log_mu) / 2]}
    one = log_lam if goal.kind in ("theta", "mu") else log_mu
    return np.array(values.get(goal.kind, [one]), dtype=float)


def _possible(goal, log_lam, log_mu):
    """The pair, or one like it inside Eq. (4), which is |sinh log lam sinh log mu| < 1."""
    if goal.kind == "equal":
        log_lam = log_mu = (log_lam + log_mu) / 2
    if goal.kind == "lam":
        log_lam = goal.values[0]
    if goal.kind == "mu":
        log_mu = goal.values[0]
    if abs(np.sinh(log_lam) * np.sinh(log_mu)) < INSIDE:
        return log_lam, log_mu
    if goal.kind in ("lam", "mu"):
        bound = np.arcsinh(INSIDE / abs(np.sinh(goal.values[0])))
        one, two = np.sign(log_lam) * bound, np.sign(log_mu) * bound
        return (log_lam, two) if goal.kind == "lam" else (one, log_mu)
    shrink = brentq(lambda k: abs(np.sinh(k * log_lam) * np.sinh(k * log_mu)) - INSIDE, 0, 1)
    return shrink * log_lam, shrink * log_mu


def towards(goal: Goal, start: Sequence[float], step: float) -> list[Goal]:
    """Goals on the straight way from the values `start` to those of the goal, which comes last.

    step: the largest change of an angle from one to the next, radians (for a logarithm of
    a ratio the same number).  With step = inf only the goal itself."""
    start, end = np.array(start), np.array(goal.values)
    far = np.abs(end - start).max(initial=0.0)
    count = max(1, int(np.ceil(far / step - 1e-9)))
    between = (start + (end - start) * k / count for k in range(1, count))
    return [*(goal._replace(values=tuple(values)) for values in between), goal]
