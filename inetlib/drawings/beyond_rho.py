"""The half plane of rho = X_v / X_u: one point is a parallelogram, its angles and its 4-web."""

import numpy as np

from .. import parallelogram, plot
from ..plot import COLOURS, DEGREE
from . import drawn
from .abcd import net

ANGLES = [30, 60, 90, 120, 150]  # the arcs and rays drawn, degrees
RATIOS = [2.5, 1.6, 1, 1 / 1.6, 1 / 2.5]  # the circles of mu drawn, of lam without 1
SPECIAL = {  # degrees: the label and its place, right or left of the point
    (90, 90): ("squares", 1),
    (90, 60): ("3-web (90,60)", 1),
    (90, 120): ("3-web (90,120)", -1),
    (60, 90): ("3-web (60,90)", -1),
    (120, 90): ("3-web (120,90)", 1),
    (45, 45): ("(45,45)", 1),
    (60, 60): ("(60,60)", 1),
}
WIDE, HIGH = 2.45, 2.3  # the window
EQUAL = "#7b2d8b"


def mu_circle(mu):
    """Centre and radius of the circle of all rho with this mu.  Paper: B2."""
    return 0 * mu, 1 / mu


def lam_circle(lam):
    """Centre and radius of the circle of all rho with this lam, not 1.  Paper: B2."""
    if np.any(lam == 1):
        raise ValueError("lam = 1: the imaginary axis, no circle")
    return (lam**2 + 1) / (lam**2 - 1), 2 * lam / abs(lam**2 - 1)


def theta_circle(theta):
    """Height of the centre and radius of the circle; its upper arc has this theta.  Paper: B2."""
    xp = parallelogram.library(theta)
    return -xp.cos(theta) / xp.sin(theta), 1 / xp.sin(theta)


def equal_circle():
    """Centre and radius of the circle of all rho with theta = theta0, lam = mu.  Paper: B2."""
    return -1, np.sqrt(2)


@drawn()
def draw(rho=0.95 + 1.15j):
    """The half plane with its four families and special points, and what one point rho means.

    rho: complex, in the upper half plane, else ValueError.  (A) the circles of mu and lam, the
    rays of theta0 and the arcs of theta; bold those through rho.  (B) the quad of rho with its
    parallelogram.  (C) its four directions, a harmonic pencil, and the gaps between them.
    Paper: B2, B10."""
    shape = parallelogram.from_rho(rho)
    figure, axes = plot.canvas([["A", "B"], ["A", "C"]], 7.4, 3.75, [2.45, 1])
    half_plane(axes["A"], rho)
    quad(axes["B"], rho)
    web(axes["C"], rho)
    plot.panel(axes["A"], "A", r"the half plane of $\rho=X_v/X_u=e^{i\theta_0}/\mu$")
    plot.panel(axes["B"], "B", "its quad")
    plot.panel(axes["C"], "C", "its 4-web")
    lines = parallelogram.directions(rho)
    ratio = parallelogram.cross_ratio(lines[0], lines[2], lines[1], lines[3])
    claims = shape._asdict() | {"cross ratio": ratio}
    data = {"rho": np.array([rho]), "directions": np.array(lines), "special": special()}
    d1, d2 = 1 - rho, 1 + rho
    corners = np.array([d2, 0, d1, d1 + d2])
    return figure, data, [net(corners, shape.theta, shape.theta0)], claims


def explore(theta=60, theta0=45):
    """The figure of one pair of angles in degrees, for `ipywidgets.interact`; returns it.

    Paper: B2."""
    lam, mu = parallelogram.ratios(theta * DEGREE, theta0 * DEGREE)
    return draw(complex(parallelogram.rho(lam, mu))).figure


def special():
    """The special points rho, complex, in the order of their list.  Paper: B2, B10."""
    theta, theta0 = np.transpose(list(SPECIAL)) * DEGREE
    return parallelogram.rho(*parallelogram.ratios(theta, theta0))


def half_plane(ax, rho):
    """The families of circles and rays, those through rho bold, and the special points.

    Paper: B2."""
    ax.set(xlim=(-WIDE, WIDE), ylim=(-0.34, HIGH), autoscale_on=False)
    thin = [("u", _half(*mu_circle(ratio))) for ratio in RATIOS]
    thin += [("d1", _half(*lam_circle(ratio))) for ratio in RATIOS if ratio != 1]
    for angle in ANGLES:
        thin += [("v", _ray(angle * DEGREE)), ("d2", _arc(angle * DEGREE))]
    for family, z in thin:
        plot.curves(ax, [z], COLOURS[family], 0.6)
    centre, radius = equal_circle()
    plot.curves(ax, [_half(centre, radius)], EQUAL, 1.3, (0, (4, 2)), zorder=3)
    place, words = centre + radius * np.exp(1.97j), r"$\theta=\theta_0$"
    plot.text(ax, place, words, 8, 2.5, EQUAL, zorder=8)
    ax.plot([-WIDE, WIDE], [0, 0], color=plot.INK, lw=0.9)
    for x in (-1, 0, 1):
        ax.plot(x, 0, "o", color=plot.INK, ms=3)
        ax.text(x, -0.06, f"${x}$", ha="center", va="top", size=8)
    for z, (label, side) in zip(special(), SPECIAL.values(), strict=True):
        marker = "s" if label == "squares" else "^" if "web" in label else "o"
        ax.plot(z.real, z.imag, marker, color=plot.INK, mfc="white", ms=5.5, zorder=7)
        ha = "left" if side > 0 else "right"
        plot.text(ax, z + 0.09 * side, label, 7.5, 2.5, plot.INK, zorder=8, ha=ha)
    _chosen(ax, rho)


