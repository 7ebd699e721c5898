"""Drawing with matplotlib: plane figures, and shaded surfaces with curves on them, no OpenGL.

One colour a family (u, v, d1, d2) through all figures, of different lightness."""

from importlib.resources import files

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.patheffects import withStroke

from . import mesh, raster

COLOURS = {"u": "#0b3c8c", "v": "#d1440c", "d1": "#1f9e77", "d2": "#e0a100"}
INK, GREY, PALE, FILL = "#1a1a1a", "#8a8a8a", "#e9edf2", "#c3d3e8"
DARK = "#6f8fbf"  # inscribed parallelograms in space
SINGULAR = "#7b2d8b"  # faces that are no quads
HEAVY = 1.7  # wider curves in space have a white border
DEGREE = float(np.pi / 180)


def use_style():
    """Make the project's style the default of this session, whatever the user's own one is."""
    plt.style.use(["default", str(files("inetlib") / "inet.mplstyle")])


def canvas(panels, width: float, height: float, ratios=None):
    """(figure, {name: axes}): panels as of `subplot_mosaic`, inches, ratios of the columns."""
    use_style()
    figure = plt.figure(figsize=(width, height))
    axes = figure.subplot_mosaic(panels, width_ratios=ratios)
    for ax in axes.values():
        ax.set_aspect("equal")
        ax.set_axis_off()
    return figure, axes


def panel(ax, letter: str, text: str = ""):
    """The panel's letter in bold, and a few words, above the axes."""
    ax.set_title(rf"$\mathbf{{{letter}}}$" + (f"  {text}" if text else ""), loc="left")


def plane(points) -> np.ndarray:
    """Points as (..., 2): complex numbers, (..., 2) or (..., 3) arrays (z is dropped)."""
    points = np.asarray(points)
    if np.iscomplexobj(points):
        return np.stack([points.real, points.imag], axis=-1)
    return points[..., :2]


def curves(ax, lines, colour, width=1.1, style="-", zorder=2, alpha=None):
    """Polylines (complex or (k, 2) arrays) as one collection; returns it."""
    look = {"colors": colour, "linewidths": width, "linestyles": style, "alpha": alpha}
    lines = LineCollection([*map(plane, lines)], zorder=zorder, capstyle="round", **look)
    return _added(ax, lines)


def polygons(ax, V, faces, fill=FILL, edge="none", width=0.6, zorder=1, alpha=None):
    """Faces of a planar mesh as one collection; `fill` is a colour or one colour a face."""
    look = {"facecolors": fill, "edgecolors": edge, "linewidths": width, "alpha": alpha}
    return _added(ax, PolyCollection(plane(V)[faces], zorder=zorder, **look))


def _added(ax, collection):
    ax.add_collection(collection)
    ax.autoscale_view()
    return collection


def text(ax, place, words, size=None, halo=0, colour="black", zorder=6, ha="center", va="center"):
    """Words at a point of the plane, complex or (2,), in a white border of `halo` points."""
    effects = [withStroke(linewidth=halo, foreground="white")] if halo else None
    look = {"color": colour, "fontsize": size, "path_effects": effects, "zorder": zorder}
    ax.text(*plane(place), words, ha=ha, va=va, **look)


def degrees(theta: float, theta0: float | None = None) -> str:
    """TeX for an angle (radians), or for both angles of a net with their names."""
    one = f"{theta / DEGREE:.4g}\\degree"
    if theta0 is None:
        return one
    two = degrees(theta0)
    return rf"\theta=\theta_0={one}" if one == two else rf"\theta={one},\ \theta_0={two}"


def net(ax, V: np.ndarray, Q: np.ndarray, families=("u", "v"), width=1.1):
    """The named families (of u, v, d1, d2) of mesh curves of a planar net, each in its colour."""
    if unknown := set(families) - set(COLOURS):
        raise ValueError(f"no family {sorted(unknown)}: there are u, v, d1 and d2")
    lines = mesh.polylines(Q)._asdict()
    for name in families:
        curves(ax, [V[line] for line in lines[name]], COLOURS[name], width)


def black_quads(ax, V: np.ndarray, Q: np.ndarray, fill=FILL, edge=INK, width=0.4):
    """The inscribed parallelograms of a planar net."""
    polygons(ax, *mesh.checkerboard(V, Q)[:2], fill, edge, width)


