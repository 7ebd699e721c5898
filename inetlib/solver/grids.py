"""Large grids: solved coarse, refined by splines, and set right by a few smallest steps.

A net of m x n quads is an array P (3, m+1, n+1) inside here, coordinates first.
"""

import numpy as np
from scipy.interpolate import RectBivariateSpline
from tqdm import tqdm

from .. import measure, mesh, parallelogram, solver
from . import goal as goals
from . import run, sparse
from .run import timed

TOLERANCE = np.radians(1e-6)
SPARE = 100  # the finest level aims at the tolerance divided by this
FINEST = 8  # steps at most on the finest level
BETWEEN = 2, 1e-6, 0.01  # on the others: steps at most, deviation aimed at and good enough


def optimize(
    X,
    theta=None,
    theta0=None,
    lam=None,
    mu=None,
    *,
    coarse=20,
    tolerance=TOLERANCE,
    progress=False,
):
    """The grid X (m+1, n+1, 3) changed into an isogonal net: a `solver.Result`.

    theta, theta0 (radians), lam, mu: two of them, so that both angles are fixed
    coarse     quads on the shorter side of the coarse grid, about; at least 4
    tolerance  of the angles, radians; progress: show a bar

    Vertices of the result are numbered as in `mesh.grid_quads(m, n)`.  The coarse grid is
    solved by `solver.optimize`, then the number of quads is doubled both ways again and
    again; details of X smaller than coarse quads are lost.  Where that fails it is tried
    once more from a finer coarse grid.  `history` has the steps of all levels in turn, and
    `message` says how many of them belong to which level.
    """
    wanted = goals.goal(theta, theta0, lam, mu)
    if wanted.kind != "angles":
        raise ValueError("both angles must be fixed by two numbers here: use solver.optimize")
    if not tolerance > 0:
        raise ValueError(f"tolerance = {tolerance}: positive radians are wanted")
    X = _checked(X)
    m, n = X.shape[0] - 1, X.shape[1] - 1
    plans = [levels(m, n, size) for size in (coarse, 2 * coarse)]
    best, seconds = None, {}
    with tqdm(disable=not progress, unit=" steps", desc="coarse grid") as bar:
        for sizes in plans if plans[0] != plans[1] else plans[:1]:
            found = _attempt(X, wanted, sizes, tolerance, seconds, bar)
            best = min(best or found, found, key=lambda one: one[1])
            if best[1] <= (0, tolerance):
                break
    return _result(*best, wanted, tolerance, seconds, 2 * m * n)


def _checked(X):
    X = np.asarray(X)
    if X.ndim != 3 or X.shape[2] != 3 or min(X.shape) < 3:
        raise ValueError(
            f"X has the shape {X.shape}: a grid (m+1, n+1, 3) with m, n at least 2 is wanted"
        )
    V, Q = mesh.check_arrays(X.reshape(-1, 3), mesh.grid_quads(X.shape[0] - 1, X.shape[1] - 1))
    measure.flipped(V, Q, np.full((len(Q), 1), -1))  # refuses collapsed faces
    return V.reshape(X.shape)


