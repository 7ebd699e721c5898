"""Large grids: solved coarse, refined by splines, and set right by a few smallest steps.

A net of m x n quads is an array P (3, m+1, n+1) inside here, coordinates first."""

import numpy as np
from tqdm import tqdm

from .. import measure, mesh
from . import Result, sparse
from . import optimize as solve
from .goal import aim, logs
from .lattice import levels, refine
from .run import judge, timed

TOLERANCE = np.radians(1e-6)
SPARE = 100  # the finest level aims at the tolerance divided by this
FINEST = 8  # steps at most on the finest level
WORDS = "{} x {} quads in {} steps"
BETWEEN = 2, 1e-6, 0.01  # on the others: steps at most, deviation aimed at and good enough


def optimize(
    X: np.ndarray,
    theta: float | None = None,
    theta0: float | None = None,
    lam: float | None = None,
    mu: float | None = None,
    *,
    coarse: int = 20,
    tolerance: float = TOLERANCE,
    progress: bool = False,
) -> Result:
    """The grid X (m+1, n+1, 3) changed into an isogonal net: a `solver.Result`.

    theta, theta0 (radians), lam, mu: two of them, so that both angles are fixed
    coarse     quads on the shorter side of the coarse grid, about; at least 4
    tolerance  of the angles, radians; progress: show a bar

    Vertices of the result are numbered as in `mesh.grid_quads(m, n)`.  The coarse grid is
    solved by `solver.optimize`, then the number of quads is doubled both ways again and
    again; details of X smaller than coarse quads are lost.  Where that fails it is tried
    once more from a finer coarse grid.  `message` says how many steps of the `history` belong
    to which level."""
    wanted = aim(theta, theta0, lam, mu)
    if wanted.kind != "angles":
        raise ValueError("both angles must be fixed by two numbers here: use solver.optimize")
    if not tolerance > 0:
        raise ValueError(f"tolerance = {tolerance}: positive radians are wanted")
    X = _checked(X)
    m, n = (k - 1 for k in X.shape[:2])
    plans = [levels(m, n, size) for size in (coarse, 2 * coarse)]
    best, seconds = None, {}
    with tqdm(disable=not progress, unit=" steps", desc="coarse grid") as bar:
        for sizes in plans if plans[0] != plans[1] else plans[:1]:
            found = _attempt(X, wanted, sizes, tolerance, seconds, bar)
            best = min(best or found, found, key=lambda one: one[1].key)
            if best[1].key <= (0, tolerance):
                break
    V, last, history, words = best
    good = bool(last.key <= (0, tolerance))
    message = f"{'' if good else 'not '}converged: {words}; {last.words}"
    shape = (*map(float, np.exp(logs(wanted, [])[0])), *wanted.values)
    return Result._make([V, *shape, history, good, message, seconds, (V.size, 2 * m * n)])


def _checked(X):
    X = np.asarray(X)
    if X.ndim != 3 or X.shape[2] != 3 or min(X.shape) < 3:
        raise ValueError(f"X has the shape {X.shape}: (m+1, n+1, 3), m and n at least 2, is wanted")
    V, Q = mesh.check_arrays(X.reshape(-1, 3), mesh.grid_quads(X.shape[0] - 1, X.shape[1] - 1))
    measure.flipped(V, Q, np.full((len(Q), 1), -1))  # refuses collapsed faces
    return V.reshape(X.shape)


def _attempt(X, goal, sizes, tolerance, seconds, bar):
    """(V, its `run.Step`, history, words) of one run through the levels."""
    P = np.moveaxis(X, 2, 0)
    with timed(seconds, "coarse"):
        V = _vertices(refine(P, *sizes[0]))
        net = solve(V, mesh.grid_quads(*sizes[0]), *goal.values)
    history, good = list(net.history), net.converged
    words = [WORDS.format(*sizes[0], len(history) - 1)]
    P = net.V.T.reshape(3, *(k + 1 for k in sizes[0]))
    if not good:
        words.append(f"the coarse grid failed ({net.message})")
    for size in sizes[1:] if good else ():
        with timed(seconds, "refine"):
            P = refine(P, *size)
        effort = (FINEST, tolerance / SPARE, tolerance) if size == sizes[-1] else BETWEEN
        P, found, good = _level(P, goal, *effort, seconds, bar)
        history += found
        words.append(WORDS.format(*size, len(found)))
        if not good:
            words.append("where the refinement went astray")
            break
    nets = [refine(net, *sizes[-1]) for net in ([P] if good else [P, np.moveaxis(X, 2, 0)])]
    measured = _judge(sizes[-1], goal, {})
    found = [(_vertices(P).copy(), step) for P in nets if (step := measured(P))]
    return *min(found, key=lambda one: one[1].key), history, ", ".join(words)


def _level(P, goal, most, exact, enough, seconds, bar):
    """(net, steps, whether they led on) of the smallest steps on one level."""
    size = P.shape[1] - 1, P.shape[2] - 1
    measured, wanted = _judge(size, goal, seconds), logs(goal, [])[0]
    step, history = measured(P), []
    while step and step.deviation > exact and len(history) < most:
        with timed(seconds, "assemble"):
            f, A = sparse.equations(P, *wanted)
        with timed(seconds, "solve"):
            d, _ = sparse.step(A, f)
        after = measured(P - d, np.sqrt((d * d).sum(axis=0).max()))
        if after is None or after.deviation >= step.deviation:
            break
        P, step = P - d, after
        history.append(step)
        off = np.degrees(step.deviation)
        bar.set_description(f"{size[0]} x {size[1]} quads, {off:.2g} degrees off")
        bar.update()
    return P, history, step and step.key <= (0, enough)


def _judge(size, goal, seconds):
    """A function (P, way) that measures nets of one size: `run.judge`."""
    with timed(seconds, "check"):
        Q = mesh.grid_quads(*size)
        neighbours = mesh.face_neighbours(Q)

    def measured(P, way=0.0):
        with timed(seconds, "check"):
            try:
                return judge(("angle", goal), _vertices(P), Q, neighbours, goal, [], way)
            except ValueError:  # a face has collapsed, or a coordinate is not finite
                return None

    return measured


def _vertices(P):
    return np.moveaxis(P, 0, 2).reshape(-1, 3)
