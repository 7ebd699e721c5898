"""The exercises of chapter 2: the parallelograms inside a mesh, and which meshes have labels."""

import numpy as np
import sympy as sp

from .engine import Exercise


def _spread(steps):
    """(least, largest) theta of the net A with these steps, radians; its lines meet at 60."""
    u, v = np.meshgrid(steps, np.exp(1j * np.pi / 3) * np.asarray(steps, dtype=float))
    found = np.angle((u + v) / (u - v))
    return found.min(), found.max()


def _steps(value):
    steps = np.asarray(value, dtype=float)
    if steps.shape != (8,) or not (steps > 0).all():
        return "Eight positive numbers are wanted."
    low, high = np.degrees(_spread(steps))
    words = f"With these steps theta goes from {low:.2f} to {high:.2f} degrees."
    return words if high - low > 1e-6 else ""


def _corners(rng):
    """A square, then random quads in space."""
    square = np.array([[0, 1, 0], [0, 0, 0], [1, 0, 0], [1, 1, 0]], dtype=float)
    return [(square,), *((square + rng.normal(scale=0.6, size=(4, 3)),) for _ in range(15))]


def _angle(a, b):
    """By lengths only: no product of vectors, as half angles of a rhombus."""
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    return 2 * np.arctan2(np.linalg.norm(a - b), np.linalg.norm(a + b))


def _black(corners):
    m12, m23, m34, m41 = (corners + np.roll(corners, -1, axis=0)) / 2
    return _angle(m23 - m12, m41 - m12), _angle(m34 - m12, m41 - m23)


EXERCISES = [
    Exercise(
        name="2.1",
        title="Even out the net A",
        level="change a number",
        minutes=5,
        task="Eight numbers in place of `[0.6, 1.3, ...]`, the steps of the net (A) above, with "
        "which not only theta0 but also theta is the same in all faces.",
        hint="A face has two neighbouring steps for its sides, of the same angle as any other "
        "face. When do two parallelograms with one angle between their sides look alike?",
        kind="array",
        truth=None,
        fault=lambda value: _steps(value),
        mistakes=[
            ("These grow evenly: they are the places of the lines, not the steps.", range(1, 9)),
            (
                "A geometric progression: faces on the diagonal are alike, others not.",
                2.0 ** np.arange(8),
            ),
            ("These are the steps as they were.", [0.6, 1.3, 0.9, 1.9, 0.7, 1.4, 1.0, 0.5]),
        ],
    ),
    Exercise(
        name="2.2",
        title="Which rings can be labelled",
        level="write a function",
        minutes=10,
        task="`answer(valences)`: whether rings of quads around a polygon can be labelled, True "
        "or False; `valences` is a list of the valences of the polygon's corners, each 3 or more.",
        hint="Walk around the polygon, and count the quads that you pass at each corner: the "
        "names of the edges change with each of them.",
        kind="function",
        instances=lambda rng: [
            *(([k] * n,) for k in (3, 4, 5) for n in (3, 4, 5, 6)),
            *((rng.integers(3, 8, size=rng.integers(3, 9)).tolist(),) for _ in range(20)),
        ],
        truth=lambda valences: (sum(valences) - len(valences)) % 2 == 0,
        mistakes=[
            (
                "You count the corners: that is enough where all of them have valence 4, and not "
                "around a triangle of valence-3 corners.",
                lambda valences: len(valences) % 2 == 0,
            ),
            (
                "You add the valences: at a corner of valence k, how many quads are passed?",
                lambda valences: sum(valences) % 2 == 0,
            ),
            (
                "Every valence even is the rule for interior vertices, not for a polygon.",
                lambda valences: all(k % 2 == 0 for k in valences),
            ),
            (
                "It is the other way round.",
                lambda valences: (sum(valences) - len(valences)) % 2 == 1,
            ),
        ],
    ),
    Exercise(
        name="2.3",
        title="The two angles of a face",
        level="write a function",
        minutes=10,
        task="`answer(corners)`: (theta, theta0) of the parallelogram inside a quad in space, in "
        "radians, without `measure`; `corners` is a (4, 3) array, v1 at the top left, then "
        "counter-clockwise.",
        hint="d1 = v3 - v1 and d2 = v4 - v2 are twice its sides; half their sum and half their "
        "difference are its diagonals.",
        kind="function",
        instances=_corners,
        truth=lambda corners: _black(corners),
        mistakes=[
            ("The two angles are exchanged.", lambda c: _black(c)[::-1]),
            (
                "Both are the supplements: the labels are a quarter turn off.",
                lambda c: np.pi - np.array(_black(c)),
            ),
            ("These are degrees, radians are wanted.", lambda c: np.degrees(_black(c))),
            (
                "These are the acute angles between lines: without abs, angles between vectors go "
                "up to pi.",
                lambda c: [min(x, np.pi - x) for x in _black(c)],
            ),
            (
                "The difference points the other way: theta0 is the supplement.",
                lambda c: (_black(c)[0], np.pi - _black(c)[1]),
            ),
            ("These are half the angles.", lambda c: np.array(_black(c)) / 2),
        ],
    ),
    Exercise(
        name="2.4",
        title="The area of a black face",
        level="prove",
        minutes=10,
        task="A flat convex quad has diagonals of the lengths d1 and d2 that meet at theta. Its "
        "black parallelogram has which area? A sympy expression in `d1, d2, theta`.",
        hint="The sides of the parallelogram are parallel to the diagonals.",
        kind="expression",
        instances=lambda rng: [(2.0, 2.0, np.pi / 2), *map(tuple, rng.uniform(0.3, 2.8, (11, 3)))],
        truth=lambda d1, d2, theta: d1 * d2 * sp.sin(theta) / 4,
        mistakes=[
            ("That is the area of the whole quad.", lambda d1, d2, t: d1 * d2 * sp.sin(t) / 2),
            ("That is half of it, a triangle.", lambda d1, d2, t: d1 * d2 * sp.sin(t) / 8),
            ("The sides are half as long as the diagonals.", lambda d1, d2, t: d1 * d2 * sp.sin(t)),
            (
                "A cosine is a scalar product: an area takes a sine.",
                lambda d1, d2, t: d1 * d2 * sp.cos(t) / 4,
            ),
            (
                "A tangent is no height: which function is the opposite side over the hypotenuse?",
                lambda d1, d2, t: d1 * d2 * sp.tan(t) / 4,
            ),
        ],
    ),
]
