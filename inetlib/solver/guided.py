"""The paper's own formulation: quadratic equations with auxiliary variables, all at once.

Unknowns, with V vertices and F faces and one column each:
  general mode  3 V + 6 F + 2: vertices, La, Lb, Lp, Lq, c1, c2 of every face, lam, mu;
                8 F equations, F more for one given angle, 2 F for two, 1 for a given ratio
  theta mode    3 V + 2 F + 1: vertices, La, Lb of every face, and c1 = lam^2;
                4 F equations, 1 more for a given angle
The shape energies add rows, not equations."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csr_array, diags_array, vstack

from ..parallelogram import ratios
from . import residuals, sparse
from .goal import Goal, freedom
from .problem import shape
from .run import Log, timed

EPSILON = 0.001  # of the regularisation
STEPS = 17  # as many as the paper makes, the last two without shape energies


class Layout(NamedTuple):
    """Where the unknowns stand."""

    theta_mode: bool
    corners: np.ndarray  # (f, 12)
    at: dict  # the other variables by name, each (f,)
    columns: int  # how many


def layout(Q: np.ndarray, count: int, theta_mode: bool) -> Layout:
    """The `Layout` of a mesh of `count` vertices.  Paper: Eq. (17), Eq. (18), Eq. (21), Table 1."""
    names = ["La", "Lb"] if theta_mode else ["La", "Lb", "Lp", "Lq", "c1", "c2"]
    common = ["c1"] if theta_mode else ["lam", "mu"]
    here = 3 * count + np.arange(len(names) * len(Q)).reshape(len(names), len(Q))
    end = 3 * count + here.size
    at = dict(zip(names, here, strict=True))
    at |= {name: np.full(len(Q), end + k) for k, name in enumerate(common)}
    return Layout(theta_mode, sparse.coordinates(Q), at, end + len(common))


def start(lay: Layout, V: np.ndarray, Q: np.ndarray) -> np.ndarray:
    """The unknowns at a mesh: auxiliary variables as they are there, common ones their means."""
    x = np.zeros(lay.columns)
    x[: V.size] = V.ravel()
    P = V[Q]
    d1, d2 = P[:, 2] - P[:, 0], P[:, 3] - P[:, 1]
    La, Lb, Lp, Lq = (np.einsum("ij,ij->i", d, d) for d in (d1, d2, d1 + d2, d2 - d1))
    lam, mu = np.sqrt(Lb / La), np.sqrt(Lp / Lq)
    values = {"La": La, "Lb": Lb, "Lp": Lp, "Lq": Lq, "c1": lam**2, "c2": mu**2}
    values |= {"lam": lam.mean(), "mu": mu.mean()}
    if lay.theta_mode:
        values["c1"] = np.mean(lam**2)
    for name, columns in lay.at.items():
        x[columns] = values[name]
    return x


def logs(lay: Layout, x: np.ndarray) -> np.ndarray:
    """(log lam, log mu) of the common unknowns; of their absolute values."""
    if lay.theta_mode:
        return np.full(2, np.log(np.abs(x[lay.at["c1"][0]])) / 2)
    return np.log(np.abs(x[[lay.at["lam"][0], lay.at["mu"][0]]]))


def equations(lay: Layout, goal: Goal) -> list[tuple[Callable, np.ndarray, tuple]]:
    """The hard constraints as a list of (function, index (f, k), further arguments).

    Paper: Eq. (17), Eq. (18), Eq. (19), Eq. (20), Eq. (21), Eq. (22)."""

    def index(*names):
        return np.stack([lay.at[name] for name in names], axis=1)

    found = [
        (residuals.squared_diagonals, np.hstack([lay.corners, index("La", "Lb")]), ()),
        (residuals.proportional, index("Lb", "La", "c1"), ()),
    ]
    if lay.theta_mode:
        found.append((residuals.theta_quad, lay.corners, ()))
        if goal.values:
            lam, _ = ratios(goal.values[0], goal.values[0])
            found.append((residuals.given, index("c1")[:1], (lam**2,)))
        return found
    found += [
        (residuals.square_root, index("lam", "c1"), ()),
        (residuals.squared_medials, np.hstack([lay.corners, index("Lp", "Lq")]), ()),
        (residuals.proportional, index("Lp", "Lq", "c2"), ()),
        (residuals.square_root, index("mu", "c2"), ()),
    ]
    if goal.kind in ("lam", "mu"):
        return [*found, (residuals.given, index(goal.kind)[:1], (np.exp(goal.values[0]),))]
    known = {"theta": index("lam", "c1", "c2"), "theta0": index("mu", "c2", "c1")}
    names = tuple(known) if goal.kind == "angles" else (goal.kind,)
    pairs = zip(names, goal.values, strict=False)
    return found + [(residuals.given_angle, known[name], (angle,)) for name, angle in pairs]


def size(Q: np.ndarray, count: int, goal: Goal) -> tuple[int, int]:
    """(#var, #cons) of the formulation on a mesh, by the formulas above.  Paper: Table 1."""
    lay = layout(Q, count, goal.equal)
    return lay.columns, hard(lay, goal, np.ones(lay.columns))[0].size


def hard(lay: Layout, goal: Goal, x: np.ndarray) -> tuple[np.ndarray, csr_array]:
    """(residual, Jacobian) of all hard constraints at the unknowns x."""
    found, blocks = [], []
    for function, index, more in equations(lay, goal):
        residual, jacobian = function(x[index], *more)
        found.append(residual.ravel())
        blocks.append(sparse.rows(jacobian, index, lay.columns))
    return np.concatenate(found), vstack(blocks, format="csr")


def run(log: Log, goals: list[Goal], limit: int, solve: Callable | None = None) -> None:
    """Guided projection: `limit` steps, the last two without shape energies, to `run.way` goals.

    x holds lengths in units of the diagonal of the bounding box, as the paper scales its
    meshes; solve: a function (A, b) for the linear systems, by `sparse.factor` unless given.
    Paper: Table 1."""
    given, V, lay = log.given, log.given.V, None
    solve = solve or (lambda A, b: sparse.factor(A)(b))
    diagonal = np.linalg.norm(np.ptp(V, axis=0))
    last = limit - 2
    for k in range(limit):
        goal = goals[k] if k < min(len(goals), last) else given.goal
        if lay is None or goal.equal != lay.theta_mode:
            lay = layout(given.Q, len(V), goal.equal)
            x = start(lay, V / diagonal, given.Q)
        with timed(given.seconds, "assemble"):
            A, g, root = _system(given, lay, goal, x, diagonal if k < last else None)
        with timed(given.seconds, "solve"):
            d = -root * solve(A, root * g)
        x = x + d
        if not np.isfinite(x).all():
            return
        moved = diagonal * d[: V.size].reshape(-1, 3)
        V, longest = V + moved, np.linalg.norm(moved, axis=1).max()
        residual = np.sum(hard(lay, goal, x)[0] ** 2)
        s = freedom(given.goal, logs(lay, x))
        if log.record("guided", goal, V, s, longest, residual) is None or log.stopped:
            return


def _system(given, lay, goal, x, diagonal):
    """(R A R, g, R) of the step d with (H^T H + K^T K + eps^2) d = -g, R as free as mobility."""
    residual, H = hard(lay, goal, x)
    A, g, count = H.T @ H, H.T @ residual, given.V.size
    if diagonal:  # the unit of the lengths in x; None without the energies of Sec. 6.3
        K, k = shape(given, diagonal * x[:count].reshape(-1, 3))
        K = (K + diags_array(np.repeat(given.weights.closeness, 3))).tocoo()
        A = A + coo_array((K.data, K.coords), shape=A.shape)
        g[:count] += k / diagonal
    root = np.ones(lay.columns)
    root[:count] = np.repeat(np.sqrt(given.mobility), 3)
    moving = diags_array(root)
    A = moving @ A @ moving + EPSILON**2 * diags_array(np.ones(lay.columns))
    return A.tocsc(), g, root
