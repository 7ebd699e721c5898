"""What there is to say about a net: numbers in degrees, for a table or for JSON.

Paper: Sec. 6.3 (statistics; beyond the paper).
"""

import numpy as np

from . import measure


def net(V, Q, polygons=(), wanted=None):
    """The numbers of a labelled net as a dict of plain numbers, angles in degrees.

    wanted: what was asked for, {"theta": 60, "theta0": None, "lam": 1.2, ...}, angles in
    degrees; deviations are from it, or from the mean of the net where it is None or missing.
    "ratios" and "angles" hold `measure.Spread` as dicts; "deviation" is the largest one of
    the two angles, and polygons become their numbers of corners.

    Paper: Sec. 6.3 (statistics; beyond the paper).
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
    """The numbers of `net` as lines of text.

    Paper: Sec. 6.3 (statistics; beyond the paper).
    """
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
    """What `design.Report` says more than `net`, as lines of text.

    Paper: Sec. 6.2 (beyond the paper).
    """
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

    Paper: Sec. 6.3 (statistics; beyond the paper).
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
