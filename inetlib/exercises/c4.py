"""The exercises of chapter 4: tangents of a net and of its diagonals, faces that close a net."""

import numpy as np
import sympy as sp

from .engine import Exercise

HELIX = np.radians([60, 45])


def _angle(a, b):
    """By lengths only, as half angles of a rhombus."""
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    return 2 * np.arctan2(np.linalg.norm(a - b), np.linalg.norm(a + b))


def _tangents(rng):
    """X_u, X_v: orthogonal ones of equal and of other lengths, random ones."""
    some = [([1.0, 0, 0], [0, 1.0, 0]), ([2.0, 0, 0], [0, 0, 1.0])]
    some += [tuple(pair) for pair in rng.normal(size=(12, 2, 3))]
    return [(np.array(a), np.array(b)) for a, b in some]


def _halves(Xu, Xv):
    """(alpha, beta)."""
    return _angle(Xu + Xv, Xu), _angle(Xu - Xv, Xu)


def _surfaces(rng):
    """Polynomial surfaces X(u, v), and places."""
    found = []
    for _ in range(10):
        c = rng.normal(size=(3, 3, 3))
        surface = lambda u, v, c=c: np.polynomial.polynomial.polyval2d(u, v, c)  # noqa: E731
        found.append((surface, *rng.uniform(-1, 1, 2).tolist()))
    return [(found[0][0], 0.0, 0.0), *found]


def _start(value, X, u, v):
    """What must hold where both parametrisations begin."""
    return "The point Y(0, 0) must be X(0, 0)." if u == v == 0 else ""


def _corners(lam, mu, theta):
    """Four corners with d1 = 1, d2 = lam exp(i theta), not at rest and not a parallelogram."""
    d1, d2 = 1, lam * np.exp(1j * theta)
    return np.array([0.3 + 0.1j, -0.2 - mu * 0.3j, 0.3 + 0.1j + d1, -0.2 - mu * 0.3j + d2])


def _quads(rng):
    """Squares, theta-quads, and quads with other numbers in the place of 2 in Eq. (13)."""
    found = []
    for k in range(24):
        theta, factor = rng.uniform(0.4, 1.2) * rng.choice([1, 2]), (2, -2, 1, 0)[k % 4]
        half = 0 if k < 3 else factor * np.cos(theta) / 2
        z = _corners(half + np.sqrt(half**2 + 1), 1.1, np.pi / 2 if k < 3 else theta)
        z = z * rng.uniform(0.5, 2) * np.exp(1j * rng.uniform(0, 6))
        found.append((np.stack([z.real, z.imag, [0.2, -0.1, 0.2, -0.1]], axis=1),))
    return found


def _vectors(corners):
    d1, d2 = corners[2] - corners[0], corners[3] - corners[1]
    return d1, d2, d1 + d2, d2 - d1


def _is_theta(corners):
    d1, d2, m13, m24 = _vectors(corners)
    return bool(abs(_angle(d1, d2) - _angle(m13, m24)) < 1e-7)


def _why(value, corners):
    """Both angles of a quad."""
    d1, d2, m13, m24 = _vectors(corners)
    found = _angle(d1, d2), _angle(m13, m24)
    return "Here theta = {:.9f}, theta0 = {:.9f}, in radians.".format(*found)


def _divided(corners):
    """Whether the quotient of the cosines is 1: 0/0 at right angles."""
    _, _, m13, m24 = _vectors(corners)
    right = abs(_angle(m13, m24) - np.pi / 2) < 1e-9
    return bool(not right and _is_theta(corners))


def _sign(corners, factor):
    """Whether d2^2 - d1^2 = factor d1 . d2, up to rounding."""
    d1, d2, _, _ = _vectors(corners)
    return bool(abs(d2 @ d2 - d1 @ d1 - factor * (d1 @ d2)) < 1e-7 * (d1 @ d1 + d2 @ d2))


def _ratio(theta, theta0):
    """lam exp(i theta): the direction of v is theta0, its length makes the diagonals meet."""
    steep = np.sin(theta0) / np.tan(theta)
    v = np.exp(1j * theta0) * (np.sqrt(steep**2 + 1) - steep)
    return (1 + v) / (1 - v)


def _places(rng):
    z = rng.normal(size=(12, 3)) + 1j * rng.normal(size=(12, 3))
    pairs = np.concatenate([np.radians([(90, 90), (60, 60)]), rng.uniform(0.4, 2.7, (10, 2))])
    return [(*map(complex, a), *map(float, b)) for a, b in zip(z, pairs, strict=True)]


