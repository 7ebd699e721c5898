"""A surface in, an isogonal net out: flattened conformally, covered by a sheared grid, lifted.

Every conformal map of a sheared grid is nearly an isogonal net for every pair of angles, so
the optimisation that follows moves the vertices only a little along the surface."""

from collections.abc import Callable
from contextlib import contextmanager
from functools import partial
from typing import NamedTuple

import igl
import numpy as np
from numpy.typing import ArrayLike
from tqdm import tqdm

from .. import measure, parallelogram, reference, repair, solver
from ..solver.run import timed
from ..solver.sparse import BLAS
from . import flatten, opening, overlay, steer
from .report import Report, area_of, survey
from .trim import trim as cut
from .trim import uncrossed

POLISH = {"shape_steps": 0, "via": "jump"}  # smallest steps to the angles, in free space
ON = POLISH | {"on_surface": True}
ATTEMPTS = (  # the first good one is taken: on the surface, or near it
    ON,
    ON | {"shape_steps": 2},
    {"shape_steps": 8, "via": "jump", "coupled": True},
)
COARSE = 1000  # triangles: a surface with fewer is divided before it is flattened
FINE = 1e-3  # radians: a net on the surface that is this close is finished in space
GROWN = 1.5  # of the area: a net that grows or shrinks more has folded or collapsed
STAGES = {"check": "checking", "flatten": "flattening", "grid": "laying"}
STAGES |= {"optimise": "optimising", "report": "measuring"}
AWAY = 0.01  # of the diagonal: vertices farther from the surface are not welcome
SLENDER = 0.15  # of the faces: where more are darts or flipped in the grid as lifted, they stay so


class Stopped(ValueError):
    """The caller said stop before there was a net."""


class Ground(NamedTuple):
    """A surface made ready by `ready`: it fits all angles, sizes and directions."""

    surface: repair.Clean
    goal: reference.Reference
    V: np.ndarray  # (n, 3) vertices that were flattened
    flat: flatten.Flat
    domain: overlay.Domain
    seconds: dict  # {stage: seconds}


class Cover(NamedTuple):
    """The net V (n, 3), Q (f, 4), labelled, its `Report`, and what `cover(..., trim=True)` adds.

    >>> from inetlib import examples
    >>> net = cover(*examples.wavy_roof(10), np.radians(70), np.radians(50), count=50)
    >>> net.report.converged, net.report.flips, round(float(np.degrees(net.report.theta.mean)), 6)
    (True, 0, 70.0)"""

    V: np.ndarray
    Q: np.ndarray
    report: Report
    polygons: list = ()  # index arrays: panels that are cut at the boundary, turning like the quads
    edges: dict = None  # {"u": (k, 2), "v": (k, 2)}: where the curves of the net run on, to there


def ready(
    V: np.ndarray,
    F: np.ndarray,
    openings: str | None = None,
    boundary: str = "even",
    progress: bool = False,
    stage: Callable | None = None,
) -> Ground:
    """The surface V (n, 3), F as a `Ground` for `cover(..., known=ground)`; arguments as there."""
    seconds = {}
    begin = partial(_stage, seconds, progress, stage)
    with begin("check"):
        surface = repair.clean(V, F)
        filled = opening.are_filled(openings, surface.loops)
        goal = reference.mesh(surface.V, surface.F)
    with begin("flatten"):
        W, flat = _flatten(surface, filled, boundary)
        domain = overlay.Domain(flat, W)
    return Ground(surface, goal, W, flat, domain, seconds)


