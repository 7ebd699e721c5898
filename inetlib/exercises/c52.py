"""The exercises of chapter 5.2: squares in a row, isothermal meridians, the associate family."""

import numpy as np
import sympy as sp

from .engine import Exercise

V = sp.Symbol("v")
STEP = 1e-3


def _row(k):
    """(theta, theta0): v2 = (0, 1), v1 = (1, 1), v3 = (k - 1, 0), v4 = (k, 0)."""
    return np.arctan2(1, k - 2) - np.arctan2(1, k), np.arctan2(1, k - 1)


def _meridians(rng):
    """(radius, height) with height(0) = 0: cylinder, sphere, catenoid, cones, the plane."""
    found = [(sp.exp(V), sp.S(0))]
    for r, a in rng.uniform([0.5, 0.2], [2, 0.9], (4, 2)).round(3).tolist():
        slope = sp.sqrt(1 - a**2) / a
        found += [(r + 0 * V, r * V), (r / sp.cosh(V), r * sp.tanh(V)), (r * sp.cosh(V), r * V)]
        found += [(r * sp.exp(a * V), r * slope * (sp.exp(a * V) - 1))]
    return found


HEIGHTS = dict(_meridians(np.random.default_rng(17)))


def _ends(rng):
    return [(f, V, float(rng.uniform(0.2, 1.4))) for f in HEIGHTS]


def _integral(slope):
    """A wrong height: the integral of a function of f and f', by Gauss quadrature."""
    x, weights = np.polynomial.legendre.leggauss(30)

    def height(f, v, end):
        at = end * (x + 1) / 2
        radius, speed = (sp.lambdify(v, g, "numpy")(at) + 0 * at for g in (f, f.diff(v)))
        return slope(radius, speed) @ weights * end / 2

    return height


def _stencils(rng):
    """(u, v) at a place, then a step to the right, left, up and down."""
    across = STEP * np.array([[0, 1, -1, 0, 0], [0, 0, 0, 1, -1]])
    return [tuple(place[:, None] + across) for place in rng.uniform(-1.2, 1.2, (8, 2))]


def _catenoid(u, v):
    return np.array([np.cosh(v) * np.cos(u), np.cosh(v) * np.sin(u), v])


def _conjugate(u, v, height=None):
    return np.array([np.sinh(v) * np.sin(u), -np.sinh(v) * np.cos(u), u])


def _family(value, u, v):
    """E, F and G of the family, by central differences, at three values of t."""
    value = np.asarray(value, dtype=float)
    if value.shape != (3, len(u)):
        return f"An array of shape {(3, len(u))} is wanted: x, y and z of each point."
    for t in (0.5, 1.2, 2.5):
        X = np.cos(t) * _catenoid(u, v) + np.sin(t) * value
        Xu, Xv = (X[:, 1] - X[:, 2]) / (2 * STEP), (X[:, 3] - X[:, 4]) / (2 * STEP)
        E, F, G = np.array([Xu @ Xu, Xu @ Xv, Xv @ Xv]) / np.cosh(v[0]) ** 2
        if max(abs(E - 1), abs(F), abs(G - 1)) > 1e-4:
            numbers = f"E = {E:.4f}, F = {F:.4f} and G = {G:.4f}"
            return f"At the first of these points, for t = {t}: {numbers}, over cosh(v)^2."
    return ""


