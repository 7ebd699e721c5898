"""Drawing with matplotlib: plane figures, and 3D by projected, depth-sorted polygons.

No OpenGL is needed anywhere.  One colour a family through all figures: the u-curves, the
v-curves, and the two families of diagonals d1 and d2.  The four differ in lightness too, so
they stay apart in greyscale.

Paper: Figs. 1-13 (drawing).
"""

from importlib.resources import files

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PathCollection, PolyCollection
from matplotlib.path import Path

from . import mesh, ties

COLOURS = {"u": "#0b3c8c", "v": "#d1440c", "d1": "#1f9e77", "d2": "#e0a100"}
INK, GREY, PALE, FILL = "#1a1a1a", "#8a8a8a", "#e9edf2", "#c3d3e8"
DARK = "#6f8fbf"  # inscribed parallelograms in space
STYLE = files("inetlib") / "inet.mplstyle"
DEGREE = float(np.pi / 180)
ROUNDING = 1e-12  # of the size of numbers: closer ones count as the same on every machine


def use_style():
    """Make the project's style the default of this session, whatever the user's own one is."""
    plt.style.use(["default", str(STYLE)])


def canvas(panels, width, height, ratios=None):
    """A figure with named panels: (figure, {name: axes}), axes off and of equal aspect.

    panels: rows of names as for `matplotlib.pyplot.subplot_mosaic`; width, height in inches;
    ratios: relative widths of the columns.
    """
    use_style()
    figure = plt.figure(figsize=(width, height))
    axes = figure.subplot_mosaic(panels, width_ratios=ratios)
    for ax in axes.values():
        ax.set_aspect("equal")
        ax.set_axis_off()
    return figure, axes


def panel(ax, letter, text=""):
    """The panel's letter in bold, and a few words, above the axes."""
    ax.set_title(rf"$\mathbf{{{letter}}}$" + (f"  {text}" if text else ""), loc="left")


# --- in the plane -------------------------------------------------------------------------


def plane(points):
    """Points as (..., 2): complex numbers, (..., 2) or (..., 3) arrays (z is dropped)."""
    points = np.asarray(points)
    if np.iscomplexobj(points):
        return np.stack([points.real, points.imag], axis=-1)
    return points[..., :2]


def curves(ax, lines, colour, width=1.1, style="-", **options):
    """Polylines (complex or (k, 2) arrays) as one collection; returns it."""
    lines = [plane(line) for line in lines]
    collection = LineCollection(
        lines, colors=colour, linewidths=width, linestyles=style, capstyle="round", **options
    )
    ax.add_collection(collection)
    ax.autoscale_view()
    return collection


def polygons(ax, V, faces, fill=FILL, edge="none", width=0.6, **options):
    """Faces of a planar mesh as one collection; `fill` is a colour or one colour a face."""
    collection = PolyCollection(
        plane(V)[faces], facecolors=fill, edgecolors=edge, linewidths=width, **options
    )
    ax.add_collection(collection)
    ax.autoscale_view()
    return collection


def net(ax, V, Q, families=("u", "v"), width=1.1):
    """The named families (of u, v, d1, d2) of mesh curves of a planar net, each in its colour."""
    if unknown := set(families) - set(COLOURS):
        raise ValueError(f"no family {sorted(unknown)}: there are u, v, d1 and d2")
    for name, lines in mesh.polylines(Q)._asdict().items():
        if name in families:
            curves(ax, [V[line] for line in lines], COLOURS[name], width)


def black_quads(ax, V, Q, fill=FILL, edge=INK, width=0.4):
    """The inscribed parallelograms of a planar net."""
    board = mesh.checkerboard(V, Q)
    polygons(ax, board.V, board.black, fill, edge, width)


def arc(apex, a, b, radius, samples=40):
    """Points on the arc around `apex` from the direction a to the direction b, (samples, dim).

    apex, a, b: vectors of two or three coordinates, a and b not parallel, else ValueError.
    A right angle is drawn as a corner (3 points).
    """
    apex, a, b = (np.asarray(x, dtype=float) for x in (apex, a, b))
    if np.linalg.matrix_rank([a, b]) < 2:
        raise ValueError(f"the directions {a} and {b} are parallel: no arc between them")
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    if abs(a @ b) < 1e-9:
        return apex + 0.7 * radius * np.array([a, a + b, b])
    normal = b - (a @ b) * a
    angle = np.arctan2(np.linalg.norm(normal), a @ b)
    t = np.linspace(0, angle, samples)[:, None]
    return apex + radius * (np.cos(t) * a + np.sin(t) * normal / np.linalg.norm(normal))


