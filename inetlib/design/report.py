"""What there is to say about a net: numbers in degrees, for a table or for JSON."""

from typing import NamedTuple

import igl
import numpy as np

from .. import measure, mesh, reference


def net(V, Q, polygons=(), wanted=None):
    """The numbers of a labelled net as a dict of plain numbers, angles in degrees.

    wanted: what was asked for, {"theta": 60, "theta0": None, "lam": 1.2, ...}, angles in
    degrees; deviations are from it, or from the mean of the net where it is None or missing.
    "ratios" and "angles" hold `measure.Spread` as dicts; "deviation" is the largest one of
    the two angles, and polygons become their numbers of corners.
    """
    quality = measure.quality(V, Q)
    names = ("lam", "mu"), ("theta", "theta0")
    columns = [measure.ratios(V, Q), np.degrees(measure.angles(V, Q))]
    wanted = {name: (wanted or {}).get(name) for pair in names for name in pair}
    spreads = [
        {
            name: measure.spread(x, wanted.get(name))._asdict()
            for name, x in zip(pair, values, strict=True)
        }
        for pair, values in zip(names, columns, strict=True)
    ]
    return plain(
        {
            "vertices": len(np.unique(Q)),
            "quads": len(Q),
            "polygons": sorted(len(polygon) for polygon in polygons),
            "wanted": wanted,
            "ratios": spreads[0],
            "angles": spreads[1],
            "deviation": max(s["max_deviation"] for s in spreads[1].values()),
            "flips": quality.flips,
            "area_ratio": quality.area_ratio,
            "aspect": quality.aspect,
            "planarity": quality.planarity,
        }
    )


def table(numbers):
    """The numbers of `net` as lines of text."""
    count = f"{numbers['vertices']} vertices, {numbers['quads']} quads"
    if numbers["polygons"]:
        corners = ", ".join(str(n) for n in numbers["polygons"][:8])
        more = ", ..." if len(numbers["polygons"]) > 8 else ""
        count += f"; {len(numbers['polygons'])} other faces, with {corners}{more} corners"
    lines = [count, f"{'':12}{'mean':>15}{'lowest':>15}{'highest':>15}   largest deviation"]
    for name, s in (numbers["ratios"] | numbers["angles"]).items():
        wanted = numbers["wanted"].get(name)
        source = "the mean" if wanted is None else f"{wanted:g}"
        label = f"{name} deg" if name in numbers["angles"] else name
        values = "".join(f"{s[key]:15.9f}" for key in ("mean", "low", "high"))
        lines.append(f"{label:12}{values}   {s['max_deviation']:.3g} from {source}")
    lines.append(
        f"{numbers['flips']} flipped faces, smallest area {numbers['area_ratio']:.3g} of the "
        f"largest, aspect {numbers['aspect']:.3g} at most, planarity {numbers['planarity']:.3g}"
    )
    return "\n".join(lines)


def cover(numbers):
    """What `design.Report` says more than `net`, as lines of text."""
    mean, most = (100 * numbers[f"distance_{name}"] for name in ("mean", "max"))
    low, middle, high = (numbers[f"edge_{name}"] for name in ("low", "mean", "high"))
    return (
        f"distance to the surface {mean:.2g} % of its diagonal on average, {most:.2g} % at most\n"
        f"{100 * numbers['covered']:.0f} % of the surface is covered; edges {low:.3g} to "
        f"{high:.3g}, mean {middle:.3g}\n"
        f"largest quad / smallest {numbers['size_ratio']:.3g}; conformal map: distortion "
        f"{numbers['distortion_mean']:.3f} on average, {numbers['distortion_max']:.3f} at most\n"
        f"{sum(numbers['seconds'].values()):.2f} seconds"
    )


def plain(value):
    """Dicts, lists and Python numbers in place of arrays, tuples and numpy's numbers.

    Numbers that are not finite become None, for JSON.
    """
    if hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, dict):
        return {str(key): plain(x) for key, x in value.items()}
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(x) for x in value]
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


# --- how good a cover of a surface is ---


class Report(NamedTuple):
    """How good a cover is; angles in radians, lengths in those of the surface unless it is said.

    quads            the number of faces; theta, theta0: the angles asked for
    converged        all angles within the tolerance and no face flipped; `message` says it
    max_deviation    of theta and theta0 of any face, mean_deviation over all of them
    flips            flipped faces
    distance_mean, distance_max    from the net's vertices to the surface, as fractions of the
                     surface's bounding-box diagonal
    back_mean, back_max            from the surface's vertices above the net to the net
    covered          area of the net / area of the surface
    edge_low, edge_mean, edge_high lengths of the edges
    size_ratio       longest / shortest d1: how much the similar parallelograms differ in size
    planarity        largest distance between the diagonals of a face over their mean length
    scale_ratio      largest / smallest scale of the conformal map
    distortion_mean, distortion_max  axes of the ellipse that a circle becomes (1 is conformal)
    surface_flips    triangles of the surface flipped by the map
    winding          (k, l): around a ring the net closes after k steps along u and l along v
    repairs          what was repaired in the input, sentences
    seconds          {stage: seconds}
    """

    quads: int
    theta: float
    theta0: float
    converged: bool
    message: str
    max_deviation: float
    mean_deviation: float
    flips: int
    distance_mean: float
    distance_max: float
    back_mean: float
    back_max: float
    covered: float
    edge_low: float
    edge_mean: float
    edge_high: float
    size_ratio: float
    planarity: float
    scale_ratio: float
    distortion_mean: float
    distortion_max: float
    surface_flips: int
    winding: tuple
    repairs: tuple
    seconds: dict


