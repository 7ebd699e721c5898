"""Small drawings of the explorer as SVG text: the parallelogram, two histograms, a profile.

Lines are drawn in the page's own colours: `currentColor`, and the classes u, v, d1, d2."""

from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from .. import measure
from ..design.report import Report
from ..parallelogram import ratios
from ..surfaces import spline_profile
from .choices import HEIGHTS

BOX = 270, 150  # of the parallelogram and the histograms, in pixels
NAMES = "\u03b8", "\u03b8\u2080"
BINS = 27
EXACT = 1e-9  # degrees: smaller deviations are rounding


def parallelogram(theta: float, theta0: float) -> str:
    """The parallelogram of the angles (radians), sides as d1 and d2, diagonals as u and v."""
    slanted = ratios(theta, theta0)[0] * np.exp(1j * theta)
    words = f"parallelogram with the angle {np.degrees(theta):.4g} degrees"
    return _inscribed(np.array([slanted, 0, 1, 1 + slanted]) - (1 + slanted) / 2, words)


def face(corners: np.ndarray) -> str:
    """A quad (4, 3) seen along d1 x d2, d1 to the right, and in it its parallelogram."""
    d1, d2 = corners[2] - corners[0], corners[3] - corners[1]
    right = d1 / np.linalg.norm(d1)
    up = d2 - (d2 @ right) * right
    flat = (corners - corners.mean(axis=0)) @ np.stack([right, up / np.linalg.norm(up)], axis=1)
    z = flat @ np.array([1, 1j])
    return _inscribed((np.roll(z, 1) + z) / 2, "a face and its inscribed parallelogram", z)


def _inscribed(shape, words, around=()):
    """A parallelogram A, B, C, D about 0, and the quad v1, ..., v4 that it is inscribed in."""
    centre, every = complex(*BOX) / 2, np.concatenate([shape, around])
    margin = np.array([60, 44]) if len(around) == 0 else 16
    scale = np.min((np.array(BOX) - margin) / (np.ptp(every.real), np.ptp(every.imag)))
    centre -= scale * complex(_middle(every.real), -_middle(every.imag))
    A, B, C, D = centre + scale * shape.conj()
    corners = centre + scale * np.conj(around)
    least = min(abs(C - B), abs(A - B))
    parts = [_line(*side, "vu"[k % 2], 2) for k, side in enumerate(_sides(corners))]
    parts += [_line(A, C, "v", 1.5), _line(B, D, "u", 1.5)]
    parts += [_line(*side, "d1", 3) for side in ((B, C), (A, D))]
    parts += [_line(*side, "d2", 3) for side in ((B, A), (C, D))]
    parts.append(_arc(B, C - B, A - B, min(26, 0.45 * least), NAMES[0], D - B))
    reach = min(22, 0.4 * abs(D - centre))
    parts.append(_arc(centre, D - centre, A - centre, reach, NAMES[1]))
    return _svg(BOX, parts, words)


def _middle(x):
    return (x.min() + x.max()) / 2


def _sides(corners):
    return zip(corners, np.roll(corners, -1), strict=True)


def histograms(off: Sequence[np.ndarray], asked: tuple[float, float]) -> str:
    """How far two angles are off those asked for, each (f,), degrees: histograms, one scale."""
    reach = _nice(max(EXACT, *(np.abs(x).max() for x in off)))
    left, middle, right = 10, BOX[0] / 2, BOX[0] - 10
    parts, wide = [], (right - left) / BINS
    for row, (values, name, angle) in enumerate(zip(off, NAMES, asked, strict=True)):
        base = 58 + 70 * row
        count, _ = np.histogram(np.clip(values, -reach, reach), BINS, (-reach, reach))
        for k in np.flatnonzero(count):
            high = max(1.5, 40 * count[k] / count.max())
            box = f'x="{left + k * wide:.1f}" y="{base - high:.1f}" width="{wide - 1:.1f}"'
            parts.append(f'<rect class="bar{row}" {box} height="{high:.1f}"/>')
        parts.append(_line(complex(left, base), complex(right, base), "axis", 1))
        parts.append(_text(left, base - 46, f"{name} \u2212 {angle:.6g}\u00b0", "start"))
    for x, value, anchor in ((left, -reach, "start"), (middle, 0, "middle"), (right, reach, "end")):
        parts.append(_text(x, BOX[1] - 6, f"{short(value, 1)}\u00b0", anchor))
    return _svg(BOX, parts, "histograms of the deviations of both angles")