def angle(ax, apex, a, b, radius, label="", colour=INK, camera=None, gap=1.45, size=None):
    """An angle mark at `apex` between the directions a and b, with its label outside the arc.

    In space (three coordinates) `camera` projects it.
    """
    points = arc(apex, a, b, radius)
    middle = np.asarray(apex) + gap * (points[len(points) // 2] - apex)
    if camera is not None:
        points, middle = camera(points)[0], camera(middle[None])[0][0]
    ax.plot(*points.T, color=colour, lw=1.0, zorder=5)
    if label:
        ax.text(*middle, label, color=colour, ha="center", va="center", zorder=6, fontsize=size)


def vector(ax, start, end, colour=INK, label="", shift=(0, 0), width=1.6, at=0.5, zorder=4):
    """An arrow between two points of the plane, and a label beside the fraction `at` of it."""
    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    arrow = {"arrowstyle": "-|>,head_width=0.22,head_length=0.45", "color": colour, "lw": width}
    arrow |= {"shrinkA": 0, "shrinkB": 0, "mutation_scale": 12}
    ax.annotate("", end, start, arrowprops=arrow, zorder=zorder)
    ax.update_datalim([start, end])
    ax.autoscale_view()
    if label:
        middle = start + at * (end - start) + np.asarray(shift)
        ax.text(*middle, label, color=colour, ha="center", va="center", zorder=zorder + 1)


# --- in space -----------------------------------------------------------------------------


def camera(azimuth, elevation):
    """An orthographic camera: a function from points (k, 3) to (xy (k, 2), nearness (k,)).

    azimuth, elevation: radians, the direction from which the scene is seen; z points up.
    """
    ca, sa, ce, se = np.cos(azimuth), np.sin(azimuth), np.cos(elevation), np.sin(elevation)
    right, up = np.array([-sa, ca, 0]), np.array([-se * ca, -se * sa, ce])
    towards = np.array([ce * ca, ce * sa, se])

    def project(points):
        points = np.asarray(points, dtype=float)
        return np.stack([points @ right, points @ up], axis=-1), points @ towards

    return project


def shade(V, faces, colour=PALE, light=(0.3, -0.5, 0.8), depth=0.35):
    """One colour a face, darker where the face turns away from the light (both sides alike).

    V: (n, 3), faces: (f, 3 or 4) -> RGB (f, 3).
    """
    corners = np.asarray(V)[faces]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = normal / np.where(length > 0, length, 1)
    light = np.asarray(light) / np.linalg.norm(light)
    rgb = np.array(plt.matplotlib.colors.to_rgb(colour))
    return rgb * (1 - depth * (1 - np.abs(normal @ light)))[:, None]


def order(keys):
    """The places of the keys from the smallest to the largest; ties keep their order.

    keys: (k,) numbers.  Neighbours closer than `ties.TIE` times the range of all, or by the
    rounding of the largest, are ties: which of two computed numbers is larger by its last
    digits differs from machine to machine.
    """
    keys = np.asarray(keys, dtype=float)
    close = ties.TIE * np.ptp(keys) + ROUNDING * np.abs(keys).max()
    return np.argsort(ties.ranks(keys, close), kind="stable")


def families(V, Q, widths):
    """Lines for `scene`: the polylines of each family of {family: width} in its colour."""
    found = mesh.polylines(Q)._asdict()
    return [(V[line], COLOURS[name], w) for name, w in widths.items() for line in found[name]]


def cells(V, Q, white=False):
    """(points, black, light): a net cut along its inscribed parallelograms, faces (., 4).

    light: the four corners left of every face; with white=True the white quads of the
    checkerboard, and corners only where these leave some along the rim.
    """
    board = mesh.checkerboard(V, Q)
    black = board.black + len(V)
    corners = np.stack([np.roll(black, 1, axis=1), Q, black, black], axis=2)
    light = corners.swapaxes(0, 1).reshape(-1, 4)
    if white:
        light = np.concatenate([board.white + len(V), corners[np.bincount(Q.ravel())[Q] < 4]])
    return np.concatenate([V, board.V]), black, light


def scene(ax, view, V, faces, fill=None, lines=(), lift=0.02):
    """A surface and curves on it, painted from the back to the front as vectors.

    view: a `camera`; V: (n, 3); faces: (f, k) index array; fill: a colour or one colour a
    face (default `shade`); lines: (points (k, 3), colour, width) triples, cut into segments that
    are sorted with the faces, in front of those they lie on, and lifted by the fraction
    `lift` of the scene's depth.
    """
    xy, near = view(V)
    fill = shade(V, faces) if fill is None else fill
    closed = np.concatenate([faces, faces[:, :1]], axis=1)
    paths = [Path(p) for p in xy[closed]]
    keys = list(near[faces].mean(axis=1))
    rgba = plt.matplotlib.colors.to_rgba_array(fill)
    inside = [tuple(c) for c in np.broadcast_to(rgba, (len(paths), 4))]
    edges, widths = list(inside), [0.3] * len(paths)
    tilt = near[faces].mean(axis=1) - near[faces].min(axis=1)  # else faces hide half their lines
    lifted = lift * (np.ptp(near) or 1) + tilt.max()
    for points, colour, width in lines:
        flat, close = view(points)
        paths += [Path(flat[k : k + 2]) for k in range(len(flat) - 1)]
        keys += list((close[1:] + close[:-1]) / 2 + lifted)
        inside += ["none"] * (len(flat) - 1)
        edges += [colour] * (len(flat) - 1)
        widths += [width] * (len(flat) - 1)
    picked = ([values[k] for k in order(keys)] for values in (paths, inside, edges, widths))
    paths, inside, edges, widths = picked
    collection = PathCollection(
        paths, facecolors=inside, edgecolors=edges, linewidths=widths, capstyle="round"
    )
    ax.add_collection(collection)
    ax.update_datalim(np.concatenate([p.vertices for p in paths]))
    ax.autoscale_view()
    return collection
