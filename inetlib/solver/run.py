"""The steps of an optimisation, the runs they make, and the judge of every net on the way."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
from scipy.sparse import bsr_array, csr_array, diags_array, kron
from tqdm import tqdm

from .. import measure
from ..parallelogram import is_admissible
from . import lattice, residuals, sparse
from .goal import Goal, aim, angles, freedom, logs, towards
from .problem import Problem, shape

Change = tuple[np.ndarray, np.ndarray]  # of V (n, 3) and of the freedom s

REGULAR = 1e-12  # of the mean diagonal, in the matrix of an angle step
MANY = 4000  # faces: from here on waves beat factors where the mesh is a piece of a grid
WAVES = 1e-2  # relative residual of a smallest step by waves, at most
SETTLED = 1e-6  # radians, about: then waves leave vertices this close (in diagonals) to a surface
EXACT = 3e-12  # radians, about: smaller errors of the angles are not aimed at by waves
COUPLING = 100  # weight of shifting every other vertex in the size of a coupled step
LOOSE = 1e-6, 0.0  # weights of that size, and of the distances from the reference, at the end
NEAR = (1e-5, 1.0), (1e-4, 0.1), (1e-3, 0.01)  # and before: as near as can be, else less
STARTS = {
    "medials": {"theta0": np.pi / 2},
    "diagonals": {"theta": np.pi / 2},
    "squares": {"theta": np.pi / 2, "theta0": np.pi / 2},
}
STRIDES = 1, 1 / 3, 1 / 9  # times the stride, one after the other when a run fails
ANGLE_STEPS = 25  # at most, in one run
PARTS = 1, 1 / 2, 1 / 4, 1 / 8, 1 / 16  # of a step, when free ratios leave their range
WORSE = 3  # angle steps in a row without progress end a run


class Step(NamedTuple):
    """One iteration and the net after it."""

    kind: str  # "start", "shape", "angle", "guided" or "refined", a net of a coarser grid
    goal: Goal  # of this step
    residual: float  # sum of the squared residuals of the formulation's equations
    theta_max: float  # deviations of the angles from those of the final goal, radians
    theta_mean: float
    theta0_max: float
    theta0_mean: float
    size: float  # the longest way of a vertex
    flips: int  # flipped faces
    darts: int  # faces that are not convex

    @property
    def deviation(self) -> float:
        """The larger of theta_max and theta0_max."""
        return max(self.theta_max, self.theta0_max)

    @property
    def key(self) -> tuple[int, float]:
        """How bad the net is: (faces flipped or not convex, deviation), the smaller the better."""
        return self.flips + self.darts, self.deviation

    @property
    def words(self) -> str:
        """The key in words."""
        off = f"at most {np.degrees(self.deviation):.3g} degrees off"
        return f"{off}, {self.flips} flipped faces, {self.darts} darts"


@contextmanager
def timed(seconds: dict, name: str) -> Iterator[None]:
    """Add the seconds that the block takes to seconds[name].  Paper: Table 1 (seconds)."""
    start = time.perf_counter()
    yield
    seconds[name] = seconds.get(name, 0.0) + time.perf_counter() - start


def judge(
    step: tuple[str, Goal],
    V: np.ndarray,
    Q: np.ndarray,
    neighbours: np.ndarray,
    wanted: Goal,
    s: Sequence[float],
    size: float,
    residual: float | None = None,
) -> Step:
    """What came of a step (kind, goal): the net V, Q measured against the wanted goal at s.

    residual: that of the two logarithms if None.  ValueError where V is no net: a face has
    collapsed, a coordinate is not finite, the ratios are those of no parallelogram."""
    found = measure.faces(V, Q)
    off = np.abs(found[2:] - np.reshape(angles(wanted, s), (2, 1)))
    if residual is None:
        residual = np.sum((np.log(found[:2]) - logs(wanted, s)[0][:, None]) ** 2)
    spread = (float(f(x)) for x in off for f in (np.max, np.mean))
    faults = len(measure.flipped(V, Q, neighbours)), len(measure.nonconvex(V, Q))
    return Step._make([*step, float(residual), *spread, float(size), *faults])


def equations(
    problem: Problem, V: np.ndarray, goal: Goal, s: np.ndarray
) -> tuple[np.ndarray, csr_array, np.ndarray]:
    """(residual (2 f,), Jacobian (2 f, 3 n), slopes (2 f, k)) of the angles at the net V.

    Zero residual: log lam and log mu of every face are those of the goal at the freedom s;
    the Jacobian is in V and minus `slopes` in s.  Of a quadratic problem they are
    `residuals.scaled_ratios`.  Paper: Eq. (11), Eq. (12)."""
    wanted, slopes = logs(goal, s)
    x = V[problem.Q].reshape(-1, 12)
    if problem.quadratic:
        found, jacobian = residuals.scaled_ratios(x, *np.exp(wanted))
    else:
        found, jacobian = residuals.log_ratios(x)
        found -= wanted
    J = sparse.rows(jacobian, sparse.coordinates(problem.Q), V.size)
    return found.ravel(), J, np.tile(slopes, (len(x), 1))


def shape_step(problem: Problem, V: np.ndarray, goal: Goal, s: np.ndarray) -> Change:
    """(change of V, change of s) of one Gauss-Newton step on all energies.

    All lengths are measured in mean edges, so the step does not depend on the scale."""
    with timed(problem.seconds, "assemble"):
        f, J, G = equations(problem, V, goal, s)
        f, G = f * problem.edge, G * problem.edge
        root = np.repeat(np.sqrt(problem.mobility), 3)
        J = sparse.scaled(J, problem.edge * root)
        A, g = shape(problem, V)
        if (root != 1).any():
            A = sparse.scaled(sparse.scaled(A, root).T.tocsr(), root)
        A = A + J.T @ J
        diagonal = A.diagonal() + np.repeat(problem.weights.closeness, 3)
        A.setdiag(diagonal + REGULAR * diagonal.mean())
    with timed(problem.seconds, "factor"):
        solve = problem.shape_factor(A)
    with timed(problem.seconds, "solve"):
        y, ds = _least(solve, J, f, G, root * g)
    return (root * y).reshape(-1, 3), ds


def _least(solve, J, f, G, g):
    """(y, ds) with the least |f + J y - G ds|^2 + other energies of y, half of their slope g."""
    right = np.column_stack([g + J.T @ f, J.T @ G])
    y = solve(right)
    B = right[:, 1:].T
    ds = _freedom(G.T @ G - B @ y[:, 1:], G.T @ f - B @ y[:, 0])
    return y[:, 1:] @ ds - y[:, 0], ds


def coupled_step(
    problem: Problem, V: np.ndarray, goal: Goal, s: np.ndarray, weights: tuple[float, float]
) -> Change:
    """(change of V, change of s): a small change to the angles that makes no darts.

    The angles see diagonals only, so that shifting every other vertex costs nothing (darts).
    Here the size of a change d is sum |d|^2 / mobility over the vertices, plus COUPLING times
    sum |d1 - d2 + d3 - d4|^2 / 4 over the corners of the faces, all in local lengths.
    weights: of this size, and of the distances from the tangent planes of the reference,
    beside the equations.

    Paper: B11."""
    with timed(problem.seconds, "assemble"):
        f, J, G = equations(problem, V, goal, s)
        root = np.repeat(np.sqrt(problem.mobility), 3)
        long = np.linalg.norm(np.stack(measure.vectors(V, problem.Q)[:2]), axis=2).mean(axis=0)
        corners = problem.Q.ravel()
        reach = np.bincount(corners, np.repeat(long, 4)) / np.bincount(corners)
        twist = np.array([0.5, -0.5, 0.5, -0.5]) / long[:, None, None]
        T = kron(sparse.rows(twist, problem.Q, len(V)), np.eye(3), format="csr")
        T, J = sparse.scaled(T, root), sparse.scaled(J, root)
        A = COUPLING * (T.T @ T) + diags_array(np.repeat(reach, 3) ** -2)
        loose, close = weights
        A, g = loose * A + J.T @ J, 0
        if close and problem.reference is not None:
            off, normals = residuals.distances(V, *problem.reference.closest(V))
            at = sparse.coordinates(np.arange(len(V))[:, None])
            N = sparse.scaled(sparse.rows(normals / reach[:, None, None], at, V.size), root)
            A, g = A + close * (N.T @ N), close * (N.T @ (off.ravel() / reach))
    with timed(problem.seconds, "factor"):
        solve = problem.shape_factor(A.tocsr())
    with timed(problem.seconds, "solve"):
        y, ds = _least(solve, J, f, G, g)
        if not close:  # the weight of the size is not so small
            more, further = _least(solve, J, f + J @ y - G @ ds, G, 0)
            y, ds = y + more, ds + further
    return (root * y).reshape(-1, 3), ds


def angle_step(problem: Problem, V: np.ndarray, goal: Goal, s: np.ndarray) -> Change:
    """(change of V, change of s): the smallest change to the linearised angles.

    Smallest in the sum of |d|^2 / mobility over the vertices.  On a surface (`on_surface`)
    the vertices go to their closest points and move along the tangent planes there."""
    with timed(problem.seconds, "assemble"):
        f, J, G = equations(problem, V, goal, s)
        waves = problem.piece is not None and len(problem.Q) > MANY
        free, root, lift = _metric(problem, V, waves and np.abs(f).max() <= SETTLED)
        right = np.column_stack([f + J @ lift, G])
        J = free(J)
    y = _smallest(problem, J, right, f, waves)
    ds = _freedom(G.T @ y[:, 1:], G.T @ y[:, 0])
    d = lift - root @ (J.T @ (y[:, 0] - y[:, 1:] @ ds))
    return d.reshape(-1, 3), ds


def _smallest(problem, J, right, f, waves):
    """y (2 f, k) with J J^T y = right: by waves, in a large piece of a grid, else by factors."""
    more = REGULAR * (J.data @ J.data) / len(f)
    if waves:
        with timed(problem.seconds, "solve"):
            off = max(np.abs(f).max() ** 1.5, EXACT)
            part = min(off / np.abs(right[:, 0]).max(initial=off), WAVES)
            y = lattice.solve(problem.piece, J, right, part, more)
        if y is not None:
            return y
    with timed(problem.seconds, "assemble"):
        S = J @ J.T
        S.setdiag(S.diagonal() + more)
    with timed(problem.seconds, "factor"):
        solve = problem.angle_factor(S)
    with timed(problem.seconds, "solve"):
        return solve(right)


def _freedom(A, b):
    """Solution of the small system of the freedom s (0, 1 or 2 unknowns)."""
    if not (len(b) and np.isfinite(A).all() and np.isfinite(b).all()):
        return np.full(len(b), np.nan)  # no freedom, or a run that has diverged
    return np.linalg.lstsq(A, b, rcond=None)[0]


def _metric(problem, V, settled):
    """(J -> J R, R, the way onto the surface); R R^T tells how freely the coordinates move."""
    root = np.sqrt(problem.mobility)
    if not problem.on_surface:
        root = np.repeat(root, 3)
        return lambda J: sparse.scaled(J, root), diags_array(root), np.zeros(V.size)
    feet, normals = problem.reference.closest(V)
    frames, at = _tangents(normals) * root[:, None, None], np.arange(len(V) + 1)
    R = bsr_array((frames, at[:-1], at), shape=(V.size, 2 * len(V)))
    lift = np.where(root[:, None] > 0, feet - V, 0.0)
    near = SETTLED * problem.reference.diagonal
    if settled and np.linalg.norm(lift, axis=1).max() <= near:  # else it would take a step more
        lift[:] = 0
    columns = (2 * problem.Q[..., None] + np.arange(2)).reshape(-1, 8)

    def free(J):
        local = J.data.reshape(-1, 2, 4, 3)
        along = np.swapaxes(np.swapaxes(local, 1, 2) @ frames[problem.Q], 1, 2)
        return sparse.rows(along.reshape(-1, 2, 8), columns, R.shape[1])

    return free, R, lift.ravel()


def _tangents(normals):
    """Two unit vectors across each unit normal and each other, as columns: (n, 3, 2)."""
    x, y, z = normals.T
    side = np.copysign(1.0, z)
    a = -1 / (side + z)
    one = 1 + side * x * x * a, side * x * y * a, -side * x
    return np.stack([np.stack(one, axis=1), np.stack([x * y * a, side + y * y * a, -y], axis=1)], 2)


class Log:
    """The history of an optimisation and its best net.

    best: (step, V, s) of the best net so far, see `Step.key`; `stopped` by the callback.
    """

    def __init__(self, given, tolerance, progress, callback):
        self.given, self.callback = given, callback
        self.tolerance = max(tolerance, given.rounding)
        self.history: list[Step] = []
        self.best = None
        self.stopped = False
        self.bar = tqdm(disable=not progress, unit=" steps", desc="optimising")
        self.record("start", given.goal, given.V, None, 0.0)

    def record(self, kind, goal, V, s, size, residual=None):
        """Judge the net V, remember it if it is the best; the `Step`, None if V is no net.

        s: the freedom, that of the mean ratios if None; residual: see `judge`."""
        given = self.given
        with timed(given.seconds, "check"):
            try:
                s = nearest(given.goal, V, given.Q) if s is None else s
                net = V, given.Q, given.neighbours
                step = judge((kind, goal), *net, given.goal, s, size, residual)
            except ValueError:
                return None
        if self.best is None or step.key < self.best[0].key:
            self.best = step, V, s
        self.tell(step, lambda: V)
        return step

    def tell(self, step: Step, net: Callable, where: str = "") -> bool:
        """Note a step that led to net(), tell the caller, and return whether to go on."""
        self.history.append(step)
        words = f"optimising: {step.kind} step{where}, {np.degrees(step.deviation):.2g} degrees off"
        self.bar.set_description_str(words)
        self.bar.update()
        if step.kind != "start" and self.callback is not None and not self.stopped:
            self.stopped = self.callback(step, net()) is False
        return not self.stopped

    @property
    def done(self) -> bool:
        """Whether the last net has its angles and no faulty face, or a caller said stop."""
        return self.stopped or self.history[-1].key <= (0, self.tolerance)


def nearest(goal: Goal, V: np.ndarray, Q: np.ndarray) -> np.ndarray:
    """The freedom s of the goal that fits the mean logarithms of the net's ratios."""
    return freedom(goal, [np.log(ratio).mean() for ratio in measure.ratios(V, Q)])


