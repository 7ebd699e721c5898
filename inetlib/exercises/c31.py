"""The exercises of chapter 3.1: two ratios, two angles, and the digits of an arc cosine."""

import numpy as np
import sympy as sp

from .engine import Exercise


def _shape(lam, mu):
    """(theta, theta0) of the corners: the triangle with the sides 1, lam and p of Eq. (2)."""
    square = 2 * (1 + lam**2) / (1 + mu**2)
    x = (1 + lam**2 - square) / 2
    A = x + 1j * np.sqrt(lam**2 - x**2)
    return np.angle(A), np.angle((A - 1) / (A + 1))


def _inverse(theta, theta0):
    """(lam, mu): mu - 1/mu = 2 sin theta0 cot theta, by the argument of (1 + rho) / (1 - rho)."""
    one, two = np.sin(theta) / np.tan(theta0), np.sin(theta0) / np.tan(theta)
    return one + np.sqrt(one**2 + 1), two + np.sqrt(two**2 + 1)


def _pairs(rng):
    """Angles: a square, a rectangle, a rhombus, the golden one, random ones."""
    special = np.radians([(90, 90), (90, 40), (130, 90), (60, 60), (20, 150)])
    return [*map(tuple, special.tolist()), *map(tuple, rng.uniform(0.3, 2.8, (12, 2)).tolist())]


def _exists(lam, mu):
    """Whether the triangle with the sides 1, lam and p of Eq. (2) closes."""
    square = 2 * (1 + lam**2) / (1 + mu**2)
    return bool((1 - lam) ** 2 < square < (1 + lam) ** 2)


def _borders(rng):
    """Ratios inside, outside and on the border (exact in floats)."""
    some = [(2.0, 3.0), (0.5, 3.0), (3.0, 2.0), (3.0, 0.5), (5.0, 1.0), (1.0, 0.01), (2.5, 0.5)]
    return some + [tuple(x) for x in np.exp(rng.uniform(-2, 2, (30, 2))).tolist()]


def _vectors(rng):
    """Pairs of vectors at 1e-6 to pi - 1e-6, of random lengths, turned at random."""
    found = []
    for angle in (1e-6, 3e-5, 1e-3, 0.4, np.pi / 2, 2.2, np.pi - 1e-6, 1.0):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0] * rng.uniform(0.5, 2)
        found.append((turn @ [1, 0, 0], turn @ [2 * np.cos(angle), 2 * np.sin(angle), 0]))
    return found


def _between(a, b):
    """Half the angle is that of a rhombus: its diagonals are the sum and the difference."""
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    return 2 * np.arctan2(np.linalg.norm(a - b), np.linalg.norm(a + b))


def _digits(value, a, b):
    wanted = _between(a, b)
    close = abs(value - wanted) < 1e-2 * min(wanted, np.pi - wanted)
    words = "Nearly: an arccos (or arcsin) loses half of the digits where it is flat."
    return words if close else ""