def cover(
    V: np.ndarray,
    F: np.ndarray,
    theta: float,
    theta0: float,
    count: int = 1500,
    size: float | None = None,
    direction: float = 0.0,
    *,
    boundary: str = "even",
    openings: str | None = None,
    trim: bool = False,
    along: str | None = None,
    through: ArrayLike | None = None,
    align: ArrayLike | None = None,
    optimise: bool = True,
    tolerance: float = 1e-11,
    progress: bool = False,
    callback: Callable | None = None,
    stage: Callable | None = None,
    known: Ground | None = None,
) -> Cover:
    """The surface V (n, 3), F triangles (f, 3) or quads (f, 4), covered by a net: a `Cover`.

    count, size    about how many quads, or the mean length of their edges instead
    direction      of the u-lines in the flattened surface against its longest direction, or
                   against that around the hole; radians, as theta and theta0
    boundary       "even": sizes as equal as a conformal map allows; "plain": another map of
                   disks; over a ring the u-lines then follow both boundaries (direction=0)
    openings       "fill": a hole is an opening, the curves run on across it; "ring", and None if
                   there is one hole: the net closes around it; more holes are openings
    along          "boundary": u-lines follow the longest stretch of it without corners, as well
                   as one direction in the plane can
    align          (x, y, z): u-lines go that way in space, at the point `through` or else in the
                   middle of the surface; direction adds to this, and to along
    through        (x, y, z): a grid point is the point of the surface nearest to it, and stays
    trim           fill the strip between the whole quads and the boundary, by cut panels
    optimise       move the vertices until the angles are exact up to `tolerance` (else: nearly)
    callback       (step, V, Q) before the first step of the optimisation (step is None) and
                   after every one (`solver.run.Step`); it may return False to stop
    stage          (name) when one begins, one of STAGES, and often in "grid"; it may
                   return False to stop before there is a net: then `Stopped` is raised
    known          the surface, made `ready` before: V, F, boundary and openings are those of it

    The surface is a disk with any number of holes, in one piece; the net has whole quads only
    and leaves less than a quad's width free at the boundary, or cut panels there.  Over a ring it
    closes, with the nearest size and direction for which it can.  ValueError for input that
    cannot be covered, and for quads too slender for the surface; safe repairs are named in the
    report.  Look at `report.converged`: a net that is off is returned, not raised."""
    theta, theta0 = float(theta), float(theta0)
    count, size = _checked(theta, theta0, count, size, direction)
    through, align = steer.check(along, through, align)
    ground = known or ready(V, F, openings, boundary, progress, stage)
    goal, seconds = ground.goal, {} if known else ground.seconds
    begin = partial(_stage, seconds, progress, stage)
    with begin("grid") as ask:
        flat, turn = steer.steered(ground.flat, ground.V, along, through, align)
        moved = flat is not ground.flat
        domain = overlay.Domain(flat, ground.V) if moved else ground.domain
        layer = overlay.cover(domain, theta, theta0, count, size, direction + turn, ask)
        if optimise:  # before the edge is cut, which takes time
            _refuse_slender(layer)
        edge = cut(domain, layer, ask) if trim else None
        layer = edge.layer if trim else layer
    pinned = np.flatnonzero(~layer.ij.any(axis=1)) if through is not None else []
    net, done, words = layer.V, False, "not optimised"
    if optimise:
        with begin("optimise"), BLAS.limit(limits=1, user_api="blas"):  # more only wait
            ways = {"reference": goal, "tolerance": tolerance, "progress": progress}
            ways["fixed"] = pinned if len(pinned) else None
            net, done, words = _optimise(layer, theta, theta0, callback, ways)
    with begin("report"):
        net = _measured(net, layer, edge, theta, theta0, ground, flat)
    words += _away(net.report, ground.surface) if done else ""
    notes = net.report.notes
    if not (through is None or trim or len(pinned)):
        notes += ("no whole quad reaches the point to go through: trim the net, or ask for more",)
    found = {"converged": done, "message": words, "notes": notes, "seconds": seconds}
    return net._replace(report=net.report._replace(**found))


def _checked(theta, theta0, count, size, direction):
    """(count, size) of a grid; ValueError for what is none."""
    parallelogram.ratios(theta, theta0)  # refuses angles out of range
    if not np.isfinite(direction):
        raise ValueError(f"direction = {direction}: a finite angle in radians is wanted")
    if size is None:
        return parallelogram.check_whole("count", count), None
    return count, parallelogram.check_positive("size", size)


def _measured(V, layer, edge, theta, theta0, ground, flat):
    """The `Cover` of the vertices V of a `Layer`; edge: the `Trimmed` one, if not None."""
    Q, polygons, edges, smallest = layer.Q, [], None, None
    if edge is not None:
        V, plain = (np.concatenate([x, edge.extra]) for x in (V, layer.V))
        V, Q, edge = uncrossed(V, plain, Q, edge)
        polygons, edges, smallest = edge.polygons, edge.edges, edge.smallest
    found = survey(V, Q, theta, theta0, ground.goal, flat, polygons)
    known = {"cut_smallest": smallest, "winding": layer.winding}
    found = found._replace(repairs=tuple(ground.surface.repairs), **known)
    return Cover(V, Q, found, polygons, edges)


