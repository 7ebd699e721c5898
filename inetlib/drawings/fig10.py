"""Fig. 10: an I-net on a part of the unit sphere and its stereographic image in the plane."""

import numpy as np

from .. import conformal, mesh, moebius, plot, surfaces
from ..plot import DEGREE
from . import drawn, enlarged, isothermal, patches, sampled

RAYS = 0, 0.5, 1  # along the highlighted curve, where its image is outside
WIDTHS = {"A": 2.0, "A'": 1.03}  # of the panels, for their height
FACE = 60  # of both nets, enlarged
CIRCLE = np.exp(2j * np.pi * np.arange(181) / 180)


@drawn("azimuth", "elevation")
def draw(around=36, rows=12, top=4, azimuth=-90 * DEGREE, elevation=14 * DEGREE):
    """The (arccos 1/sqrt 5, 45 degree) net on a sphere, and seen from the north pole.

    around: steps of a full turn; rows: of the net; top: its uppermost parallel, in steps
    above the equator; azimuth, elevation: the camera, radians.  Paper: Fig. 10."""
    figure, axes = plot.canvas([["A", "A'"]], 7.4, 3.5, ratios=[*WIDTHS.values()])
    step = 2 * np.pi / around
    z = isothermal.domain(rows, around, step, 1j * top * step)
    V, Q = isothermal.sample(surfaces.SPHERE, z)
    curve = isothermal.curve(surfaces.SPHERE, z[:, around * 5 // 10])
    flat, flat_curve = moebius.stereographic(V), moebius.stereographic(curve)
    W = np.stack([flat.real, flat.imag, 0 * flat.real], axis=1)
    view = plot.camera(azimuth, elevation)
    flat_curve = np.stack([flat_curve.real, flat_curve.imag, 0 * flat_curve.real], axis=1)
    _sphere(axes["A"], view, V, W, Q, (curve, flat_curve))
    _plane(axes["A'"], W, Q, flat_curve)
    plot.panel(axes["A"], "A", "on the unit sphere")
    plot.panel(axes["A'"], "A'", "in the plane, with the equator")
    data, claims = {"sphere": V, "plane": W}, {}
    for (name, wide), points in zip(WIDTHS.items(), data.values(), strict=True):
        place = enlarged.below(axes[name], wide, 0.2)
        enlarged.draw(place, points, Q, FACE, isothermal.FAMILIES, 9)
    for name, points in data.items():
        claims |= sampled(f"sampled_net_{name}", points, Q, isothermal.ANGLES)
    return figure, data, [(*conformal.quads(z), *isothermal.ANGLES)], claims


def _sphere(ax, view, V, W, Q, curves):
    """The net on the whole sphere, its image outside, and rays from the north pole."""
    pole = np.array([0, 0, 1.0])
    outside = Q[(np.linalg.norm(W[Q], axis=2) > 1 - 1e-9).all(axis=1)]
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 121), np.linspace(-4, 4, 61), indexing="ij")
    globe = surfaces.SPHERE.point(u, v).reshape(-1, 3), mesh.grid_quads(120, 60), "#f7f8fa"
    layers, lines = [globe, (V, Q, plot.PALE), (W, outside, plot.PALE)], []
    for points, faces in ((V, Q), (W, outside)):
        board = mesh.checkerboard(points, faces)
        corners = board.V[board.black].reshape(-1, 3)
        layers.append((corners, np.arange(len(corners)).reshape(-1, 4), plot.DARK))
        lines += isothermal.lines(points, faces, 0.35)
    lines += [(curve, isothermal.SLANTED, 1.8) for curve in curves]
    lines += [patches.outline(points, Q[[FACE]], width=1.2) for points in (V, W)]
    start = np.flatnonzero(np.linalg.norm(curves[1], axis=1) > 1.05)[[0, -1]]
    for k in RAYS:
        k = int(start[0] + k * (start[1] - start[0]))
        on, off = (curve[k] for curve in curves)
        lines.append((np.stack([on, off]), plot.INK, 0.8))
        plot.curves(ax, [view(np.stack([pole, on]))[0]], plot.INK, 0.6, (0, (3, 2)), zorder=5)
        ax.plot(*view(np.stack([on, off]))[0].T, "o", color=plot.INK, ms=2.2, zorder=6)
    plot.scene(ax, view, layers, lines, pixels=1400)
    north = view(pole)[0]
    ax.plot(*north, "o", color=plot.INK, ms=4, zorder=7)
    plot.text(ax, north + np.array([0.08, 0.06]), "$N$", zorder=7, ha="left")


def _plane(ax, V, Q, curve):
    plot.polygons(ax, V, Q, plot.PALE, zorder=0)
    board = mesh.checkerboard(V, Q)
    plot.polygons(ax, board.V, board.black, plot.DARK, zorder=1)
    for line, colour, width in isothermal.lines(V, Q, 0.4):
        plot.curves(ax, [line], colour, width)
    plot.curves(ax, [curve], isothermal.SLANTED, 1.8, zorder=4)
    plot.polygons(ax, V, Q[[FACE]], "none", plot.INK, 1.2, zorder=5)
    plot.curves(ax, [CIRCLE], plot.INK, 0.9, (0, (4, 3)), zorder=5)