def levels(m, n, coarse=20):
    """The sizes [(m0, n0), ..., (m, n)] of the grids from coarse to fine, each about doubled."""
    if not coarse >= 4:
        raise ValueError(f"coarse = {coarse}: at least 4 quads are wanted")
    sizes = [(m, n)]
    while min(m, n) > 1.5 * coarse or m * n > 4 * coarse**2:
        m, n = (-(-k // 2) if k > coarse else k for k in (m, n))
        sizes.insert(0, (m, n))
    return sizes


# --- from level to level ----------------------------------------------------------------


def _attempt(X, goal, sizes, tolerance, seconds, bar):
    """(V, (flips, deviation), history, words) of one run through the levels."""
    P = np.moveaxis(X, 2, 0)
    with timed(seconds, "coarse"):
        V = _vertices(refine(P, *sizes[0]))
        net = solver.optimize(V, mesh.grid_quads(*sizes[0]), *goal.values)
    history, good = list(net.history), net.converged
    words = [_words(sizes[0], len(history) - 1)]
    P = net.V.T.reshape(3, *(k + 1 for k in sizes[0]))
    if not good:
        words.append(f"the coarse grid failed ({net.message})")
    for size in sizes[1:] if good else ():
        with timed(seconds, "refine"):
            P = refine(P, *size)
        effort = (FINEST, tolerance / SPARE, tolerance) if size == sizes[-1] else BETWEEN
        P, found, good = _level(P, goal, *effort, seconds, bar)
        history += found
        words.append(_words(size, len(found)))
        if not good:
            words.append("where the refinement went astray")
            break
    V, key = _finished([P] if good else [P, np.moveaxis(X, 2, 0)], X.shape, goal)
    return V, key, history, ", ".join(words)


def _words(size, count):
    return f"{size[0]} x {size[1]} quads in {count} steps"


def _level(P, goal, most, aim, enough, seconds, bar):
    """(net, steps, whether they led on) of the smallest steps on one level."""
    judge = _Judge(P, goal, seconds)
    step, history = judge(P), []
    while step and step.deviation > aim and len(history) < most:
        with timed(seconds, "assemble"):
            f, A = sparse.equations(P, *judge.logs[:, 0])
        with timed(seconds, "solve"):
            d, _ = sparse.step(A, f)
        after = judge(P - d, np.sqrt((d * d).sum(axis=0).max()))
        if after is None or after.deviation >= step.deviation:
            break
        P, step = P - d, after
        history.append(step)
        bar.set_description(f"{judge.name}, {np.degrees(step.deviation):.2g} degrees off")
        bar.update()
    return P, history, step is not None and not step.flips and step.deviation <= enough


class _Judge:
    """Measures nets of one size; the `solver.run.Step`, or None where the array is no net."""

    def __init__(self, P, goal, seconds):
        size = P.shape[1] - 1, P.shape[2] - 1
        self.name = f"{size[0]} x {size[1]} quads"
        self.goal, self.seconds = goal, seconds
        self.logs = goals.logs(goal, [])[0][:, None]
        with timed(seconds, "check"):
            self.Q = mesh.grid_quads(*size)
            self.neighbours = mesh.face_neighbours(self.Q)

    def __call__(self, P, size=0.0):
        with timed(self.seconds, "check"):
            V = _vertices(P)
            try:
                angles = measure.angles(V, self.Q)
                residual = np.sum((np.log(measure.ratios(V, self.Q)) - self.logs) ** 2)
                flips = len(measure.flipped(V, self.Q, self.neighbours))
            except ValueError:  # a face has collapsed, or a coordinate is not finite
                return None
            off = [np.abs(a - b) for a, b in zip(angles, self.goal.values, strict=True)]
            spread = [float(f(x)) for x in off for f in (np.max, np.mean)]
            return run.Step("angle", self.goal, float(residual), *spread, float(size), flips)


def _finished(nets, shape, goal):
    """(V, (flips, deviation)) of the best of the nets at full size."""
    found = []
    for P in nets:
        P = refine(P, shape[0] - 1, shape[1] - 1)
        step = _Judge(P, goal, {})(P)
        if step is not None:
            found.append((_vertices(P).copy(), (step.flips, step.deviation)))
    return min(found, key=lambda one: one[1])


def _result(V, key, history, words, goal, tolerance, seconds, count):
    flips, deviation = key
    good = bool(flips == 0 and deviation <= tolerance)
    message = f"{'' if good else 'not '}converged: {words}; at most " + (
        f"{np.degrees(deviation):.3g} degrees off, {flips} flipped faces"
    )
    theta, theta0 = goal.values
    lam, mu = (float(x) for x in parallelogram.ratios(theta, theta0))
    found = V, lam, mu, theta, theta0, history, good, message, seconds
    return solver.Result(*found, (V.size, count))


def _vertices(P):
    return np.moveaxis(P, 0, 2).reshape(-1, 3)


def refine(P, m, n):
    """The grid P (3, ., .) at m x n quads, by cubic splines through its points."""
    if P.shape[1:] == (m + 1, n + 1):
        return P
    here = [np.linspace(0, 1, k) for k in P.shape[1:]]
    there = np.linspace(0, 1, m + 1), np.linspace(0, 1, n + 1)
    kx, ky = (min(3, len(x) - 1) for x in here)
    return np.stack([RectBivariateSpline(*here, x, kx=kx, ky=ky)(*there) for x in P])
