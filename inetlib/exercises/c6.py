"""The exercises of chapter 6: what is counted, differentiated and solved on the way to a net."""

import numpy as np
import sympy as sp

from .engine import Exercise


def _grids(rng):
    """(m, n, short, given): one quad, a strip, grids; the short mode knows one angle."""
    some = [(1, 1, False, 0), (1, 6, True, 1), (20, 20, False, 2), (20, 20, True, 1)]
    for _ in range(14):
        short = bool(rng.integers(2))
        m, n, given = rng.integers([2, 2, 0], [30, 30, 2 if short else 3]).tolist()
        some.append((m, n, short, given))
    return some


def _count(m, n, short, given, around=1, globals_=True, each=6, rest=0):
    """(unknowns, equations), summed up by what they belong to."""
    vertices, faces = (m + around) * (n + around), m * n
    if short:
        unknowns = 3 * vertices + 2 * faces + globals_
        return unknowns + rest, 2 * faces + faces + faces + given + (rest > 0)
    unknowns = 3 * vertices + each * faces + 2 * globals_
    pairs = 4 * faces + 2 * faces + 2 * faces  # squared lengths, proportions, roots
    return unknowns + rest, pairs + given * faces + (rest > 0)


def _eq21(v):
    d1, d2 = v[2] - v[0], v[3] - v[1]
    return d2 @ d2 - d1 @ d1 - 2 * d1 @ d2


def _gradient(v, equation=_eq21):
    """Central differences of step 1, without an error: the equation is quadratic."""
    found = np.zeros((4, 3))
    for k in np.ndindex(4, 3):
        up, down = v.copy(), v.copy()
        up[k], down[k] = up[k] + 1, down[k] - 1
        found[k] = (equation(up) - equation(down)) / 2
    return found


def _halved(v):
    return _eq21(v) + (v[2] - v[0]) @ (v[3] - v[1])


def _quads(rng):
    """A flat square, then random quads in space."""
    square = np.array([[0, 1, 0], [0, 0, 0], [1, 0, 0], [1, 1, 0]], dtype=float)
    return [(square,), *((x,) for x in rng.normal(size=(10, 4, 3)))]


def _systems(rng):
    """One equation, one vertex of mobility 0 and one of 0.1, random ones."""
    found = [(np.array([[3.0, 4.0]]), np.array([5.0]), np.ones(2))]
    for k in range(10):
        m = int(rng.integers(1, 4))
        mobility = rng.uniform(0.2, 1, 7) if k else np.array([0, 0.1, 1, 1, 1, 1, 1])
        found.append((rng.normal(size=(m, 7)), rng.normal(size=m), mobility))
    return found


def _smallest(J, f):
    """By the QR decomposition of the transpose: J = R^T P^T, and P has orthonormal columns."""
    P, R = np.linalg.qr(J.T)
    return -P @ np.linalg.solve(R.T, f)


def _mobile(J, f, mobility):
    """In the unknowns d / root(m) the size of the step is |d|^2."""
    root = np.sqrt(mobility)
    return root * _smallest(J * root, f)


def _any_step(J, f, mobility):
    """A step that meets the conditions, by the first unknowns alone."""
    step = np.zeros(J.shape[1])
    step[: len(J)] = -np.linalg.solve(J[:, : len(J)], f)
    return step


