"""A surface in, an isogonal net out: flattened conformally, covered by a sheared grid, lifted.

Every conformal map of a sheared grid is nearly an isogonal net for every pair of angles, so
the optimisation that follows moves the vertices only a little along the surface.

Paper: Sec. 6.2 (beyond the paper).
"""

from typing import NamedTuple

import numpy as np

from . import clean as cleaning
from . import flatten, overlay, parallelogram, reference, solver
from .problem import Weights
from .steps import timed
from .survey import Report, survey
from .survey import describe as describe  # public here too

NEAR = Weights(fairness=0.02, closeness=0.001, approximation=10.0, boundary=0.0)
ATTEMPTS = (  # the first good one is taken: on the surface, near it, reshaped near it
    *({"on_surface": True, "shape_steps": steps, "via": "jump"} for steps in (0, 2, 8)),
    {"shape_steps": 0, "via": "jump"},
    {"shape_steps": 4, "weights": NEAR},
)
AWAY = 0.01  # of the diagonal: vertices farther from the surface are not welcome


class Cover(NamedTuple):
    """The net V (n, 3), Q (f, 4), labelled, and its `Report`."""

    V: np.ndarray
    Q: np.ndarray
    report: Report


def cover(
    V,
    F,
    theta,
    theta0,
    count=1500,
    size=None,
    direction=0.0,
    *,
    optimise=True,
    tolerance=1e-11,
    progress=False,
):
    """The surface V (n, 3), F triangles (f, 3) or quads (f, 4), covered by a net: a `Cover`.

    theta, theta0  the angles, radians
    count, size    about how many quads, or the mean length of their edges instead
    direction      of the u-lines, radians: in the flattened surface against its longest
                   direction, or against the direction around the hole
    optimise       move the vertices until the angles are exact (else: nearly)
    tolerance      of the angles, radians; progress: show a bar

    The surface is a disk (one boundary loop) or a ring (two), in one piece; the net has whole
    quads only, so that the surface shows at the boundary for less than a quad's width.  Over
    a ring the net closes, with the nearest size and direction for which it can.  ValueError,
    one sentence, for input that cannot be covered; safe repairs are named in the report.
    Look at `report.converged`: a net that is off is returned, not raised.

    Paper: Sec. 6.2 (beyond the paper).
    """
    theta, theta0 = float(theta), float(theta0)
    parallelogram.ratios(theta, theta0)  # refuses angles out of range
    _check(count, size, direction)
    seconds = {}
    with timed(seconds, "check"):
        surface = cleaning.clean(V, F)
        goal = reference.mesh(surface.V, surface.F)
    with timed(seconds, "flatten"):
        flat = flatten.flatten(surface.V, surface.F, surface.loops)
    with timed(seconds, "grid"):
        domain = overlay.Domain(flat, surface.V)
        layer = overlay.cover(domain, theta, theta0, count, size, direction)
    net, done, words = layer.V, False, "not optimised"
    if optimise:
        with timed(seconds, "optimise"):
            net, done, words = _optimise(layer, theta, theta0, goal, tolerance, progress)
    with timed(seconds, "report"):
        found = survey(net, layer.Q, theta, theta0, goal, flat)
    if done and found["distance_max"] > AWAY:
        words += f", but up to {100 * found['distance_max']:.2g} % of the diagonal off the surface"
        words += ": ask for more quads"
    known = done, words, layer.winding, tuple(surface.repairs), seconds
    names = "converged", "message", "winding", "repairs", "seconds"
    return Cover(net, layer.Q, Report(**found, **dict(zip(names, known, strict=True))))


def _check(count, size, direction):
    if size is None and not (np.isfinite(count) and count >= 1 and int(count) == count):
        raise ValueError(f"count = {count}: a whole number of quads, 1 or more, is wanted")
    if size is not None and not (np.isfinite(size) and size > 0):
        raise ValueError(f"size = {size}: a positive length is wanted")
    if not np.isfinite(direction):
        raise ValueError(f"direction = {direction}: a finite angle in radians is wanted")


def _optimise(layer, theta, theta0, goal, tolerance, progress):
    """(V, converged, message) of the first attempt that is good, else of the best one."""
    best = None
    for options in ATTEMPTS:
        result = solver.optimize(
            layer.V,
            layer.Q,
            theta,
            theta0,
            reference=goal,
            tolerance=tolerance,
            progress=progress,
            **options,
        )
        off = np.linalg.norm(goal.closest(result.V)[0] - result.V, axis=1).max() / goal.diagonal
        last = result.history[-1]
        key = (False, 0, off) if result.converged else (True, last.flips, last.deviation)
        if best is None or key < best[0]:
            best = key, result
        if result.converged and off <= AWAY:
            break
    result = best[1]
    return result.V, result.converged, result.message