EXERCISES = [
    Exercise(
        name="3.1.1",
        title="Ratios to angles",
        level="write a function",
        minutes=10,
        task="`answer(lam, mu)`: (theta, theta0) in radians, without the library.",
        hint="Eq. (3) gives the cosines. Or put the corners into the plane: B = 0, C = 1, and A "
        "at the distance lam from B and p from C.",
        kind="function",
        instances=lambda rng: [_inverse(*pair) for pair in _pairs(rng)],
        truth=lambda lam, mu: _shape(lam, mu),
        tolerance=1e-8,
        mistakes=[
            ("The two angles are exchanged.", lambda x, y: _shape(x, y)[::-1]),
            (
                "Both are the supplements: a ratio is upside down twice.",
                lambda x, y: np.pi - np.array(_shape(x, y)),
            ),
            ("theta is the supplement: mu is |BD| / |AC|.", lambda x, y: _shape(x, 1 / y)),
            ("theta0 is the supplement: it is AOD, and not AOB.", lambda x, y: _shape(1 / x, y)),
            ("These are degrees, radians are wanted.", lambda x, y: np.degrees(_shape(x, y))),
            ("These are the cosines: the angles are wanted.", lambda x, y: np.cos(_shape(x, y))),
            ("These are half the angles.", lambda x, y: np.array(_shape(x, y)) / 2),
        ],
    ),
    Exercise(
        name="3.1.2",
        title="Angles to ratios",
        level="write a function",
        minutes=15,
        task="`answer(theta, theta0)`: (lam, mu), without the library; all angles between 0 and "
        "pi, right ones among them.",
        hint="With l = ln lam and m = ln mu, Eq. (3) is cos theta = cosh l tanh m, and the same "
        "with l and m exchanged. Which combination of the angles is sinh l?",
        kind="function",
        instances=_pairs,
        truth=lambda theta, theta0: _inverse(theta, theta0),
        mistakes=[
            (
                "The cotangents are of the other angle: lam and mu are exchanged.",
                lambda x, y: _inverse(y, x),
            ),
            ("Both ratios are upside down.", lambda x, y: 1 / np.array(_inverse(x, y))),
            ("These are the logarithms: take exp.", lambda x, y: np.log(_inverse(x, y))),
            (
                "A tangent stands where a cotangent belongs.",
                lambda x, y: np.exp(np.arcsinh([np.sin(x) * np.tan(y), np.sin(y) * np.tan(x)])),
            ),
            (
                "sinh stands where its inverse belongs.",
                lambda x, y: np.exp(np.sinh(np.sinh(np.log(_inverse(x, y))))),
            ),
            (
                "A factor 2 is lost: sinh m is half of mu - 1/mu.",
                lambda x, y: np.exp(np.arcsinh(np.sinh(np.log(_inverse(x, y))) / 2)),
            ),
        ],
    ),
    Exercise(
        name="3.1.3",
        title="Which ratios are possible",
        level="write a function",
        minutes=10,
        task="`answer(lam, mu)`: whether a parallelogram exists, True or False, without the "
        "library. Both are positive; on the border, where it collapses, the answer is False.",
        hint="With p from Eq. (2) a triangle has the sides 1, lam and p. When does it close?",
        kind="function",
        instances=_borders,
        truth=lambda lam, mu: _exists(lam, mu),
        mistakes=[
            (
                "This is Eq. (6), which holds for mu > 1 only: it refuses every mu below.",
                lambda x, y: bool(y > 1 and (y - 1) / (y + 1) < x < (y + 1) / (y - 1)),
            ),
            ("The upper bound is missing.", lambda x, y: bool(abs(y - 1) / (y + 1) < x)),
            ("The lower bound is missing.", lambda x, y: bool(x * abs(y - 1) < y + 1)),
            (
                "On the border the parallelogram has no area: the bounds do not belong to it.",
                lambda x, y: bool((x - 1 / x) ** 2 * (y - 1 / y) ** 2 <= 16),
            ),
            ("It is the other way round.", lambda x, y: not _exists(x, y)),
        ],
    ),
    Exercise(
        name="3.1.4",
        title="An angle near 1e-6",
        level="write a function",
        minutes=10,
        task="`answer(a, b)`: the angle between two vectors in space, in radians, to nine digits "
        "even where it is 1e-6 or pi - 1e-6.",
        hint="1 - cos(1e-6) is 5e-13, and a float has 16 digits. The length of a cross product "
        "keeps them; which function takes a sine and a cosine?",
        kind="function",
        instances=_vectors,
        truth=lambda a, b: _between(a, b),
        fault=_digits,
        mistakes=[
            (
                "An arcsin never goes beyond pi / 2: obtuse angles become acute.",
                lambda a, b: min(_between(a, b), np.pi - _between(a, b)),
            ),
            ("arctan2 takes the sine first.", lambda a, b: np.pi / 2 - _between(a, b)),
            ("These are degrees.", lambda a, b: np.degrees(_between(a, b))),
            ("This is half of it.", lambda a, b: _between(a, b) / 2),
            (
                "This is the supplement: one of the vectors is reversed.",
                lambda a, b: np.pi - _between(a, b),
            ),
        ],
    ),
    Exercise(
        name="3.1.5",
        title="The missing factor",
        level="prove",
        minutes=15,
        task="16 - (lam - 1/lam)^2 (mu - 1/mu)^2 is a square times sin(theta)^2. Give the square, "
        "a sympy expression in `lam, mu` (one of them may be missing).",
        hint="The folded proof of Eq. (4) has this expression times lam^2 mu^2, and above it the "
        "same product as a square with sin theta in it.",
        kind="expression",
        instances=lambda rng: [tuple(x) for x in rng.uniform(0.5, 2, (12, 2)).tolist()],
        truth=lambda lam, mu: 4 * (mu + 1 / mu) ** 2,
        mistakes=[
            ("With lam in it this belongs to theta0.", lambda lam, mu: 4 * (lam + 1 / lam) ** 2),
            ("Wrong sign: try a square, lam = mu = 1.", lambda lam, mu: 4 * (mu - 1 / mu) ** 2),
            ("A factor is lost: try lam = mu = 1.", lambda lam, mu: (mu + 1 / mu) ** 2),
            ("A factor 2 is lost: try lam = mu = 1.", lambda lam, mu: 2 * (mu + 1 / mu) ** 2),
            ("That is the root of it.", lambda lam, mu: 2 * (mu + 1 / mu)),
            ("Divide by lam^2 mu^2.", lambda lam, mu: 4 * lam**2 * (1 + mu**2) ** 2),
            ("Upside down.", lambda lam, mu: 1 / (4 * (mu + 1 / mu) ** 2) + sp.Integer(0)),
        ],
    ),
]
