"""The runs of an optimisation: which step comes next, what came of it, which net was best."""

import time
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
from scipy.sparse import bsr_array, diags_array
from tqdm import tqdm

from .. import measure
from ..parallelogram import angles as exact_angles
from . import goal as goals
from . import guided, sparse
from . import residuals as constraints
from .goal import logs
from .problem import shape

REGULAR = 1e-12  # of the mean diagonal, in the matrix of an angle step


@contextmanager
def timed(seconds, name):
    """Add the seconds that the block takes to seconds[name].

    Paper: Table 1 (seconds).
    """
    start = time.perf_counter()
    yield
    seconds[name] = seconds.get(name, 0.0) + time.perf_counter() - start


def equations(problem, V, goal, s, quadratic=False):
    """(residual (2 f,), Jacobian (2 f, 3 n), slopes (2 f, k)) of the angles at the net V.

    Zero residual: log lam and log mu of every face are those of the goal at the freedom s;
    the Jacobian is in V and minus `slopes` in s.  quadratic: `solver.residuals.scaled_ratios`.

    Paper: Eq. (11), Eq. (12).
    """
    wanted, slopes = logs(goal, s)
    corners = V[problem.Q].reshape(-1, 12)
    if quadratic:
        residual, jacobian = constraints.scaled_ratios(
            corners, *np.exp(wanted), constraints.sizes(corners)
        )
    else:
        residual, jacobian = constraints.log_ratios(corners)
        residual = residual - wanted
    J = sparse.rows(jacobian, sparse.coordinates(problem.Q), V.size)
    return residual.ravel(), J, np.tile(slopes, (len(corners), 1))


def shape_step(problem, V, goal, s, seconds, quadratic=False):
    """(change of V, change of s) of one Gauss-Newton step on all energies.

    All lengths are measured in mean edges, so the step does not depend on the scale.
    """
    with timed(seconds, "assemble"):
        residual, J, slopes = equations(problem, V, goal, s, quadratic)
        f, G = residual * problem.edge, slopes * problem.edge
        root = np.repeat(np.sqrt(problem.mobility), 3)
        J = sparse.scaled(J, problem.edge * root)
        A, g = shape(problem, V)
        if (root != 1).any():
            A = sparse.scaled(sparse.scaled(A, root).T.tocsr(), root)
        A = A + J.T @ J
        diagonal = A.diagonal() + np.repeat(problem.weights.closeness, 3)
        A.setdiag(diagonal + REGULAR * diagonal.mean())
        right = np.column_stack([root * g + J.T @ f, J.T @ G])
    with timed(seconds, "factor"):
        solve = problem.shape_factor(A)
    with timed(seconds, "solve"):
        y = solve(right)
        ds = _freedom(
            G.T @ G - right[:, 1:].T @ y[:, 1:],
            G.T @ f - right[:, 1:].T @ y[:, 0],
        )
        d = root * (y[:, 1:] @ ds - y[:, 0])
    return d.reshape(-1, 3), ds


def _freedom(A, b):
    """Solution of the small system of the freedom s (0, 1 or 2 unknowns)."""
    if not (len(b) and np.isfinite(A).all() and np.isfinite(b).all()):
        return np.full(len(b), np.nan)  # no freedom, or a run that has diverged
    return np.linalg.lstsq(A, b, rcond=None)[0]


def angle_step(problem, V, goal, s, seconds, quadratic=False):
    """(change of V, change of s): the smallest change to the linearised angles.

    Smallest in the sum of |d|^2 / mobility over the vertices.  On a surface (`on_surface`)
    the vertices go to their closest points and move along the tangent planes there.
    """
    with timed(seconds, "assemble"):
        residual, J, slopes = equations(problem, V, goal, s, quadratic)
        free, root, lift = _metric(problem, V)
        f = residual + J @ lift
        J = free(J)
        S = J @ J.T
        diagonal = S.diagonal()
        S.setdiag(diagonal + REGULAR * diagonal.mean())
        right = np.column_stack([f, slopes])
    with timed(seconds, "factor"):
        solve = problem.angle_factor(S)
    with timed(seconds, "solve"):
        y = solve(right)
        ds = _freedom(slopes.T @ y[:, 1:], slopes.T @ y[:, 0])
        d = lift - root @ (J.T @ (y[:, 0] - y[:, 1:] @ ds))
    return d.reshape(-1, 3), ds