def _face(value, v1, v2, v3, theta, theta0):
    d1, d2 = v3 - v1, complex(value) - v2
    found = np.angle([d2 / d1, (d2 - d1) / (d1 + d2)])
    return "Measured: theta = {:.4f}, theta0 = {:.4f}, in radians.".format(*found)


def _screw(value):
    """What a face of the helical net with this step along v measures."""
    turn, height = np.real(np.asarray(value, dtype=complex).reshape(2))
    i, j = np.array([(0, 1), (0, 0), (1, 0), (1, 1)]).T
    z = np.exp(1j * (0.3 * i + turn * j))
    d1, d2, m13, m24 = _vectors(np.stack([z.real, z.imag, 0.05 * i + height * j], axis=1))
    found = np.array([_angle(d1, d2), _angle(m13, m24)])
    words = "Measured: theta = {:.4f}, theta0 = {:.4f} degrees.".format(*np.degrees(found))
    for name, other in {
        "The angles are exchanged.": HELIX[::-1],
        "Both are the supplements: the step goes down.": np.pi - HELIX,
    }.items():
        if np.abs(found - other).max() < 1e-3:
            words += " " + name
    return "" if np.abs(found - HELIX).max() < 1e-6 else words


EXERCISES = [
    Exercise(
        name="4.1",
        title="A step of the helical net",
        level="change a number",
        minutes=10,
        task="On the helical net below Thm 12 the point turns by 0.3 and rises by 0.05 with each "
        "u-step. `answer = [turn, rise]` of the v-step that makes it a (60, 45)-net, to 1e-6.",
        hint="Two unknowns, two equations: `scipy.optimize.root` on `measure.angles`.",
        kind="array",
        truth=None,
        fault=lambda value: _screw(value),
        mistakes=[
            ("That is the step of the net as it is.", [0.08, 0.24]),
            ("That is the u-step again: the faces have no area.", [0.3, 0.05]),
        ],
    ),
    Exercise(
        name="4.2",
        title="The two parts of theta",
        level="write a function",
        minutes=10,
        task="`answer(Xu, Xv)`: (alpha, beta) in radians, where alpha is between Y_v and X_u and "
        "beta between Y_u and X_u; Xu and Xv are tangents in space.",
        hint="Y_u = X_u - X_v and Y_v = X_u + X_v; the angles by arctan2 of |a x b| and a . b.",
        kind="function",
        instances=_tangents,
        truth=lambda Xu, Xv: _halves(Xu, Xv),
        mistakes=[
            (
                "Exchanged, as the paper prints it in the proof of Thm 7.",
                lambda a, b: _halves(a, b)[::-1],
            ),
            (
                "Your Y_u points the other way: beta is the supplement.",
                lambda a, b: (_halves(a, b)[0], np.pi - _halves(a, b)[1]),
            ),
            (
                "Half of theta each: X_u bisects it for equal lengths only.",
                lambda a, b: np.full(2, sum(_halves(a, b)) / 2),
            ),
            ("These are the angles with X_v.", lambda a, b: _halves(b, a)),
            ("Both are the supplements.", lambda a, b: np.pi - np.array(_halves(a, b))),
            ("These are degrees.", lambda a, b: np.degrees(_halves(a, b))),
            ("These are the cosines.", lambda a, b: np.cos(_halves(a, b))),
        ],
    ),
    Exercise(
        name="4.3",
        title="The diagonal parametrisation",
        level="prove",
        minutes=10,
        task="`answer(X, u, v)`: the point Y(u, v) of the parametrisation with Y_u = X_u - X_v, "
        "Y_v = X_u + X_v and Y(0, 0) = X(0, 0); X is a function of two numbers.",
        hint="Y = X(p, q) with p and q linear in u and v. The chain rule gives their four "
        "coefficients.",
        kind="function",
        instances=_surfaces,
        truth=lambda X, u, v: X(u + v, v - u),
        fault=_start,
        mistakes=[
            (
                "So it is printed; its derivatives are Y_u = X_u + X_v and Y_v = X_v - X_u: a "
                "quarter turn off.",
                lambda X, u, v: X(u - v, u + v),
            ),
            (
                "The orientation is reversed: your Y_v is X_u - X_v.",
                lambda X, u, v: X(u + v, u - v),
            ),
            (
                "The derivatives are halves of the wanted ones.",
                lambda X, u, v: X((u + v) / 2, (v - u) / 2),
            ),
            ("Half of the position is another surface.", lambda X, u, v: X(u + v, v - u) / 2),
            ("This is X itself.", lambda X, u, v: X(u, v)),
            (
                "Sum and difference of points of X lie on another surface.",
                lambda X, u, v: X(u, v) + X(v, -u) - X(0, 0),
            ),
        ],
    ),
    Exercise(
        name="4.4",
        title="Is it a theta-quad",
        level="write a function",
        minutes=10,
        task="`answer(corners)`: whether theta = theta0 in a quad in space, True or False; "
        "`corners` is a (4, 3) array. Right angles count, and floats are never quite equal.",
        hint="Eq. (13), over the sum of the two squares, against 1e-7.",
        kind="function",
        instances=_quads,
        truth=lambda corners: _is_theta(corners),
        fault=_why,
        mistakes=[
            ("Right angles are refused: you divide by cos theta0.", lambda c: _divided(c)),
            ("d1 and d2 are exchanged in Eq. (13).", lambda c: _sign(c, -2)),
            ("The factor 2 of Eq. (13) is lost.", lambda c: _sign(c, 1)),
            ("That asks for equal diagonals.", lambda c: _sign(c, 0)),
            ("Two floats are never quite equal: allow for 1e-7 or so.", lambda c: False),
            ("It is the other way round.", lambda c: not _is_theta(c)),
        ],
    ),
    Exercise(
        name="4.5",
        title="The fourth corner",
        level="write a function",
        minutes=10,
        task="`answer(v1, v2, v3, theta, theta0)`: the corner v4, complex like the others, of a "
        "face with these angles in the plane.",
        hint="d2 = K d1 with one complex number K. `parallelogram.ratios` gives its length.",
        kind="function",
        instances=_places,
        truth=lambda v1, v2, v3, theta, theta0: v2 + _ratio(theta, theta0) * (v3 - v1),
        fault=_face,
        mistakes=[
            (
                "The ratio is upside down: lam = |d2| / |d1|.",
                lambda a, b, c, x, y: b + (c - a) / np.conj(_ratio(x, y)),
            ),
            (
                "The orientation is reversed: d2 is d1 turned counter-clockwise.",
                lambda a, b, c, x, y: b + (c - a) * np.conj(_ratio(x, y)),
            ),
            ("The length lam is missing.", lambda a, b, c, x, y: b + (c - a) * np.exp(1j * x)),
            ("The turn is missing.", lambda a, b, c, x, y: b + (c - a) * abs(_ratio(x, y))),
            ("The angles are exchanged.", lambda a, b, c, x, y: b + (c - a) * _ratio(y, x)),
            ("d2 begins in v2.", lambda a, b, c, x, y: a + (c - a) * _ratio(x, y)),
            ("d1 runs from v1 to v3.", lambda a, b, c, x, y: b - (c - a) * _ratio(x, y)),
            ("That makes a parallelogram of the quad itself.", lambda a, b, c, x, y: a + c - b),
        ],
    ),
    Exercise(
        name="4.6",
        title="How long is the diagonal",
        level="prove",
        minutes=15,
        task="|Y_v| / |X_u| as a sympy expression in `lam, mu`. What becomes of it for lam = mu?",
        hint="With |X_v| = 1 and |X_u| = mu the parallelogram law gives the sum of |Y_u|^2 and "
        "|Y_v|^2, and their quotient is known.",
        kind="expression",
        instances=lambda rng: [tuple(x) for x in rng.uniform(0.4, 2.5, (12, 2)).tolist()],
        truth=lambda lam, mu: lam * sp.sqrt(2 * (1 + mu**2) / (1 + lam**2)) / mu,
        mistakes=[
            (
                "That is |Y_u| / |X_u|.",
                lambda lam, mu: sp.sqrt(2 * (1 + mu**2) / (1 + lam**2)) / mu,
            ),
            (
                "That is |Y_v| / |X_v|.",
                lambda lam, mu: lam * sp.sqrt(2 * (1 + mu**2) / (1 + lam**2)),
            ),
            (
                "That is its square.",
                lambda lam, mu: 2 * lam**2 * (1 + mu**2) / (mu**2 + lam**2 * mu**2),
            ),
            (
                "A factor is lost: the sum is twice |X_u|^2 + |X_v|^2.",
                lambda lam, mu: lam * sp.sqrt((1 + mu**2) / (1 + lam**2)) / mu,
            ),
            ("Upside down.", lambda lam, mu: mu * sp.sqrt((1 + lam**2) / (2 + 2 * mu**2)) / lam),
            ("That holds for lam = mu only.", lambda lam, mu: sp.sqrt(2)),
        ],
    ),
]
