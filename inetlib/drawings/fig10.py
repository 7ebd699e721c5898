"""Fig. 10: an I-net on a part of the unit sphere and its stereographic image in the plane."""

import numpy as np

from .. import conformal, moebius, plot, surfaces
from ..plot import DEGREE
from . import drawn, isothermal, sampled

CIRCLE = np.exp(2j * np.pi * np.arange(181) / 180)


@drawn("azimuth", "elevation")
def draw(around=24, rows=8, top=3, azimuth=-90 * DEGREE, elevation=22 * DEGREE):
    """The (arccos 1/sqrt 5, 45 degree) net on a sphere, and seen from the north pole.

    around: steps of a full turn; rows: of the net; top: its uppermost parallel, in steps
    above the equator; azimuth, elevation: the camera, radians.  Paper: Fig. 10."""
    figure, axes = plot.canvas([["A", "A'"]], 6.6, 3.2)
    step = 2 * np.pi / around
    z = isothermal.domain(rows, around, step, 1j * top * step)
    V, Q = isothermal.sample(surfaces.SPHERE, z)
    curve = isothermal.curve(surfaces.SPHERE, z[:, around * 7 // 10])
    flat, flat_curve = moebius.stereographic(V), moebius.stereographic(curve)
    W = np.stack([flat.real, flat.imag, 0 * flat.real], axis=1)
    _sphere(axes["A"], plot.camera(azimuth, elevation), V, Q, curve)
    _plane(axes["A'"], W, Q, flat_curve)
    plot.panel(axes["A"], "A", "on the unit sphere")
    plot.panel(axes["A'"], "A'", "in the plane (dashed: equator)")
    data, claims = {"sphere": V, "plane": W}, {}
    for name, points in data.items():
        claims |= sampled(f"sampled_net_{name}", points, Q, isothermal.ANGLES)
    return figure, data, [(*conformal.quads(z), *isothermal.ANGLES)], claims


def _sphere(ax, view, V, Q, curve):
    lines = plot.families(V, Q, {"v": 0.7, "u": 0.7})
    lines.append((curve, plot.COLOURS["u"], 2.6))
    plot.scene(ax, view, V, Q, plot.shade(V, Q), lines)
    plot.curves(ax, [CIRCLE], plot.GREY, 0.7, zorder=0)
    north = view(np.array([0, 0, 1.0]))[0]
    ax.plot(*north, "o", color=plot.INK, ms=4, zorder=7)
    plot.text(ax, north + np.array([0.06, 0.02]), "$N$", zorder=7, ha="left")


def _plane(ax, V, Q, curve):
    plot.polygons(ax, V, Q, plot.PALE, zorder=0)
    plot.net(ax, V, Q, width=0.7)
    plot.curves(ax, [curve], plot.COLOURS["u"], 2.6)
    plot.curves(ax, [CIRCLE], plot.INK, 0.8, (0, (4, 3)), zorder=5)