def _metric(problem, V):
    """(free, root, lift): J -> J R, the matrix R, and the way onto the surface.

    R R^T tells how freely the coordinates move: by the mobility, on a surface along it.
    """
    root = np.sqrt(problem.mobility)
    if not problem.on_surface:
        root = np.repeat(root, 3)
        return lambda J: sparse.scaled(J, root), diags_array(root), np.zeros(V.size)
    feet, normals = problem.reference.closest(V)
    blocks = (np.eye(3) - normals[:, :, None] * normals[:, None, :]) * root[:, None, None]
    count = len(V)
    R = bsr_array((blocks, np.arange(count), np.arange(count + 1)), shape=(V.size, V.size)).tocsr()
    lift = np.where(root[:, None] > 0, feet - V, 0.0).ravel()
    return lambda J: J @ R, R, lift


# --- The runs of an optimisation: which step comes next, what came of it, which net was best. ---

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
    """One iteration: `kind` is "shape", "angle" or "guided"; angles in radians.

    residual: sum of the squared residuals of the formulation's equations after the step;
    theta_max ... theta0_mean: deviation of the angles from those of the final goal;
    size: the longest way of a vertex; flips: flipped faces; goal: that of this step.
    """

    kind: str
    goal: goals.Goal
    residual: float
    theta_max: float
    theta_mean: float
    theta0_max: float
    theta0_mean: float
    size: float
    flips: int

    @property
    def deviation(self):
        """The larger of theta_max and theta0_max."""
        return max(self.theta_max, self.theta0_max)


class Log:
    """The history of a run, its best net, its clock, and the judge of every step.

    best: ((flips, deviation), V, s) of the best net so far; `stopped` by the callback.
    """

    def __init__(self, given, tolerance, progress, callback):
        self.given, self.callback = given, callback
        self.tolerance = max(tolerance, _rounding(given.V, given.Q))
        self.history, self.seconds = [], {}
        self.best = None
        self.stopped = False
        self.bar = tqdm(disable=not progress, unit=" steps", desc="start")
        self.record("start", given.goal, given.V, None, 0.0)

    def record(self, kind, goal, V, s, size, residual=None):
        """Judge the net V, remember it if it is the best; the `Step`, None if V is no net.

        s: the freedom, that of the mean ratios if None; residual: that of the logarithms if None.
        """
        with timed(self.seconds, "check"):
            try:
                step, s = self._judge(kind, goal, V, s, size, residual)
            except ValueError:  # a face has collapsed, V is not finite, ratios outside Eq. (4)
                return None
        self.history.append(step)
        key = step.flips, step.deviation
        if self.best is None or key < self.best[0]:
            self.best = key, V, s
        self.bar.set_description(f"{kind} step, {np.degrees(step.deviation):.2g} degrees off")
        self.bar.update()
        if kind != "start" and self.callback is not None:
            self.stopped = self.callback(step, V) is False
        return step

    def _judge(self, kind, goal, V, s, size, residual):
        theta, theta0 = measure.angles(V, self.given.Q)
        flips = len(measure.flipped(V, self.given.Q, self.given.neighbours))
        s = freedom(self.given, V) if s is None else s
        logs = goals.logs(self.given.goal, s)[0]
        wanted = exact_angles(*np.exp(logs))
        if residual is None:
            found = np.log(np.stack(measure.ratios(V, self.given.Q), axis=1))
            residual = np.sum((found - logs) ** 2)
        off = [np.abs(a - b) for a, b in zip((theta, theta0), wanted, strict=True)]
        spread = [float(f(x)) for x in off for f in (np.max, np.mean)]
        return Step(kind, goal, float(residual), *spread, float(size), flips), s

    @property
    def done(self):
        """Whether the last net has its angles and no flipped face, or a caller said stop."""
        last = self.history[-1]
        return self.stopped or (last.deviation <= self.tolerance and last.flips == 0)


def _rounding(V, Q):
    """The angle by which rounding of the coordinates may turn the shortest edge."""
    shortest = np.linalg.norm(V[Q] - V[np.roll(Q, -1, axis=1)], axis=2).min()
    return 8 * np.spacing(np.abs(V).max()) / shortest