def survey(V, Q, theta, theta0, goal, flat):
    """The measured part of a `Report`, as a dict, of the net V, Q over the reference `goal`.

    theta, theta0: wanted, radians; goal: from `reference.mesh`; flat: from `flatten`.
    """
    found = {"theta": theta, "theta0": theta0} | _angles(V, Q, theta, theta0)
    return found | _distances(V, Q, goal) | _sizes(V, Q, goal) | _map(flat)


def _angles(V, Q, theta, theta0):
    found = measure.angles(V, Q)
    off = np.abs(np.stack(found) - [[theta], [theta0]])
    quality = measure.quality(V, Q)
    return {
        "quads": len(Q),
        "max_deviation": float(off.max()),
        "mean_deviation": float(off.mean()),
        "flips": quality.flips,
        "planarity": quality.planarity,
    }


def _distances(V, Q, goal):
    """Distances both ways; back only from where the closest point is no boundary point."""
    there = np.linalg.norm(goal.closest(V)[0] - V, axis=1) / goal.diagonal
    net = reference.mesh(V, Q)
    back = np.linalg.norm(net.closest(goal.V)[0] - goal.V, axis=1)
    rim = np.linalg.norm(net.boundary(goal.V)[0] - goal.V, axis=1)
    above = back[rim > back + 1e-9 * goal.diagonal] / goal.diagonal
    return {
        "distance_mean": float(there.mean()),
        "distance_max": float(there.max()),
        "back_mean": float(above.mean()) if above.size else 0.0,
        "back_max": float(above.max(initial=0.0)),
    }


def _sizes(V, Q, goal):
    edges = np.linalg.norm(V[Q] - V[np.roll(Q, -1, axis=1)], axis=2)
    d1 = np.linalg.norm(V[Q[:, 2]] - V[Q[:, 0]], axis=1)
    return {
        "covered": area_of(V, Q) / area_of(goal.V, goal.F),
        "edge_low": float(edges.min()),
        "edge_mean": float(edges.mean()),
        "edge_high": float(edges.max()),
        "size_ratio": float(d1.max() / d1.min()),
    }


def area_of(V, F):
    """The area of triangles (f, 3) or quads (f, 4), cut along their shorter diagonals."""
    return float(igl.doublearea(*mesh.triangles(V, F)).sum() / 2)


def _map(flat):
    return {
        "scale_ratio": float(flat.scale.max() / flat.scale.min()),
        "distortion_mean": float(flat.distortion.mean()),
        "distortion_max": float(flat.distortion.max()),
        "surface_flips": flat.flips,
    }


def describe(report):
    """The `Report` in lines of text, angles in degrees, distances in % of the diagonal."""
    r, degrees = report, np.degrees
    lines = [
        *(f"input: {words}" for words in r.repairs),
        f"{r.quads} quads, theta = {degrees(r.theta):g}, theta0 = {degrees(r.theta0):g} degrees: "
        + r.message,
        f"angles: at most {degrees(r.max_deviation):.2g} degrees off, "
        f"{degrees(r.mean_deviation):.2g} on average; {r.flips} flipped faces",
        f"to the surface: {100 * r.distance_mean:.4f} % of the diagonal on average, "
        f"{100 * r.distance_max:.4f} % at most; back: {100 * r.back_mean:.4f} %, "
        f"{100 * r.back_max:.4f} %",
        f"covers {100 * r.covered:.1f} % of the surface; edges {r.edge_low:.4g} to "
        f"{r.edge_high:.4g}, {r.edge_mean:.4g} on average; largest quad / smallest: "
        f"{r.size_ratio:.3g}",
        f"planarity: the diagonals of a quad pass at {100 * r.planarity:.3g} % of their length "
        "at most",
        f"conformal map: distortion {r.distortion_mean:.3f} on average, {r.distortion_max:.3f} at "
        f"most, scale varies by {r.scale_ratio:.3g}, {r.surface_flips} flipped triangles",
    ]
    if r.winding != (0, 0):
        lines.append(f"around the hole: {r.winding[0]} steps along u and {r.winding[1]} along v")
    return "\n".join([*lines, f"{sum(r.seconds.values()):.2f} seconds"])