EXERCISES = [
    Exercise(
        name="5.2.1",
        title="Squares in a row",
        level="write a function",
        minutes=10,
        task="`answer(k)`: (theta, theta0) in radians of the quad that is bounded by two edges and "
        "two diagonals of a row of k squares: v1 = (1, 1), v2 = (0, 1), v3 = (k - 1, 0), "
        "v4 = (k, 0). Fig. 8 has k = 2.",
        hint="d1 = v3 - v1 and d2 = v4 - v2 as vectors, and the same for the medial lines.",
        kind="function",
        instances=lambda rng: [(k,) for k in range(1, 13)],
        truth=lambda k: _row(k),
        mistakes=[
            ("The two angles are exchanged.", lambda k: _row(k)[::-1]),
            ("These are those of k + 1 squares: Fig. 8 has two.", lambda k: _row(k + 1)),
            ("These are those of k - 1 squares: Fig. 8 has two.", lambda k: _row(k - 1)),
            ("These are degrees.", lambda k: np.degrees(_row(k))),
            (
                "Both are the supplements: the labels are a quarter turn off.",
                lambda k: np.pi - np.array(_row(k)),
            ),
            (
                "That theta0 is the other angle of its triangle: the slope is 1 / (k - 1).",
                lambda k: (_row(k)[0], np.arctan2(k - 1, 1)),
            ),
            ("Half of both angles.", lambda k: np.array(_row(k)) / 2),
        ],
    ),
    Exercise(
        name="5.2.2",
        title="The height that belongs to a radius",
        level="write a function",
        minutes=15,
        task="`answer(f, v, end)`: the height g(end) - g(0), g growing, of the meridian of an "
        "isothermal surface of revolution, Eq. (14); the radius f is a sympy expression in the "
        "symbol v. Six digits are enough.",
        hint="E = G says f^2 = f'^2 + g'^2. `sp.lambdify` makes a function of an expression, and "
        "`scipy.integrate.quad` integrates it.",
        kind="function",
        instances=_ends,
        truth=lambda f, v, end: float(HEIGHTS[f].subs(v, end)),
        tolerance=1e-6,
        mistakes=[
            ("The meridian moves sideways, too: f' is missing.", _integral(lambda f, d: f)),
            ("The sign: g'^2 = f^2 - f'^2.", _integral(lambda f, d: np.sqrt(f**2 + d**2))),
            ("That is g'^2: the root is missing.", _integral(lambda f, d: f**2 - d**2)),
            (
                "f - f' is not the root of f^2 - f'^2.",
                _integral(lambda f, d: f - d),
            ),
            (
                "That is a meridian by its arc length: E = G wants the speed f, and not 1.",
                _integral(lambda f, d: np.sqrt(1 - d**2)),
            ),
            (
                "That is g' at the end: it has to be integrated.",
                lambda f, v, end: float(sp.sqrt(f**2 - f.diff(v) ** 2).subs(v, end)),
            ),
        ],
    ),
    Exercise(
        name="5.2.3",
        title="The conjugate of the catenoid",
        level="prove",
        minutes=15,
        task="`answer(u, v)`: the three coordinates of a surface H, for which cos t C + sin t H "
        "is isothermal for each t, with E = G = cosh(v)^2 and F = 0, where C is the catenoid "
        "(cosh v cos u, cosh v sin u, v). u and v are arrays; return x, y, z.",
        hint="Cauchy and Riemann: H_u = -C_v and H_v = C_u, or both with the other sign.",
        kind="function",
        instances=_stencils,
        truth=None,
        fault=_family,
        mistakes=[
            (
                "So it is printed: a helicoid, but a quarter turn off. F is not 0 in between.",
                lambda u, v: [np.sinh(v) * np.cos(u), np.sinh(v) * np.sin(u), u],
            ),
            ("That is the catenoid itself.", lambda u, v: _catenoid(u, v)),
            (
                "One sign is off: x and y must turn like those of C.",
                lambda u, v: [np.sinh(v) * np.sin(u), np.sinh(v) * np.cos(u), u],
            ),
            (
                "Only C has cosh: on the axis, v = 0, the helicoid has the radius 0.",
                lambda u, v: [np.cosh(v) * np.sin(u), -np.cosh(v) * np.cos(u), u],
            ),
            (
                "A helicoid rises while it turns: z goes with u.",
                lambda u, v: [np.sinh(v) * np.sin(u), -np.sinh(v) * np.cos(u), v],
            ),
            (
                "The orientation of the axis: z has the other sign.",
                lambda u, v: _conjugate(u, v) * [[1], [1], [-1]],
            ),
            ("Half as large as it should be.", lambda u, v: _conjugate(u, v) / 2),
            ("u and v are exchanged.", lambda u, v: _conjugate(v, u)),
        ],
    ),
]
