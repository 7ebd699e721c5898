"""The exercises of chapter 3.3: the edges of a sheared grid, and which maps keep the ratios."""

from functools import cache

import numpy as np
import sympy as sp

from .engine import Exercise

Z = sp.Symbol("z")


def _edge(theta, theta0):
    """v for u = 1: it leans by theta0, and d2 / d1 = (1 + v) / (1 - v) has the argument theta."""
    steep = np.sin(theta0) / np.tan(theta)
    return np.exp(1j * theta0) * (np.sqrt(steep**2 + 1) - steep)


def _measured(value, theta, theta0):
    v = complex(value)
    found = np.angle([(1 + v) / (1 - v), v])
    return "Measured from it: theta = {:.4f}, theta0 = {:.4f}, in radians.".format(*found)


def _angles(rng):
    special = np.radians([(90, 90), (60, 60), (90, 60), (60, 90), (120, 45)])
    return [*map(tuple, special.tolist()), *map(tuple, rng.uniform(0.4, 2.7, (10, 2)).tolist())]


def _maps(rng):
    """Maps with and without a constant kappa."""
    a, b, c = rng.integers(2, 6, size=3).tolist()
    exact = [Z, Z**2, a * Z**2 + b * Z, sp.exp(a * Z), sp.sin(Z), sp.cosh(b * Z)]
    exact += [sp.exp(c * Z) + sp.exp(-c * Z) + a, sp.cos(Z) + sp.I * sp.sin(Z)]
    others = [1 / Z, Z**3, sp.log(Z), sp.exp(Z) + Z, sp.sqrt(Z), sp.exp(Z) + sp.exp(2 * Z)]
    return [(f, Z) for pair in zip(exact, others + others[:2], strict=True) for f in pair]


@cache
def _quotient(f, z, upper=3, lower=1):
    """Quotient of two derivatives at four places, by Taylor coefficients on a small circle."""
    circle, values = 0.2 * np.exp(2j * np.pi * np.arange(32) / 32), sp.lambdify(z, f, "numpy")
    found = []
    for centre in (1.1, 0.8 + 0.3j, 1.3 - 0.4j, 0.7 - 0.1j):
        taylor = np.fft.fft(values(centre + circle) * np.ones(32)) / 32 / 0.2 ** np.arange(32)
        of = taylor * np.array([1, 1, 2, 6] + [0] * 28)
        found.append(of[upper] / of[lower])
    return np.array(found)


@cache
def _kappa(f, z):
    found = _quotient(f, z)
    return np.round(found.mean(), 6) + 0 if np.ptp(found.real) + np.ptp(found.imag) < 1e-6 else None


@cache
def _constant(quotient):
    """The simplified quotient where no symbol is left in it, else None."""
    quotient = sp.simplify(quotient)
    return None if quotient.free_symbols else quotient