def _refuse_slender(layer):
    """ValueError where the grid as lifted is no start: no optimisation makes a net of it."""
    flips, darts = (len(f(layer.V, layer.Q)) for f in (measure.flipped, measure.nonconvex))
    if max(flips, darts) > SLENDER * len(layer.Q):
        raise ValueError(
            f"the quads are too slender for this surface: {darts} of {len(layer.Q)} are not "
            "convex on it; angles nearer to 90 degrees, or more quads, are wanted"
        )


def _away(found, surface):
    """What there is to say of a net that is not on its surface."""
    if found.distance_max <= AWAY:
        return ""
    words = f", but up to {100 * found.distance_max:.2g} % of the diagonal off the surface"
    triangles = np.linalg.norm(surface.V[surface.F[:, 1]] - surface.V[surface.F[:, 0]], axis=1)
    coarse = triangles.mean() > found.edge_mean
    return words + (": its triangles are coarser" if coarse else ": ask for more quads")


def _flatten(surface, filled, boundary):
    """(vertices, `Flat`) of the surface, divided where it is coarse; filled: without openings."""
    (W, T, loops), count = surface[:3], len(surface.F)
    if filled:
        W, T = opening.filled(W, T, loops)
        loops = repair.topology(T)
    while len(T) < COARSE:  # the map is linear on each triangle
        W, T = igl.upsample(W, T)
        loops, count = repair.topology(T), 4 * count
    flat = flatten.flatten(W, T, loops, boundary)
    return W, opening.opened(flat, W, count) if filled else flat


@contextmanager
def _stage(seconds, progress, stage, name):
    """A stage of the way, named by a bar while it lasts; gives what asks whether to go on."""

    def ask():
        if stage is not None and stage(name) is False and name != "report":
            raise Stopped(f"stopped while {STAGES[name]}, before there was a net")

    ask()
    shown = progress and name != "optimise"  # that has a bar of its own
    look = {"bar_format": "{desc} ... {elapsed}", "leave": False, "disable": not shown}
    with timed(seconds, name), tqdm(desc=STAGES[name], **look):
        yield ask


def _optimise(layer, theta, theta0, callback, ways):
    """(V, converged, message) of the first attempt that is good, else of the best one."""
    stopped, area, tried = False, area_of(layer.V, layer.Q), []

    def ask(step, V):
        nonlocal stopped
        stopped = callback is not None and callback(step, V, layer.Q) is False
        return not stopped

    common, goal = {**ways, "callback": ask}, ways["reference"]
    if not ask(None, layer.V):
        return layer.V, False, "stopped by the caller before the first step"
    for options in ATTEMPTS:
        result = solver.optimize(layer.V, layer.Q, theta, theta0, **common, **options)
        close = not result.converged and _deviation(result) < FINE
        if close and not stopped:  # facets keep the last digits off
            result = solver.optimize(result.V, layer.Q, theta, theta0, **common, **POLISH)
        on_it = options is ON and not close  # vertices stay on the surface
        tried.append((_faults(result, layer.Q, area, None if on_it else goal), result))
        if stopped or tried[-1][0] <= (False, False, AWAY):
            break
    (folded, *_), result = min(tried, key=lambda attempt: attempt[0])
    if folded:
        return result.V, False, f"the net has folded or collapsed; {result.message}"
    if stopped and not (result.converged or "stopped" in result.message):
        return result.V, False, f"stopped by the caller; the best net so far: {result.message}"
    return result.V, result.converged, result.message


def _faults(result, Q, area, goal):
    """(folded, not converged, how far off in space or else in angles): the smaller the better.

    goal: the `Reference`, None for a net that lies on it."""
    folded = not 1 / GROWN < area_of(result.V, Q) / area < GROWN
    if not result.converged:
        return folded, True, _deviation(result)
    return folded, False, 0.0 if goal is None else goal.distances(result.V).max()


def _deviation(result):
    """The largest deviation of an angle in the net returned, infinite if faces are faulty."""
    return min((step.deviation for step in result.history if not step.key[0]), default=np.inf)