EXERCISES = [
    Exercise(
        name="6.1",
        title="Unknowns and equations",
        level="write a function",
        minutes=10,
        task="`answer(m, n, short, given)`: (unknowns, equations) of the paper's formulation on a "
        "grid of m x n quads, in the short mode, Eq. (21), or in the general one; `given` angles "
        "are prescribed: 0, 1, and 2 in the general mode.",
        hint="See above. V vertices with three coordinates each, F faces; a given angle is one "
        "equation a face in the general mode, and one alone in the short mode.",
        kind="function",
        instances=_grids,
        truth=lambda m, n, short, given: _count(m, n, short, given),
        mistakes=[
            (
                "m x n quads have (m + 1)(n + 1) vertices.",
                lambda m, n, s, k: _count(m, n, s, k, around=0),
            ),
            (
                "The ratios are unknowns, too: two of them, one in the short mode.",
                lambda m, n, s, k: _count(m, n, s, k, globals_=False),
            ),
            (
                "Four squared lengths and two squared ratios: six for each face.",
                lambda m, n, s, k: _count(m, n, s, k, each=4),
            ),
            (
                "Each face has its equation of a given angle, in the general mode.",
                lambda m, n, s, k: (
                    _count(m, n, True, k) if s else (_count(m, n, s, k)[0], 8 * m * n + k)
                ),
            ),
            (
                "These are the numbers as Table 1 prints them, with unknowns that the paper does "
                "not name: count your own.",
                lambda m, n, s, k: _count(m, n, s, k, rest=2 if s else 3),
            ),
            ("Equations first? Unknowns come first.", lambda *a: _count(*a)[::-1]),
        ],
    ),
    Exercise(
        name="6.2",
        title="The gradient of Eq. (21)",
        level="write a function",
        minutes=10,
        task="`answer(v)`: the gradient of d2^2 - d1^2 - 2 d1 . d2 by the four corners of a quad; "
        "v and the answer have the shape (4, 3).",
        hint="First by d1 and by d2; v1 is in d1 with a minus, v3 with a plus. A difference "
        "quotient is a good test.",
        kind="function",
        instances=_quads,
        truth=lambda v: _gradient(v),
        mistakes=[
            ("The factor 2 of a square's derivative is lost.", lambda v: _gradient(v) / 2),
            (
                "The sign is wrong, or the labels are a quarter turn off: d1 = v3 - v1 and "
                "d2 = v4 - v2.",
                lambda v: -_gradient(v),
            ),
            ("The factor 2 before d1 . d2 is lost.", lambda v: _gradient(v, _halved)),
            (
                "The product d1 . d2 depends on the corners as well.",
                lambda v: _gradient(v, lambda x: _eq21(x) + 2 * (x[2] - x[0]) @ (x[3] - x[1])),
            ),
            (
                "d1 and d2 are exchanged.",
                lambda v: _gradient(v[[1, 0, 3, 2]])[[1, 0, 3, 2]],
            ),
            (
                "The rows are in another order: v1, v2, v3, v4.",
                lambda v: _gradient(v)[[0, 2, 1, 3]],
            ),
        ],
    ),
    Exercise(
        name="6.3",
        title="The smallest step",
        level="write a function",
        minutes=10,
        task="`answer(J, f, mobility)`: the step d with f + J d = 0 for which the sum of "
        "d_i^2 / mobility_i is least; an unknown of mobility 0 stays.",
        hint="The multipliers y solve (J M J^T) y = f. With all mobilities 1 it is what "
        "`np.linalg.lstsq` finds, but mind its right side.",
        kind="function",
        instances=_systems,
        truth=lambda J, f, mobility: _mobile(J, f, mobility),
        tolerance=1e-7,
        mistakes=[
            (
                "The sign: f + J d = 0, so lstsq gets -f.",
                lambda J, f, m: -_mobile(J, f, m),
            ),
            ("The mobilities are ignored.", lambda J, f, m: _smallest(J, f)),
            (
                "Both the sign and the mobilities: J d is -f, and not f.",
                lambda J, f, m: -_smallest(J, f),
            ),
            (
                "The step meets f + J d = 0, but a smaller one does, too.",
                lambda J, f, m: _any_step(J, f, m),
            ),
            (
                "That goes down the slope: J^T has to be applied to the multipliers, not to f.",
                lambda J, f, m: -m * (J.T @ f),
            ),
            (
                "You applied M to the step of mobility 1: then f + J d is not 0 any more.",
                lambda J, f, m: m * _smallest(J, f),
            ),
            (
                "That divides by the mobilities: unknowns with small ones move most.",
                lambda J, f, m: _mobile(J, f, 1 / m),
            ),
            (
                "You took squares of the mobilities.",
                lambda J, f, m: _mobile(J, f, m**2),
            ),
            ("Half of the step.", lambda J, f, m: _mobile(J, f, m) / 2),
        ],
    ),
    Exercise(
        name="6.4",
        title="How the ratio follows the angle",
        level="prove",
        minutes=10,
        task="For equal angles Eq. (22) gives lam. If theta is a little off, by which factor of "
        "it is ln lam off? The derivative of ln lam by theta, in its shortest form, a sympy "
        "expression in `theta`.",
        hint="lam - 1 / lam = 2 cos theta. Differentiate both sides.",
        kind="expression",
        instances=lambda rng: [(np.pi / 2,), *((float(x),) for x in rng.uniform(0.2, 2.9, 11))],
        truth=lambda theta: -sp.sin(theta) / sp.sqrt(1 + sp.cos(theta) ** 2),
        mistakes=[
            (
                "The sign: the ratio falls while the angle grows.",
                lambda t: sp.sin(t) / sp.sqrt(1 + sp.cos(t) ** 2),
            ),
            (
                "That is the derivative of lam, not of its logarithm.",
                lambda t: -sp.sin(t) * (1 + sp.cos(t) / sp.sqrt(1 + sp.cos(t) ** 2)),
            ),
            (
                "The inner derivative is lost: cos theta depends on theta.",
                lambda t: 1 / sp.sqrt(1 + sp.cos(t) ** 2),
            ),
            ("The root is lost.", lambda t: -sp.sin(t) / (1 + sp.cos(t) ** 2)),
            (
                "The sign in the root: that is 1 - cos^2, which belongs to arcsin, not arsinh.",
                lambda t: -sp.sin(t) / sp.sqrt(1 - sp.cos(t) ** 2),
            ),
            (
                "A factor 2: lam - 1 / lam has the derivative (lam + 1 / lam) (ln lam)'.",
                lambda t: -2 * sp.sin(t) / sp.sqrt(1 + sp.cos(t) ** 2),
            ),
        ],
    ),
]
