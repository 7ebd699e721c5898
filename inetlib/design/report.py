"""The numbers of a net, made in one place: angles, shape, and how well it covers a surface."""

from collections.abc import Sequence
from typing import NamedTuple

import igl
import numpy as np

from .. import measure, mesh, panels, ties
from ..reference import Reference
from .flatten import Flat

NAMES = "lam", "mu", "theta", "theta0"
SHAPE = "flips", "darts", "corner", "area_ratio", "aspect", "planarity"
COVERED = 0.8  # of the surface: a net that leaves out more says so
FAR = 2  # longest edges between the net and a part of the surface that is left out
FOLDED = 1.05  # times the area of the surface: a net with more lies over itself
SHOWN = 20  # panels that are named at most
SHRUNK = 20  # scales of the map that differ more leave parts out, however small the quads


class Report(NamedTuple):
    """The numbers of a net; angles in radians, lengths in the unit of V.

    Deviations are from what was asked for, or from the mean.  What comes from `converged` on is
    None unless the net covers a surface (`design.cover`); its bounding box gives the diagonal."""

    vertices: int  # those of faces only
    quads: int
    polygons: tuple  # corners of the other faces
    wanted: dict  # {"lam", "mu", "theta", "theta0"}: what was asked for, None where nothing was
    lam: measure.Spread  # over the faces, as the next three
    mu: measure.Spread
    theta: measure.Spread
    theta0: measure.Spread
    flips: int  # this and the next five: see `measure.quality`
    darts: int
    corner: float
    area_ratio: float
    aspect: float
    planarity: float
    edge_low: float
    edge_mean: float
    edge_high: float
    size_ratio: float  # longest / shortest d1: how much the similar parallelograms differ in size
    smallest: tuple  # the middle (x, y, z) of the first quad with the shortest d1
    largest: tuple  # the same of the longest
    converged: bool = None  # all angles within the tolerance, no face flipped or a dart
    message: str = None  # the same in words
    distance_mean: float = None  # from the net's vertices to the surface, in diagonals
    distance_max: float = None
    back_mean: float = None  # from the surface's vertices above the net to the net, in diagonals
    back_max: float = None
    covered: float = None  # area of the net / area of the surface
    cut_smallest: float = None  # area of the smallest cut panel / that of a quad, in the plane
    scale_ratio: float = None  # largest / smallest scale of the conformal map
    distortion_mean: float = None  # axes of the ellipse that a circle becomes (1 is conformal)
    distortion_max: float = None
    surface_flips: int = None  # triangles of the surface flipped by the map
    winding: tuple = None  # (k, l): around a ring the net closes after k steps along u, l along v
    notes: tuple = None  # what is left out of the surface, where and why, sentences
    repairs: tuple = None  # what was repaired in the input, sentences
    seconds: dict = None  # {stage: seconds}

    @property
    def max_deviation(self):
        """The largest deviation of theta and theta0 of any face, radians."""
        return max(self.theta.max_deviation, self.theta0.max_deviation)


def report(
    V: np.ndarray,
    Q: np.ndarray,
    polygons: Sequence = (),
    lam: float | None = None,
    mu: float | None = None,
    theta: float | None = None,
    theta0: float | None = None,
) -> Report:
    """The `Report` of a labelled net V (n, 3), Q (f, 4).

    polygons: faces that are no quads; lam, mu, theta, theta0 (radians): what was asked for.
    ValueError where a face has collapsed."""
    wanted = dict(zip(NAMES, (lam, mu, theta, theta0), strict=True))
    spreads = map(measure.spread, measure.faces(V, Q), wanted.values())
    quality = measure.quality(V, Q)
    shape = (getattr(quality, name) for name in SHAPE)
    edges = np.linalg.norm(V[Q] - V[np.roll(Q, -1, axis=1)], axis=2)
    d1 = np.linalg.norm(measure.vectors(V, Q)[0], axis=1)
    sizes = map(float, (edges.min(), edges.mean(), edges.max(), d1.max() / d1.min()))
    ends = ties.first_smallest(d1), ties.first_largest(d1)
    where = (tuple(V[Q[k]].mean(axis=0).tolist()) for k in ends)
    vertices = int(np.count_nonzero(np.bincount(np.concatenate([Q.ravel(), *polygons]))))
    counts = vertices, len(Q), tuple(sorted(map(len, polygons)))
    known = (*counts, wanted, *spreads, *shape, *sizes, *where)
    return Report(*known)


