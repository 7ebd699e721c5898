"""What a net looks like in the explorer: its cells, curves, colours, and pictures of it."""

import io
from collections.abc import Callable
from typing import NamedTuple

import matplotlib
import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from .. import design, measure, parallelogram, plot, repair
from ..design import report

DECADES = -3, 1  # powers of ten of a degree: what the shading by deviation tells apart
SLIM = 0.5  # quads of less height have thinner curves, see `crowd`
STEPS = 5  # of the other scales
EQUAL = 1e-9  # of the scale: sizes, or planarities, that differ by less are equal
OPACITY = 0.3  # of the surface below a net
PIXELS = 1200  # of the longer side of a net in a saved picture


class Palette(NamedTuple):
    """Colours; black: of the inscribed parallelograms, cut: of panels cut at the edge."""

    background: str
    face: str
    black: str
    cut: str
    families: dict


RIM = {"rim": plot.GREY}  # the edge of panels that are cut there
LIGHT = Palette("#ffffff", "#dfe6ee", "#a9c0dd", "#bccad9", plot.COLOURS | RIM)
BRIGHT = {"u": "#7db0ff", "v": "#ff8f5e", "d1": "#45d6ab", "d2": "#ffd04a"}
DARK = Palette("#11161d", "#434f5d", "#6d88a8", "#586878", BRIGHT | RIM)


def shades(off: np.ndarray) -> np.ndarray:
    """The colours of deviations (degrees) on a logarithmic scale from near white: bytes (k, 3)."""
    low, high = DECADES
    part = (np.log10(np.maximum(off, 1e-300)) - low) / (high - low)
    rgb = _tones(part)
    rgb[part < 0] = np.round(255 * np.array(to_rgb("#f4f6f8")))
    return rgb


def _tones(part):
    """One hue, that of no family, from light to dark: bytes (k, 3) of parts from 0 to 1."""
    part = np.clip(part, 0, 1)  # the darkest tones of the map would hide the curves
    rgb = matplotlib.colormaps["Purples"](0.2 + 0.65 * part)[:, :3]
    return np.round(255 * rgb).astype(np.uint8)


def scale() -> list[tuple[str, str]]:
    """The colours and names of the scale of `shades`: [(colour, words), ...]."""
    powers = np.arange(DECADES[0] - 1, DECADES[1] + 1)
    words = [f"{10.0**p:g}\u00b0" for p in powers]
    words[0] = f"< {words[1]}"
    return _legend(shades(10.0**powers), words)


def _legend(colours, words):
    return [(f"rgb({r},{g},{b})", w) for (r, g, b), w in zip(colours.tolist(), words, strict=True)]


def shading(name: str, V: np.ndarray, Q: np.ndarray, deviations: Callable) -> tuple:
    """What the faces are shaded by: RGB bytes (f, 3), and the scale as that of `scale`.

    "deviation": the largest of deviations(), (2, f), degrees; "size": the root of the area, in
    units of V; "planarity": the distance of the diagonals over their mean length; "none": None,
    []."""
    if name == "deviation":
        return shades(np.abs(deviations()).max(axis=0)), scale()
    if name == "size":
        d1, d2 = measure.vectors(V, Q)[:2]
        sizes = np.sqrt(np.linalg.norm(np.cross(d1, d2), axis=1) / 2)
        return _graded(sizes, sizes.min(), EQUAL * sizes.max(), "")
    if name == "planarity":
        return _graded(100 * measure.planarity(V, Q), 0.0, 100 * EQUAL, " %")
    return None, []


def _graded(values, low, least, unit):
    """As `shading`: values on a scale from low to the largest, if they differ by `least` at all."""
    reach, digits = values.max() - low, 2 if unit else 3
    if not reach > least:
        tone = _tones(np.zeros(1))
        return np.repeat(tone, len(values), axis=0), _legend(tone, [f"all {low:.{digits}g}{unit}"])
    part = np.linspace(0, 1, STEPS)
    words = [f"{x:.{digits}g}{unit}" for x in low + part * reach]
    return _tones((values - low) / reach), _legend(_tones(part), words)


