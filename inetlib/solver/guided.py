"""The paper's own formulation: quadratic equations with auxiliary variables, all at once.

Unknowns, with V vertices and F faces and one column each:
  general mode  3 V + 6 F + 2: vertices, La, Lb, Lp, Lq, c1, c2 of every face, lam, mu;
                8 F equations, F more for one given angle, 2 F for two, 1 for a given ratio
  theta mode    3 V + 2 F + 1: vertices, La, Lb of every face, and c1 = lam^2;
                4 F equations, 1 more for a given angle
The shape energies add rows, not equations.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, diags_array, vstack

from . import residuals as constraints
from . import sparse
from .problem import shape
from .run import timed

EPSILON = 0.001  # of the regularisation


class Layout(NamedTuple):
    """Where the unknowns stand: corners (f, 12), names of the others (f,) or one number."""

    theta_mode: bool
    corners: np.ndarray
    at: dict
    columns: int


def layout(Q, count, theta_mode):
    """The `Layout` of a mesh of `count` vertices.

    Paper: Eq. (17), Eq. (18), Eq. (21), Table 1.
    """
    F, start = len(Q), 3 * count
    names = ["La", "Lb"] if theta_mode else ["La", "Lb", "Lp", "Lq", "c1", "c2"]
    at = {name: np.arange(start + k * F, start + (k + 1) * F) for k, name in enumerate(names)}
    start += len(names) * F
    common = ["c1"] if theta_mode else ["lam", "mu"]
    at |= {name: np.full(F, start + k) for k, name in enumerate(common)}
    return Layout(theta_mode, sparse.coordinates(Q), at, start + len(common))


def start(lay, V, Q):
    """The unknowns at a mesh: auxiliary variables as they are there, common ones their means."""
    x = np.zeros(lay.columns)
    x[: V.size] = V.ravel()
    P = V[Q]
    d1, d2 = P[:, 2] - P[:, 0], P[:, 3] - P[:, 1]
    squares = [np.einsum("ij,ij->i", d, d) for d in (d1, d2, d1 + d2, d2 - d1)]
    x[lay.at["La"]], x[lay.at["Lb"]] = squares[:2]
    lam = np.sqrt(squares[1] / squares[0])
    if lay.theta_mode:
        x[lay.at["c1"][0]] = np.mean(lam**2)
        return x
    mu = np.sqrt(squares[2] / squares[3])
    x[lay.at["Lp"]], x[lay.at["Lq"]] = squares[2:]
    x[lay.at["c1"]], x[lay.at["c2"]] = lam**2, mu**2
    x[lay.at["lam"][0]], x[lay.at["mu"][0]] = lam.mean(), mu.mean()
    return x


def logs(lay, x):
    """(log lam, log mu) of the common unknowns; of their absolute values."""
    if lay.theta_mode:
        return np.full(2, np.log(np.abs(x[lay.at["c1"][0]])) / 2)
    return np.log(np.abs(x[[lay.at["lam"][0], lay.at["mu"][0]]]))


def equations(lay, goal):
    """The hard constraints as a list of (function, index (f, k), further arguments).

    Paper: Eq. (17), Eq. (18), Eq. (19), Eq. (20), Eq. (21), Eq. (22).
    """
    at = lay.at

    def index(*names):
        return np.stack([at[name] for name in names], axis=1)

    diagonals = np.hstack([lay.corners, index("La", "Lb")])
    found = [
        (constraints.squared_diagonals, diagonals, ()),
        (constraints.proportional, index("Lb", "La", "c1"), ()),
    ]
    if lay.theta_mode:
        found.append((constraints.theta_quad, lay.corners, ()))
        if goal.values:
            ratio = constraints.theta_ratio(goal.values[0])
            found.append((constraints.given, index("c1")[:1], (ratio**2,)))
        return found
    found += [
        (constraints.square_root, index("lam", "c1"), ()),
        (constraints.squared_medials, np.hstack([lay.corners, index("Lp", "Lq")]), ()),
        (constraints.proportional, index("Lp", "Lq", "c2"), ()),
        (constraints.square_root, index("mu", "c2"), ()),
    ]
    return found + _wanted(index, goal)


def _wanted(index, goal):
    """Eqs. (19) and (20): what is given of the general mode."""
    if goal.kind in ("lam", "mu"):
        return [(constraints.given, index(goal.kind)[:1], (np.exp(goal.values[0]),))]
    names = ("theta", "theta0") if goal.kind == "angles" else (goal.kind,)
    rows = {
        "theta": (constraints.given_theta, ("lam", "c1", "c2")),
        "theta0": (constraints.given_theta0, ("mu", "c2", "c1")),
    }
    pairs = zip(names, goal.values, strict=False)
    return [(rows[name][0], index(*rows[name][1]), (value,)) for name, value in pairs]


def size(Q, count, goal):
    """(#var, #cons) of the formulation on a mesh, by the formulas above.

    Paper: Table 1.
    """
    lay = layout(Q, count, goal.equal)
    x = np.ones(lay.columns)
    rows = [f(x[index], *more)[0].size for f, index, more in equations(lay, goal)]
    return lay.columns, sum(rows)


def hard(lay, goal, x):
    """(residual, Jacobian) of all hard constraints at the unknowns x."""
    residuals, blocks = [], []
    for function, index, more in equations(lay, goal):
        residual, jacobian = function(x[index], *more)
        residuals.append(residual.ravel())
        blocks.append(sparse.rows(jacobian, index, lay.columns))
    return np.concatenate(residuals), vstack(blocks, format="csr")


def step(given, lay, goal, x, diagonal, seconds, with_shape=True, solve=None):
    """One step of Guided Projection, the change of x: (H^T H + K^T K + eps^2) d = -gradient.

    x holds lengths in units of `diagonal`, the bounding box's, as the paper scales its
    meshes; with_shape: with the energies of Sec. 6.3, or without (the last two steps);
    solve: a function (A, b), `solver.sparse.factor` unless given.
    """
    with timed(seconds, "assemble"):
        residual, H = hard(lay, goal, x)
        A, g = H.T @ H, H.T @ residual
        if with_shape:
            count = given.V.size
            K, k = shape(given, diagonal * x[:count].reshape(-1, 3))
            K = (K + diags_array(np.repeat(given.weights.closeness, 3))).tocoo()
            A = A + coo_array((K.data, K.coords), shape=A.shape)
            g[:count] += k / diagonal
        root = np.ones(lay.columns)
        root[: given.V.size] = np.repeat(np.sqrt(given.mobility), 3)
        moving = diags_array(root)
        A = moving @ A @ moving + EPSILON**2 * diags_array(np.ones(lay.columns))
    with timed(seconds, "solve"):
        solve = solve or (lambda A, b: sparse.factor(A)(b))
        return -root * solve(A.tocsc(), root * g)