def survey(
    V: np.ndarray,
    Q: np.ndarray,
    theta: float,
    theta0: float,
    goal: Reference,
    flat: Flat,
    polygons: Sequence = (),
) -> Report:
    """The `Report` of the net V, Q and its cut panels over the `Reference` goal, flattened to
    the `Flat` flat."""
    there = goal.distances(V)
    net, fans = report(V, Q, polygons, theta=theta, theta0=theta0), [mesh.triangles(V, Q)[1]]
    fans += [np.stack([np.full(len(p) - 2, p[0]), p[1:-1], p[2:]], axis=1) for p in polygons]
    T = np.concatenate(fans)
    sides = [np.stack(mesh.half_edges(Q)), *(np.stack([p, np.roll(p, -1)]) for p in polygons)]
    (start, end), n = np.concatenate(sides, axis=1), len(V)
    alone = ~np.isin(start * n + end, end * n + start, assume_unique=True)
    outline = np.stack([start, end], axis=1)[alone]
    back, rim = (np.sqrt(igl.point_mesh_squared_distance(goal.V, V, x)[0]) for x in (T, outline))
    above = back[rim > back + 1e-9 * goal.diagonal] / goal.diagonal  # not beside the net
    cut = sum(float(np.linalg.norm(panels.area_vectors(V[p][None]))) for p in polygons)
    covered = (float(igl.doublearea(V, fans[0]).sum() / 2) + cut) / area_of(goal.V, goal.F)
    notes, holes = [], len(mesh.boundary_loops(Q)) - len(mesh.boundary_loops(goal.F))
    scale_ratio = float(flat.scale.max() / flat.scale.min())
    gaps = holes > 0 or back.max() > FAR * net.edge_high
    if covered < COVERED or (gaps and not polygons):
        why = "the quads are large for its width, ask for more"
        if scale_ratio > SHRUNK:
            why = f"the map to the plane has scales {scale_ratio:.3g} times apart, cut the surface"
        far, gaps = np.argmax(back), f" and the net has {holes} holes" if holes > 0 else ""
        part = f"{100 - 100 * covered:.0f} %" if covered < 1 else "a part"
        notes.append(
            f"{part} of the surface is left out{gaps}, farthest near "
            f"{mesh.place(goal.V[far])}, {100 * back[far] / goal.diagonal:.2g} % of its diagonal "
            f"from the net: {why}"
        )
    return net._replace(
        distance_mean=float(there.mean()),
        distance_max=float(there.max()),
        back_mean=float(above.mean()) if above.size else 0.0,
        back_max=float(above.max(initial=0.0)),
        covered=covered,
        scale_ratio=scale_ratio,
        distortion_mean=float(flat.distortion.mean()),
        distortion_max=float(flat.distortion.max()),
        surface_flips=flat.flips,
        notes=tuple(notes),
    )


def out_of_plane(V: np.ndarray, Q: np.ndarray, polygons: Sequence, beyond: float) -> dict:
    """The panels whose planarity (`panels.Shapes`) is larger than the length `beyond`, for JSON.

    beyond, count, and panels: of the 20 worst, the worst first, number as in `schedule`, from 1
    on and quads first, planarity and place.  ValueError for panels without area."""
    shape = panels.shapes(V, [*Q, *polygons])
    found = np.flatnonzero(~ties.at_most(shape.planarity, beyond))
    rank = ties.ranks(-shape.planarity[found], ties.TIE * beyond)
    worst = [
        {"panel": k + 1, "planarity": float(shape.planarity[k]), "place": shape.centre[k].tolist()}
        for k in found[np.argsort(rank, kind="stable")[:SHOWN]].tolist()
    ]
    return {"beyond": beyond, "count": len(found), "panels": worst}


def area_of(V: np.ndarray, F: np.ndarray) -> float:
    """The area of triangles (f, 3) or quads (f, 4), cut along their shorter diagonals."""
    return float(igl.doublearea(*mesh.triangles(V, F)).sum() / 2)