def crowd(quads: int, theta: float, theta0: float) -> float:
    """The number of quads that are no slimmer than `SLIM`, with curves as close as those of these.

    theta, theta0: of the quads, degrees.  Slim is the height over the longer medial line / it."""
    mu = parallelogram.ratios(*np.radians([theta, theta0]))[1]
    return quads * max(1.0, SLIM / (np.sin(np.radians(theta0)) * min(mu, 1 / mu)))


def line_width(quads: float) -> float:
    """The width of the curves in pixels: thinner where there are more quads, or a `crowd`."""
    return 3 if quads < 200 else 2 if quads < 2000 else 1 if quads < 6000 else 0.5


def ink(colour: str, face: str, quads: float) -> np.ndarray:
    """The RGB of a curve, of parts of 1: fainter where so many quads run together."""
    part = 0.0 if quads < 6000 else 0.45
    return (1 - part) * np.array(to_rgb(colour)) + part * np.array(to_rgb(face))


class Layout(NamedTuple):
    """What is filled and drawn of a net, by vertex numbers.

    means: arrays (k, s) of vertices of the net; their means are further vertices, in order;
    quads (f, 4), triangles (t, 3) and those of cut panels, cut (c, 3), are filled; lines:
    {family: (k, 2)} segments, and with cut panels the rest of their sides as "rim"."""

    means: list
    quads: np.ndarray
    triangles: np.ndarray
    cut: np.ndarray
    lines: dict


def layout(Q, count, families, parallelograms=False, cover=None) -> Layout:
    """The `Layout` of quads Q (f, 4) on `count` vertices, with the named families of curves.

    cover: the `design.Cover` with the panels that are cut at the edge, where there are any.

    With `parallelograms` each quad is cut into its mid-edge parallelogram and four corners.
    Where diagonals are shown, the quads become triangles around the mean of their corners."""
    after, before = np.roll(Q, -1, axis=1), np.roll(Q, 1, axis=1)
    sides = np.sort(np.stack([Q, after], axis=2).reshape(-1, 2), axis=1)
    edges, around = np.unique(sides, axis=0, return_inverse=True)
    around = around.reshape(-1, 4)
    along_u = np.isin(np.arange(len(edges)), around[:, [1, 3]])  # v2 v3 and v4 v1
    lines = {"u": edges[along_u], "v": edges[~along_u]}
    quads, triangles, means = Q, np.empty((0, 3), dtype=np.int64), []
    if parallelograms:
        quads, means = around + count, [edges]
        triangles = np.stack([Q, quads, np.roll(quads, 1, axis=1)], axis=2).reshape(-1, 3)
        count += len(edges)
    if {"d1", "d2"} & set(families):
        if parallelograms:  # flat: from the corner down to a side, and straight across it
            across = count + np.arange(Q.size).reshape(-1, 4)
            means.append(np.stack([Q, Q, before, after], axis=2).reshape(-1, 4))
            pieces = np.stack([Q, across], axis=2), across
        else:
            centre = np.broadcast_to(count + np.arange(len(Q))[:, None], Q.shape)
            quads, triangles = Q[:0], np.stack([Q, after, centre], axis=2).reshape(-1, 3)
            means, pieces = [Q], [np.stack([centre, Q], axis=2)]
        for name, corners in (("d1", [0, 2]), ("d2", [1, 3])):
            lines[name] = np.concatenate([p[:, corners].reshape(-1, 2) for p in pieces])
    cut, rim = np.empty((0, 3), dtype=np.int64), {}
    if cover is not None:
        cut = repair.triangulate(cover.V, cover.polygons)
        lines |= {name: np.concatenate([lines[name], cover.edges[name]]) for name in "uv"}
        more = [np.stack([p, np.roll(p, -1)], axis=1) for p in cover.polygons]
        every = np.unique(np.concatenate([edges, np.sort(np.concatenate(more), axis=1)]), axis=0)
        pairs = np.concatenate([every, every, lines["u"], lines["v"]])
        pairs, times = np.unique(pairs, axis=0, return_counts=True)
        rim = {"rim": pairs[times == 2]}  # sides of panels on no curve
    return Layout(means, quads, triangles, cut, {name: lines[name] for name in families} | rim)