def _nice(x):
    """The next of 1, 2, 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(x))
    return float(f"{next(k for k in (1, 2, 5, 10) if x <= k * power * (1 + 1e-12)) * power:.0e}")


def profile(radii: Sequence[float]) -> str:
    """The meridian with its radii, the axis at the left."""
    box, points = (110, 150), list(zip(radii, HEIGHTS, strict=True))
    scale = min((box[0] - 16) / max(1.3, 1.1 * max(radii)), (box[1] - 16) / HEIGHTS[-1])
    corner = complex(8, box[1] - 8)
    parts = [_line(8 + 4j, complex(8, box[1] - 4), "axis", 1)]
    with suppress(ValueError):  # the page says why there is no net
        curve = spline_profile(points)
        t = np.linspace(curve.start, curve.stop, 81)
        parts.append(_curve(corner + scale * (curve.radius(t) - 1j * curve.height(t)), 2))
    for radius, height in points:
        at = corner + scale * complex(radius, -height)
        parts.append(f'<circle class="dot" cx="{at.real:.1f}" cy="{at.imag:.1f}" r="3.5"/>')
    return _svg(box, parts, "profile")


def short(x: float, digits: int = 2) -> str:
    """A number with so many digits, in few characters: 0.25, 4.3e-13, with a true minus."""
    text = f"{x:.{digits}g}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")
    return text.replace("-", "\u2212")


def numbers(about: Report, V: np.ndarray, Q: np.ndarray) -> dict[str, str]:
    """A `Report` on the net V, Q as the page shows it, angles in degrees: a dict of texts."""
    theta, theta0 = about.wanted["theta"], about.wanted["theta0"]
    lam, mu = ratios(theta, theta0)
    medial = np.linalg.norm(measure.vectors(V, Q)[2:], axis=2)
    over = _named(about) | ({} if about.covered is None else _covering(about))
    quads, cut = (f"{x:,}".replace(",", "\u2009") for x in (about.quads, len(about.polygons)))
    return over | {
        "quads": quads,
        "cut": cut,
        "lam": f"{lam:.5g}",
        "mu": f"{mu:.5g}",
        "mean_theta": f"{np.degrees(about.theta.mean):.6f}",
        "mean_theta0": f"{np.degrees(about.theta0.mean):.6f}",
        "theta_off": short(np.degrees(about.theta.max_deviation)),
        "theta0_off": short(np.degrees(about.theta0.max_deviation)),
        "flips": str(about.flips),
        "darts": str(about.darts),
        "size_low": short(medial.min(), 3),
        "size_high": short(medial.max(), 3),
        "theta": f"{np.degrees(theta):.10g}",
        "theta0": f"{np.degrees(theta0):.10g}",
    }


def _named(about):
    """What the faces are called that the numbers are of, and the others, where there are any."""
    if not about.polygons:
        return {"faces": "faces", "others": ""}
    if about.cut_smallest is None:
        return {"faces": "quads", "others": "other faces"}
    return {"faces": "whole faces", "others": "panels cut at the edge"}


def _covering(about):
    """How well a net covers its surface, in percent of its area and its diagonal."""
    return {
        "covered": f"{100 * about.covered:.3g}",
        "distance": short(100 * about.distance_max),
        "distance_mean": short(100 * about.distance_mean),
    }


def _svg(box, parts, words):
    about = f'viewBox="0 0 {box[0]} {box[1]}" role="img" aria-label="{words}"'
    return f'<svg {about} xmlns="http://www.w3.org/2000/svg">{"".join(parts)}</svg>'


def _line(a, b, kind, width):
    ends = f'x1="{a.real:.1f}" y1="{a.imag:.1f}" x2="{b.real:.1f}" y2="{b.imag:.1f}"'
    return f'<line class="{kind}" stroke-width="{width}" stroke-linecap="round" {ends}/>'


def _curve(points, width):
    xy = " ".join(f"{p.real:.1f},{p.imag:.1f}" for p in points)
    return f'<polyline class="line" stroke-width="{width}" fill="none" points="{xy}"/>'


def _text(x, y, words, anchor="middle"):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{words}</text>'


def _arc(apex, start, end, radius, label, line=None):
    """An arc around the apex from the direction start to the direction end, and its name, on the
    wider side of a line between them if there is one."""
    t = start / abs(start) * np.exp(1j * np.linspace(0, np.angle(end / start), 24))
    sides = [(start, end)] if line is None else [(start, line), (line, end)]
    one, two = max(sides, key=lambda side: round(abs(np.angle(side[1] / side[0])), 6))
    at = apex + (radius + 11) * one / abs(one) * np.exp(0.5j * np.angle(two / one))
    x, y = np.clip(at.real, 8, BOX[0] - 8), np.clip(at.imag, 8, BOX[1] - 6)
    return _curve(apex + radius * t, 1.2) + _text(x, y + 4, label)