EXERCISES = [
    Exercise(
        name="3.3.1",
        title="The second edge",
        level="write a function",
        minutes=10,
        task="`answer(theta, theta0)`: the complex number v, so that cells with the edges u = 1 "
        "and v have these angles, with v1 at the top left; without `conformal`.",
        hint="v has the argument theta0. The diagonals are d1 = u - v and d2 = u + v; its length "
        "is a ratio of medial lines.",
        kind="function",
        instances=_angles,
        truth=lambda theta, theta0: _edge(theta, theta0),
        fault=_measured,
        mistakes=[
            (
                "The length is upside down: these are the labels of Fig. 1, with the angle AOD in "
                "place of COD.",
                lambda x, y: 1 / np.conj(_edge(x, y)),
            ),
            ("The orientation is reversed: v must point up.", lambda x, y: np.conj(_edge(x, y))),
            ("The angles are exchanged: theta is between the diagonals.", lambda x, y: _edge(y, x)),
            ("The length is missing: this is a rhombus.", lambda x, y: np.exp(1j * y)),
            ("This is d2 / d1, and not v.", lambda x, y: (1 + _edge(x, y)) / (1 - _edge(x, y))),
            (
                "np.exp takes radians: do not convert.",
                lambda x, y: np.abs(_edge(x, y)) * np.exp(1j * np.degrees(y)),
            ),
        ],
    ),
    Exercise(
        name="3.3.2",
        title="Blocks of cells",
        level="write a function",
        minutes=5,
        task="`answer(mu, j, k)`: the mu of a block of j x k cells, j of them along u and k along "
        "v, where each cell has this mu.",
        hint="The medial lines of the block are j and k times those of a cell.",
        kind="function",
        instances=lambda rng: (
            [(1.5, 1, 1), (0.7, 3, 3), (1.5, 1, 2), (1.5, 2, 1)]
            + [(x, *rng.integers(1, 6, 2).tolist()) for x in rng.uniform(0.4, 2, 8).tolist()]
        ),
        truth=lambda mu, j, k: mu * j / k,
        mistakes=[
            (
                "So the paper has it, any block is similar to a cell: a square one is.",
                lambda mu, j, k: mu,
            ),
            ("Upside down: m13 runs along u.", lambda mu, j, k: mu * k / j),
            ("One of them multiplies and the other one divides.", lambda mu, j, k: mu * j * k),
            ("That is 1 / mu of the block.", lambda mu, j, k: k / (mu * j)),
            ("Whole numbers are not rounded down.", lambda mu, j, k: mu * (j // k)),
        ],
    ),
    Exercise(
        name="3.3.3",
        title="Which maps keep the ratios",
        level="write a function",
        minutes=15,
        task="`answer(f, z)`: the number kappa = f'''/f' of a sympy expression f in the symbol z, "
        "where it does not depend on z, else None; without `conformal.kappa`.",
        hint="f.diff(z, 3), sympy.simplify, and the symbols that are left: `.free_symbols`.",
        kind="function",
        instances=_maps,
        truth=lambda f, z: _kappa(f, z),
        tolerance=1e-5,
        mistakes=[
            (
                "You return the quotient of every map: None is wanted where z is left in it.",
                lambda f, z: sp.simplify(f.diff(z, 3) / f.diff(z)),
            ),
            (
                "This is f''/f', which is 0 or no constant for most of them.",
                lambda f, z: _constant(f.diff(z, 2) / f.diff(z)),
            ),
            (
                "This is f''/f: both derivatives are one too low.",
                lambda f, z: _constant(f.diff(z, 2) / f),
            ),
            (
                "All but z and z^2 get None: exp, sin and cosh have a constant, too.",
                lambda f, z: 0 if f.diff(z, 3) == 0 else None,
            ),
            (
                "The sign is wrong: exp has kappa = 1.",
                lambda f, z: None if _kappa(f, z) is None else -_kappa(f, z),
            ),
        ],
    ),
    Exercise(
        name="3.3.4",
        title="The error of a power",
        level="prove",
        minutes=10,
        task="Under f = z^c the ratio K = d2/d1 of a small cell with the edges u, v changes by the "
        "factor 1 + e u v + ... Give e, a sympy expression in `c, z`. For which c is it 0?",
        hint="ln (K / K0) = f''' / (6 f') u v + ..., above.",
        kind="expression",
        instances=lambda rng: [tuple(x) for x in rng.uniform(0.5, 3.5, (12, 2)).tolist()],
        truth=lambda c, z: (c - 1) * (c - 2) / (6 * z**2),
        mistakes=[
            ("That is f''/f' over 6: the third derivative counts.", lambda c, z: (c - 1) / (6 * z)),
            (
                "12 belongs to R, the ratio of the edges.",
                lambda c, z: (c - 1) * (c - 2) / (12 * z**2),
            ),
            ("The 6 is lost.", lambda c, z: (c - 1) * (c - 2) / z**2),
            ("You divide by f, and not by f'.", lambda c, z: c * (c - 1) * (c - 2) / (6 * z**3)),
            (
                "That is f'''/f' with a derivative too many: f' has c - 1 as its exponent.",
                lambda c, z: (c - 2) * (c - 3) / (6 * z**2),
            ),
        ],
    ),
]
