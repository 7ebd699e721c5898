"""The exercises of chapter 5.3: courses on the globe, the rows of a web, closed webs on a torus."""

import numpy as np

from .engine import Exercise


def _courses(rng):
    """(from, to, theta0): a meridian, across the equator, back to the south, obtuse angles."""
    some = [(0.0, 1.0, np.pi / 2), (0.0, 0.8, np.pi / 3), (-1.2, 1.2, 0.3), (0.9, 0.1, 2.0)]
    return some + [tuple(x) for x in rng.uniform([-1.3, -1.3, 0.3], [1.3, 1.3, 2.8], (12, 3))]


def _mercator(latitude):
    """By the half angle: ln tan(45 degrees + latitude / 2)."""
    return np.log(np.tan(np.pi / 4 + latitude / 2))


def _turned(a, b, factor):
    return (_mercator(b) - _mercator(a)) * factor


def _mu(theta, theta0):
    """mu - 1/mu = 2 sin(theta0) cot(theta)."""
    half = np.sin(theta0) / np.tan(theta)
    return half + np.sqrt(half**2 + 1)


def _step(theta, theta0, m, power=-1):
    return 2 * np.pi / m * np.sin(theta0) * _mu(theta, theta0) ** power


def _webs(rng):
    special = [(np.pi / 2, np.pi / 2, 12), (np.pi / 3, np.pi / 3, 24), (np.pi / 3, np.pi / 2, 7)]
    more = [(*rng.uniform(0.4, 2.7, 2).tolist(), int(rng.integers(5, 90))) for _ in range(12)]
    return special + more


