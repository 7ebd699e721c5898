"""Fig. 7: a planar sheared grid and developable surfaces that it is bent into."""

import numpy as np

from .. import conformal, developable, mesh, plot
from ..plot import DEGREE
from . import drawn, enlarged, patches, sampled

WIDTHS = {"A": 20, "B": 16, "C": 12}, {"D": 7, "E": 7, "F": 10, "G": 13, "H": 11}
PANELS = [[name for name, count in row.items() for _ in range(count)] for row in WIDTHS]
HIGH, ROOM = 8.4, 0.33  # columns as wide as a net is high; the height below it, in heights
GEODESIC = ((0, 0, 0), (0.3, -0.8, 0.1), (0.6, -0.8, 0.3), (0.9, 0, 0.4))
EDITED = ((0, 0, 0), (0.1, -1, -0.1), (0.8, -1, 0.6), (0.9, 0, 0.4))
FACE = 74  # that is enlarged
TITLES = {"A": "$k=0$: sheared grid in the plane", "B": "$k=1/4$", "C": "$k=1/2$", "D": "$k=3/4$"}
TITLES |= {"E": "$k=1$", "F": "a cone", "G": "B\u00e9zier geodesic", "H": "moved points"}


@drawn("theta", "theta0", "azimuth", "elevation")
def draw(
    theta=60 * DEGREE,
    theta0=45 * DEGREE,
    cells=12,
    azimuth=-90 * DEGREE,
    elevation=20 * DEGREE,
    geodesic=GEODESIC,
    edited=EDITED,
):
    """One net in the plane, rolled up in four steps, on a cone and along a space curve.

    theta, theta0: angles of the net; cells: faces each way, those along u close around the
    cylinder of curvature k = 1; azimuth, elevation: the camera; radians.  geodesic, edited:
    control points, scaled to the length of the diagonal of the net, which becomes that curve.
    Paper: Fig. 7."""
    z = conformal.sheared_grid(theta, theta0, cells, cells, edge=2 * np.pi / cells)
    z = z - z.mean()
    maps = {name: _rolling(k / 4) for k, name in enumerate("ABCDE")} | {"F": _cone(z)}
    controls = {}
    for name, points in (("G", geodesic), ("H", edited)):
        maps[name], controls[name] = _along(z, points)
    figure, axes = plot.canvas(PANELS, 7.6, 4.2)
    view = plot.camera(azimuth, elevation)
    domain, Q = conformal.quads(z)
    data, claims = {"domain": domain}, {}
    for name, bend in maps.items():
        V = data[f"net_{name}"] = bend(z).reshape(-1, 3)
        claims |= sampled(f"chords_{name}", V, Q, (theta, theta0))
        claims[f"stretch_{name}"] = _stretch(bend, z)
        _sheet(axes[name], view, bend, z)
        plot.panel(axes[name], name, TITLES[name])
    for name, points in controls.items():
        flat = view(points)[0]
        axes[name].plot(*flat.T, "o--", color=plot.INK, ms=3.5, lw=0.8, zorder=6)
        axes[name].update_datalim(flat)
    _same_scale(axes)
    for name, ax in axes.items():
        place = ax.inset_axes(enlarged.place(ROOM))
        enlarged.draw(place, data[f"net_{name}"], Q, FACE, size=7.5, reach=1.4)
    return figure, data, [(domain, Q, theta, theta0)], claims


def _stretch(bend, z):
    """How much the map stretches the two directions of edges at most: 0 for a bending."""
    edges = z[1, 0] - z[0, 0], z[0, 1] - z[0, 0]
    found = [developable.tangent(bend, z, edge / abs(edge)) for edge in edges]
    return np.abs(np.linalg.norm(found, axis=-1) - 1).max()


def _rolling(curvature):
    """A wall in front of the camera that curls away from it."""
    return lambda z: developable.roll(z, curvature)[..., [0, 2, 1]]


def _cone(z):
    """The net below an apex, on a cone that it closes by three quarters or so."""
    apex = 1j * (z.imag.max() + 1.5)
    span = np.ptp(np.angle((z - apex) * 1j))
    gamma = np.pi - np.arcsin(span / (2 * np.pi) / 0.8)
    return lambda z: developable.cone(z, gamma, apex, direction=-1j)


def _along(z, points):
    """The map that takes the diagonal of the net to a Bezier curve, and its control points."""
    start, chord = z[0, 0], z[-1, -1] - z[0, 0]
    margin = 0.04 * abs(chord)
    points = np.array(points, dtype=float)
    points *= (abs(chord) + 2 * margin) / developable.arc_length(developable.bezier(points)).length
    curve = developable.arc_length(developable.bezier(points))
    turn = np.conj(chord) / abs(chord)
    return lambda z: developable.rectifying((z - start) * turn + margin, curve), points


def _sheet(ax, view, bend, z):
    """Black quads dark, the rest light, u- and v-curves, and the diagonal of the net."""
    V, Q = conformal.quads(z)
    fine, F = conformal.quads(_finer(_finer(z).T).T)
    black = mesh.checkerboard(V, Q)
    quads = bend(black.V[:, 0] + 1j * black.V[:, 1])[black.black].reshape(-1, 3)
    lines = [
        (bend(line), plot.COLOURS[name], 0.5)
        for name, family in (("u", _finer(z).T), ("v", _finer(z.T).T))
        for line in family
    ]
    lines.append(patches.outline(bend(z).reshape(-1, 3), Q[[FACE]], width=1.1))
    lines.append((bend(np.linspace(z[0, 0], z[-1, -1], 4 * len(z))), plot.INK, 2))
    surface = bend(fine[:, 0] + 1j * fine[:, 1]), F, plot.PALE
    apart = np.arange(len(quads)).reshape(-1, 4)
    plot.scene(ax, view, [surface, (quads, apart, plot.DARK)], lines, pixels=700)


def _finer(z, parts=6):
    """The rows of a grid, and more between them."""
    s = np.arange((len(z) - 1) * parts + 1) / parts
    k = np.minimum(s.astype(int), len(z) - 2)
    return z[k] + (s - k)[:, None] * (z[k + 1] - z[k])


def _same_scale(axes):
    """All panels of the same scale: they are equally high, and so are their limits.

    Below the nets is room for their parallelograms."""
    columns = WIDTHS[0] | WIDTHS[1]
    sizes = [(ax.dataLim.height, ax.dataLim.width * HIGH / columns[k]) for k, ax in axes.items()]
    height = 1.07 * np.max(sizes)
    for ax in axes.values():
        ax.set_aspect("equal", adjustable="datalim")
        x, y = (ax.dataLim.p0 + ax.dataLim.p1) / 2
        ax.set_xlim(x - 0.1, x + 0.1, auto=True)  # to be widened to the panel
        ax.set_ylim(y - (0.5 + ROOM) * height, y + height / 2, auto=True)
