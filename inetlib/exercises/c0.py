"""The exercises of chapter 0: two angles, what they mean, and the labels that they depend on."""

import numpy as np

from .engine import Exercise, numbers

RHOMBUS = np.radians([40, 90])
INVERTED = np.radians([70, 130])


def _exact(theta, theta0, m, n):
    """A sheared m x n grid, squared: the edges of a cell are 1 and exp(i theta0) / mu."""
    steep = np.sin(theta0) / np.tan(theta)
    v = np.exp(1j * theta0) / (steep + np.sqrt(steep**2 + 1))
    z = (0.7 + 0.1 * np.add.outer(np.arange(m + 1), v * np.arange(n + 1))) ** 2
    i, j = (x.ravel() for x in np.indices((m, n)))
    Q = np.stack([i * (n + 1) + j + 1, i * (n + 1) + j], axis=1)
    Q = np.concatenate([Q, Q[:, ::-1] + n + 1], axis=1)
    return np.stack([z.real, z.imag, 0 * z.real], axis=-1).reshape(-1, 3), Q


def _rolled(rng):
    """Nets of random angles; right angles among them; all faces rolled by 0, 1, 2, 3 in turn."""
    nets = []
    for k in range(12):
        theta, theta0 = (np.pi / 2, 1.0) if k < 4 else rng.uniform(0.5, 1.4, 2)
        V, Q = _exact(theta, theta0, 3 + k % 3, 2)
        nets.append((V, np.roll(Q, k % 4, axis=1), theta, theta0))
    return nets


def _labels(value, V, Q, theta, theta0):
    """What is wrong with the labels of a net."""
    value = np.asarray(value)
    if value.shape != Q.shape:
        return f"An array of shape {Q.shape} is wanted: the same faces with other labels."
    turns = [(value == np.roll(Q, k, axis=1)).all(axis=1) for k in range(4)]
    if not np.any(turns, axis=0).all():
        return "Each row must hold the vertices of its face, in their order around it."
    v1, v2, v3, v4 = (V[value] @ [1, 1j, 0]).T
    d1, d2 = v3 - v1, v4 - v2
    found = np.array([np.angle(d2 / d1), np.angle((d2 - d1) / (d1 + d2))])
    off = np.abs(found - np.array([[theta], [theta0]])).max(axis=0)
    words = "Measured: theta = {:.6f}, theta0 = {:.6f}".format(*found[:, off.argmax()])
    turned = np.allclose(found[:, off.argmax()], [np.pi - theta, np.pi - theta0])
    words += ", the supplements: the labels are a quarter turn off." if turned else "."
    return words if off.max() > 1e-9 else ""


def _degrees(value):
    large = np.abs(numbers(value)).max() > 2 * np.pi
    return "These look like degrees: radians are wanted." if large else ""


EXERCISES = [
    Exercise(
        name="0.1",
        title="Rhombuses of 40 degrees",
        level="change a number",
        minutes=3,
        task="Which angles does one ask for, so that all parallelograms are rhombuses with sides "
        "that meet at 40 degrees? `answer = [theta, theta0]`, in radians.",
        hint="The sides of the parallelogram meet at theta, its diagonals at theta0. How do the "
        "diagonals of a rhombus meet?",
        kind="array",
        truth=RHOMBUS,
        fault=_degrees,
        tolerance=1e-3,
        mistakes=[
            ("The two are exchanged: so the parallelograms are rectangles.", RHOMBUS[::-1]),
            ("These are other rhombuses: 140 degrees is the supplement.", np.pi - RHOMBUS),
            ("Two equal angles do not make a rhombus.", np.radians([40, 40])),
            ("These are degrees: np.radians makes radians of them.", np.degrees(RHOMBUS)),
            ("These are half the angles.", RHOMBUS / 2),
        ],
    ),
    Exercise(
        name="0.2",
        title="One ratio inverted",
        level="change a number",
        minutes=5,
        task="A net has theta = 70 and theta0 = 50 degrees. Another one has the same mu, and "
        "1 / lam in place of lam. `answer = [theta, theta0]` of the other one, in radians.",
        hint="`parallelogram.ratios` gives lam and mu, `parallelogram.angles` goes back. Or: which "
        "two sides change places, and what does that do to the diagonals?",
        kind="array",
        truth=INVERTED,
        fault=_degrees,
        tolerance=1e-3,
        mistakes=[
            (
                "Both supplements belong to a quarter turn: it inverts mu as well.",
                np.radians([110, 130]),
            ),
            ("That is what 1 / mu does.", np.radians([110, 50])),
            (
                "That is the net as it was: the lengths of d1 and d2 have changed places.",
                np.radians([70, 50]),
            ),
            ("Exchanging the angles exchanges lam and mu.", np.radians([50, 70])),
            ("These are degrees: np.radians makes radians of them.", np.degrees(INVERTED)),
        ],
    ),
    Exercise(
        name="0.3",
        title="Labels that give the asked angles",
        level="write a function",
        minutes=15,
        task="`answer(V, Q, theta, theta0)`: Q with its rows rolled, all by the same number of "
        "places, so that the net has these angles. Somebody may have begun at another corner.",
        hint="Measure. A half turn changes nothing, a quarter turn gives the supplements: roll "
        "along axis 1 when the angles are not the asked ones. One of them may be 90 degrees.",
        kind="function",
        instances=_rolled,
        truth=None,
        fault=_labels,
        mistakes=[
            ("You leave the labels as they are.", lambda V, Q, theta, theta0: Q),
            (
                "You always roll: half of the nets are right as they are.",
                lambda V, Q, theta, theta0: np.roll(Q, 1, axis=1),
            ),
            (
                "That exchanges the faces: the labels run along axis 1.",
                lambda V, Q, theta, theta0: np.roll(Q, 1, axis=0),
            ),
            (
                "That reverses the orientation: counter-clockwise must stay so.",
                lambda V, Q, theta, theta0: Q[:, ::-1],
            ),
            ("A half turn changes no angle.", lambda V, Q, theta, theta0: np.roll(Q, 2, axis=1)),
        ],
    ),
]