def _tori(rng):
    found = [(2.0, 0.8, 48, 24, 12), (2.0, 0.8, 30, 30, 0), (3.0, 1.0, 20, 24, -5)]
    for _ in range(12):
        r, m, n = rng.uniform(0.3, 1.2), *rng.integers(8, 60, 2)
        found.append((float(r + rng.uniform(0.3, 2)), float(r), int(m), int(n), int(n) // 3))
    return found


def _around(R, r):
    """The length of the tube in Mercator's map, by the mean of its integrand."""
    return 2 * np.pi * np.mean(r / (R + r * np.cos(2 * np.pi * np.arange(2000) / 2000)))


def _closed(R, r, m, n, k, height=_around):
    """(theta, theta0): n steps along v make one way around the tube and k steps along u."""
    rho = (k + 1j * m * height(R, r) / (2 * np.pi)) / n
    return np.array([np.angle((1 + rho) / (1 - rho)), np.angle(rho)])


EXERCISES = [
    Exercise(
        name="5.3.1",
        title="What to ask Eq. (15) for",
        level="change a number",
        minutes=5,
        task="Somebody has programmed Eq. (15) as it is printed, with cos theta0 before the "
        "integral. Which angle do they have to ask for, so that their loxodrome meets the "
        "parallels at 60 degrees? `answer` in degrees, to 0.01.",
        hint="The right factor is cot theta0. Which angle has the cosine that is needed?",
        kind="number",
        truth=float(np.degrees(np.arccos(1 / np.sqrt(3)))),
        tolerance=1e-4,
        mistakes=[
            ("That is right for Eq. (15) as it should be, and not as it is printed.", 60.0),
            ("That is what they get when they ask for 60.", np.degrees(np.arctan(2))),
            (
                "The error at 60 degrees, subtracted: at other angles it is another one.",
                120 - np.degrees(np.arctan(2)),
            ),
            ("These are radians, degrees are wanted.", np.arccos(1 / np.sqrt(3))),
            ("That is the angle with the meridians.", 90 - np.degrees(np.arccos(1 / np.sqrt(3)))),
            ("60 degrees with the parallels are 30 with the meridians, but Eq. (15) is off.", 30.0),
        ],
    ),
    Exercise(
        name="5.3.2",
        title="How far a course turns",
        level="write a function",
        minutes=10,
        task="`answer(a, b, theta0)`: by which angle, in radians, a loxodrome of the unit sphere "
        "turns around the axis from the latitude a to the latitude b; it meets the parallels at "
        "theta0, and turns to the east on the way up when theta0 is acute.",
        hint="d alpha = cot(theta0) dw, and w of a sphere is artanh(sin(latitude)).",
        kind="function",
        instances=_courses,
        truth=lambda a, b, theta0: _turned(a, b, 1 / np.tan(theta0)),
        mistakes=[
            (
                "cos theta0 as Eq. (15) prints it: a course of 63.43 degrees in place of 60.",
                lambda a, b, t: _turned(a, b, np.cos(t)),
            ),
            (
                "The tangent is for the angle with the meridians.",
                lambda a, b, t: _turned(a, b, np.tan(t)),
            ),
            (
                "The parallels get shorter towards the poles: latitude is not Mercator's w.",
                lambda a, b, t: (b - a) / np.tan(t),
            ),
            ("It turns the other way.", lambda a, b, t: -_turned(a, b, 1 / np.tan(t))),
            (
                "You add up without a sign: on the way down it turns back.",
                lambda a, b, t: abs(_turned(a, b, 1 / np.tan(t))),
            ),
            (
                "Degrees: radians are wanted.",
                lambda a, b, t: np.degrees(_turned(a, b, 1 / np.tan(t))),
            ),
            (
                "The factor 1/2 of artanh(x) = 1/2 ln ((1 + x) / (1 - x)) is lost.",
                lambda a, b, t: 2 * _turned(a, b, 1 / np.tan(t)),
            ),
        ],
    ),
    Exercise(
        name="5.3.3",
        title="How long a course is",
        level="write a function",
        minutes=5,
        task="`answer(a, b, theta0)`: the length of this loxodrome, between the latitudes a and b "
        "of the unit sphere.",
        hint="The angle with the meridian is constant as well: no integral is needed.",
        kind="function",
        instances=_courses,
        truth=lambda a, b, theta0: np.sqrt((b - a) ** 2 * (1 + np.tan(theta0) ** -2.0)),
        mistakes=[
            (
                "theta0 is the angle with the parallels: climbing is its sine.",
                lambda a, b, t: abs((b - a) / np.cos(t)),
            ),
            ("The course is longer than its climb.", lambda a, b, t: abs(b - a) * np.sin(t)),
            ("That is the climb along the meridian.", lambda a, b, t: abs(b - a)),
            (
                "On the way down it is negative: lengths are not.",
                lambda a, b, t: (b - a) / np.sin(t),
            ),
            (
                "A map is no globe: that is the length in Mercator's map.",
                lambda a, b, t: abs(_turned(a, b, 1 / np.sin(t))),
            ),
            ("A tangent is no hypotenuse.", lambda a, b, t: abs((b - a) / np.tan(t))),
            ("These are degrees.", lambda a, b, t: abs(np.degrees((b - a) / np.sin(t)))),
        ],
    ),
    Exercise(
        name="5.3.4",
        title="From row to row",
        level="write a function",
        minutes=10,
        task="`answer(theta, theta0, m)`: the step of Mercator's w from one parallel of the smooth "
        "web to the next, with m quads around the axis.",
        hint="In the map the cells have the width 2 pi / m; the other edge is 1 / mu times as "
        "long, at the angle theta0. `parallelogram.ratios` gives mu.",
        kind="function",
        instances=_webs,
        truth=lambda theta, theta0, m: _step(theta, theta0, m),
        mistakes=[
            (
                "The other root of the lambda-equation: these rows have the supplement of theta.",
                lambda a, b, m: _step(a, b, m, 1),
            ),
            (
                "That is the length of the slanted edge: its height takes sin theta0.",
                lambda a, b, m: 2 * np.pi / m / _mu(a, b),
            ),
            (
                "mu is lost: that fits theta = 90 degrees only.",
                lambda a, b, m: _step(a, b, m, 0),
            ),
            (
                "That is lambda in the place of mu.",
                lambda a, b, m: 2 * np.pi / m * np.sin(b) / _mu(b, a),
            ),
            ("m quads around have m lines, not m + 1.", lambda a, b, m: _step(a, b, m + 1)),
            ("m quads around have m lines, not m - 1.", lambda a, b, m: _step(a, b, m - 1)),
            ("A factor 2: once around is 2 pi.", lambda a, b, m: _step(a, b, 2 * m)),
            (
                "The cosine is how far the edge leans.",
                lambda a, b, m: _step(a, b, m) / np.tan(b),
            ),
        ],
    ),
    Exercise(
        name="5.3.5",
        title="A web that closes on a torus",
        level="write a function",
        minutes=15,
        task="`answer(R, r, m, n, k)`: (theta, theta0) in radians of the smooth web on a torus "
        "(R from the axis to the middle of the tube, r its radius) with m quads around the axis "
        "and n rows around the tube, shifted by k quads where they meet.",
        hint="In Mercator's map the torus is 2 pi wide and W = 2 pi r / sqrt(R^2 - r^2) high. "
        "From n v-edges and k u-edges follows rho = X_v / X_u.",
        kind="function",
        instances=_tori,
        truth=lambda R, r, m, n, k: _closed(R, r, m, n, k),
        mistakes=[
            (
                "The height of the map is 2 pi r / R for a thin tube only.",
                lambda R, r, m, n, k: _closed(R, r, m, n, k, lambda R, r: 2 * np.pi * r / R),
            ),
            (
                "The sign under the root: R^2 - r^2.",
                lambda R, r, m, n, k: _closed(
                    R, r, m, n, k, lambda R, r: 2 * np.pi * r / np.hypot(R, r)
                ),
            ),
            ("The shift is lost.", lambda R, r, m, n, k: _closed(R, r, m, n, 0)),
            ("The shift goes the other way.", lambda R, r, m, n, k: _closed(R, r, m, n, -k)),
            (
                "m and n are exchanged: m is the number of quads around the axis.",
                lambda R, r, m, n, k: _closed(R, r, n, m, k),
            ),
            ("The angles are exchanged.", lambda R, r, m, n, k: _closed(R, r, m, n, k)[::-1]),
            ("These are degrees.", lambda R, r, m, n, k: np.degrees(_closed(R, r, m, n, k))),
            (
                "The factor 2 pi: a u-edge has the length 2 pi / m in the map.",
                lambda R, r, m, n, k: _closed(R, r, 2 * np.pi * m, n, k),
            ),
            (
                "X_v / X_u is upside down: theta is the supplement.",
                lambda R, r, m, n, k: [np.pi, 0] + [-1, 1] * _closed(R, r, m, n, k),
            ),
        ],
    ),
]
