"""Optimisation of quad meshes into isogonal nets.

The work is shared: `goals` knows what is wanted, `problem` checks the input and holds the
shape energies, `steps` and `guided` make one step of either formulation, `runs` decides
which step comes next and judges its net by `measure`.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import spsolve

from ..parallelogram import angles as exact_angles
from . import goal as goals
from . import guided, run
from .problem import PAPER, Weights, prepare

STRIDE = np.radians(15)


class NotConverged(RuntimeError):
    """A guarantee was asked for and not met; `result` holds the best net."""

    def __init__(self, result):
        super().__init__(result.message)
        self.result = result


class Result(NamedTuple):
    """The optimised net: V (n, 3), its ratios and angles (radians), and how it was found.

    history: list of `solver.run.Step`, the first is the start; seconds: {stage: seconds}; sizes:
    (#var, #cons) of the formulation; message: why it converged or did not.
    """

    V: np.ndarray
    lam: float
    mu: float
    theta: float
    theta0: float
    history: list
    converged: bool
    message: str
    seconds: dict
    sizes: tuple


def optimize(
    V,
    Q,
    theta=None,
    theta0=None,
    lam=None,
    mu=None,
    *,
    equal=False,
    reference=None,
    on_surface=False,
    formulation="ratio",
    residual="log",
    weights=None,
    fixed=None,
    mobility=None,
    polygons=(),
    via="mean",
    stride=STRIDE,
    shape_steps=2,
    tolerance=1e-11,
    iterations=None,
    strict=False,
    progress=False,
    callback=None,
):
    """The labelled mesh V (n, 3), Q (f, 4) changed into an isogonal net: a `Result`.

    theta, theta0 (radians), lam, mu: at most two; the rest stays free (equal: theta = theta0)
    reference    surface to stay near (see `reference`); on_surface: vertices stay on it
    formulation  "ratio": two logarithms a face (residual="quadratic": scaled squares), shape
                 steps, then smallest steps to the angles; "paper": guided projection by
                 SciPy's spsolve; "paper, splu": the same, ordered better and so faster
    weights      `Weights` of the shape energies; `solver.problem.PAPER` unless given for "paper"
    fixed        vertices that stay: numbers, mask or "boundary"; mobility: see `problem`
    polygons     corners of faces that are no quads, one sequence each
    via          "mean": by goals at most `stride` apart from the mean angles of the mesh;
                 "medials", "diagonals", "squares": through an orthogonal net; "jump": at once
    shape_steps  steps with shape energies at the final angles
    tolerance    of the angles, radians (at least what rounding of V allows)
    iterations   the most steps; of "paper" their number, 17 unless given
    strict       raise `NotConverged` instead of returning a net that is off
    progress     show a bar; callback(step, V) after every step may return False to stop

    A run that ends off its angles or with flipped faces is repeated with smaller strides; of
    all nets the one with the fewest flips, then the smallest deviation, is returned.
    `converged`: all faces have their angles, none is flipped.  Bad input is a ValueError.

    Paper: Sec. 6, Table 1.
    """
    options = formulation, residual, via, stride, shape_steps, tolerance, iterations
    wanted = goals.goal(theta, theta0, lam, mu, equal)
    _check_options(*options, on_surface)
    weights = weights or (Weights() if formulation == "ratio" else PAPER)
    given = prepare(V, Q, wanted, weights, reference, on_surface, fixed, mobility, polygons)
    result = _solve(given, *options, progress, callback)
    if strict and not result.converged:
        raise NotConverged(result)
    return result


def _check_options(*options):
    formulation, residual, via, stride, shape_steps, tolerance, iterations, on_surface = options
    choices = {
        "formulation": (formulation, ("ratio", "paper", "paper, splu")),
        "residual": (residual, ("log", "quadratic")),
        "via": (via, ("mean", "jump", *run.STARTS)),
    }
    for name, (value, allowed) in choices.items():
        if value not in allowed:
            raise ValueError(f'{name} = "{value}": one of {", ".join(allowed)} is wanted')
    if not (stride > 0 and tolerance > 0):
        raise ValueError(f"stride = {stride}, tolerance = {tolerance}: positive radians are wanted")
    for name, value in (("shape_steps", shape_steps), ("iterations", iterations)):
        if value is not None and not (value >= 0 and int(value) == value):
            raise ValueError(f"{name} = {value}: a whole number, 0 or more, is wanted")
    if formulation != "ratio" and on_surface:
        raise ValueError('on_surface=True needs formulation="ratio": the paper has no such step')


def _solve(given, *options):
    formulation, residual, via, stride, shape_steps, tolerance, iterations = options[:7]
    log = run.Log(given, tolerance, *options[7:])
    with log.bar, np.errstate(all="ignore"):  # a run that diverges is found out by its judge
        if formulation != "ratio":
            solve = spsolve if formulation == "paper" else None
            run.paper(log, via, stride, 17 if iterations is None else iterations, solve)
        else:
            limit = np.inf if iterations is None else iterations
            run.ratio(log, via, stride, shape_steps, residual == "quadratic", limit)
    (flips, deviation), V, s = log.best
    good = bool(deviation <= log.tolerance and flips == 0)
    lam, mu = (float(x) for x in np.exp(goals.logs(given.goal, s)[0]))
    angles = (float(x) for x in exact_angles(lam, mu))
    message = _message(good, log.stopped, flips, deviation, len(log.history) - 1)
    sizes = V.size + len(s), 2 * len(given.Q)
    if formulation != "ratio":
        sizes = guided.size(given.Q, len(V), given.goal)
    return Result(V, lam, mu, *angles, log.history, good, message, log.seconds, sizes)


def _message(good, stopped, flips, deviation, count):
    if good:
        words = f"converged in {count} steps"
    elif stopped:
        words = f"stopped by the caller after {count} steps"
    elif flips:
        words = f"not converged in {count} steps, every net on the way had flipped faces"
    else:
        words = f"not converged in {count} steps, this is the best net without flipped faces"
    return f"{words}: at most {np.degrees(deviation):.3g} degrees off, {flips} flipped faces"
