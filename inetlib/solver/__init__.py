"""Optimisation of quad meshes into isogonal nets.

`goal` knows what is wanted, `problem` checks the input and holds the shape energies,
`residuals` are the equations, `run` and `guided` make the steps of either formulation and
judge every net by `measure`, `sparse` solves, pieces of grids by `lattice`; large grids go from
coarse to fine, those of `grids` without any matrix."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import spsolve

from .. import mesh
from ..parallelogram import check_whole
from ..reference import Reference
from . import guided, lattice, run
from .goal import aim, angles, logs
from .problem import PAPER, Weights, prepare

STRIDE = np.radians(15)
DETAIL = 0.25  # of an edge: where a coarser grid is farther off, it has lost something
ENOUGH = 1e-6  # radians, of the angles of a coarser grid


class NotConverged(RuntimeError):
    """A guarantee was asked for and not met; `result` holds the best net."""

    def __init__(self, result: "Result"):
        super().__init__(result.message)
        self.result = result


class Result(NamedTuple):
    """The optimised net, and how it was found."""

    V: np.ndarray  # (n, 3)
    lam: float
    mu: float
    theta: float  # radians
    theta0: float
    history: list  # of `run.Step`, the first is the start
    converged: bool
    message: str  # why it converged or did not
    seconds: dict  # {stage: seconds}
    sizes: tuple  # (#var, #cons) of the formulation


def optimize(
    V: np.ndarray,
    Q: np.ndarray,
    theta: float | None = None,
    theta0: float | None = None,
    lam: float | None = None,
    mu: float | None = None,
    *,
    equal: bool = False,
    reference: Reference | None = None,
    on_surface: bool = False,
    formulation: str = "ratio",
    residual: str = "log",
    weights: Weights | None = None,
    fixed: str | Sequence | np.ndarray | None = None,
    mobility: np.ndarray | None = None,
    polygons: Sequence = (),
    via: str = "mean",
    stride: float = STRIDE,
    shape_steps: int = 2,
    coupled: bool = False,
    tolerance: float = 1e-11,
    iterations: int | None = None,
    strict: bool = False,
    progress: bool = False,
    callback: Callable | None = None,
) -> Result:
    """The labelled mesh V (n, 3), Q (f, 4) changed into an isogonal net: a `Result`.

    theta, theta0 (radians), lam, mu: at most two; the rest stays free (equal: theta = theta0)
    reference    surface to stay near (see `reference`); on_surface: vertices stay on it
    formulation  "ratio": two logarithms a face (residual="quadratic": scaled squares), shape
                 steps, then smallest steps to the angles; "paper": guided projection by
                 SciPy's spsolve; "paper, splu": the same, ordered better and so faster
    weights      `Weights` of the shape energies; `problem.PAPER` unless given for "paper"
    fixed        vertices that stay: numbers, mask or "boundary"; mobility: see `problem`
    polygons     corners of faces that are no quads, one sequence each
    via          "mean": by goals at most `stride` apart from the mean angles of the mesh;
                 "medials", "diagonals", "squares": through an orthogonal net; "jump": at once
    shape_steps  steps with shape energies at the final angles
    coupled      `run.coupled_step` from the first step on, not only where others make darts
    tolerance    of the angles, radians (at least what rounding of V allows)
    iterations   the most steps; of "paper" their number, 17 unless given
    strict       raise `NotConverged` instead of returning a net that is off
    progress     show a bar; callback(step, V) after every step may return False to stop

    A whole grid of many quads is solved as a coarser one, refined, and set right by smallest
    steps, wherever nothing forbids it: polygons, coupled, iterations, shape_steps=0, vertices
    that stay inside, details that a coarser grid would lose.  Steps on coarser grids are in the
    history, too, and the callback sees their nets refined.

    A run that ends off its angles is repeated with smaller strides, one that ends with flipped
    faces or darts with `run.coupled_step`; of all nets the one with the fewest of these, then
    the smallest deviation, is returned.  `converged`: all faces have their angles, none is
    flipped or a dart.  Bad input is a ValueError.

    >>> from inetlib import surfaces
    >>> found = optimize(*surfaces.freeform_patch(8, 8), theta=1.2, theta0=1.3)
    >>> found.converged, found.theta, round(found.lam, 6)
    (True, 1.2, 1.291682)

    Paper: Table 1."""
    wanted = aim(theta, theta0, lam, mu, equal)
    ours = formulation == "ratio"
    _check_choice("residual", residual, ("log", "quadratic"))
    _check_choice("formulation", formulation, ("ratio", "paper", "paper, splu"))
    _check_choice("via", via, ("mean", "jump", *run.STARTS))
    if not (stride > 0 and tolerance > 0):
        raise ValueError(f"stride = {stride}, tolerance = {tolerance}: positive radians are wanted")
    if (on_surface or coupled) and not ours:
        raise ValueError('on_surface and coupled need formulation="ratio": the paper has neither')
    if on_surface and coupled:
        raise ValueError("on_surface=True knows no coupled steps: give one of the two")
    limit = np.inf if ours else guided.STEPS
    if iterations is not None:
        limit = check_whole("iterations", iterations, 0)
    shape_steps = check_whole("shape_steps", shape_steps, 0)
    weights = weights or (Weights() if ours else PAPER)
    still, quadratic = (fixed, mobility, polygons), residual == "quadratic"
    given = prepare(V, Q, wanted, weights, reference, on_surface, *still, quadratic)
    log = run.Log(given, tolerance, progress, callback)
    asked: dict = dict(theta=theta, theta0=theta0, lam=lam, mu=mu, equal=equal, reference=reference)
    asked |= dict(on_surface=on_surface, residual=residual, via=via, stride=stride)
    simple = ours and not (coupled or len(polygons)) and iterations is None and shape_steps
    with log.bar, np.errstate(all="ignore"):  # a run that diverges is found out by its judge
        if ours:
            start = _refined(log, asked | {"shape_steps": shape_steps}) if simple else None
            _by_steps(log, start, (via, stride), (shape_steps, limit), coupled, not on_surface)
        else:
            solve = spsolve if formulation == "paper" else None
            guided.run(log, run.way(given, via, stride), limit, solve)
    result = _result(log, ours)
    if strict and not result.converged:
        raise NotConverged(result)
    return result


def _refined(log, asked):
    """The net V (n, 3) of a coarser grid, solved, refined and recorded; None where there is none.

    Such a net is fairer than what steps of the whole size find, and sooner there."""
    given = log.given
    grid = None if given.piece is None else lattice.vertices(given.Q, given.piece.place)
    if grid is None or not _sides_alike(given.mobility[grid] == 0):
        return None
    size, P = [k - 1 for k in grid.shape], np.moveaxis(given.V[grid], 2, 0)
    m, n = lattice.levels(*size)[-2]
    some = grid[
        np.ix_(
            *((2 * k * np.arange(j + 1) + j) // (2 * j) for k, j in zip(size, (m, n), strict=True))
        )
    ]

    def refined(W):
        V, still = np.empty_like(given.V), given.mobility == 0
        V[grid] = np.moveaxis(lattice.refine(W.T.reshape(3, m + 1, n + 1), *size), 0, 2)
        V[still] = given.V[still]
        return V

    coarse = np.moveaxis(lattice.refine(P, m, n), 0, 2).reshape(-1, 3)
    if np.linalg.norm(refined(coarse) - given.V, axis=1).max() > DETAIL * given.edge:
        return None
    here = {"mobility": given.mobility[some.ravel()], "tolerance": max(ENOUGH, log.tolerance)}
    here["weights"] = Weights(*(weight[some.ravel()] for weight in given.weights))
    here["callback"] = lambda step, W: log.tell(step, lambda: refined(W), " on a coarser grid")
    found = optimize(coarse, mesh.grid_quads(m, n), **asked, **here)
    if not (found.converged or log.stopped):
        return None
    V = refined(found.V)
    return V if log.record("refined", given.goal, V, None, 0.0) else None


def _sides_alike(mask):
    """Whether a mask (m+1, n+1) is constant inside and along each side, but for the corners."""
    inside = mask[1:-1, 1:-1], mask[1:-1, 0], mask[1:-1, -1], mask[0, 1:-1], mask[-1, 1:-1]
    return all(part.all() or not part.any() for part in inside)


def _by_steps(log, start, way, most, coupled, can_couple):
    """Runs of `run.ratio`, the first from the net start if there is one, until one is good.

    way: (via, stride), see `run.way`; most: numbers of shape steps and of all steps."""
    (via, stride), (shape_steps, limit) = way, most
    if start is not None and not log.stopped:
        run.ratio(log, [log.given.goal], 0, limit, None, start)
    if log.stopped or (start is not None and log.done):
        return
    factors = run.STRIDES if via != "jump" else run.STRIDES[:1]
    for couple, factor in _runs(log, factors, coupled, can_couple):
        run.ratio(log, run.way(log.given, via, stride * factor), shape_steps, limit, couple)
        if log.done or len(log.history) > limit:
            return


def _runs(log, factors, coupled, can_couple):
    """(coupled, factor of the stride) of one run after the other, as long as they are wanted."""
    for factor in () if coupled else factors:
        yield None, factor
        if log.history[-1].deviation <= log.tolerance:
            break  # the angles are right, some faces are not: smaller strides do not help
    if coupled or (can_couple and log.history[-1].key[0]):
        yield from ((near, 1) for near in run.NEAR)


def _check_choice(name, value, allowed):
    if value not in allowed:
        raise ValueError(f'{name} = "{value}": one of {", ".join(allowed)} is wanted')


def _result(log, ours):
    """The `Result` of the best net."""
    given, count = log.given, len(log.history) - 1
    best, V, s = log.best
    good, steps = bool(best.key <= (0, log.tolerance)), f"{count} step{'s' * (count != 1)}"
    if good:
        words = f"converged in {steps}"
    elif log.stopped:
        words = f"stopped by the caller after {steps}"
    elif best.key[0]:
        words = f"not converged in {steps}, every net on the way had flipped faces or darts"
    else:
        words = f"not converged in {steps}, this is the best net without flips and darts"
    shape = map(float, (*np.exp(logs(given.goal, s)[0]), *angles(given.goal, s)))
    sizes = V.size + len(s), 2 * len(given.Q)
    if not ours:
        sizes = guided.size(given.Q, len(V), given.goal)
    message = f"{words}: {best.words}"
    return Result(V, *shape, log.history, good, message, given.seconds, sizes)