def way(given: Problem, via: str, stride: float) -> list[Goal]:
    """The goals of the first steps, one each; the last one is the goal itself."""
    if via == "jump":
        return [given.goal]
    lam, mu, theta, theta0 = measure.faces(given.V, given.Q)
    found = {"theta": theta, "theta0": theta0, "lam": np.log(lam), "mu": np.log(mu)}
    here = {name: float(x.mean()) for name, x in found.items()}

    def leg(goal):
        names = ("theta", "theta0") if goal.kind == "angles" else (goal.kind,) * len(goal.values)
        return towards(goal, [here[name] for name in names], stride)

    first = leg(aim(**STARTS[via])) if via in STARTS else []
    here |= STARTS.get(via, {}) if given.goal.kind == "angles" else {}
    return first + leg(given.goal)


def ratio(
    log: Log,
    goals: list[Goal],
    shape_steps: int,
    limit: float,
    coupled: tuple | None,
    V: np.ndarray | None = None,
) -> None:
    """One run of the reduced formulation, until done or WORSE angle steps gained nothing.

    goals: of the first steps, see `way`; limit: the most steps; coupled: None, or one of `NEAR`;
    V: where it starts, the given net if None."""
    given, final = log.given, log.given.goal
    plan = [("shape" if shape_steps else "angle", goal) for goal in goals]
    plan += [("shape", final)] * (shape_steps - 1) + [("angle", final)] * ANGLE_STEPS
    V, before, s = given.V if V is None else V, None, None
    lowest, worse = np.inf, 0
    for kind, goal in plan:
        if len(log.history) > limit:
            return
        if goal is not before:
            before, s = goal, nearest(goal, V, given.Q)
        try:
            if coupled:
                d, ds = coupled_step(given, V, goal, s, coupled if kind == "shape" else LOOSE)
            else:
                d, ds = (shape_step if kind == "shape" else angle_step)(given, V, goal, s)
        except RuntimeError:  # SciPy's word for a singular matrix
            return
        parts = (t for t in PARTS if is_admissible(*np.exp(logs(goal, s + t * ds)[0])))
        part = next(parts, 0.0)
        V, s = V + part * d, s + part * ds
        size = np.linalg.norm(d, axis=1).max()
        step = log.record(kind, goal, V, s if goal is final else None, size)
        if step is None or log.done:
            return
        if kind == "angle" and goal is final:
            worse = 0 if step.deviation < 0.9 * lowest else worse + 1
            lowest = min(lowest, step.deviation)
            if worse == WORSE:
                return
