"""The exercises of chapter 7: one complex number, harmonic lines, freedoms of a planar net."""

from functools import cache

import numpy as np

from .engine import Exercise


def _rho(theta, theta0):
    """Its length r: d2 / d1 has the argument theta where 2 r sin(theta0) = (1 - r^2) tan(theta)."""
    half = np.sin(theta0) / np.tan(theta)
    return np.exp(1j * theta0) * (np.sqrt(half**2 + 1) - half)


def _pairs(rng):
    special = np.radians([(90, 90), (90, 60), (60, 90), (120, 60), (60, 60)])
    return [*map(tuple, special.tolist()), *map(tuple, rng.uniform(0.4, 2.7, (10, 2)).tolist())]


def _reads(value, theta, theta0):
    rho = complex(value)
    found = np.angle([(1 + rho) / (1 - rho), rho])
    return "It belongs to theta = {:.4f}, theta0 = {:.4f}, in radians.".format(*found)


def _pencils(rng):
    """Harmonic lines, and random ones; some vectors are turned round, which no line notices."""
    found = []
    for k in range(14):
        a, b, c, d = rng.normal(size=4) + 1j * rng.normal(size=4)
        if k < 4:
            c, d = a + b, a - b
        found.append((a, b, -2 * c if k % 2 else c, d))
    return [tuple(map(complex, lines)) for lines in found]


def _cross(a, b, c, d):
    """By their slopes: of the points where the lines meet a vertical one."""
    a, b, c, d = (z.imag / z.real for z in (a, b, c, d))
    return (a - c) * (b - d) / ((a - d) * (b - c))


def _of_vectors(a, b, c, d):
    return (a - c) * (b - d) / ((a - d) * (b - c))


def _of_angles(*lines):
    a, b, c, d = (np.angle(z) % np.pi for z in lines)
    return (a - c) * (b - d) / ((a - d) * (b - c))


def _products(*lines):
    """With scalar products in the place of areas."""
    a, b, c, d = lines
    dot = lambda x, y: (np.conj(x) * y).real  # noqa: E731
    return dot(a, c) * dot(b, d) / (dot(a, d) * dot(b, c))


@cache
def _free(m, n, closed):
    """Real unknowns minus the rank of the real equations of v4 - v2 = K (v3 - v1)."""
    K, columns = 1.3 + 1.1j, m if closed else m + 1
    matrix = np.zeros((m * n, columns * (n + 1)), dtype=complex)
    for row, (i, j) in enumerate(np.ndindex(m, n)):
        here, right = i * (n + 1) + j, (i + 1) % columns * (n + 1) + j
        matrix[row, [right + 1, here]] = 1, -1
        matrix[row, [right, here + 1]] = -K, K
    real = np.block([[matrix.real, -matrix.imag], [matrix.imag, matrix.real]])
    return real.shape[1] - int(np.linalg.matrix_rank(real))


def _meshes(rng):
    found = [(1, 1, False), (1, 5, False), (4, 4, False), (4, 1, True), (6, 4, True)]
    for k in range(8):
        m, n = rng.integers([3, 1], [9, 8]).tolist()
        found.append((m, n, k % 2 == 1))
    return found


