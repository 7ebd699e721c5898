"""Fig. 4: the mid-edge parallelogram inside a quad in space."""

import numpy as np

from .. import measure, parallelogram, plot, raster
from ..plot import COLOURS, DEGREE, INK
from . import drawn

GAP = np.array([0.3, -0.5, 0.7])  # from the midpoint of v2 v4 to that of v1 v3
FACE = np.array([[0, 1, 2, 3]])
GROUND = -0.75  # height of the ground; the parallelogram is at 0
LEFT, SIXTY, VIEW = (80 * DEGREE, 55 * DEGREE), 60 * DEGREE, (-100 * DEGREE, 42 * DEGREE)


@drawn("theta", "theta0", "alone", "azimuth", "elevation")
def draw(theta=LEFT[0], theta0=LEFT[1], alone=SIXTY, azimuth=VIEW[0], elevation=VIEW[1]):
    """Two quads in space, seen from outside, each with its inscribed parallelogram.

    theta, theta0: angles of the left quad; alone: both angles of the right one; azimuth,
    elevation: the camera; all in radians.  Paper: Fig. 4."""
    figure, axes = plot.canvas([["A", "B"]], 7.2, 2.9)
    view = plot.camera(azimuth, elevation)
    data, nets, claims = {}, [], {}
    one, two, both = (plot.degrees(angle) for angle in (theta, theta0, alone))
    titles = {"A": rf"$\theta={one}$, $\theta_0={two}$", "B": rf"$\theta=\theta_0={both}$"}
    for name, asked in (("A", (theta, theta0)), ("B", (alone, alone))):
        V = _quad(*asked)
        lam, mu = (x[0] for x in measure.ratios(V, FACE))
        _panel(axes[name], view, V)
        plot.panel(axes[name], name, rf"{titles[name]}:  $\lambda={lam:.3f}$, $\mu={mu:.3f}$")
        nets.append((V, FACE, *asked))
        data[name] = V
        claims |= {f"lam_{name}": lam, f"mu_{name}": mu}
    corners = view(np.concatenate(list(data.values())))[0]
    for ax in axes.values():
        ax.update_datalim([corners.min(axis=0) - 0.2, corners.max(axis=0) + 0.2])
        ax.autoscale_view()
    return figure, data, nets, claims


def _quad(theta, theta0):
    """Corners v1 ... v4 (4, 3); m13 has length 2 and points along x."""
    rho = parallelogram.rho(*parallelogram.ratios(theta, theta0))
    d1, d2 = (np.array([w.real, w.imag, 0.0]) for w in (2 - 2 * rho, 2 + 2 * rho))
    return np.stack([GAP - d1, -GAP - d2, GAP + d1, -GAP + d2]) / 2


def _panel(ax, view, V):
    """The quad over the ground with its shadow; what lies behind the parallelogram is dashed."""
    edges = (V + np.roll(V, -1, axis=0)) / 2  # midpoints of v1 v2, v2 v3, v3 v4, v4 v1
    flat, middle = view(V)[0], view(edges)[0]
    fallen = np.array([1, 1, 0])
    shadow = [x * fallen + [0, 0, GROUND] for x in (V, edges)]
    low, high = shadow[0].min(axis=0) - 0.25, shadow[0].max(axis=0) + 0.25
    ground = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    ground = np.column_stack([ground, np.full(4, GROUND)])
    layers = [(ground, FACE, "#f4f5f7"), (shadow[1], FACE, "#cfd4da"), (edges, FACE, "#b5c9e6")]
    ring, cut = [0, 1, 2, 3, 0], np.linspace(0, 1, 60)[:, None]
    lines = [(shadow[0][ring], "#b4bac2", 0.9), (V[ring], INK, 1.5), (edges[ring], INK, 0.8)]
    lines += [(np.stack(pair), plot.GREY, 0.5) for pair in zip(V, shadow[0], strict=True)]
    scene = plot.scene(ax, view, layers, lines, lift=0.001)
    for name, (start, end) in {"d2": V[[1, 3]], "d1": V[[0, 2]]}.items():
        way = (1 - cut) * start + cut * end
        seen = raster.in_front(scene, view, [way], 3)
        plot.curves(ax, [view(run)[0] for run in seen], COLOURS[name], 1.6, zorder=4)
        plot.curves(ax, [view(way)[0]], COLOURS[name], 0.9, (0, (2, 2)), zorder=3)
        plot.vector(ax, *view(np.stack([start + 0.9 * (end - start), end]))[0], COLOURS[name])
    plot.vector(ax, middle[0], middle[2], COLOURS["u"])
    plot.vector(ax, middle[1], middle[3], COLOURS["v"])
    ax.plot(*flat.T, "o", color=INK, ms=3.5, zorder=6)
    d1, d2, m13, m24 = (x[0] for x in measure.vectors(V, FACE))
    plot.angle(ax, edges[0], d1, d2, 0.26, camera=view)
    below = d1 / np.linalg.norm(d1) + m13 / np.linalg.norm(m13)  # off m13
    plot.text(ax, view(edges[0] + 0.2 * below)[0], r"$\theta$", zorder=7)
    plot.angle(ax, edges.mean(axis=0), m13, m24, 0.26, r"$\theta_0$", camera=view)
    _labels(ax, flat, middle)


def _labels(ax, flat, middle):
    """Names of the corners, outside, and of the four vectors, beside them."""
    places = {}
    for k, away in enumerate(flat - flat.mean(axis=0)):
        places[f"v_{k + 1}"] = flat[k] + 0.15 * away / np.linalg.norm(away)
    places |= {"m_{13}": middle[2] + [0.17, 0.02], "m_{24}": middle[3] + [0.03, 0.12]}
    for k, at, side in ((0, 0.85, 0.1), (1, 0.22, -0.1)):
        along = flat[k + 2] - flat[k]
        beside = np.array([-along[1], along[0]]) / np.linalg.norm(along)
        places[f"d_{k + 1}"] = flat[k] + at * along + side * beside
    for name, place in places.items():
        plot.text(ax, place, f"${name}$", zorder=7)