def numbers(report: Report) -> dict:
    """The `Report` as a dict for JSON, angles in degrees; what does not apply is left out."""
    r, out = report, (*NAMES, "notes", "repairs")
    covers = r.converged is not None
    plain = {k: x for k, x in r._asdict().items() if k not in out and (covers or x is not None)}
    plain["wanted"] = {k: x if x is None else _shown(k, x) for k, x in r.wanted.items()}
    spreads = {k: {n: _shown(k, x) for n, x in getattr(r, k)._asdict().items()} for k in NAMES}
    plain["ratios"] = {k: spreads[k] for k in NAMES[:2]}
    plain["angles"] = {k: spreads[k] for k in NAMES[2:]}
    degrees = {"corner": r.corner, "deviation": r.max_deviation}
    return plain | {name: float(np.degrees(x)) for name, x in degrees.items()}


def _shown(name, x):
    return float(np.degrees(x)) if name.startswith("theta") else x


def text(report: Report) -> str:
    """The `Report` as lines of text, angles in degrees."""
    r, lines = report, [f"{report.vertices} vertices, {report.quads} quads"]
    if r.cut_smallest is not None:
        share = f"the smallest {r.cut_smallest:.2f} of a quad"
        lines[0] = f"{r.vertices} vertices, {r.quads} whole quads, {len(r.polygons)} cut panels, "
        lines[0] += share if r.polygons else "there is no need for them"
    elif r.polygons:
        corners = ", ".join(map(str, r.polygons[:8])) + ", ..." * (len(r.polygons) > 8)
        lines[0] += f"; {len(r.polygons)} other faces, with {corners} corners"
    lines += [f"{'':12}{'mean':>15}{'lowest':>15}{'highest':>15}   largest deviation"]
    for name in NAMES:
        spread, wanted = getattr(r, name), r.wanted[name]
        mean, low, high, most, _ = (_shown(name, x) for x in spread)
        source = "the mean" if wanted is None else f"{_shown(name, wanted):g}"
        label = f"{name} deg" if name.startswith("theta") else name
        lines.append(f"{label:12}{mean:15.9f}{low:15.9f}{high:15.9f}   {most:.3g} from {source}")
    lines.append(
        f"{r.flips} flipped faces, {r.darts} darts, smallest corner {np.degrees(r.corner):.3g} "
        f"degrees, smallest area {r.area_ratio:.3g} of the largest, aspect {r.aspect:.3g} at "
        f"most, planarity {r.planarity:.3g}"
    )
    lines.append(_sizes(r))
    if r.distance_mean is not None:
        lines += [
            f"distance to the surface {100 * r.distance_mean:.2g} % of its diagonal on average, "
            f"{100 * r.distance_max:.2g} % at most"
        ]
    if r.converged is not None:
        lines[-1] += f"; back from it {100 * r.back_max:.2g} % at most"
        lines += [
            f"{_covered(r)}; edges {r.edge_low:.3g} to {r.edge_high:.3g}, mean {r.edge_mean:.3g}",
            f"conformal map: distortion {r.distortion_mean:.3f} on average, "
            f"{r.distortion_max:.3f} at most",
            f"{sum(r.seconds.values()):.2f} seconds",
        ]
    return "\n".join(lines)


def _covered(r):
    """How much of the surface is covered, or that the net is in folds."""
    if r.covered > FOLDED:
        return f"the net is in folds: its faces have {r.covered:.3g} times the area of the surface"
    return f"{100 * min(r.covered, 1):.0f} % of the surface is covered"


def _sizes(r):
    """Where quads are smallest and largest, and how many would have to be there instead."""
    if ties.at_most(r.size_ratio, 1):
        return "all quads are of one size"
    wanted = float(f"{r.quads * r.size_ratio**2:.3g}")
    return (
        f"quads are smallest near {mesh.place(r.smallest)} and {r.size_ratio:.3g} times as large "
        f"near {mesh.place(r.largest)}: with about {wanted:.10g} quads, not {r.quads}, none would "
        "be larger than the smallest is now"
    )


def bent_text(found: dict) -> str:
    """What `out_of_plane` has found, a line a panel."""
    lines = [f"panels more than {found['beyond']:g} out of plane: {found['count']}"]
    lines[0] += f", the worst {SHOWN} of them:" * (found["count"] > SHOWN)
    for one in found["panels"]:
        where = mesh.place(one["place"])
        lines.append(f"panel {one['panel']}: {one['planarity']:.3g} near {where}")
    return "\n".join(lines)