EXERCISES = [
    Exercise(
        name="7.1",
        title="The complex number of two angles",
        level="write a function",
        minutes=5,
        task="`answer(theta, theta0)`: the complex number rho = X_v / X_u of the nets with these "
        "angles.",
        hint="Its argument is one of the angles. Its length is a ratio or the reciprocal of one: "
        "`parallelogram.ratios`.",
        kind="function",
        instances=_pairs,
        truth=lambda theta, theta0: _rho(theta, theta0),
        fault=_reads,
        mistakes=[
            (
                "The length is upside down: mu = |X_u| / |X_v|.",
                lambda a, b: 1 / np.conj(_rho(a, b)),
            ),
            ("That is X_u / X_v.", lambda a, b: 1 / _rho(a, b)),
            (
                "The orientation is reversed: the upper half plane is wanted.",
                lambda a, b: np.conj(_rho(a, b)),
            ),
            ("The two angles are exchanged.", lambda a, b: _rho(b, a)),
            (
                "That is Y_v / Y_u = lam exp(i theta).",
                lambda a, b: (1 + _rho(a, b)) / (1 - _rho(a, b)),
            ),
            (
                "A quarter turn of the labels: that has both supplements.",
                lambda a, b: -1 / _rho(a, b),
            ),
            ("The length is missing.", lambda a, b: np.exp(1j * b)),
            ("The length alone: the turn is missing.", lambda a, b: abs(_rho(a, b))),
        ],
    ),
    Exercise(
        name="7.2",
        title="The cross ratio of four lines",
        level="write a function",
        minutes=10,
        task="`answer(a, b, c, d)`: the cross ratio (a, b; c, d), a real number, of four lines "
        "through 0, given by complex numbers on them; without `parallelogram.cross_ratio`. For "
        "(1, rho; 1 + rho, 1 - rho) it is -1.",
        hint="Im(conj(x) y), the area that x and y span, in the place of the differences of four "
        "numbers. A line has no direction: -x is as good as x.",
        kind="function",
        instances=_pencils,
        truth=lambda a, b, c, d: _cross(a, b, c, d),
        mistakes=[
            (
                "That is the one of four points of the plane, complex: a line goes on beyond them.",
                lambda *z: _of_vectors(*z),
            ),
            ("Upside down: c and d are exchanged.", lambda *z: 1 / _cross(*z)),
            ("The pairs are others: b and c are exchanged.", lambda *z: 1 - _cross(*z)),
            ("The sign is lost: harmonic lines have -1.", lambda *z: abs(_cross(*z))),
            ("The sign is wrong: harmonic lines have -1.", lambda *z: -_cross(*z)),
            (
                "Differences of angles turn into areas by their sines.",
                lambda *z: _of_angles(*z),
            ),
            ("Areas take a sine: these are scalar products.", lambda *z: _products(*z)),
        ],
    ),
    Exercise(
        name="7.3",
        title="What a planar net leaves free",
        level="write a function",
        minutes=10,
        task="`answer(m, n, closed)`: how many real numbers a planar net of m x n quads with given "
        "angles leaves free; when `closed` is True, the first of its m columns follows the last "
        "one, around a ring.",
        hint="A vertex is a complex unknown, a face one complex equation, and all are independent. "
        "A complex number is two real ones.",
        kind="function",
        instances=_meshes,
        truth=lambda m, n, closed: _free(m, n, closed),
        mistakes=[
            (
                "These are complex numbers: each is two real ones.",
                lambda m, n, closed: _free(m, n, closed) // 2,
            ),
            (
                "That is the count in space: a vertex of the plane has two coordinates.",
                lambda m, n, closed: 3 * (m + (not closed)) * (n + 1) - 2 * m * n,
            ),
            (
                "You subtract one number a face: it has two equations.",
                lambda m, n, closed: 2 * (m + (not closed)) * (n + 1) - m * n,
            ),
            (
                "A ring of m columns has m lines across, not m + 1.",
                lambda m, n, closed: _free(m, n, False),
            ),
            (
                "m columns of an open grid have m + 1 lines across.",
                lambda m, n, closed: 2 * m,
            ),
            (
                "You left out the similarities: they are free as well.",
                lambda m, n, closed: _free(m, n, closed) - 4,
            ),
        ],
    ),
    Exercise(
        name="7.4",
        title="The mirrored circle",
        level="prove",
        minutes=10,
        task="theta + theta0 = 180 degrees means lam mu = 1, or |1 + rho|^2 = |1 - rho|^2 |rho|^2. "
        "The left side minus the right side is |rho|^2 + 1 times what? A sympy expression in "
        "`x, y`, for rho = x + i y.",
        hint="Write it with x and y, and let sympy divide: `sp.factor`, `sp.cancel`. Where it is 0 "
        "lies a circle, the mirror image of one above.",
        kind="expression",
        instances=lambda rng: [(0.0, 1.0), *map(tuple, rng.uniform(-2, 2, (11, 2)).tolist())],
        truth=lambda x, y: (
            ((1 + x) ** 2 + y**2 - ((1 - x) ** 2 + y**2) * (x**2 + y**2)) / (x**2 + y**2 + 1)
        ),
        mistakes=[
            (
                "That is the circle of theta = theta0: mirror it.",
                lambda x, y: x**2 + 2 * x + y**2 - 1,
            ),
            (
                "The right circle, with the other sign: left side minus right side.",
                lambda x, y: x**2 - 2 * x + y**2 - 1,
            ),
            (
                "That is the circle of theta = theta0, with another sign.",
                lambda x, y: 1 - 2 * x - x**2 - y**2,
            ),
            (
                "That is the whole difference: divide by |rho|^2 + 1.",
                lambda x, y: (1 + 2 * x - x**2 - y**2) * (1 + x**2 + y**2),
            ),
            ("A factor 2: |1 + rho|^2 has 2 x in it.", lambda x, y: 1 + x - x**2 - y**2),
            ("That is the unit circle, where mu = 1.", lambda x, y: 1 - x**2 - y**2),
        ],
    ),
]