def _half(centre, radius):
    return centre + radius * np.exp(1j * np.linspace(0, np.pi, 241))


def _ray(theta0):
    return np.array([0j, 4 * np.exp(1j * theta0)])


def _arc(theta):
    height, radius = theta_circle(theta)
    start = np.arctan2(-height, np.sqrt(max(radius**2 - height**2, 0)))
    return 1j * height + radius * np.exp(1j * np.linspace(start, np.pi - start, 241))


def _chosen(ax, rho):
    """The point rho and its four curves, with their values at the edges of the window."""
    lam, mu, theta, theta0 = parallelogram.from_rho(rho)
    straight = abs(lam - 1) <= 1e-9
    last = np.array([0, 4j]) if straight else _half(*lam_circle(lam))
    bold = {"u": _half(*mu_circle(mu)), "v": _ray(theta0), "d2": _arc(theta)}
    for family, z in (bold | {"d1": last}).items():
        plot.curves(ax, [z], COLOURS[family], 2, zorder=4)
    ax.plot(rho.real, rho.imag, "o", color=plot.INK, ms=7, mec="white", zorder=9)
    texts = {
        "u": rf"$\mu={mu:.3f}$",
        "v": rf"$\theta_0={theta0 / DEGREE:.1f}\degree$",
        "d1": rf"$\lambda={lam:.3f}$",
        "d2": rf"$\theta={theta / DEGREE:.1f}\degree$",
    }
    for k, (name, text) in enumerate(texts.items()):
        x = WIDE * (-0.96 + 0.52 * k)
        ax.plot([x, x + 0.2], 2 * [-0.27], color=COLOURS[name], lw=2, clip_on=False)
        ax.text(x + 0.26, -0.27, text, va="center", size=9)


def quad(ax, rho):
    """A quad with the diagonals d1, d2 and medial lines of rho, and its parallelogram.

    Paper: B2."""
    d1, d2 = 1 - rho, 1 + rho
    middle = 0.08 * d1 - 0.1 * d2  # where the diagonals cross, off the middle: no parallelogram
    v = np.array([-d1 / 2 - middle, -d2 / 2 + middle, d1 / 2 - middle, d2 / 2 + middle])
    v = v / np.abs(v).max()
    middles = (v + np.roll(v, -1)) / 2
    plot.polygons(ax, v, [[0, 1, 2, 3]], "#f0f2f5", plot.INK, 1.0)
    plot.polygons(ax, middles, [[0, 1, 2, 3]], plot.FILL, plot.INK, 0.6)
    lines = {"d1": v[[0, 2]], "d2": v[[1, 3]], "v": middles[[1, 3]], "u": middles[[0, 2]]}
    for family, line in lines.items():
        plot.curves(ax, [line], COLOURS[family], 1.6, zorder=4)
    ax.margins(0.08)


def web(ax, rho):
    """The four lines of the pencil with their names, and the four gaps in degrees.  Paper: B10."""
    lines = np.array(parallelogram.directions(rho))
    lines = lines / np.abs(lines) * np.where(lines.imag < 0, -1, 1)
    names = {"u": "$X_u$", "d2": "$Y_v$", "v": "$X_v$", "d1": "$Y_u$"}
    for z, (family, name) in zip(lines, names.items(), strict=True):
        plot.curves(ax, [[-0.35 * z, z]], COLOURS[family], 1.8)
        plot.text(ax, 1.17 * z, name, 9)
    shape = parallelogram.from_rho(rho)
    gaps = np.array(parallelogram.gaps(shape.lam, shape.mu)) / DEGREE
    ends = np.append(lines, -1)
    for a, b, gap in zip(ends[:-1], ends[1:], gaps, strict=True):
        middle = np.sqrt(a * b) * np.sign(np.sqrt(a * b).imag)
        plot.angle(ax, (0, 0), plot.plane(a), plot.plane(b), 0.42)
        plot.text(ax, (0.6 if gap > 25 else 0.82) * middle, rf"${gap:.1f}\degree$", 7)
    plot.curves(ax, [[-1 + 0j, 0]], COLOURS["u"], 0.9, ":")
    alpha, beta = (rf"{gap:.1f}\degree" for gap in gaps[[0, 3]])
    ax.text(0.05, -0.55, rf"$\alpha={alpha},\ \beta={beta}$", size=8, ha="center")
    ax.set(xlim=(-1.2, 1.4), ylim=(-0.6, 1.3))