def arc(apex, a, b, radius: float, samples: int = 40) -> np.ndarray:
    """Points on the arc around `apex` from the direction a to b, (samples, 2 or 3).

    A right angle is drawn as a corner (3 points); ValueError where a and b are parallel."""
    apex, a, b = (np.asarray(x, dtype=float) for x in (apex, a, b))
    if np.linalg.matrix_rank([a, b]) < 2:
        raise ValueError(f"the directions {a} and {b} are parallel: no arc between them")
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    if abs(a @ b) < 1e-9:
        return apex + 0.7 * radius * np.array([a, a + b, b])
    normal = b - (a @ b) * a
    length = np.linalg.norm(normal)
    t = np.linspace(0, np.arctan2(length, a @ b), samples)[:, None]
    return apex + radius * (np.cos(t) * a + np.sin(t) * normal / length)


def angle(ax, apex, a, b, radius, label="", colour=INK, camera=None, gap=1.45):
    """An `arc` with its label outside; in space (three coordinates) `camera` projects both."""
    points = arc(apex, a, b, radius)
    middle = np.asarray(apex) + gap * (points[len(points) // 2] - apex)
    if camera is not None:
        points, middle = camera(points)[0], camera(middle)[0]
    ax.plot(*points.T, color=colour, lw=1.0, zorder=5)
    if label:
        text(ax, middle, label, colour=colour)


def vector(ax, start, end, colour=INK, width=1.6, zorder=4):
    """An arrow between two points of the plane."""
    arrow = {"arrowstyle": "-|>,head_width=0.22,head_length=0.45", "color": colour, "lw": width}
    arrow |= {"shrinkA": 0, "shrinkB": 0, "mutation_scale": 12}
    ax.annotate("", end, start, arrowprops=arrow, zorder=zorder)
    ax.update_datalim([start, end])
    ax.autoscale_view()


def camera(azimuth: float, elevation: float):
    """An orthographic camera: a function from points (..., 3) to (xy (..., 2), nearness (...)).

    azimuth, elevation: radians, the direction from which the scene is seen; z points up."""
    ca, sa, ce, se = np.cos(azimuth), np.sin(azimuth), np.cos(elevation), np.sin(elevation)
    right, up, towards = [-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]

    def project(points):
        points = np.asarray(points, dtype=float)
        return np.stack([points @ right, points @ up], axis=-1), points @ towards

    return project


def families(V, Q, widths):
    """Lines for `scene`: the polylines of each family of {family: width} in its colour."""
    found = mesh.polylines(Q)._asdict()
    return [(V[line], COLOURS[name], w) for name, w in widths.items() for line in found[name]]


def board(ax, view, V, Q, lines=(), more=(), fill=DARK, pixels=1000):
    """A net in space: its inscribed parallelograms over the light surface; see `scene`.

    more: further layers below; fill: the colour of the parallelograms, or one of each."""
    quads, black = mesh.checkerboard(V, Q)[:2]
    corners = quads[black].reshape(-1, 3)
    apart = np.arange(len(corners)).reshape(-1, 4)  # with corners of their own, to be flat
    return scene(ax, view, [(V, Q, PALE), *more, (corners, apart, fill)], lines, pixels)


def scene(ax, view, layers, lines=(), pixels=1000, lift=0.003):
    """Shaded surfaces as a picture, and what is seen of the curves on them as vectors.

    view: a `camera`; layers, pixels, lift: of `raster.render`; lines: (points (k, 3), colour,
    width) triples.  Returns the `raster.Picture`."""
    seen = raster.render(view, layers, pixels, lift)
    ax.imshow(seen.image, extent=seen.extent, interpolation="hanning", zorder=1)
    ax.update_datalim(np.reshape(seen.extent, (2, 2)).T)
    styles: dict = {}
    for points, colour, width in lines:
        styles.setdefault((width, colour), []).append(points)
    for (width, colour), curved in styles.items():
        runs = raster.in_front(seen, view, curved, len(layers))
        look = {"facecolor": "none", "edgecolor": colour, "linewidth": width, "capstyle": "round"}
        if runs:  # as one path, for a small file
            path = Path.make_compound_path(*(Path(view(run)[0]) for run in runs))
            if width > HEAVY:
                look["path_effects"] = [withStroke(linewidth=width + 1.4, foreground="white")]
            ax.add_patch(PathPatch(path, zorder=2 + width / 100, joinstyle="round", **look))
    return seen