def freedom(given, V, goal=None):
    """The freedom s of the goal that fits the mean logarithms of the net's ratios."""
    lam, mu = measure.ratios(V, given.Q)
    return goals.freedom(goal or given.goal, (np.log(lam).mean(), np.log(mu).mean()))


# --- the way to the angles --------------------------------------------------------------


def _way(given, V, via, stride):
    """The goals of the first steps, one each; the last one is the goal itself."""
    if via == "jump":
        return [given.goal]
    first = []
    start = _means(given.goal, V, given.Q)
    if via in STARTS:
        middle = goals.goal(**STARTS[via])
        first = goals.towards(middle, _means(middle, V, given.Q), stride)
        on_way = {"theta": np.pi / 2, "theta0": np.pi / 2}
        known = dict(zip(("theta", "theta0"), start, strict=False))
        if given.goal.kind == "angles":
            start = tuple((known | {k: on_way[k] for k in STARTS[via]}).values())
    return first + goals.towards(given.goal, start, stride)


def _means(goal, V, Q):
    theta, theta0 = measure.angles(V, Q)
    lam, mu = measure.ratios(V, Q)
    return goals.values_at(goal, theta.mean(), theta0.mean(), np.log(lam).mean(), np.log(mu).mean())


def ratio(log, via, stride, shape_steps, quadratic, limit):
    """Runs of the reduced formulation with smaller and smaller strides, until one succeeds."""
    given = log.given
    for factor in STRIDES[:1] if via == "jump" else STRIDES:
        way = _way(given, given.V, via, stride * factor)
        first = "shape" if shape_steps else "angle"
        plan = [(first, goal) for goal in way] + [("shape", given.goal)] * (shape_steps - 1)
        _run(log, plan + [("angle", given.goal)] * ANGLE_STEPS, quadratic, limit)
        if log.done or len(log.history) > limit:
            return


def _run(log, plan, quadratic, limit):
    """The planned steps from the start, until done or WORSE angle steps gained nothing."""
    given, V, before, s = log.given, log.given.V, None, None
    lowest, worse = np.inf, 0
    for kind, goal in plan:
        if len(log.history) > limit:
            return
        if goal is not before:
            before, s = goal, freedom(given, V, goal)
        take = shape_step if kind == "shape" else angle_step
        d, ds = take(given, V, goal, s, log.seconds, quadratic)
        part = next((t for t in PARTS if goals.is_possible(goal, s + t * ds)), 0.0)
        V, s = V + part * d, s + part * ds
        final = s if goal is given.goal else None
        size = np.linalg.norm(d, axis=1).max()
        step = log.record(kind, goal, V, final, size)
        if step is None or log.done:
            return
        if kind == "angle" and goal is given.goal:
            worse = 0 if step.deviation < 0.9 * lowest else worse + 1
            lowest = min(lowest, step.deviation)
            if worse == WORSE:
                return


def paper(log, via, stride, iterations, solve=None):
    """Guided projection: a fixed number of steps, the last two without shape energies.

    solve: a function (A, b) for the linear systems, see `solver.guided.step`.

    Paper: Sec. 6.3 (guided projection), Table 1.
    """
    given = log.given
    way = _way(given, given.V, via, stride)
    diagonal = np.linalg.norm(np.ptp(given.V, axis=0))
    V, lay = given.V, None
    for k in range(iterations):
        goal = way[k] if k < min(len(way), iterations - 2) else given.goal
        if lay is None or goal.equal != lay.theta_mode:
            lay = guided.layout(given.Q, len(V), goal.equal)
            x = guided.start(lay, V / diagonal, given.Q)
        d = guided.step(given, lay, goal, x, diagonal, log.seconds, k < iterations - 2, solve)
        x = x + d
        if not np.isfinite(x).all():
            return
        moved = diagonal * d[: V.size].reshape(-1, 3)
        V, size = V + moved, np.linalg.norm(moved, axis=1).max()
        residual = np.sum(guided.hard(lay, goal, x)[0] ** 2)
        s = goals.freedom(given.goal, guided.logs(lay, x))
        if log.record("guided", goal, V, s, size, residual) is None or log.stopped:
            return