def with_panels(V: np.ndarray, Q: np.ndarray, polygons: list) -> design.Cover | None:
    """The `design.Cover` of a net with further faces, where there are any: no curves cross them.

    Its report has deviations from the mean angles."""
    if not polygons:
        return None
    means = dict(zip(("theta", "theta0"), (x.mean() for x in measure.angles(V, Q)), strict=True))
    none = np.empty((0, 2), dtype=np.int64)
    about = report.report(V, Q, polygons, **means)
    return design.Cover(V, Q, about, polygons, {"u": none, "v": none})


def points(V: np.ndarray, layout: Layout) -> np.ndarray:
    """The vertices of a layout: V and the means."""
    return np.concatenate([V, *(sum(V[c] for c in k.T) / k.shape[1] for k in layout.means)])


def fills(layout: Layout, palette: Palette, shade: np.ndarray | None = None) -> np.ndarray:
    """RGB bytes of all cells, in their order: (f + t + c, 3).

    shade: one colour a quad, or None; of inscribed parallelograms, where they are shown."""
    counts = [len(cells) for cells in (layout.quads, layout.triangles, layout.cut)]
    colours = palette.black if counts[0] and counts[1] else palette.face, palette.face, palette.cut
    rgb = np.round(255 * np.array([to_rgb(colour) for colour in colours])).astype(np.uint8)
    rgb = np.repeat(rgb, counts, axis=0)
    if shade is not None:
        rgb[: counts[0] or counts[1]] = shade if counts[0] else np.repeat(shade, 4, axis=0)
    return rgb


def picture(V, Q, choice, shade, camera, form, cover=None, surface=None, ghost=None) -> bytes:
    """The net as the bytes of a picture, form "svg" or "png", drawn without OpenGL.

    choice: what is shown of it; shade: RGB bytes a quad (f, 3), or None; camera: `plot.camera`;
    cover: as of `layout`; surface, ghost: (V, triangles), (V, Q) of what is shown with it."""
    plan = layout(Q, len(V), choice.families, choice.parallelograms, cover)
    triangles = np.concatenate([plan.triangles, plan.cut])
    W, faces = points(V, plan), np.concatenate([plan.quads, triangles[:, [0, 1, 2, 2]]])
    fill = fills(plan, LIGHT, shade) / 255
    many, named = crowd(len(Q), choice.theta, choice.theta0), plan.lines.items()
    width = 0.6 * line_width(many)
    lines = [(W[pair], LIGHT.families[name], width) for name, pairs in named for pair in pairs]
    if ghost is not None:
        pairs = np.concatenate(list(layout(ghost[1], len(ghost[0]), ("u", "v")).lines.values()))
        lines += [(ends, LIGHT.families["rim"], 0.6) for ends in ghost[0][pairs]]
    return drawn([(W, faces, fill)], lines, camera, form, surface)


def drawn(layers, lines, camera, form, pale=None) -> bytes:
    """Surfaces and curves on them, as of `plot.scene`, as the bytes of a picture.

    pale: (V, F) of a surface behind them, or None."""
    file, metadata = io.BytesIO(), {"Date": None} if form == "svg" else {"Software": None}
    with matplotlib.rc_context():
        plot.use_style()
        matplotlib.rcParams["svg.hashsalt"] = "inetlib"
        figure = Figure(figsize=(8, 6), layout="none")
        ax = figure.add_axes((0.02, 0.02, 0.96, 0.96), aspect="equal")
        ax.set_axis_off()
        if pale is not None:
            seen = plot.scene(ax, camera, [(*pale, LIGHT.cut)], (), PIXELS)
            ax.images[0].set_data(seen.image * [1, 1, 1, OPACITY])
        plot.scene(ax, camera, layers, lines, PIXELS)
        ax.margins(0)  # of all of it
        ax.autoscale_view()
        figure.savefig(file, format=form, dpi=200, metadata=metadata, facecolor="white")
    return file.getvalue()
