"""What is wanted of a net, and the way there: given angles or ratios, the rest left free.

A `Goal` is a curve, a surface or a point in the plane of (log lam, log mu): what is given
fixes part of it, and `free` numbers of freedom s remain.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from .. import parallelogram

INSIDE = 0.99  # of the range of Eq. (4), for a start
ALIKE = 1e-9  # radians: two given angles as close as this are meant to be the same


class Goal(NamedTuple):
    """kind: "angles", "theta", "theta0", "lam", "mu", "equal" or "free"; values: see `goal`.

    equal: theta = theta0 is wanted in the end; the paper has fewer equations for that.
    """

    kind: str
    values: tuple
    equal: bool = False


def goal(theta=None, theta0=None, lam=None, mu=None, equal=False):
    """The `Goal` of the given numbers: angles in radians, ratios positive; None leaves free.

    equal: theta = theta0 wanted (lam = mu), whatever its value.  `values` holds (theta,
    theta0) of "angles", else the one given angle or the logarithm of the one given ratio.
    ValueError for numbers out of range, for more than two, and for pairs that fit no
    parallelogram or two of them.

    Paper: Eq. (19), Eq. (20), Eq. (22).
    """
    names = {"theta": theta, "theta0": theta0, "lam": lam, "mu": mu}
    known = {name: _checked(name, x) for name, x in names.items() if x is not None}
    if equal:
        return _equal(known)
    if len(known) > 2:
        raise ValueError(f"{', '.join(known)} are given: two numbers fix the net, drop the others")
    if len(known) < 2:
        kind, value = next(iter(known.items()), ("free", None))
        return Goal(kind, () if value is None else (_parameter(kind, value),))
    theta, theta0 = _both(known)
    if abs(theta - theta0) <= ALIKE:  # one angle, twice: lam and mu from it may differ in a bit
        return _equal({"theta": theta})
    return Goal("angles", (theta, theta0))


def _checked(name, x):
    x = float(x)
    if name.startswith("theta"):
        if not 0 < x < np.pi:
            raise ValueError(f"{name} = {x:.6g}: an angle between 0 and pi radians is wanted")
    elif not 0 < x < np.inf:
        raise ValueError(f"{name} = {x:.6g}: a positive finite ratio is wanted")
    return x


def _parameter(kind, value):
    return value if kind.startswith("theta") else float(np.log(value))


def _equal(known):
    angles = [x for name, x in known.items() if name.startswith("theta")]
    ratios = [x for name, x in known.items() if not name.startswith("theta")]
    if (angles and ratios) or np.ptp(angles or ratios or [0.0]) > ALIKE:
        raise ValueError("with equal=True one angle or one ratio is wanted, and no other value")
    if ratios:
        angles = [float(parallelogram.angles(ratios[0], ratios[0])[0])]
    return Goal("angles", (angles[0], angles[0]), True) if angles else Goal("equal", (), True)


def _both(known):
    """(theta, theta0) from any two of the four numbers."""
    names = set(known)
    if names == {"theta", "theta0"}:
        return known["theta"], known["theta0"]
    if names == {"lam", "mu"}:
        return tuple(float(x) for x in parallelogram.angles(known["lam"], known["mu"]))
    if names in ({"lam", "theta0"}, {"mu", "theta"}):
        one, other = sorted(names)
        rest = "mu or theta" if one == "lam" else "lam or theta0"
        raise ValueError(f"{one} and {other} fit two nets, or none: give {rest} instead of one")
    kind = "theta" if "theta" in known else "theta0"
    ratio = np.log(known["lam" if kind == "theta" else "mu"])
    found, _ = logs(Goal(kind, (known[kind],)), [ratio])
    return tuple(float(x) for x in parallelogram.angles(*np.exp(found)))


def logs(goal, s):
    """(log lam, log mu), shape (2,), and their derivatives (2, k) in the k freedoms s.

    "angles" has no freedom; "theta" and "mu" have s = (log lam), "theta0" and "lam" (log mu),
    "equal" the common logarithm, "free" both.  By Lemma 1 tanh(log mu) = cos theta /
    cosh(log lam), and the same with the names exchanged.

    Paper: Lemma 1 (beyond the paper).
    """
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


def freedom(goal, near):
    """The freedom s of a goal whose (log lam, log mu) comes near the given pair."""
    log_lam, log_mu = _possible(goal, *near)
    values = {"angles": [], "free": [log_lam, log_mu], "equal": [(log_lam + log_mu) / 2]}
    one = log_lam if goal.kind in ("theta", "mu") else log_mu
    return np.array(values.get(goal.kind, [one]), dtype=float)


def is_possible(goal, s):
    """Whether the ratios at the freedom s are those of a parallelogram.

    Paper: Eq. (4).
    """
    return bool(parallelogram.is_admissible(*np.exp(logs(goal, s)[0])))


def _possible(goal, log_lam, log_mu):
    """The pair, or one like it inside Eq. (4), which is |sinh log lam sinh log mu| < 1."""
    if goal.kind == "equal":
        log_lam = log_mu = (log_lam + log_mu) / 2
    if goal.kind == "lam":
        log_lam = goal.values[0]
    if goal.kind == "mu":
        log_mu = goal.values[0]
    size = abs(np.sinh(log_lam) * np.sinh(log_mu))
    if size < INSIDE:
        return log_lam, log_mu
    if goal.kind in ("lam", "mu"):
        bound = np.arcsinh(INSIDE / abs(np.sinh(goal.values[0])))
        return tuple(
            x if k == goal.kind else np.sign(x) * bound
            for k, x in (("lam", log_lam), ("mu", log_mu))
        )
    shrink = brentq(lambda k: abs(np.sinh(k * log_lam) * np.sinh(k * log_mu)) - INSIDE, 0, 1)
    return shrink * log_lam, shrink * log_mu


def values_at(goal, theta, theta0, log_lam, log_mu):
    """What a net has in place of the goal's values; the four numbers are its means."""
    here = {"theta": theta, "theta0": theta0, "lam": log_lam, "mu": log_mu}
    names = ("theta", "theta0") if goal.kind == "angles" else (goal.kind,) * len(goal.values)
    return tuple(float(here[name]) for name in names)


def towards(goal, start, step):
    """Goals on the straight way from the values `start` to those of the goal, which comes last.

    step: the largest change of an angle from one to the next, radians (for a logarithm of
    a ratio the same number).  With step = inf only the goal itself.
    """
    start, end = np.array(start), np.array(goal.values)
    far = np.abs(end - start).max(initial=0.0)
    count = max(1, int(np.ceil(far / step - 1e-9)))
    between = (start + (end - start) * k / count for k in range(1, count))
    return [*(goal._replace(values=tuple(values)) for values in between), goal]
